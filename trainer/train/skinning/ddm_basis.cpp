#include "trainer/train/skinning/ddm_basis.h"

#include <nlohmann/json.hpp>

#include "runtime/core/hexadecimal.h"
#include "runtime/core/json.h"
#include "trainer/train/skinning/mesh_table.h"

namespace bodyopt {

std::string provenance_text(const Character& character, double radius, const TrainOptions& options, bool updated) {
  Json provenance = {{"program", "bodyopt " BODYOPT_VERSION},
                     {"character", character.name},
                     {"smoothing_radius_m", radius},
                     {"smoothing_steps", options.smoothing_steps},
                     {"components", options.components},
                     {"centres", options.centres},
                     {"budget", options.budget},
                     {"tolerance_mm", options.tolerance_mm},
                     {"surface_curves", options.surface_curves},
                     {"seed", options.seed}};
  if (updated) provenance["updated"] = true;
  return provenance.dump(-1, ' ', false, Json::error_handler_t::replace);
}

DdmBase make_ddm_base(const Character& ordered, double radius, const TrainOptions& options) {
  DdmBase base{{},
               ddm_moments(ordered.vertices, ordered.triangles, ordered.weights,
                           {.radius = radius, .steps = options.smoothing_steps}),
               radius};
  Basis& basis = base.basis;
  basis.skeleton = ordered.skeleton;
  basis.mesh = make_mesh_table(ordered);
  basis.ddm = pack_ddm(base.moments);
  basis.strain.fibre_begin = {0};
  basis.residual.blend_begin.assign(basis.mesh.block_count() + 1, 0);
  basis.metadata["units"] = "metres";
  basis.metadata["topology_hash"] = hexadecimal(topology_hash(basis.mesh));
  basis.metadata["skeleton_hash"] = hexadecimal(skeleton_hash(basis.skeleton));
  basis.metadata["provenance"] = provenance_text(ordered, radius, options, false);
  return base;
}

Basis build_ddm_basis(const Character& character, const TrainOptions& options) {
  const Character ordered = in_order(character, morton_order(character.vertices));
  const double radius =
      options.smoothing_radius > 0 ? options.smoothing_radius : default_smoothing_radius(ordered.vertices);
  return make_ddm_base(ordered, radius, options).basis;
}

}  // namespace bodyopt
