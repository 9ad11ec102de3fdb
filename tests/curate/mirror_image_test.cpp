// Poses and shapes in the mirror, and what training makes of them.
#include "trainer/curate/mirror_image.h"

#include <gtest/gtest.h>

#include "runtime/host/rig.h"
#include "tests/curate/curated_limb.h"
#include "tests/support/stand_in_human.h"
#include "trainer/curate/edit_stack.h"
#include "trainer/curate/pose_space.h"
#include "trainer/curate/shape_stack.h"
#include "trainer/train/data/samples.h"
#include "trainer/train/fit/fit_regions.h"

namespace bodyopt::trainer {
namespace {

TEST(Symmetry, AddsTheMirrorImageOfEveryFrame) {
  const CuratedLimb limb;
  add_modifier(limb.path(), {.type = "symmetry"});
  const ShapeStack stack = limb.stack();
  const auto count = static_cast<std::size_t>(2 * kSweepFrames);
  ASSERT_EQ(stack.database().frames.size(), 2 * count);
  EXPECT_EQ(stack.database().takes[2], "one mirrored");
  Positions image = stack.shape(15);
  image.col(0) *= -1;
  // The limb's rings are their own mirror images.
  const Positions mirrored = stack.shape(count + 15);
  EXPECT_LT(rms_mm(mirrored.colwise().mean(), image.colwise().mean()), 1e-3);
  const Positions true_image = limb_truth(limb.character(), limb_muscles(), stack.database().frames[count + 15].pose);
  EXPECT_LT(rms_mm(mirrored, true_image), 0.05);
}

// Blocks that are held out are counted by places: an image goes where the frame goes that it is the image of.
TEST(Symmetry, ImagesHaveThePlacesOfTheirOrigins) {
  const CuratedLimb limb;
  add_modifier(limb.path(), {.type = "symmetry"});
  const SampleSet set = read_samples(read_dataset(limb.path()));
  const auto count = static_cast<std::size_t>(2 * kSweepFrames);
  ASSERT_EQ(set.train.size(), 2 * count);
  for (std::size_t n = 0; n < count; ++n) {
    const Sample &origin = set.train[n], &image = set.train[count + n];
    EXPECT_EQ(origin.place, n % kSweepFrames);
    EXPECT_EQ(image.place, origin.place) << n;
    EXPECT_EQ(frame_name(set, image), "frame " + std::to_string(origin.frame) + " of take '" +
                                          set.takes[static_cast<std::size_t>(origin.take)] + " mirrored'");
  }
}

// What a frame tells its image tells, too: cross-validation holds both out together.
TEST(Symmetry, ImagesAreInTheFoldsOfTheirOrigins) {
  const CuratedLimb limb;
  const std::vector<int> alone = training_folds(read_samples(read_dataset(limb.path())));
  add_modifier(limb.path(), {.type = "symmetry"});
  std::vector<int> both = alone;
  both.insert(both.end(), alone.begin(), alone.end());
  EXPECT_EQ(training_folds(read_samples(read_dataset(limb.path()))), both);
}

TEST(Symmetry, TurnsAHumansOtherThumb) {
  for (const Character& human : humans("characters/human_muscular.glb")) {
    const MirrorImage mirror(human, {});
    const auto left = static_cast<std::size_t>(human.skeleton.find("LThumb")),
               right = static_cast<std::size_t>(human.skeleton.find("RThumb"));
    const Pose rest = bind_pose(human.skeleton);
    Pose pose = rest;
    pose.joints[left].rotation = normalized(pose.joints[left].rotation * Quat{0.2, -0.1, 0.3, 0.9});
    const Pose image = mirror.pose(pose), again = mirror.pose(image);
    const auto apart = [](const Pose& a, const Pose& b, std::size_t j) {
      return pose_distance(a, b, {std::uint32_t(j)});
    };
    EXPECT_NEAR(apart(image, rest, left), 0, 1e-3);
    EXPECT_NEAR(apart(image, rest, right), apart(pose, rest, left), 1e-3);
    for (std::size_t j = 0; j < human.skeleton.size(); ++j) EXPECT_NEAR(apart(again, pose, j), 0, 1e-3) << j;
  }
}

// Some rigs move legs against the body by translation.
TEST(Symmetry, MovesJointsAgainstTheirParentsAsInTheMirror) {
  for (const Character& human : humans("characters/human_muscular.glb")) {
    const MirrorImage mirror(human, {});
    const auto left = static_cast<std::size_t>(human.skeleton.find("LeftLeg")),
               right = static_cast<std::size_t>(human.skeleton.find("RightLeg"));
    Pose bent = bind_pose(human.skeleton);
    bent.joints[left].rotation = normalized(bent.joints[left].rotation * Quat{0.2, -0.1, 0.3, 0.9});
    Pose moved = bent;
    moved.joints[left].translation = moved.joints[left].translation + Vec3{0.01, 0.04, -0.02};
    const auto place = [&](const Pose& pose, std::size_t j) {
      const Affine joint = posed_joints(human.skeleton, pose.joints)[j];
      return Vec3{joint.m[0][3], joint.m[1][3], joint.m[2][3]};
    };
    const Vec3 way = place(moved, left) - place(bent, left),
               image = place(mirror.pose(moved), right) - place(mirror.pose(bent), right);
    EXPECT_GT(length(way), 0.04);
    EXPECT_NEAR(length(image - Vec3{-way[0], way[1], way[2]}), 0, 1e-9);
  }
}

// A thousandth of the limb's length is 0.6 mm.
TEST(Symmetry, TellsWhichBodiesAreTheirOwnMirrorImages) {
  const Character limb = limb_character();
  EXPECT_TRUE(is_own_mirror_image(limb));
  Character dented = limb;
  dented.vertices(12 * kLimbSides, 0) *= 0.9;
  EXPECT_FALSE(is_own_mirror_image(dented));
  Character crooked = limb;
  crooked.skeleton.joints.back().inverse_bind.m[0][3] += 0.02;
  EXPECT_FALSE(is_own_mirror_image(crooked));
}

}  // namespace
}  // namespace bodyopt::trainer
