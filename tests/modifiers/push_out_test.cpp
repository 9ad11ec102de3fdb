// Skin that crosses itself where a joint is bent far, taken out of itself.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <fstream>

#include "runtime/deformer/deformer.h"
#include "runtime/host/device_choice.h"
#include "runtime/host/skin_tables.h"
#include "runtime/modifiers/drive_modifiers.h"
#include "tests/support/capsule_limb.h"
#include "tests/support/error_kind.h"
#include "tests/support/temporary_folder.h"
#include "trainer/modifiers/bake_stack.h"
#include "trainer/modifiers/measure_modifiers.h"
#include "trainer/train/skinning/ddm.h"

namespace bodyopt::testing {
namespace push_out_test {

using namespace trainer;

// Of one modifier or more.
Basis limb_with(const std::string& push_out) {
  const TemporaryFolder folder;
  std::ofstream(folder / "stack.json") << R"({"schema": "bodyopt-modifiers-1", "modifiers": [)" + push_out + "]}";
  Basis basis = build_ddm_basis(limb_character(), {});
  std::vector<std::string> notes;
  basis.modifiers = bake_stack(folder / "stack.json", basis, notes);
  validate(basis, "the test's basis");
  return basis;
}

class PushOut : public ::testing::Test {
 protected:
  static void SetUpTestSuite() { basis_ = new Basis(limb_with(R"({"name": "folds", "type": "push_out"})")); }
  static void TearDownTestSuite() { delete basis_; }

  static Pose driven(const Basis& basis, double bend, float strength = 1) {
    Basis weighted = basis;
    weighted.modifiers.stack[0].constants["strength"] = strength;
    Pose pose = bind_pose(basis.skeleton);
    pose.joints[1].rotation = axis_angle({1, 0, 0}, bend);
    drive_modifiers(weighted, {}, 24, {&pose, 1});
    return pose;
  }
  static Positions shown(const Pose& pose) { return EvaluatedSkin(*basis_)({&pose, 1})[0]; }

