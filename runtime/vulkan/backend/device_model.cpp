#include "runtime/vulkan/backend/device_model.h"

namespace bodyopt::vulkan {

SkinTables::SkinTables(const Device& device, const Basis& b)
    : ddm(device, b.ddm, device.info()),
      blend(device, b.residual.blend_begin, b.residual.blend, device.info()),
      modifiers(device, b.modifiers.blend_begin, b.modifiers.blend, device.info()),
      strain_vertices(upload(device, b.strain.vertices, "the strain vertices")),
      points(upload(device, b.strain.points, "the fibre points")),
      fibre_begin(upload(device, b.strain.fibre_begin, "the fibres")),
      rest_length(upload(device, b.strain.rest_length, "the fibres' rest lengths")),
      ranges(upload(device, b.residual.features, "the feature ranges")),
      regions(upload(device, b.residual.regions, "the regions")),
      region_features(upload(device, b.residual.region_features, "the regions' features")),
      coordinate_region(upload(device, b.residual.coordinate_region, "the coordinates' regions")),
      projections(upload(device, b.residual.projections, "the projections")),
      centre_region(upload(device, b.residual.centre_region, "the centres' regions")),
      centres(upload(device, b.residual.centres, "the centres")),
      coefficient_region(upload(device, b.residual.coefficient_region, "the coefficients' regions")),
      weights(upload(device, b.residual.weights, "the weights")),
      rest(upload(device, b.modifiers.of_type(kRelax.name) ? b.mesh.rest : std::vector<float>(), "the skin at rest")),
      fold_sides(upload(device, bodyopt::fold_sides(b), "the folds' sides")),
      triangles(upload(device, b.mesh.triangles, "the triangles")),
      vertex_triangle_begin(upload(device, b.mesh.vertex_triangle_begin, "the vertices' triangles")),
      vertex_triangles(upload(device, b.mesh.vertex_triangles, "the vertices' triangles")),
      output_vertex(upload(device, b.mesh.output_vertex, "the output vertices")) {}

SkinKernels::SkinKernels(const Device& device)
    : strain_skin(device),
      strain_measure(device),
      residual_features(device),
      residual_project(device),
      residual_kernels(device),
      residual_coefficients(device),
      residual_blend(device),
      modify_blend(device),
      pose_skin(device),
      output_relax(device),
      output_bound(device),
      output_separate(device),
      output_normals(device),
      output_place(device) {}

DynamicsTables::DynamicsTables(const Device& device, const Dynamics& d)
    : tets(upload(device, d.tets.tets, "the tets")),
      shapes(upload(device, d.tets.shapes, "the tets' shapes")),
      corner_begin(upload(device, d.tets.corner_begin, "the nodes' tets")),
      corners(upload(device, d.tets.corners, "the nodes' tets")),
      surface(upload(device, d.tets.surface, "the nodes on the skin")),
      skin(upload(device, d.tets.skin, "the tets of the skin")),
      limit(upload(device, d.tets.skin_limit, "the limits of the skin")),
      row_begin(upload(device, d.diffuse.row_begin, "the rows of diffuse")),
      columns(upload(device, d.diffuse.columns, "the columns of diffuse")),
      values(upload(device, d.diffuse.values, "the values of diffuse")),
      diffuse_inverse(device, d.diffuse.inverse, device.info()),
      nodes(upload(device, d.jiggle.nodes, "the nodes of the jiggle")),
      jiggle_inverse(device, d.jiggle.inverse, device.info()) {}

DynamicsKernels::DynamicsKernels(const Device& device)
    : diffuse_surface(device),
      diffuse_gather(device),
      block_solve(device),
      jiggle_rotate(device),
      jiggle_kick(device),
      jiggle_begin(device),
      jiggle_advance(device),
      jiggle_end(device),
      jiggle_skin(device) {}

DeviceModel::DeviceModel(std::shared_ptr<const Device> device, std::shared_ptr<const CharacterModel> model)
    : device_(std::move(device)),
      model_(std::move(model)),
      counts_(model_->basis),
      tables_(*device_, model_->basis),
      kernels_(*device_) {}

const DeviceModel::Jiggling& DeviceModel::jiggling() const {
  std::call_once(jiggles_, [&] {
    jiggling_.emplace(Jiggling{DynamicsTables(*device_, *model_->dynamics), DynamicsKernels(*device_)});
  });
  return *jiggling_;
}

}  // namespace bodyopt::vulkan
