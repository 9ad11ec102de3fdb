#include "trainer/transfer/carry_parts.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "assets/caches/pc2.h"
#include "base/wording.h"
#include "dataset/modifier.h"
#include "geometry/mesh.h"
#include "runtime/basis/output_order.h"
#include "runtime/core/error.h"
#include "runtime/core/transformed.h"
#include "runtime/host/rig.h"
#include "trainer/curate/mirror_image.h"
#include "trainer/train/skinning/ddm.h"
#include "trainer/transfer/skin_transfer.h"

namespace bodyopt::trainer {
namespace {

// Moves points inside the body as the joints and the skin around them say.
class BodyCarrier {
 public:
  explicit BodyCarrier(const TransferPair& pair)
      : pair_(pair),
        warp_(joint_warps(pair.source, pair.target, pair.match)),
        rest_(rows_of(pair.source.mesh.rest)),
        skin_gap_(sure_places(pair) - warped_by_joints(pair.source, pair.target, pair.match)) {}

  // The nearest joint that the target has, at or above `joint` of the source; -1 for none.
  int joint_of(std::uint32_t joint) const {
    return matched_at_or_above(pair_.source.skeleton, pair_.match.target_joint, static_cast<int>(joint));
  }

  double size_at(int source_joint) const { return warp_[static_cast<std::size_t>(source_joint)].size; }

  // Rest space of the source to rest space of the target.
  MusclePoint carried(const MusclePoint& point, int source_joint) const {
    const Eigen::RowVector3d place(point.position[0], point.position[1], point.position[2]);
    const JointWarp& warp = warp_[static_cast<std::size_t>(source_joint)];
    const Eigen::RowVector3d common = warp.to + warp.size * (place - warp.from) + gap_at(place);
    const auto joint = static_cast<std::uint32_t>(pair_.match.target_joint[static_cast<std::size_t>(source_joint)]);
    return {joint, to_bind(joint, common)};
  }

 private:
  Eigen::RowVector3d gap_at(const Eigen::RowVector3d& place) const {
    const Eigen::VectorXd weights =
        ((rest_.rowwise() - place).rowwise().squaredNorm().array() + 1e-12).square().inverse();
    return (weights.transpose() * skin_gap_) / weights.sum();
  }

  // Moves a place from the common pose back to the target's own rest, rigidly with the joint.
  Vec3 to_bind(std::uint32_t joint, const Eigen::RowVector3d& place) const {
    const std::vector<Affine> skinning = skinning_matrices(pair_.target.skeleton, pair_.match.common.joints);
    return inverse(skinning[joint]) * Vec3{place[0], place[1], place[2]};
  }

  const TransferPair& pair_;
  const std::vector<JointWarp> warp_;
  const Positions rest_;
  const Positions skin_gap_;  // of the source's vertices: what the fit adds to the joints' warp
};

// V' x R: of every vertex of the target the weights of the points of the source that it is.
Eigen::MatrixXd mixed_on_target(const TransferPair& pair, const std::vector<RegionWeights>& regions) {
  const std::vector<SkinPoint>& at = pair.correspondence.at;
  Eigen::MatrixXd weights(at.size(), regions.size());
  for (std::size_t r = 0; r < regions.size(); ++r) {
    Eigen::VectorXd on_source = Eigen::VectorXd::Zero(pair.source.mesh.vertex_count());
    on_source(regions[r].vertices) = Eigen::Map<const Eigen::VectorXd>(
        regions[r].weights.data(), static_cast<Eigen::Index>(regions[r].weights.size()));
    for (std::size_t v = 0; v < at.size(); ++v) {
      weights(static_cast<Eigen::Index>(v), static_cast<Eigen::Index>(r)) =
          at[v].weights.dot(on_source(at[v].vertices));
    }
  }
  return weights;
}

namespace fs = std::filesystem;

// Gives joints the target's names in every list called "joints", at any depth. False where the target has none of a
// list: that is left as it is, for an empty one would mean all of the skin.
bool rename_joints(Json& json, const TransferPair& pair) {
  bool is_found = true;
  if (json.is_array()) {
    for (Json& item : json) is_found = rename_joints(item, pair) && is_found;
  }
  if (!json.is_object()) return is_found;
  for (auto& [key, value] : json.items()) {
    if (key != "joints" || !value.is_array()) {
      is_found = rename_joints(value, pair) && is_found;
      continue;
    }
    Json names = Json::array();
    for (const Json& name : value) {
      const int joint = name.is_string() ? pair.source.skeleton.find(name.get<std::string>()) : -1;
      const int other = joint < 0 ? -1 : pair.match.target_joint[static_cast<std::size_t>(joint)];
      if (other >= 0) names.push_back(pair.target.skeleton.joints[static_cast<std::size_t>(other)].name);
    }
    if (names.empty() && !value.empty()) {
      is_found = false;
    } else {
      value = names;
    }
  }
  return is_found;
}

class ModifierCarrier {
 public:
  ModifierCarrier(const Dataset& dataset, const Character& source_character, const Character& target,
                  const TransferPair& pair, const fs::path& out, std::vector<std::string>& notes)
      : dataset_(dataset), character_(source_character), target_(target), pair_(pair), out_(out), notes_(notes) {}