  static inline Basis* basis_ = nullptr;
};

constexpr double kDeep = 2.6, kShallow = 1.2;

TEST_F(PushOut, TakesSkinOutOfSkin) {
  const Pose pose = driven(*basis_, kDeep);
  const FoldMeasure fold = FoldJudge(*basis_)({&pose, 1})[0];
  EXPECT_GT(fold.deepest, 0.01);
  EXPECT_GT(fold.removed(), 0.9);
  EXPECT_LT(fold.deepest_left, 0.25 * fold.deepest);
}

TEST_F(PushOut, LeavesAloneWhatHasCrossedNothing) {
  EXPECT_EQ(shown(driven(*basis_, kShallow)), shown(driven(*basis_, kShallow, 0)));
  EXPECT_EQ(shown(driven(*basis_, 0)), shown(driven(*basis_, 0, 0)));
  for (const double bend : {2.0, 2.3, kDeep}) {
    const Pose pose = driven(*basis_, bend);
    EXPECT_LT(FoldJudge(*basis_)({&pose, 1})[0].elsewhere, 1e-5) << bend;
  }
}

TEST_F(PushOut, TellsHowDeepAFoldWas) {
  const std::vector<Pose> poses = {driven(*basis_, kDeep, 0), driven(*basis_, kDeep, 1)};
  const std::vector<FoldMeasure> folds = FoldJudge(*basis_)(poses);
  EXPECT_EQ(folds[0].sum, folds[1].sum);
  EXPECT_EQ(folds[0].sum_left, folds[0].sum);
  EXPECT_EQ(folds[0].deepest_left, folds[0].deepest);
  EXPECT_EQ(folds[0].elsewhere, 0);
  // The axes of the limb's halves come as near as twice its radius at rest; what is nearer lies in skin.
  EXPECT_LT(folds[1].deepest, 2 * kLimbRadius);
}

// Skin that is evened out after push-out goes further from where push-out moved some of it.
TEST_F(PushOut, IsNotBlamedForWhatFollowsIt) {
  const Basis followed =
      limb_with(R"({"name": "folds", "type": "push_out"}, {"name": "even", "type": "relax", "strength": 3})");
  const Pose pose = driven(followed, kDeep);
  const FoldMeasure fold = FoldJudge(followed)({&pose, 1})[0];
  EXPECT_GT(fold.sum, 0);
  EXPECT_LT(fold.elsewhere, 1e-5);
  Pose without = pose;
  std::fill_n(without.modifiers.begin(), followed.modifiers.stack[0].component_count, 0.0f);
  EvaluatedSkin skin(followed);
  const Eigen::VectorXd moved = (skin({&pose, 1})[0] - skin({&without, 1})[0]).rowwise().norm();
  const Pose own = driven(*basis_, kDeep);
  const FoldMeasure alone = FoldJudge(*basis_)({&own, 1})[0];
  EXPECT_NE(fold.sum_left, alone.sum_left) << "what is left is that of the skin that is shown";
  EXPECT_GT((moved.array() > 1e-5).count(), 0);
}

TEST_F(PushOut, IsMeasuredAtTheLimitsOfTheJoints) {
  JointLimits limits;
  limits.dofs = {{"bend", 0, -10, 149, {{1, {1, 0, 0}, 1}}}};
  const std::vector<BentJoint> folds = measure_push_out(*basis_, limits);
  ASSERT_EQ(folds.size(), 1u);
  EXPECT_EQ(folds[0].joint, "bend 149");
  const Pose pose = driven(*basis_, kDeep);  // 148.97 degrees
  EXPECT_NEAR(folds[0].measure.deepest, FoldJudge(*basis_)({&pose, 1})[0].deepest, 2e-4);
  limits.dofs[0].max = 40;
  EXPECT_TRUE(measure_push_out(*basis_, limits).empty());
}

TEST_F(PushOut, WithoutStrengthNotABitChanges) {
  Basis without = *basis_;
  without.modifiers = {};
  Pose pose = driven(*basis_, kDeep, 0);
  const Positions weighted = shown(pose);
  pose.modifiers.clear();
  EXPECT_EQ(weighted, EvaluatedSkin(without)({&pose, 1})[0]);
}

TEST_F(PushOut, MovesNoFurtherThanItsLimit) {
  const Basis limited = limb_with(R"({"name": "folds", "type": "push_out", "limit_mm": 3})");
  const Pose pose = driven(limited, kDeep), without = driven(limited, kDeep, 0);
  EvaluatedSkin skin(limited);
  const Eigen::VectorXd moved = (skin({&pose, 1})[0] - skin({&without, 1})[0]).rowwise().norm();
  EXPECT_NEAR(moved.maxCoeff(), 3e-3, 1e-6);
}

TEST_F(PushOut, ComesInEvenlyWhileAJointBends) {
  Pose before = driven(*basis_, 0.5);
  EXPECT_EQ(before.modifiers, std::vector<float>(before.modifiers.size(), 0.0f));  // 29 degrees
  double last = 0;
  for (double bend = 0.5; bend < 0.85; bend += 0.05) {
    const Pose pose = driven(*basis_, bend);
    const double shown = Eigen::Map<const Eigen::Vector3f>(pose.modifiers.data()).cast<double>().norm();
    EXPECT_GE(shown, last);
    EXPECT_LT(shown - last, 0.25);
    last = shown;
  }
  EXPECT_NEAR(last, 1, 1e-6);
  // Half-way between where the bone pointed and where it points, in the world.
  const Pose pose = driven(*basis_, 1.0);
  const Eigen::Vector3d normal = Eigen::Map<const Eigen::Vector3f>(pose.modifiers.data()).cast<double>();
  EXPECT_LT((normal - Eigen::Vector3d(0, -std::sin(0.5), std::cos(0.5))).norm(), 1e-6);
}

TEST_F(PushOut, AChunkHasTheBitsOfTheWhole) {
  std::vector<Pose> poses;
  for (int k = 0; k < 20; ++k) poses.push_back(driven(*basis_, 0.13 * k));
  EvaluatedSkin skin(*basis_);
  const std::vector<Positions> whole = skin(poses), part = skin(std::span(poses).subspan(13, 7));
  for (std::size_t k = 0; k < part.size(); ++k) EXPECT_EQ(part[k], whole[13 + k]) << k;
}

TEST_F(PushOut, NormalsFollow) {
  DeviceChoice cpu;
  cpu.name = "cpu";
  Deformer deformer(*basis_, cpu);
  const Pose pose = driven(*basis_, kDeep), without = driven(*basis_, kDeep, 0);
  const Evaluation shown = deformer.evaluate({&pose, 1}), bare = deformer.evaluate({&without, 1});
  EXPECT_NE(shown.normals, bare.normals);
  ASSERT_EQ(shown.normals.size(), shown.positions.size());
}

TEST_F(PushOut, RefusesTablesThatAreNotItsOwn) {
  const auto refused = [&](auto damage) {
    Basis damaged = *basis_;
    damage(damaged.modifiers);
    return kind_of([&] { validate(damaged, "the test's basis"); }) == ErrorKind::file;
  };
  EXPECT_TRUE(refused([](SkinModifiers& m) { m.stack[0].numbers.pop_back(); }));
  EXPECT_TRUE(refused([](SkinModifiers& m) { m.stack[0].joints.pop_back(); }));
  EXPECT_TRUE(refused([](SkinModifiers& m) { --m.stack[0].component_count; }));
  EXPECT_TRUE(refused([](SkinModifiers& m) {
    m.stack.push_back(m.stack[0]);
    m.stack[1].name = "again";
    m.stack[1].first_component = m.stack[0].component_count;
  }));
  const TemporaryFolder folder;
  std::ofstream(folder / "stack.json") << R"({"schema": "bodyopt-modifiers-1", "modifiers": [
      {"name": "folds", "type": "push_out"}, {"name": "again", "type": "push_out"}]})";
  std::vector<std::string> notes;
  EXPECT_EQ(kind_of([&] { bake_stack(folder / "stack.json", *basis_, notes); }), ErrorKind::file);
}

