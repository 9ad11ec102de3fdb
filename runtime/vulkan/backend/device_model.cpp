#include "runtime/vulkan/backend/device_model.h"

#include "runtime/vulkan/commands.h"

namespace bodyopt::vulkan {
namespace {

// Before anything is uploaded: what the kernels without windows run over.
const Basis& require_threads_of(const Basis& basis, const FrameCounts& n, const DeviceInfo& limits) {
  require_threads(n.strain_vertices, "the strain vertices", limits);
  require_threads(n.fibres, "the fibres", limits);
  require_threads(n.features, "the features", limits);
  require_threads(n.coordinates, "the coordinates", limits);
  require_threads(n.centres, "the centres", limits);
  require_threads(n.coefficients, "the coefficients", limits);
  require_threads(n.boxes, "the boxes of triangles", limits);
  if (n.boxes > 0) require_threads(n.vertices, "the skin that is pushed out", limits);
  require_threads(n.tangents / 4, "the tangents' vertices", limits);
  return basis;
}

const Dynamics& require_threads_of(const Dynamics& dynamics, const DeviceInfo& limits) {
  require_threads(dynamics.tets.nodes.size(), "the numbers of the nodes", limits);
  require_threads(dynamics.tets.skin.size(), "the skin that jiggles", limits);
  for (const BlockInverse* inverse : {&dynamics.diffuse.inverse, &dynamics.jiggle.inverse}) {
    for (const InverseLevel& level : inverse->levels) {
      require_threads(level.end_slot - level.first_slot, "a level of the block inverse", limits);
    }
  }
  return dynamics;
}

}  // namespace

BlockSolve::BlockSolve(const Device& device) : gather_(device), up_(device), down_(device) {}

void BlockSolve::record(Commands& commands, const Buffers& buffers, std::uint32_t right_side_count,
                        std::uint32_t interleave) const {
  const auto& [inverse, right_sides, gathered, results, solutions] = buffers;
  for (const InverseBuffers::LevelWindows& level : inverse.levels) {
    record_block_gather(commands, gather_, {inverse, right_sides, results, gathered}, level, right_side_count,
                        interleave);
    record_block_up(commands, up_, {inverse, gathered, results}, level, right_side_count);
  }
  for (auto level = inverse.levels.rbegin(); level != inverse.levels.rend(); ++level) {
    record_block_down(commands, down_, {inverse, results, solutions}, *level, right_side_count, interleave);
  }
}

FoldBuffers::FoldBuffers(Uploads& uploads, const FoldTables& tables, const DeviceInfo& limits)
    : triangles(upload_whole(uploads, tables.triangles, "the triangles", limits)),
      sides(upload_whole(uploads, tables.sides, "the folds' sides", limits)) {}

TangentBuffers::TangentBuffers(Uploads& uploads, const TangentTables& tables, const DeviceInfo& limits)
    : vertices(upload_whole(uploads, tables.vertices, "the tangents' vertices", limits)),
      corners(upload_whole(uploads, tables.corners, "the tangents' corners", limits)) {}

SkinTables::SkinTables(Uploads& uploads, const Basis& b, const FoldTables& fold_tables,
                       const TangentTables& tangent_tables, const DeviceInfo& limits)
    : ddm(uploads, b.ddm, limits),
      blend(uploads, b.residual.blend_begin, b.residual.blend, limits),
      modifiers(uploads, b.modifiers.blend_begin, b.modifiers.blend, limits),
      strain_vertices(upload_whole(uploads, b.strain.vertices, "the strain vertices", limits)),
      points(upload_whole(uploads, b.strain.points, "the fibre points", limits)),
      fibre_begin(upload_whole(uploads, b.strain.fibre_begin, "the fibres", limits)),
      rest_length(upload_whole(uploads, b.strain.rest_length, "the fibres' rest lengths", limits)),
      ranges(upload_whole(uploads, b.residual.features, "the feature ranges", limits)),
      regions(upload_whole(uploads, b.residual.regions, "the regions", limits)),
      region_features(upload_whole(uploads, b.residual.region_features, "the regions' features", limits)),
      coordinate_region(upload_whole(uploads, b.residual.coordinate_region, "the coordinates' regions", limits)),
      projections(upload_whole(uploads, b.residual.projections, "the projections", limits)),
      centre_region(upload_whole(uploads, b.residual.centre_region, "the centres' regions", limits)),
      centres(upload_whole(uploads, b.residual.centres, "the centres", limits)),
      coefficient_region(upload_whole(uploads, b.residual.coefficient_region, "the coefficients' regions", limits)),
      weights(upload_whole(uploads, b.residual.weights, "the weights", limits)),
      rest(upload_whole(uploads, b.modifiers.of_type(kRelax.name) ? b.mesh.rest : std::vector<float>(),
                        "the skin at rest", limits)),
      folds(uploads, fold_tables, limits),
      fans(uploads, b.mesh, limits),
      tangents(uploads, tangent_tables, limits),
      output_vertex(upload_whole(uploads, b.mesh.output_vertex, "the output vertices", limits)) {}

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
      output_tangents(device),
      output_place(device) {}

DynamicsTables::DynamicsTables(Uploads& uploads, const Dynamics& d, const DeviceInfo& limits)
    : tets(upload_whole(uploads, d.tets.tets, "the tets", limits)),
      shapes(upload_whole(uploads, d.tets.shapes, "the tets' shapes", limits)),
      corner_begin(upload_whole(uploads, d.tets.corner_begin, "the nodes' tets", limits)),
      corners(upload_whole(uploads, d.tets.corners, "the nodes' tets", limits)),
      surface(upload_whole(uploads, d.tets.surface, "the nodes on the skin", limits)),
      skin(upload_whole(uploads, d.tets.skin, "the tets of the skin", limits)),
      limit(upload_whole(uploads, d.tets.skin_limit, "the limits of the skin", limits)),
      row_begin(upload_whole(uploads, d.diffuse.row_begin, "the rows of diffuse", limits)),
      columns(upload_whole(uploads, d.diffuse.columns, "the columns of diffuse", limits)),
      values(upload_whole(uploads, d.diffuse.values, "the values of diffuse", limits)),
      diffuse_inverse(uploads, d.diffuse.inverse, limits),
      nodes(upload_whole(uploads, d.jiggle.nodes, "the nodes of the jiggle", limits)),
      jiggle_inverse(uploads, d.jiggle.inverse, limits) {}

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
    : DeviceModel(device, std::move(model), device->info()) {}

DeviceModel::DeviceModel(std::shared_ptr<const Device> device, std::shared_ptr<const CharacterModel> model,
                         const DeviceInfo& limits)
    : device_(std::move(device)),
      model_(std::move(model)),
      limits_(limits),
      counts_(model_->basis, model_->tangents),
      tables_(upload_together<SkinTables>(*device_, require_threads_of(model_->basis, counts_, limits_), model_->folds,
                                          model_->tangents, limits_)),
      kernels_(device_->shared<SkinKernels>()) {}

const DeviceModel::Jiggling& DeviceModel::jiggling() const {
  std::call_once(jiggles_, [&] {
    jiggling_.emplace(
        Jiggling{upload_together<DynamicsTables>(*device_, require_threads_of(*model_->dynamics, limits_), limits_),
                 device_->shared<DynamicsKernels>()});
  });
  return *jiggling_;
}

}  // namespace bodyopt::vulkan
