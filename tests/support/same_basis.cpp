#include "tests/support/same_basis.h"

#include "runtime/basis/skin_modifiers.h"

namespace bodyopt::testing {

bool same_bits(const Skeleton& a, const Skeleton& b) {
  if (a.size() != b.size() || a.features != b.features) return false;
  for (std::size_t j = 0; j < a.size(); ++j) {
    const Joint &x = a.joints[j], &y = b.joints[j];
    if (x.name != y.name || x.parent != y.parent || std::memcmp(&x.bind, &y.bind, sizeof(x.bind)) != 0 ||
        std::memcmp(&x.default_local, &y.default_local, sizeof(x.bind)) != 0 ||
        std::memcmp(&x.inverse_bind, &y.inverse_bind, sizeof(x.inverse_bind)) != 0) {
      return false;
    }
  }
  return true;
}

std::string difference(const Basis& a, const Basis& b) {
  const MeshTable &m = a.mesh, &n = b.mesh;
  const ResidualTable &r = a.residual, &s = b.residual;
  if (!same_bits(a.skeleton, b.skeleton)) return "skeleton";
  if (!same_bits(m.rest, n.rest) || !same_bits(m.triangles, n.triangles) ||
      !same_bits(m.output_vertex, n.output_vertex) || !same_bits(m.output_triangles, n.output_triangles) ||
      !same_bits(m.vertex_triangle_begin, n.vertex_triangle_begin) ||
      !same_bits(m.vertex_triangles, n.vertex_triangles)) {
    return "mesh";
  }
  if (!same_bits(a.ddm.block_begin, b.ddm.block_begin) || !same_bits(a.ddm.block_joints, b.ddm.block_joints) ||
      !same_bits(a.ddm.moments, b.ddm.moments) || !same_bits(a.ddm.vertices, b.ddm.vertices)) {
    return "ddm";
  }
  if (!same_bits(a.strain.vertices, b.strain.vertices) || !same_bits(a.strain.points, b.strain.points) ||
      !same_bits(a.strain.fibre_begin, b.strain.fibre_begin) ||
      !same_bits(a.strain.rest_length, b.strain.rest_length) || a.strain.names != b.strain.names) {
    return "strain";
  }
  if (r.controls != s.controls || !same_bits(r.features, s.features) || !same_bits(r.regions, s.regions) ||
      !same_bits(r.region_features, s.region_features) || !same_bits(r.coordinate_region, s.coordinate_region) ||
      !same_bits(r.projections, s.projections) || !same_bits(r.centre_region, s.centre_region) ||
      !same_bits(r.centres, s.centres) || !same_bits(r.coefficient_region, s.coefficient_region) ||
      !same_bits(r.weights, s.weights) || !same_bits(r.blend_begin, s.blend_begin) || !same_bits(r.blend, s.blend)) {
    return "residual";
  }
  const FadeTable &f = r.fade, &g = s.fade;
  if (!same_bits(f.joint_begin, g.joint_begin) || !same_bits(f.joints, g.joints) ||
      !same_bits(f.direction_begin, g.direction_begin) || !same_bits(f.directions, g.directions) ||
      !same_bits(f.tolerance, g.tolerance) || !same_bits(f.region_begin, g.region_begin) ||
      !same_bits(f.region_joints, g.region_joints) || !same_bits(f.region_weights, g.region_weights)) {
    return "fade";
  }
  const CoverageTable &k = a.coverage, &l = b.coverage;
  if (k.names != l.names || !same_bits(k.joint_begin, l.joint_begin) || !same_bits(k.joints, l.joints) ||
      !same_bits(k.sizes, l.sizes) || !same_bits(k.growth, l.growth) || !same_bits(k.usual, l.usual) ||
      !same_bits(k.local, l.local) || !same_bits(k.motion, l.motion) || !same_bits(k.metric, l.metric)) {
    return "coverage";
  }
  if (!same_bits(a.modifiers.blend_begin, b.modifiers.blend_begin) ||
      !same_bits(a.modifiers.blend, b.modifiers.blend) ||
      text_of_stack(a.modifiers.stack, "a") != text_of_stack(b.modifiers.stack, "b")) {
    return "modifiers";
  }
  return a.metadata == b.metadata ? "" : "metadata";
}

}  // namespace bodyopt::testing