// Of a hand that lies by a knee at rest, and hangs on a body far off, the knee's fold has nothing.
TEST_F(PushOut, SkinThatIsFarAlongTheBonesIsNotTheFolds) {
  Basis basis = *basis_;
  const Vec3 knee = bind_place(basis.skeleton, 1), away = knee + Vec3{10, 0, 0};
  const auto hang = [&](int parent, const Vec3& place) {
    Joint joint = basis.skeleton.joints[0];
    joint.parent = parent;
    joint.inverse_bind = inverse(affine_from({.translation = place}));
    basis.skeleton.joints.push_back(joint);
    return static_cast<std::uint32_t>(basis.skeleton.size() - 1);
  };
  const std::uint32_t arm = hang(0, away), hand = hang(static_cast<int>(arm), knee), calf = hang(1, knee);
  const auto near_bits = [&] {
    const FoldTables tables = fold_tables(basis);
    std::size_t count = 0;
    for (std::size_t v = 0; v < basis.mesh.vertex_count(); ++v) count += tables.sides[2 * v] & 1u;
    return count;
  };
  const auto held_by = [&](std::uint32_t joint) {
    for (auto& vertex : basis.ddm.vertices) vertex.base_joint = joint;
    return near_bits();
  };
  const std::size_t within_reach = held_by(calf);
  EXPECT_GT(within_reach, 0u);
  EXPECT_EQ(held_by(0), within_reach);  // the limb that the joint bends
  EXPECT_EQ(held_by(hand), 0u);
}

}  // namespace push_out_test
}  // namespace bodyopt::testing
