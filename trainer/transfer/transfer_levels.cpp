#include "trainer/transfer/transfer_levels.h"

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <nlohmann/json.hpp>
#include <numbers>

#include "assets/characters/character.h"
#include "base/wording.h"
#include "geometry/mesh.h"
#include "runtime/core/error.h"
#include "runtime/core/transform.h"
#include "trainer/proxy/build_proxy.h"
#include "trainer/proxy/level_skins.h"
#include "trainer/simulate/muscle_fibres.h"
#include "trainer/train/skinning/ddm.h"
#include "trainer/train/skinning/unpose.h"
#include "trainer/transfer/carry_parts.h"
#include "trainer/transfer/transfer_basis.h"

namespace bodyopt::trainer {
namespace {

// A level of detail on the target.
struct TargetSkin {
  double error;  // asked of it, millimetres
  Character skin;
};

constexpr double kTurn = 40 * std::numbers::pi / 180;

Positions bent(const Character& character, const Vec3& axis, double angle) {
  Pose pose = bind_pose(character.skeleton);
  const Quat turn = axis_angle(axis, angle);
  for (std::size_t j = 0; j < pose.joints.size(); ++j) {
    if (character.skeleton.joints[j].parent >= 0) pose.joints[j].rotation = pose.joints[j].rotation * turn;
  }
  return skin_linear(character, pose);
}

// The skin simplified for the default errors, as far as they make levels, `most` at most. Its shapes are at rest, and
// linear blends of all joints but roots turned 40 degrees about each axis, either way. No motion of it is known, and a
// skin simplified at rest alone keeps no vertices where limbs bend. `notes`, errors: as level_skins().
std::vector<TargetSkin> own_level_skins(const Character& character, std::size_t most, std::vector<std::string>& notes) {
  std::vector<Positions> shapes = {character.vertices};
  for (const Vec3& axis : {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}}) {
    for (const double angle : {kTurn, -kTurn}) shapes.push_back(bent(character, axis, angle));
  }
  std::vector<TargetSkin> levels;
  for (const LevelSkin& level : level_skins(character, shapes, {}, notes)) {
    if (levels.size() < most) levels.push_back({1e3 * level.error, proxy_character(character, level.skin)});
  }
  return levels;
}

// How much further from the target's skin than from the source's, in its size, the finest level may lie.
constexpr double kNearEnough = 3;

// Lays skins of levels onto the target.
class SkinLayer {
 public:
  SkinLayer(const TransferPair& pair, const Character& target)
      : pair_(pair),
        target_(target),
        order_(morton_order(target.vertices)),
        source_rest_(rows_of(pair.source.mesh.rest)),
        source_triangles_(rows_of(pair.source.mesh.triangles)),
        target_triangles_(rows_of(pair.target.mesh.triangles)),
        on_source_(source_rest_, source_triangles_),
        on_target_(pair.correspondence.target, target_triangles_) {}

  // The level's vertices in their runtime order, its triangles and output vertices; the target's skeleton and weights.
  Character lay(const MeshTable& level) const {
    Character result;
    result.name = target_.name;
    result.skeleton = target_.skeleton;
    result.triangles = rows_of(level.triangles);
    result.output_triangles = rows_of(level.output_triangles);
    result.output_vertex = level.output_vertex;
    const Positions rest = rows_of(level.rest);
    result.vertices.resize(rest.rows(), 3);
    for (Eigen::Index v = 0; v < rest.rows(); ++v) {
      const SkinPoint at = place_of(rest.row(v).transpose());
      result.vertices.row(v) = at_point(target_.vertices, at);
      result.weights.push_back(mixed_weights(at));
    }
    return result;
  }

 private:
  // The point of the target's skin, in the order of its file, that a point of the source's at rest lies on.
  SkinPoint place_of(const Eigen::Vector3d& point) const {
    SkinPoint at = on_target_(at_point(pair_.correspondence.fitted, on_source_(point)).transpose());
    for (std::uint32_t& vertex : at.vertices) vertex = order_[vertex];
    return at;
  }

