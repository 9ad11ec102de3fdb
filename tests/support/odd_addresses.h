// Arrays at addresses that are as aligned as their numbers are, and no more: at those to which an allocator gives them
// a load of a whole register may ask for too much and never be found out.
#pragma once

#include <vector>

#include "runtime/basis/dynamics.h"

namespace bodyopt::testing {

// While it lives, `new` gives addresses that are 4 more than a multiple of 16. For arrays of numbers alone.
class OddNew {
 public:
  OddNew();
  ~OddNew();
  OddNew(const OddNew&) = delete;
  OddNew& operator=(const OddNew&) = delete;
};

template <typename... T>
void move_to_odd_addresses(std::vector<T>&... arrays) {
  static_assert(((alignof(T) <= 4) && ...));
  const OddNew odd;
  ((arrays = std::vector<T>(arrays.begin(), arrays.end())), ...);
}

inline void move_to_odd_addresses(DdmTable& ddm) {
  move_to_odd_addresses(ddm.block_begin, ddm.block_joints, ddm.moments, ddm.vertices);
}
inline void move_to_odd_addresses(MeshTable& mesh) {
  move_to_odd_addresses(mesh.rest, mesh.triangles, mesh.output_vertex, mesh.vertex_triangle_begin,
                        mesh.vertex_triangles);
}
inline void move_to_odd_addresses(StrainTable& strain) {
  move_to_odd_addresses(strain.vertices, strain.points, strain.fibre_begin, strain.rest_length);
}
inline void move_to_odd_addresses(ResidualTable& r) {
  move_to_odd_addresses(r.features, r.regions, r.region_features, r.coordinate_region, r.projections, r.centre_region,
                        r.centres, r.coefficient_region, r.weights, r.blend_begin, r.blend);
}
inline void move_to_odd_addresses(SkinModifiers& modifiers) {
  move_to_odd_addresses(modifiers.blend_begin, modifiers.blend);
}
inline void move_to_odd_addresses(BlockInverse& inverse) {
  move_to_odd_addresses(inverse.levels, inverse.slot_unknown, inverse.child_slots, inverse.up, inverse.down,
                        inverse.values);
}
inline void move_to_odd_addresses(TetTable& tets) {
  move_to_odd_addresses(tets.nodes, tets.tets, tets.shapes, tets.corner_begin, tets.corners, tets.surface, tets.skin,
                        tets.skin_limit);
}
inline void move_to_odd_addresses(Dynamics& dynamics) {
  move_to_odd_addresses(dynamics.tets);
  DiffuseTable& diffuse = dynamics.diffuse;
  move_to_odd_addresses(diffuse.row_begin, diffuse.columns, diffuse.values);
  move_to_odd_addresses(diffuse.inverse);
  move_to_odd_addresses(dynamics.jiggle.nodes);
  move_to_odd_addresses(dynamics.jiggle.inverse);
}

}  // namespace bodyopt::testing
