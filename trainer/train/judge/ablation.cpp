#include "trainer/train/judge/ablation.h"

#include <algorithm>

#include "runtime/core/error.h"
#include "runtime/core/stopwatch.h"
#include "runtime/deformer/deformer.h"
#include "runtime/host/device_choice.h"
#include "trainer/train/fit/train.h"
#include "trainer/train/judge/heldout.h"
#include "trainer/train/pack/trade_off.h"
#include "trainer/train/skinning/linear_blend.h"
#include "trainer/train/skinning/mesh_table.h"
#include "trainer/train/skinning/unpose.h"

namespace bodyopt {
namespace {

using Support = Method::Support;
using Unposing = Method::Unposing;

// Per region, of methods that need them to make use of their bytes: linear maps, and components of the whole skin.
constexpr int kManyComponents = 128;

struct NamedMethod {
  const char* name;
  Method method;
};

constexpr NamedMethod kMethods[] = {
    {"LBS + joints, linear, dense", {Unposing::lbs, Support::whole_skin, false, false}},         // as SMPL
    {"LBS + joints, linear, local", {Unposing::lbs, Support::static_regions, false, false}},     // as STAR
    {"LBS + joints, kernels, dense", {Unposing::lbs, Support::whole_skin, false, true}},         // as DCC tools
    {"LBS + strains, kernels, dynamic", {Unposing::lbs, Support::dynamic_regions, true, true}},  // full, but un-posing
    {"DDM + joints, linear, dense", {Unposing::ddm, Support::whole_skin, false, false}},
    {"DDM + joints, linear, local", {Unposing::ddm, Support::static_regions, false, false}},
    {"DDM + joints, kernels, static", {Unposing::ddm, Support::static_regions, false, true}},
    {"DDM + strains, kernels, dense", {Unposing::ddm, Support::whole_skin, true, true}},
    {"DDM + strains, kernels, static", {Unposing::ddm, Support::static_regions, true, true}},
};

// A joint index and a weight, four bytes each.
double lbs_bytes_per_vertex(const Character& character) {
  double weights = 0;
  for (const auto& row : character.weights) weights += static_cast<double>(row.size());
  return 8 * weights / static_cast<double>(character.weights.size());
}

// What a basis that was trained on linear un-posing stands for: the deformer adds its displacement before Direct Delta
// Mush; taken out again, it is added before linear blending.
std::vector<Positions> heldout_by_corrected_lbs(const SampleSet& set, const Basis& basis) {
  const std::vector<std::uint32_t> order = morton_order(set.character.vertices);
  Deformer deformer(basis, {.name = "cpu"});
  std::vector<Positions> shapes = heldout_by_basis(set, deformer);
  Character moved = set.character;
  for (std::size_t k = 0; k < shapes.size(); ++k) {
    const Pose& pose = set.heldout[k].pose;
    const Positions delta = unpose_ddm(basis, pose, in_order(shapes[k], order));
    for (std::size_t v = 0; v < order.size(); ++v) {
      moved.vertices.row(order[v]) = set.character.vertices.row(order[v]) + delta.row(static_cast<Eigen::Index>(v));
    }
    shapes[k] = skin_linear(moved, pose);
  }
  return shapes;
}

MethodResult row_of(const std::string& name, const SampleSet& set, const Basis& basis, double seconds) {
  Deformer deformer(basis, {.name = "cpu"});
  return {name, heldout_errors(set.heldout, heldout_by_basis(set, deformer)), bytes_per_vertex(basis),
          basis.residual.coefficient_count(), seconds};
}

// `spared_bytes`: of every vertex, what linear blending takes less than Direct Delta Mush.
MethodResult row_of(const NamedMethod& named, const SampleSet& set, TrainOptions options, double spared_bytes) {
  const Stopwatch watch;
  options.method = named.method;
  if (!named.method.kernels || named.method.support == Support::whole_skin) {
    options.components = std::max(options.components, kManyComponents);
  }
  // The basis that is trained has the table of Direct Delta Mush; linear blending does without.
  if (named.method.unposing == Unposing::lbs) options.budget += spared_bytes;
  const Basis basis = train(set, options).basis;
  const double seconds = watch.seconds();
  if (named.method.unposing == Unposing::ddm) return row_of(named.name, set, basis, seconds);
  const auto tables = table_bytes(basis);
  const auto learned = static_cast<double>(tables.at("strain") + tables.at("residual"));
  return {named.name, heldout_errors(set.heldout, heldout_by_corrected_lbs(set, basis)),
          lbs_bytes_per_vertex(set.character) + learned / basis.mesh.vertex_count(), basis.residual.coefficient_count(),
          seconds};
}

}  // namespace

std::vector<MethodResult> compare_with_skinning(const SampleSet& set, const Basis& full, double seconds) {
  return {{"LBS", heldout_errors(set.heldout, heldout_by_lbs(set)), lbs_bytes_per_vertex(set.character), 0, 0},
          row_of("DDM", set, without_residual(full), 0),
          row_of("full: DDM + strains, kernels, dynamic", set, full, seconds)};
}

std::vector<MethodResult> ablate(const SampleSet& set, const TrainOptions& options, const TrainingResult& full,
                                 double seconds, std::vector<std::string>& unmade) {
  std::vector<MethodResult> rows = compare_with_skinning(set, full.basis, seconds);
  TrainOptions matched = options;
  matched.smoothing_radius = full.smoothing_radius;  // chosen by the same frames, each would find it again
  matched.budget = bytes_per_vertex(full.basis);
  const double spared = bytes_per_vertex(without_residual(full.basis)) - lbs_bytes_per_vertex(set.character);
  matched.tolerance_mm = 0;
  matched.keep_in.clear();  // that is for the full model
  matched.update = false;
  for (const NamedMethod& named : kMethods) {
    try {
      rows.insert(rows.end() - 1, row_of(named, set, matched, spared));
    } catch (const Error& error) {
      // Options that served the full model can ask too much of another in their budget alone.
      if (error.kind() != ErrorKind::usage) throw;
      unmade.push_back(named.name);
    }
  }
  return rows;
}

}  // namespace bodyopt