  std::vector<JointWeight> mixed_weights(SkinPoint at) const {
    at.weights = at.weights.cwiseMax(0);  // rounding may leave less
    std::vector<JointWeight> weights = weights_at(target_.weights, at);
    std::ranges::stable_sort(weights, std::greater(), &JointWeight::weight);
    return weights;
  }

  const TransferPair& pair_;
  const Character& target_;
  const std::vector<std::uint32_t> order_;  // of the target's runtime vertices, in its file
  const Positions source_rest_;
  const Triangles source_triangles_, target_triangles_;
  const NearestSkin on_source_, on_target_;
};

// The target's own skin simplified; none where it is too coarse for that.
std::vector<TargetSkin> own_skins_of_levels(const Character& target, std::size_t most, const std::string& why,
                                            std::vector<std::string>& notes) {
  try {
    std::vector<TargetSkin> skins = own_level_skins(target, most, notes);
    notes.push_back(why + ": they are made of its own skin, simplified");
    return skins;
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::usage) throw;
    notes.push_back(why + ", and its own, of " +
                    count_of(static_cast<std::size_t>(target.vertices.rows()), "vertex", "vertices") +
                    ", is too coarse to be simplified: it gets no levels");
    return {};
  }
}

// The levels laid onto the target; where the finest lies far off, the target's own skin simplified instead.
std::vector<TargetSkin> skins_of_levels(const TransferPair& pair, const Character& target,
                                        const std::vector<Level>& levels, const ProxyReport& of_source,
                                        std::vector<std::string>& notes) {
  const SkinLayer layer(pair, target);
  const double size = pair.match.size;
  std::vector<TargetSkin> skins;
  for (std::size_t k = 0; k < levels.size(); ++k) {
    const double error = k < of_source.levels.size() ? size * of_source.levels[k].error : 0;
    skins.push_back({error, layer.lay(levels[k].basis.mesh)});
  }
  if (of_source.levels.empty()) return skins;
  const double off = skin_distance(target, skins.front().skin).rms;
  if (off <= kNearEnough * size * of_source.levels.front().distance_rms) return skins;
  const std::string why = "the source's levels of detail lie " + rounded(off) + " mm off this body's skin (RMS)";
  return own_skins_of_levels(target, levels.size(), why, notes);
}

LevelReport carried_report(LevelReport report, double size, const Character& target, const TargetSkin& laid,
                           const Level& level) {
  for (double* mm : {&report.skin_rms, &report.rms, &report.p99, &report.max}) *mm *= size;
  const SkinDistance distance = skin_distance(target, laid.skin);
  report.error = laid.error;
  report.vertices = static_cast<std::uint32_t>(laid.skin.vertices.rows());
  report.distance_rms = distance.rms;
  report.distance_max = distance.max;
  report.bytes = static_cast<double>(total_bytes(level.basis));
  report.map_bytes = static_cast<double>(level.carried.bytes());
  return report;
}

// The joints of the target that are those of the source that a region names: a region for each.
std::vector<JiggleRegion> on_target_joints(const JiggleRegion& region, const TransferPair& pair) {
  std::vector<JiggleRegion> result;
  const std::vector<Joint>& joints = pair.source.skeleton.joints;
  for (std::size_t j = 0; j < joints.size(); ++j) {
    const int target = pair.match.target_joint[j];
    if (target < 0 || !matches_pattern(region.name, joints[j].name)) continue;
    result.push_back(region);
    result.back().name = pair.target.skeleton.joints[static_cast<std::size_t>(target)].name;
  }
  return result;
}

// Empty: there is nothing on the target that it names.
std::vector<JiggleRegion> on_target(const JiggleRegion& region, const TransferPair& pair,
                                    const std::vector<Muscle>& muscles) {
  if (region.by == JiggleRegion::By::joint) return on_target_joints(region, pair);
  const bool is_there = region.by == JiggleRegion::By::muscle && std::ranges::any_of(muscles, [&](const Muscle& m) {
                          return matches_pattern(region.name, m.name);
                        });
  return is_there ? std::vector{region} : std::vector<JiggleRegion>();
}

