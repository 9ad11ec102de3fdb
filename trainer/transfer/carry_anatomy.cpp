#include "trainer/transfer/carry_anatomy.h"

#include <algorithm>

#include "assets/wording.h"
#include "geometry/table_rows.h"
#include "runtime/host/rig.h"
#include "trainer/transfer/joint_warp.h"
#include "trainer/transfer/transfer_pair.h"

namespace bodyopt {
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

  // From the common pose back to the target's own rest, rigidly with the joint.
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

}  // namespace bodyopt
