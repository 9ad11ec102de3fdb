#include "tests/support/capsule_limb.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "runtime/host/rig.h"
#include "trainer/train/skinning/unpose.h"

namespace bodyopt {

std::vector<JointWeight> limb_weights(double z) {
  const double elbow = std::clamp((z - 0.25) / 0.1, 0.0, 1.0), wrist = std::clamp((z - 0.46) / 0.08, 0.0, 1.0);
  std::vector<JointWeight> weights;
  for (const JointWeight& w :
       {JointWeight{0, 1 - elbow}, JointWeight{1, elbow * (1 - wrist)}, JointWeight{2, elbow * wrist}}) {
    if (w.weight > 0) weights.push_back(w);
  }
  std::sort(weights.begin(), weights.end(), [](const auto& a, const auto& b) { return a.weight > b.weight; });
  return weights;
}

Skeleton limb_skeleton() {
  Skeleton skeleton;
  const double heights[] = {0, 0.3, 0.5};
  for (int j = 0; j < 3; ++j) {
    Joint joint;
    joint.name = "joint" + std::to_string(j);
    joint.parent = j - 1;
    joint.bind.translation = {0, 0, j == 0 ? 0 : heights[j] - heights[j - 1]};
    joint.default_local = joint.bind;
    joint.inverse_bind.m[2][3] = -heights[j];
    skeleton.joints.push_back(joint);
  }
  return skeleton;
}

Character limb_character() {
  Character character;
  character.name = "limb";
  character.skeleton = limb_skeleton();
  const int count = kLimbSides * kLimbRings + 2;
  character.vertices.resize(count, 3);
  for (int ring = 0; ring < kLimbRings; ++ring) {
    const double z = kLimbLength * ring / (kLimbRings - 1);
    const double end = std::min(z, kLimbLength - z), cap = std::max(0.0, 1 - (end + 0.01) / kLimbRadius);
    const double radius = kLimbRadius * std::sqrt(1 - cap * cap);
    for (int side = 0; side < kLimbSides; ++side) {
      const double angle = 2 * std::numbers::pi * side / kLimbSides;
      character.vertices.row(ring * kLimbSides + side) << radius * std::cos(angle), radius * std::sin(angle), z;
    }
  }
  character.vertices.row(count - 2) << 0, 0, -0.01;
  character.vertices.row(count - 1) << 0, 0, kLimbLength + 0.01;
  std::vector<std::uint32_t> corners;
  const auto vertex = [](int ring, int side) {
    return static_cast<std::uint32_t>(ring * kLimbSides + side % kLimbSides);
  };
  for (int side = 0; side < kLimbSides; ++side) {
    for (int ring = 0; ring + 1 < kLimbRings; ++ring) {
      const std::uint32_t a = vertex(ring, side), b = vertex(ring, side + 1), c = vertex(ring + 1, side + 1),
                          d = vertex(ring + 1, side);
      corners.insert(corners.end(), {a, b, c, a, c, d});
    }
    const auto last = static_cast<std::uint32_t>(count - 1);
    corners.insert(corners.end(), {last - 1, vertex(0, side + 1), vertex(0, side)});
    corners.insert(corners.end(), {last, vertex(kLimbRings - 1, side), vertex(kLimbRings - 1, side + 1)});
  }
  character.triangles = Eigen::Map<const Triangles>(corners.data(), static_cast<Eigen::Index>(corners.size() / 3), 3);
  character.output_triangles = character.triangles;
  for (int v = 0; v < count; ++v) {
    character.weights.push_back(limb_weights(character.vertices(v, 2)));
    character.output_vertex.push_back(static_cast<std::uint32_t>(v));
  }
  return character;
}

std::vector<Muscle> limb_muscles() {
  std::vector<Muscle> muscles;
  for (const double side : {1.0, -1.0}) {
    Muscle muscle;
    muscle.name = side > 0 ? "flexor" : "extensor";
    muscle.path = {{0, {0, 0.025 * side, 0.06}}, {0, {0, 0.03 * side, 0.2}}, {1, {0, 0.025 * side, 0.42}}};
    muscles.push_back(muscle);
  }
  return muscles;
}

Pose limb_pose(const Skeleton& skeleton, double flex, double twist, double wrist) {
  Pose pose = bind_pose(skeleton);
  pose.joints[1].rotation = axis_angle({1, 0, 0}, flex) * axis_angle({0, 0, 1}, twist);
  pose.joints[2].rotation = axis_angle({0, 1, 0}, wrist);
  return pose;
}

Positions limb_truth(const Character& character, const std::vector<Muscle>& muscles, const Pose& pose) {
  const std::vector<Affine> skinning = skinning_matrices(character.skeleton, pose.joints);
  Character bulged = character;
  for (const Muscle& muscle : muscles) {
    double now = 0, rest = 0;
    for (std::size_t k = 1; k < muscle.path.size(); ++k) {
      const MusclePoint &a = muscle.path[k - 1], &b = muscle.path[k];
      now += length(skinning[a.joint] * a.position - skinning[b.joint] * b.position);
      rest += length(a.position - b.position);
    }
    const double strain = now / rest - 1, bulge = 0.05 * (-strain + 2 * strain * strain);
    for (Eigen::Index v = 0; v < character.vertices.rows(); ++v) {
      const Eigen::RowVector3d p = character.vertices.row(v);
      const double along = (p.z() - 0.18) / 0.08,
                   side = p.y() * muscle.path[0].position[1] > 0 ? p.y() / kLimbRadius : 0;
      bulged.vertices.row(v) +=
          bulge * side * side * std::exp(-along * along) * Eigen::RowVector3d(p.x(), p.y(), 0) / kLimbRadius;
    }
  }
  const double wrist = rotation_matrix(pose.joints[2].rotation)[0][2];
  for (Eigen::Index v = 0; v < character.vertices.rows(); ++v) {
    const double along = (character.vertices(v, 2) - 0.5) / 0.05;
    bulged.vertices(v, 2) += 0.004 * wrist * std::exp(-along * along);
  }
  return trainer::skin_linear(bulged, pose);
}

trainer::SampleSet limb_samples(int train_frames, int heldout_frames) {
  trainer::SampleSet set;
  set.character = limb_character();
  set.muscles = limb_muscles();
  set.takes = {"training", "heldout"};
  for (int f = 0; f < train_frames + heldout_frames; ++f) {
    const bool train = f < train_frames;
    const double t = train ? f : 0.37 + 1.9 * (f - train_frames);
    trainer::Sample sample;
    sample.take = train ? 0 : 1;
    sample.frame = f + 1;
    sample.pose = limb_pose(set.character.skeleton, 0.9 - 0.9 * std::cos(0.31 * t), 0.6 * std::sin(0.17 * t),
                            0.7 * std::sin(0.23 * t));
    sample.shape = limb_truth(set.character, set.muscles, sample.pose);
    (train ? set.train : set.heldout).push_back(std::move(sample));
  }
  return set;
}

}  // namespace bodyopt