  Modifier carry(Modifier modifier) {
    bool is_carried = modifier.type != "blend";
    for (Json* part : {&modifier.mask, &modifier.frames, &modifier.parameters}) {
      is_carried = rename_joints(*part, pair_) && is_carried;
    }
    for (auto& [key, value] : modifier.parameters.items()) {
      if (key.ends_with("_mm") && value.is_number()) value = pair_.match.size * value.get<double>();
    }
    if (modifier.type == "sculpt" && modifier.parameters.contains("sculpts")) carry_sculpts(modifier.parameters);
    if (!is_carried) disable(modifier, "what it names is the source's alone");
    if (modifier.type == "symmetry" && !is_own_mirror_image(target_)) {
      disable(modifier, "the target is not its own mirror image");
    }
    return modifier;
  }

 private:
  void disable(Modifier& modifier, const std::string& why) {
    if (modifier.enabled) notes_.push_back("the modifier '" + modifier.name + "' is disabled: " + why);
    modifier.enabled = false;
  }

  void carry_sculpts(Json& parameters) {
    for (Json& sculpt : parameters["sculpts"]) {
      const JsonObject object(sculpt, dataset_.folder / "dataset.json", "a sculpt");
      const fs::path name = fs::path("modifiers") / fs::path(object.name("offsets")).filename();
      write_carried(dataset_.folder / object.name("offsets"), out_ / name);
      sculpt["offsets"] = name.string();
    }
  }

  void write_carried(const fs::path& from, const fs::path& to) {
    const Pc2Reader reader(from);
    if (reader.point_count() != character_.output_count() || reader.sample_count() != 1) {
      throw Error(ErrorKind::mismatch, from, ": has ", reader.point_count(), " points, and the character ",
                  character_.output_count(), ": it was sculpted on another mesh");
    }
    const Positions given = welded_from_output(character_, reader.sample(0).data());
    const Positions carried = pair_.skin(in_order(given, morton_order(character_.vertices)));
    const std::vector<float> points = output_of(pair_.target.mesh, floats_of(carried));
    fs::create_directories(to.parent_path());
    Pc2Writer writer(to, static_cast<std::uint32_t>(points.size() / 3), 1);
    writer.append(points);
    writer.close();
  }

  const Dataset& dataset_;
  const Character &character_, &target_;
  const TransferPair& pair_;
  const fs::path out_;
  std::vector<std::string>& notes_;
};

}  // namespace

std::vector<Muscle> carried_muscles(const TransferPair& pair, const std::vector<Muscle>& muscles,
                                    std::vector<std::string>& notes) {
  const BodyCarrier carrier(pair);
  std::vector<Muscle> result;
  std::vector<std::string> left_out;
  for (const Muscle& muscle : muscles) {
    Muscle carried = muscle;
    double size = 0;
    bool held = true;
    for (MusclePoint& point : carried.path) {
      const int joint = carrier.joint_of(point.joint);
      held = held && joint >= 0;
      if (!held) break;
      size += carrier.size_at(joint) / static_cast<double>(carried.path.size());
      point = carrier.carried(point, joint);
    }
    if (!held) {
      left_out.push_back(muscle.name);
      continue;
    }
    carried.radius *= size;
    result.push_back(std::move(carried));
  }
  if (!left_out.empty()) {
    notes.push_back("Muscles of joints that the target does not have are left out: " + list_names(left_out) + ".");
  }
  return result;
}

std::vector<RegionWeights> carried_regions(const TransferPair& pair, const std::vector<RegionWeights>& regions) {
  Eigen::MatrixXd weights = mixed_on_target(pair, regions);
  pair.skin.fill()(weights);
  std::vector<RegionWeights> result;
  for (std::size_t r = 0; r < regions.size(); ++r) {
    RegionWeights carried{regions[r].name, {}, {}};
    for (std::uint32_t v = 0; v < weights.rows(); ++v) {
      const double weight = weights(v, static_cast<Eigen::Index>(r));
      if (!(weight > 0)) continue;
      carried.vertices.push_back(v);
      carried.weights.push_back(std::min(weight, 1.0));
    }
    result.push_back(std::move(carried));
  }
  drop_negligible(result);
  std::erase_if(result, [](const RegionWeights& region) { return region.vertices.empty(); });
  return result;
}

std::vector<NamedSelection> carried_selections(const Dataset& dataset, const TransferPair& pair) {
  std::vector<NamedSelection> selections = dataset.selections;
  for (NamedSelection& selection : selections) rename_joints(selection.frames, pair);
  return selections;
}

std::vector<Modifier> carried_modifiers(const Dataset& dataset, const Character& source_character,
                                        const Character& target, const TransferPair& pair, const fs::path& out,
                                        std::vector<std::string>& notes) {
  ModifierCarrier carrier(dataset, source_character, target, pair, out, notes);
  return transformed(dataset.modifiers, [&](const Modifier& modifier) { return carrier.carry(modifier); });
}

}  // namespace bodyopt::trainer