JiggleSettings carried_settings(const JiggleSettings& source, const TransferPair& pair,
                                const std::vector<Muscle>& muscles, std::vector<std::string>& notes) {
  JiggleSettings result = source;
  result.regions.clear();
  std::vector<std::string> lost;
  for (const JiggleRegion& region : source.regions) {
    const std::vector<JiggleRegion> carried = on_target(region, pair, muscles);
    if (carried.empty()) lost.push_back(region.name);
    std::ranges::copy(carried, std::back_inserter(result.regions));
  }
  result.flesh *= pair.match.size;
  for (JiggleRegion& region : result.regions) {
    if (region.flesh) *region.flesh *= pair.match.size;
  }
  if (!lost.empty()) {
    notes.push_back(
        "the jiggle's settings name what the target is not known to have, which is left out: " + list_names(lost) +
        ". Of muscles --muscles knows; of painted regions 'transfer dataset', then 'dynamics' of that");
  }
  return result;
}

bool tenses(const Dynamics& dynamics) {
  return std::ranges::any_of(dynamics.jiggle.nodes, [](const JiggleNode& node) { return node.stiffening > 0; });
}

}  // namespace

std::vector<Level> transfer_levels(const TransferPair& pair, const Character& target, const std::vector<Level>& levels,
                                   const TransferOptions& options, std::vector<std::string>& notes) {
  TransferOptions own = options;
  own.markers.clear();  // of the full skins
  ProxyReport report = read_proxy_report(levels.front().basis);
  const std::vector<TargetSkin> skins = skins_of_levels(pair, target, levels, report, notes);
  if (skins.empty()) return {};
  report.full_vertices = static_cast<std::uint32_t>(target.vertices.rows());
  report.measured_on += " of the source";
  report.levels.resize(std::min(report.levels.size(), skins.size()));
  std::vector<Level> result;
  for (std::size_t k = 0; k < skins.size(); ++k) {
    const TransferPair laid(levels[k].basis, skins[k].skin, own);
    Level& level = result.emplace_back();
    std::vector<std::string> said_already;  // of the full basis, whose joints are the same
    level.basis = transfer_basis(laid, own, k == 0 ? notes : said_already);
    level.carried = map_skin(target, level.basis.mesh);
    if (k < report.levels.size()) {
      report.levels[k] = carried_report(report.levels[k], pair.match.size, target, skins[k], level);
    }
  }
  if (!report.levels.empty()) result.front().basis.metadata["levels"] = to_json(report).dump();
  validate(result, "the transferred proxy");
  return result;
}

void require_proxy_of(const Basis& source, const std::vector<Level>& levels) {
  for (const Level& level : levels) {
    if (level.carried.size() == source.mesh.output_count() &&
        skeleton_hash(level.basis.skeleton) == skeleton_hash(source.skeleton)) {
      continue;
    }
    throw Error(ErrorKind::mismatch, "the proxy is none of the source: it carries ", level.carried.size(),
                " vertices of ", level.basis.skeleton.size(), " joints, the source has ", source.mesh.output_count(),
                " and ", source.skeleton.size(), " (was it made of another basis?)");
  }
}

Dynamics transfer_dynamics(const TransferPair& pair, const Character& target, const Basis& basis,
                           const Dynamics& source, const std::vector<Muscle>& muscles,
                           std::vector<std::string>& notes) {
  const std::vector<Muscle> carried = carried_muscles(pair, muscles, notes);
  DynamicsOptions options = asked_options(source);
  options.settings = carried_settings(options.settings, pair, carried, notes);
  if (carried.empty() && tenses(source)) {
    notes.push_back("the source's tissue tenses with its muscles, the target's does not: they come with --muscles");
  }
  return build_dynamics(target, carried, basis, options).dynamics;
}

}  // namespace bodyopt::trainer
