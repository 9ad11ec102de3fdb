// Skin that crosses itself in folds, and what push-out makes of it.
#include <gtest/gtest.h>

#include <fstream>
#include <numbers>

#include "assets/shot_modifiers.h"
#include "runtime/deformer/deformer.h"
#include "runtime/modifiers/drive_modifiers.h"
#include "tests/support/capsule_limb.h"
#include "tests/support/error_kind.h"
#include "tests/support/same_basis.h"
#include "tests/support/temporary_folder.h"
#include "trainer/modifiers/bake_stack.h"
#include "trainer/modifiers/fold_poses.h"
#include "trainer/modifiers/measure_push_out.h"
#include "trainer/train/skinning/ddm_basis.h"

namespace bodyopt::testing {
namespace push_out_test {

Basis baked(const Basis& plain, const std::string& modifiers) {
  const TemporaryFolder folder;
  std::ofstream(folder / "stack.json") << R"({"schema": "bodyopt-modifiers-1", "modifiers": [)" << modifiers << "]}";
  Basis basis = plain;
  std::vector<std::string> notes;
  basis.modifiers = bake_stack(folder / "stack.json", plain, notes);
  validate(basis, "the test's basis");
  return basis;
}

class PushOut : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    TrainOptions options;
    options.smoothing_steps = 4;
    plain_ = new Basis(build_ddm_basis(limb_character(), options));
    pushed_ = new Basis(baked(*plain_, R"({"name": "folds", "type": "push_out"})"));
  }
  static void TearDownTestSuite() {
    delete plain_;
    delete pushed_;
  }

  static std::vector<Pose> bent(double degrees) {
    std::vector<Pose> poses;
    for (const FoldDirection& direction : fold_directions(plain_->skeleton, 1, 20)) {
      poses.push_back(bent_pose(plain_->skeleton, direction, degrees));
    }
    return poses;
  }

  // As a shot shows them, by the strength as the shot has it.
  static std::vector<float> shown(const Basis& basis, std::vector<Pose> poses) {
    drive_modifiers(basis, {}, 24, poses);
    DeviceChoice cpu;
    cpu.name = "cpu";
    return Deformer(basis, cpu).evaluate(poses).positions;
  }

  static inline const Basis *plain_ = nullptr, *pushed_ = nullptr;
};

TEST_F(PushOut, TakesSkinOutOfSkin) {
  FoldMeasure all;
  for (const JointFolds& folds : measure_push_out(*pushed_)) {
    all.add(folds.measure);
    EXPECT_LT(folds.measure.elsewhere, 1e-5) << folds.joint;
  }
  EXPECT_GT(all.deepest, 0.004);  // or nothing was folded
  EXPECT_GT(all.removed(), 0.9);
}

TEST_F(PushOut, LeavesAloneWhatHasCrossedNothing) {
  std::vector<Pose> poses = bent(30);
  poses.push_back(bind_pose(plain_->skeleton));
  EXPECT_EQ(shown(*pushed_, poses), shown(*plain_, poses));
}

TEST_F(PushOut, AStrengthOfZeroChangesNoBit) {
  Basis off = *pushed_;
  off.modifiers.stack[0].constants["strength"] = 0;
  EXPECT_EQ(shown(off, bent(120)), shown(*plain_, bent(120)));
  EXPECT_NE(shown(*pushed_, bent(120)), shown(*plain_, bent(120)));
}

TEST_F(PushOut, HalfTheStrengthShowsHalf) {
  Basis half = *pushed_;
  half.modifiers.stack[0].constants["strength"] = 0.5f;
  const std::vector<float> none = shown(*plain_, bent(120)), some = shown(half, bent(120)),
                           all = shown(*pushed_, bent(120));
  for (std::size_t k = 0; k < none.size(); ++k) ASSERT_NEAR(some[k], (none[k] + all[k]) / 2, 1e-6f);
}

TEST_F(PushOut, APartOfAShotHasTheBitsOfTheWhole) {
  const std::vector<Pose> poses = bent(110);
  std::vector<float> parts;
  for (const Pose& pose : poses) {
    const std::vector<float> part = shown(*pushed_, {pose});
    parts.insert(parts.end(), part.begin(), part.end());
  }
  EXPECT_EQ(shown(*pushed_, poses), parts);
}

// However deep: no further than the reach that the modifier says of itself.
TEST_F(PushOut, IsBounded) {
  Basis near = *pushed_;
  for (FoldList& list : near.modifiers.folds.lists) list.reach = 0.002f;
  const std::vector<float> before = shown(*plain_, bent(150)), after = shown(near, bent(150));
  float most = 0;
  for (std::size_t k = 0; k < before.size(); k += 3) {
    most = std::max(most, std::hypot(after[k] - before[k], after[k + 1] - before[k + 1], after[k + 2] - before[k + 2]));
  }
  EXPECT_GT(most, 0);
  EXPECT_LT(most, 0.002f);
}

TEST_F(PushOut, IsKeptInTheFile) {
  const TemporaryFolder folder;
  save_basis(*pushed_, folder / "basis.safetensors");
  EXPECT_EQ(difference(load_basis(folder / "basis.safetensors"), *pushed_), "");
}

TEST_F(PushOut, ForgedFoldsAreRefused) {
  const auto refused = [&](const std::function<void(SkinModifiers&)>& forge) {
    Basis forged = *pushed_;
    forge(forged.modifiers);
    EXPECT_EQ(kind_of([&] { validate(forged, "forged"); }), ErrorKind::file);
  };
  refused([](SkinModifiers& m) { m.folds.triangles[0] = 1u << 30; });
  refused([](SkinModifiers& m) { m.folds.triangles.pop_back(); });
  refused([](SkinModifiers& m) { m.folds.lists.pop_back(); });
  refused([](SkinModifiers& m) { m.folds.lists.clear(); });
  refused([](SkinModifiers& m) { m.folds.lists[1].first = 1u << 30; });
  refused([](SkinModifiers& m) { m.folds.lists[0].component = 99; });
  refused([](SkinModifiers& m) { m.folds.vertices.pop_back(); });
  refused([](SkinModifiers& m) { m.folds.vertices[3].b = 1u << 30; });
  refused([](SkinModifiers& m) { m.folds.vertices[1].first_list = 1u << 30; });
  refused([](SkinModifiers& m) { m.folds = {}; });
  refused([](SkinModifiers& m) { m.folds.vertices.clear(); });
  refused([](SkinModifiers& m) { m.stack[0].type = "morph"; });
  refused([](SkinModifiers& m) { m.folds.lists[0].reach = -1; });
}

TEST_F(PushOut, AStackHasOne) {
  const std::string one = R"({"name": "a", "type": "push_out"})", two = one + R"(, {"name": "b", "type": "push_out"})";
  EXPECT_EQ(kind_of([&] { baked(*plain_, two); }), ErrorKind::file);
}

}  // namespace push_out_test
}  // namespace bodyopt::testing
