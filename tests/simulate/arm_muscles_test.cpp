// What muscles do to the skin of the built-in arm.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <set>

#include "geometry/mesh.h"
#include "runtime/host/rig.h"
#include "trainer/builtin/arm.h"
#include "trainer/motion/held_turns.h"
#include "trainer/simulate/quasi_static.h"

namespace bodyopt::trainer {
namespace {

class ArmMuscles : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    arm_ = new BuiltinArm(build_arm());
    body_ = new QuasiStaticBody(own_body(arm_->character, arm_->muscles, 0));
  }
  static void TearDownTestSuite() {
    delete body_;
    delete arm_;
  }

  static Positions skin(const Pose& pose, const std::string& flexed = "nothing") {
    std::vector<double> flex;
    for (const Muscle& muscle : arm_->muscles) flex.push_back(muscle.name.starts_with(flexed) ? 1 : 0);
    const SolvedPose solved = body_->solve(pose, flex);
    EXPECT_TRUE(solved.status.converged);
    return body_->skin(solved.nodes);
  }

  static Pose with_elbow_at(double degrees) {
    const JointLimits limits = arm_limits(arm_->character.skeleton);
    Angles angles = rest_angles(limits);
    for (std::size_t d = 0; d < angles.size(); ++d) {
      if (limits.dofs[d].name == "elbow_flexion") angles[d] = degrees;
    }
    return limited_pose(arm_->character.skeleton, limits, {angles});
  }

  static Eigen::Vector3d joint_at(const Pose& pose, const std::string& name) {
    const Skeleton& skeleton = arm_->character.skeleton;
    const std::vector<Affine> joints = posed_joints(skeleton, pose.joints);
    for (std::size_t j = 0; j < skeleton.size(); ++j) {
      if (skeleton.joints[j].name != name) continue;
      const Vec3 p = joints[j] * Vec3{};
      return {p[0], p[1], p[2]};
    }
    ADD_FAILURE() << name;
    return Eigen::Vector3d::Zero();
  }

  // Metres around the upper arm, at a share of the way from shoulder to elbow.
  static double girth(const Positions& skin, const Pose& pose, double at) {
    constexpr double kFarthest = 0.1;  // from the bone: beyond is the trunk's skin
    const Eigen::Vector3d from = joint_at(pose, "shoulder"), to = joint_at(pose, "elbow"),
                          middle = from + at * (to - from);
    const Eigen::Vector3d normal = (to - from).normalized(), u = normal.unitOrthogonal(), v = normal.cross(u);
    std::vector<std::pair<double, Eigen::Vector3d>> ring;  // by angle
    const Triangles& triangles = arm_->character.triangles;
    for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
      for (int k = 0; k < 3; ++k) {
        const Eigen::Vector3d a = skin.row(triangles(t, k)), b = skin.row(triangles(t, (k + 1) % 3));
        const double above = normal.dot(a - middle), below = normal.dot(b - middle);
        if (above * below >= 0) continue;
        const Eigen::Vector3d p = a + above / (above - below) * (b - a) - middle;
        if (p.norm() < kFarthest) ring.emplace_back(std::atan2(p.dot(v), p.dot(u)), p);
      }
    }
    std::ranges::sort(ring, {}, [](const auto& entry) { return entry.first; });
    double sum = 0;
    for (std::size_t k = 0; k < ring.size(); ++k) sum += (ring[(k + 1) % ring.size()].second - ring[k].second).norm();
    return sum;
  }

  static BuiltinArm* arm_;
  static QuasiStaticBody* body_;
};

BuiltinArm* ArmMuscles::arm_ = nullptr;
QuasiStaticBody* ArmMuscles::body_ = nullptr;

TEST_F(ArmMuscles, HoldOnBonesThoseOfThePieceOfTrunkAmongThem) {
  const AnatomyField field(arm_->character, arm_->muscles, {.cell = 2 * default_cell(arm_->character)});
  std::set<std::string> bones;
  for (const AnatomyField::Half& half : field.halves()) {
    for (const Division::OfMuscle& muscle : half.division.muscles) {
      for (const int end : {0, 1}) {
        EXPECT_LT(muscle.ends_off_bone[end], 2e-3) << arm_->muscles[static_cast<std::size_t>(muscle.muscle)].name;
        bones.insert(arm_->character.skeleton.joints[static_cast<std::size_t>(muscle.end_joint[end])].name);
      }
    }
  }
  EXPECT_TRUE(bones.contains("torso"));
  const Eigen::Vector3d in_chest(-0.1, 1.3, 0);
  EXPECT_EQ(field.tissue_at(in_chest).kind, TissueKind::cavity);
}

TEST_F(ArmMuscles, FlexedAtAStillJointTheyDragLittleSkin) {
  const Pose bind = bind_pose(arm_->character.skeleton);
  const Positions relaxed = skin(bind);
  const Positions normals = vertex_normals(relaxed, arm_->character.triangles).rowwise().normalized();
  for (const char* muscle : {"biceps", "triceps", "deltoid"}) {
    const Positions moved = skin(bind, muscle) - relaxed;
    const Eigen::VectorXd outwards = moved.cwiseProduct(normals).rowwise().sum();
    const Positions sideways = moved - normals.cwiseProduct(outwards.replicate(1, 3));
    EXPECT_LT(sideways.rowwise().norm().maxCoeff(), 8e-3) << muscle;
    EXPECT_GT(outwards.maxCoeff(), 1.2e-3) << muscle;
  }
}

TEST_F(ArmMuscles, OfABentElbowThickenTheUpperArm) {
  const Pose straight = with_elbow_at(0);
  const Positions before = skin(straight);
  double thickest = 0;
  for (const double angle : {45., 90., 110.}) {
    const Pose bent = with_elbow_at(angle);
    const Positions after = skin(bent);
    const double growth = girth(after, bent, 0.45) / girth(before, straight, 0.45) - 1;
    EXPECT_GT(growth, thickest) << angle;
    EXPECT_LT(growth, 0.10) << angle;
    thickest = growth;
  }
  EXPECT_GT(thickest, 0.03);
}

}  // namespace
}  // namespace bodyopt::trainer
