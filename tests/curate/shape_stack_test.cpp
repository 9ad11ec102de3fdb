// What the shapes of a dataset are through its modifiers.
#include "trainer/curate/shape_stack.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <fstream>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <numeric>
#include <random>
#include <sstream>

#include "assets/gltf/gltf_skin.h"
#include "base/json_file.h"
#include "dataset/modifier.h"
#include "runtime/core/error.h"
#include "tests/curate/curated_limb.h"
#include "tests/support/error_kind.h"
#include "tests/support/read_bytes.h"
#include "tests/support/stand_in_human.h"
#include "trainer/curate/edit_stack.h"
#include "trainer/curate/frame_files.h"
#include "trainer/curate/match_vertices.h"
#include "trainer/curate/modifier_scope.h"
#include "trainer/curate/offset_cache.h"
#include "trainer/curate/pose_space.h"
#include "trainer/train/data/samples.h"
#include "trainer/train/fit/fit_regions.h"
#include "trainer/train/skinning/unpose.h"

namespace bodyopt::trainer {
namespace {

using testing::kind_of;

// A bulge of 10 mm at the outer side of the elbow.
Positions bulge(const Character& character) {
  Positions offsets = Positions::Zero(character.vertices.rows(), 3);
  for (Eigen::Index v = 0; v < offsets.rows(); ++v) {
    const double along = (character.vertices(v, 2) - 0.3) / 0.03, side = character.vertices(v, 1) / kLimbRadius;
    if (side > 0) offsets(v, 1) = 0.01 * side * side * std::exp(-along * along);
  }
  return offsets;
}

std::vector<float> sculpted(const CuratedLimb& limb, int frame) {
  const ShapeStack stack = limb.stack();
  const Positions offsets = stack.offsets(static_cast<std::size_t>(frame - 1), 0) + bulge(limb.character());
  return output_from_welded(limb.character(), limb.character().vertices + offsets);
}

std::vector<float> read_mesh(const Character& character, const std::vector<double>& texture, const Positions& exported,
                             const std::filesystem::path& path) {
  const WrittenSkin written{exported};
  return read_frame_mesh(character, texture, {&written, 1}, path).positions;
}

TEST(ShapeStack, AnEmptyStackGivesTheRawShapesBitForBit) {
  const CuratedLimb limb;
  const ShapeStack stack = limb.stack();
  for (const std::size_t n : {0u, 20u, 60u}) {
    EXPECT_FALSE(stack.is_changed(n));
    EXPECT_EQ(stack.shape(n), stack.database().raw_shape(n));
  }
}

TEST(ShapeStack, ThereAndBackThroughUnposedSpaceMovesNothing) {
  const CuratedLimb limb;
  const ShapeStack stack = limb.stack();
  const UnposedSpace::Frame in = stack.space().frame(limb.pose(0, 18));
  EXPECT_LT(rms_mm(in.shape(in.offsets(limb.truth(0, 18))), limb.truth(0, 18)), 1e-4);
}

TEST(Sculpt, IsExactAtItsPoseHalfAtHalfTheSpreadAndNothingBeyond) {
  const CuratedLimb limb;
  sculpt_frame(limb, "elbow", "one", 16, sculpted(limb, 16), true, 36);  // 90 degrees
  const ShapeStack stack = limb.stack();
  const auto peak = [&](int frame) {
    const auto n = static_cast<std::size_t>(frame - 1);
    return 1e3 * (stack.offsets(n, 1) - stack.offsets(n, 0)).rowwise().norm().maxCoeff();
  };
  const double whole = 1e3 * bulge(limb.character()).rowwise().norm().maxCoeff();
  EXPECT_NEAR(peak(16), whole, 1e-3);
  EXPECT_NEAR(peak(26), whole, 1e-3);        // the same pose on the way back
  EXPECT_NEAR(peak(13), 0.5 * whole, 0.01);  // 18 degrees away
  EXPECT_EQ(peak(10), 0);                    // 36 degrees away
  EXPECT_EQ(stack.shape(0), stack.database().raw_shape(0));
}

TEST(Sculpt, TwoOfNearbyPosesAreBothExact) {
  const CuratedLimb limb;
  sculpt_frame(limb, "elbow", "one", 16, sculpted(limb, 16), true, 60);
  std::vector<float> plain =
      output_from_welded(limb.character(), Positions(limb.character().vertices + limb.stack().offsets(12, 0)));
  const auto moved = [](const ShapeStack& stack, std::size_t frame) {
    return 1e3 * (stack.offsets(frame, 1) - stack.offsets(frame, 0)).rowwise().norm().maxCoeff();
  };
  const double alone = moved(limb.stack(), 15);
  EXPECT_GT(alone, 5);
  sculpt_frame(limb, "elbow", "one", 13, plain, true, 60);  // as it was
  const ShapeStack stack = limb.stack();
  EXPECT_LT(moved(stack, 12), 1e-4);
  EXPECT_NEAR(moved(stack, 15), alone, 1e-3);
}

TEST(ShapeStack, DropLeavesOutFreezeKeepsAndStrengthScales) {
  const CuratedLimb limb;
  add_modifier(limb.path(), {.type = "smooth", .strength = 0.5});
  add_modifier(limb.path(), {.type = "freeze", .frames = {{{"take", "one"}, {"frames", "5"}}}});
  add_modifier(limb.path(), {.type = "drop", .frames = {{{"take", "two"}, {"frames", "7-9"}}}});
  const ShapeStack stack = limb.stack();
  EXPECT_EQ(stack.offsets(4, 3), stack.offsets(4, 0));
  EXPECT_TRUE(stack.is_dropped(kSweepFrames + 7));
  EXPECT_FALSE(stack.is_dropped(7));
  change_modifier(limb.path(), "smooth", {.strength = 1.0});
  const ShapeStack whole = limb.stack();
  const Positions half = stack.offsets(20, 3) - stack.offsets(20, 0), all = whole.offsets(20, 3) - whole.offsets(20, 0);
  EXPECT_GT(all.norm(), 1e-5);
  EXPECT_LT((2 * half - all).norm(), 1e-7);  // smooth is kept in single precision
}

TEST(Weight, CountsFramesAndTakesNoMask) {
  const CuratedLimb limb;
  const Json frames = {{{"take", "one"}, {"frames", "5-6"}}};
  add_modifier(limb.path(), {.type = "weight", .frames = frames, .parameters = {{"weight", 3}}});
  add_modifier(limb.path(), {.type = "weight", .strength = 0.5, .frames = frames, .parameters = {{"weight", 0}}});
  const ShapeStack stack = limb.stack();
  EXPECT_EQ(stack.weight(4), 1.5);
  EXPECT_EQ(stack.weight(6), 1);
  EXPECT_FALSE(stack.is_changed(4));
  const auto kind = [&](const Modifier& modifier) { return kind_of([&] { add_modifier(limb.path(), modifier); }); };
  EXPECT_EQ(kind({.type = "weight", .mask = {{"joints", {"joint1"}}}, .parameters = {{"weight", 2}}}),
            ErrorKind::mismatch);
  EXPECT_EQ(kind({.type = "weight"}), ErrorKind::file);
  EXPECT_EQ(kind({.type = "weight", .parameters = {{"weight", -1}}}), ErrorKind::file);
}

TEST(Despike, PutsAVertexThatFliesBackAndTouchesNoOther) {
  const CuratedLimb limb([](int take, int frame, const Positions& truth) {
    Positions shape = truth;
    if (take == 0 && frame == 10) shape(300, 0) += 0.04;
    return shape;
  });
  add_modifier(limb.path(), {.type = "despike"});
  const ShapeStack stack = limb.stack();
  const Positions change = stack.shape(9) - limb.truth(0, 10);
  EXPECT_LT(change.row(300).norm(), 0.002);
  EXPECT_LT(rms_mm(stack.shape(8), limb.truth(0, 9)), 1e-3);
}

TEST(Volume, GivesBackWhatWasLost) {
  const CuratedLimb limb([](int, int, const Positions& truth) {
    Positions thin = truth;
    thin.leftCols<1>() *= 0.9;
    return thin;
  });
  add_modifier(limb.path(), {.type = "volume", .parameters = {{"cap_mm", 50}}});
  const auto volume = [&](const Positions& skin) {
    double sum = 0;
    for (Eigen::Index t = 0; t < limb.character().triangles.rows(); ++t) {
      const Eigen::RowVector3d a = skin.row(limb.character().triangles(t, 0)),
                               b = skin.row(limb.character().triangles(t, 1)),
                               c = skin.row(limb.character().triangles(t, 2));
      sum += a.dot(b.cross(c)) / 6;
    }
    return sum;
  };
  const double rest = volume(limb.character().vertices);
  EXPECT_NEAR(volume(limb.stack().shape(0)), rest, 0.01 * rest);
  EXPECT_LT(volume(limb.stack().database().raw_shape(0)), 0.92 * rest);
}

TEST(Blend, TakesTheShapesOfAnotherCache) {
  const CuratedLimb limb;
  Pc2Writer writer(limb.folder() / "fixed.pc2", limb.character().output_count(), 1);
  const Positions fixed = limb.truth(0, 8).array() + 0.001;
  writer.append(output_from_welded(limb.character(), fixed));
  writer.close();
  add_modifier(limb.path(),
               {.type = "blend", .parameters = {{"cache", "fixed.pc2"}, {"take", "one"}, {"frames", "8"}}});
  EXPECT_LT(rms_mm(limb.stack().shape(7), fixed), 1e-3);
  EXPECT_LT(rms_mm(limb.stack().shape(8), limb.truth(0, 9)), 1e-3);
}

TEST(Inflate, MovesTheSkinAlongItsNormals) {
  const CuratedLimb limb;
  add_modifier(limb.path(), {.type = "inflate", .parameters = {{"distance_mm", 2}}});
  const ShapeStack stack = limb.stack();
  EXPECT_NEAR(rms_mm(stack.shape(12), limb.truth(0, 13)), 2, 0.01);
  const Positions rest = stack.shape(0);
  const Eigen::Index v = 12 * kLimbSides + 3;
  EXPECT_GT(rest.row(v).head<2>().norm(), limb.truth(0, 1).row(v).head<2>().norm() + 0.0019);
}

TEST(Detail, CarriesWhatIsFineAndNotWhatIsBroad) {
  const CuratedLimb limb([](int take, int frame, const Positions& truth) {
    Positions shape = truth;
    if (take == 0 && frame == 1) {
      for (Eigen::Index v = 0; v < shape.rows(); ++v) shape(v, 2) += v % 2 == 0 ? 0.001 : -0.001;
    }
    return shape;
  });
  add_modifier(limb.path(), {.type = "detail",
                             .frames = {{{"take", "two"}, {"frames", "1"}}},
                             .parameters = {{"take", "one"}, {"frame", 1}, {"radius_mm", 60}}});
  const ShapeStack stack = limb.stack();
  const Positions change = stack.shape(kSweepFrames) - limb.truth(1, 1);
  EXPECT_NEAR(1e3 * change(300, 2), 1, 0.3);
  EXPECT_LT(std::abs(1e3 * change.col(2).mean()), 0.1);
}

TEST(Relax, LeavesHowFarTheSkinStandsOff) {
  const CuratedLimb limb;
  add_modifier(limb.path(), {.type = "relax", .parameters = {{"radius_mm", 20}}});
  const ShapeStack stack = limb.stack();
  const Positions change = stack.offsets(20, 1) - stack.offsets(20, 0);
  const Eigen::Index v = 12 * kLimbSides + 3;  // of a straight part: its normal is radial
  const Eigen::RowVector3d radial(limb.character().vertices(v, 0), limb.character().vertices(v, 1), 0);
  EXPECT_LT(std::abs(change.row(v).dot(radial.normalized())), 1e-5);
  EXPECT_GT(change.norm(), 1e-5);
}

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

TEST(Curate, UndoneEditsAndRawCachesAreByteForByte) {
  const CuratedLimb limb;
  const std::string raw = testing::read_bytes(limb.folder() / "one.pc2"), begun = testing::read_bytes(limb.path());
  add_modifier(limb.path(), {.name = "a", .type = "smooth"});
  add_modifier(limb.path(), {.name = "b", .type = "relax"});
  move_modifier(limb.path(), "b", 1);
  enable_modifier(limb.path(), "a", false);
  remove_modifier(limb.path(), "b");
  const std::string last = testing::read_bytes(limb.path());
  for (int k = 0; k < 5; ++k) undo_modifiers(limb.path());
  EXPECT_EQ(testing::read_bytes(limb.path()), begun);
  EXPECT_THROW(undo_modifiers(limb.path()), Error);
  for (int k = 0; k < 5; ++k) redo_modifiers(limb.path());
  EXPECT_EQ(testing::read_bytes(limb.path()), last);
  EXPECT_EQ(testing::read_bytes(limb.folder() / "one.pc2"), raw);
}

TEST(Curate, AHistoryThatAKilledProcessWroteAloneDoesNoHarm) {
  const CuratedLimb limb;
  add_modifier(limb.path(), {.name = "a", .type = "smooth"});
  const std::string before = testing::read_bytes(limb.path());
  add_modifier(limb.path(), {.name = "b", .type = "relax"});
  std::ofstream(limb.path(), std::ios::binary) << before;  // as if killed between the two files
  EXPECT_EQ(undo_modifiers(limb.path()).modifiers.size(), 0u);
  EXPECT_EQ(redo_modifiers(limb.path()).modifiers.size(), 1u);
}

TEST(Curate, RandomEditsLeaveTheRawShapesAndCanAllBeUndone) {
  const CuratedLimb limb;
  const std::string raw = testing::read_bytes(limb.folder() / "two.pc2"), begun = testing::read_bytes(limb.path());
  std::mt19937 random(7);
  std::vector<std::string> states{begun};
  for (int k = 0; k < 40; ++k) {
    const std::vector<Modifier> stack = read_dataset(limb.path()).modifiers;
    const std::string name = stack.empty() ? "" : stack[random() % stack.size()].name;
    const auto choice = stack.empty() ? 0 : random() % 5;
    if (choice == 0) add_modifier(limb.path(), {.type = k % 2 == 0 ? "smooth" : "drop", .strength = 0.1});
    if (choice == 1) enable_modifier(limb.path(), name, random() % 2 == 0);
    if (choice == 2) move_modifier(limb.path(), name, 1 + random() % stack.size());
    if (choice == 3) remove_modifier(limb.path(), name);
    if (choice == 4) change_modifier(limb.path(), name, {.strength = 0.01 * static_cast<double>(random() % 100)});
    const std::string now = testing::read_bytes(limb.path());
    if (now != states.back()) states.push_back(now);
  }
  for (std::size_t k = states.size() - 1; k-- > 0;) {
    undo_modifiers(limb.path());
    ASSERT_EQ(testing::read_bytes(limb.path()), states[k]) << k;
  }
  EXPECT_EQ(testing::read_bytes(limb.folder() / "two.pc2"), raw);
}

TEST(Curate, PruneLeavesWhatUndoLeadsTo) {
  const CuratedLimb limb;
  const auto files = [&] {
    std::size_t count = 0;
    for (const auto& entry : std::filesystem::directory_iterator(limb.folder() / "modifiers")) {
      count += entry.path().extension() == ".pc2" ? 1 : 0;
    }
    return count;
  };
  sculpt_frame(limb, "elbow", "one", 16, sculpted(limb, 16), true, 36);
  sculpt_frame(limb, "elbow", "one", 16, sculpted(limb, 15), true, 36);
  remove_modifier(limb.path(), "elbow");
  std::ofstream(limb.folder() / "modifiers" / "stranded.pc2") << "of a run that was killed";
  EXPECT_EQ(files(), 3u);
  EXPECT_EQ(prune_modifiers(limb.path(), false).files, 1u);
  undo_modifiers(limb.path());
  EXPECT_TRUE(limb.stack().is_changed(15));
  EXPECT_EQ(prune_modifiers(limb.path(), true).files, 1u);
  EXPECT_EQ(files(), 1u);
  EXPECT_TRUE(limb.stack().is_changed(15));
  EXPECT_THROW(undo_modifiers(limb.path()), Error);
}

TEST(Curate, CachesAreBoundedTheOldestFirst) {
  const TemporaryFolder folder;
  const std::filesystem::path old = folder / "old.pc2", kept = folder / "kept.pc2", fresh = folder / "fresh.pc2";
  for (const auto& path : {old, kept, fresh}) std::ofstream(path) << std::string(100, 'x');
  const auto now = std::filesystem::last_write_time(fresh);
  std::filesystem::last_write_time(kept, now - std::chrono::hours(2));
  std::filesystem::last_write_time(old, now - std::chrono::hours(1));
  bound_cache(folder.path(), 250, kept);
  EXPECT_FALSE(std::filesystem::exists(old));
  EXPECT_TRUE(std::filesystem::exists(kept) && std::filesystem::exists(fresh));
}

TEST(Curate, RefusesWhatDoesNotFit) {
  const CuratedLimb limb;
  const std::string begun = testing::read_bytes(limb.path());
  const auto kind = [&](const Modifier& modifier) { return kind_of([&] { add_modifier(limb.path(), modifier); }); };
  EXPECT_EQ(kind({.type = "sharpen"}), ErrorKind::usage);
  EXPECT_EQ(kind({.type = "smooth", .mask = {{"joints", {"elbow"}}}}), ErrorKind::mismatch);
  EXPECT_EQ(kind({.type = "smooth", .mask = {{"muscles", {"biceps"}}}}), ErrorKind::mismatch);
  EXPECT_EQ(kind({.type = "smooth", .frames = {{{"take", "three"}}}}), ErrorKind::mismatch);
  EXPECT_EQ(kind({.type = "smooth", .frames = {{{"frames", "900-910"}}}}), ErrorKind::mismatch);
  EXPECT_EQ(kind({.type = "consistency", .frames = {{{"frames", "900-910"}}}}), ErrorKind::mismatch);
  EXPECT_EQ(kind({.type = "smooth", .parameters = {{"radius", 3}}}), ErrorKind::mismatch);
  EXPECT_EQ(kind({.type = "smooth", .parameters = {{"radius_mm", "wide"}}}), ErrorKind::file);
  EXPECT_EQ(kind({.type = "blend", .parameters = {{"cache", "none.pc2"}, {"take", "one"}, {"frames", "1"}}}),
            ErrorKind::file);
  EXPECT_EQ(kind_of([&] { sculpt_frame(limb, "s", "one", 3, std::vector<float>(30), true, 10); }), ErrorKind::mismatch);
  std::vector<float> exploded(3 * limb.character().output_count(), 9.0f);
  EXPECT_FALSE(sculpt_frame(limb, "s", "one", 3, exploded, true, 10).empty());  // said, and done
  undo_modifiers(limb.path());
  exploded[7] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(kind_of([&] { sculpt_frame(limb, "s", "one", 3, exploded, true, 10); }), ErrorKind::mismatch);
  EXPECT_EQ(testing::read_bytes(limb.path()), begun);
}

TEST(Curate, ATypeOfANewerVersionIsKeptAndNotApplied) {
  const CuratedLimb limb;
  Json json = Json::parse(testing::read_bytes(limb.path()));
  json["modifiers"] = {{{"name", "n"}, {"type", "sharpen"}, {"strength", 1.0}, {"since", 7}}};
  std::ofstream(limb.path()) << json.dump();
  const ShapeStack stack = limb.stack();
  ASSERT_EQ(stack.notes().size(), 1u);
  EXPECT_NE(stack.notes()[0].find("sharpen"), std::string::npos);
  EXPECT_EQ(stack.shape(3), stack.database().raw_shape(3));
  add_modifier(limb.path(), {.type = "smooth"});
  EXPECT_EQ(Json::parse(testing::read_bytes(limb.path()))["modifiers"][0]["since"], 7);
}

TEST(Curate, SelectionsThatNameThemselvesAreRefused) {
  const CuratedLimb limb;
  Json json = Json::parse(testing::read_bytes(limb.path()));
  json["selections"] = {{"a", {{{"list", "b"}}}}, {"b", {{{"list", "a"}}}}};
  std::ofstream(limb.path()) << json.dump();
  EXPECT_EQ(kind_of([&] {
              add_modifier(limb.path(), {.type = "smooth", .frames = {{{"list", "a"}}}});
            }),
            ErrorKind::mismatch);
}

// A mesh whose vertices stand in another order, sculpted by a bulge.
struct Shuffled {
  Positions sculpted;  // V x 3, in the character's order
  std::string obj;
};

// `texture`: O x 2, with as many output vertices as welded ones; empty: none.
Shuffled shuffled(const Character& character, const Positions& frame, const std::vector<double>& texture = {}) {
  Shuffled result{frame + bulge(character), ""};
  std::vector<std::size_t> order(character.vertices.rows()), place(order.size());
  std::iota(order.begin(), order.end(), 0);
  std::shuffle(order.begin(), order.end(), std::mt19937(5));
  std::ostringstream obj;
  obj.precision(9);
  for (std::size_t k = 0; k < order.size(); ++k) {
    place[order[k]] = k + 1;
    const auto at = result.sculpted.row(static_cast<Eigen::Index>(order[k]));
    obj << "v " << at[0] << ' ' << at[1] << ' ' << at[2] << '\n';
    if (!texture.empty()) obj << "vt " << texture[2 * order[k]] << ' ' << 1 - texture[2 * order[k] + 1] << '\n';
  }
  const auto corner = [&](std::uint32_t vertex) {
    const std::string number = std::to_string(place[vertex]);
    return texture.empty() ? number : number + "/" + number;
  };
  for (Eigen::Index t = character.triangles.rows(); t-- > 0;) {
    obj << "f " << corner(character.triangles(t, 1)) << ' ' << corner(character.triangles(t, 2)) << ' '
        << corner(character.triangles(t, 0)) << '\n';
  }
  result.obj = obj.str();
  return result;
}

TEST(FrameFiles, AMeshComesBackInAnyOrderAndAnotherIsRefused) {
  const CuratedLimb limb;
  const auto path = limb.folder() / "frame.obj";
  const Positions frame = limb.truth(0, 5);
  const std::vector<float> shape = output_from_welded(limb.character(), frame);
  write_frame_obj(limb.character(), {}, shape, path);
  EXPECT_EQ(read_mesh(limb.character(), {}, frame, path), shape);
  const Shuffled sculpt = shuffled(limb.character(), frame);
  std::ofstream(path) << sculpt.obj;
  const std::vector<float> back = read_mesh(limb.character(), {}, frame, path);
  EXPECT_LT(rms_mm(welded_from_output(limb.character(), back.data()), sculpt.sculpted), 1e-4);
  std::ofstream(path, std::ios::app) << "v 0 0 0\n";
  EXPECT_EQ(kind_of([&] { read_mesh(limb.character(), {}, frame, path); }), ErrorKind::mismatch);
  const std::size_t faces = sculpt.obj.find("f "), half = sculpt.obj.find("f ", (faces + sculpt.obj.size()) / 2);
  std::ofstream(path) << sculpt.obj.substr(0, half);  // what was moved has too few neighbours
  EXPECT_EQ(kind_of([&] { read_mesh(limb.character(), {}, frame, path); }), ErrorKind::mismatch);
  std::ofstream(path) << "v 0 0 nan\n";
  EXPECT_EQ(kind_of([&] { read_mesh(limb.character(), {}, frame, path); }), ErrorKind::file);
}

// Whatever its vertices' order, a mesh tells by what was not moved which skin it was made of.
TEST(FrameFiles, AMeshIsOfTheSkinThatMostOfItLiesOn) {
  const CuratedLimb limb;
  const auto path = limb.folder() / "frame.obj";
  const Positions frame = limb.truth(0, 5);
  std::vector<WrittenSkin> exported(3, {frame});
  for (Eigen::Index v = 0; v < frame.rows(); ++v) {
    exported[0].skin.row(v) *= 1.001;
    if (v % 2 == 0) exported[2].skin.row(v) *= 1.001;
  }
  std::ofstream(path) << shuffled(limb.character(), frame).obj;
  EXPECT_EQ(read_frame_mesh(limb.character(), {}, exported, path).of, 1u);
  write_frame_obj(limb.character(), {}, output_from_welded(limb.character(), exported[2].skin), path);
  EXPECT_EQ(read_frame_mesh(limb.character(), {}, exported, path).of, 2u);
  write_frame_obj(limb.character(), {}, output_from_welded(limb.character(), 1.01 * frame), path);
  EXPECT_EQ(read_frame_mesh(limb.character(), {}, exported, path).of, 0u) << "of none: the first";
}

// A sculpt that covers what differs between two exports lies on both alike: the mesh's name tells, whatever another
// program adds to it; without it, how many more there are is told.
TEST(FrameFiles, AMeshIsOfTheSkinWhoseMarkItHas) {
  const CuratedLimb limb;
  const Character& character = limb.character();
  const Positions frame = limb.truth(0, 5);
  const auto with_upper_half_moved = [&](double distance) {
    Positions moved = frame;
    for (Eigen::Index v = 0; v < moved.rows(); ++v) {
      if (character.vertices(v, 1) > 0) moved(v, 0) += distance;
    }
    return moved;
  };
  std::vector<WrittenSkin> written;
  for (const int k : {0, 1, 2}) {
    written.push_back({with_upper_half_moved(0.003 * k), export_mark(static_cast<std::uint64_t>(k))});
  }
  const Positions sculpted = with_upper_half_moved(0.02);
  for (const char* name : {"frame.obj", "frame.glb"}) {
    const auto read_marked = [&, path = limb.folder() / name](const std::string& mark) {
      if (path.extension() == ".obj") {
        write_frame_obj(character, {}, output_from_welded(character, sculpted), path, mark);
      } else {
        write_frame_gltf(character, {}, sculpted, limb.pose(0, 5), path, mark);
      }
      return read_frame_mesh(character, {}, written, path);
    };
    const FrameMesh marked = read_marked("Body_" + written[1].mark + ".001"), unmarked = read_marked("");
    EXPECT_EQ(marked.of, 1u) << name;
    EXPECT_EQ(marked.alike, 0u) << name;
    EXPECT_EQ(unmarked.of, 0u) << name;
    EXPECT_EQ(unmarked.alike, 2u) << name;
    EXPECT_EQ(read_marked(export_mark(7)).alike, 2u) << name << ": of an export that is not known any more";
  }
}

// Written with Z up: turned back, in its own order and in another. Where all of it was moved nothing tells how it lay.
TEST(FrameFiles, AMeshWithAnotherAxisUpIsTurnedBackOrRefused) {
  const CuratedLimb limb;
  const Character& character = limb.character();
  const auto path = limb.folder() / "frame.obj";
  const Positions frame = limb.truth(0, 5), sculpt = frame + bulge(character);
  const auto z_up = [](const Positions& shape) {
    Positions turned(shape.rows(), 3);
    turned << shape.col(0), -shape.col(2), shape.col(1);
    return turned;
  };
  const WrittenSkin written{frame};
  write_frame_obj(character, {}, output_from_welded(character, z_up(sculpt)), path);
  const FrameMesh in_order = read_frame_mesh(character, {}, {&written, 1}, path);
  EXPECT_TRUE(in_order.was_turned);
  EXPECT_LT(rms_mm(welded_from_output(character, in_order.positions.data()), sculpt), 1e-4);
  write_frame_gltf(character, {}, z_up(sculpt), limb.pose(0, 5), limb.folder() / "frame.glb");
  const FrameMesh any = read_frame_mesh(character, {}, {&written, 1}, limb.folder() / "frame.glb");
  EXPECT_TRUE(any.was_turned);
  EXPECT_LT(rms_mm(welded_from_output(character, any.positions.data()), sculpt), 1e-4);
  write_frame_obj(character, {}, output_from_welded(character, sculpt), path);
  EXPECT_FALSE(read_frame_mesh(character, {}, {&written, 1}, path).was_turned);
  write_frame_obj(character, {}, output_from_welded(character, z_up(1.01 * frame)), path);
  try {
    read_frame_mesh(character, {}, {&written, 1}, path);
    ADD_FAILURE() << "nothing tells how it lay, and it was read";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::mismatch) << error.what();
    EXPECT_NE(std::string(error.what()).find("another axis up"), std::string::npos) << error.what();
  }
}

// In centimetres, or in hundreds of metres: refused, whatever the order of its vertices.
TEST(FrameFiles, AMeshOfAnotherUnitIsRefused) {
  const CuratedLimb limb;
  const Positions frame = limb.truth(0, 5);
  for (const double unit : {100.0, 0.01}) {
    for (const char* name : {"frame.obj", "frame.glb"}) {
      const auto path = limb.folder() / name;
      if (path.extension() == ".obj") {
        write_frame_obj(limb.character(), {}, output_from_welded(limb.character(), unit * frame), path);
      } else {
        write_frame_gltf(limb.character(), {}, unit * frame, limb.pose(0, 5), path);
      }
      try {
        read_mesh(limb.character(), {}, frame, path);
        ADD_FAILURE() << name << " times " << unit << " was read";
      } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::mismatch) << error.what();
        EXPECT_NE(std::string(error.what()).find("another unit"), std::string::npos) << error.what();
      }
    }
  }
}

// Moved as a whole, in another order and with other faces first: the texture alone tells which vertex is which.
TEST(FrameFiles, ATextureTellsVerticesThatWereAllMoved) {
  const CuratedLimb limb;
  const Character& character = limb.character();
  const auto path = limb.folder() / "frame.obj";
  const Positions frame = limb.truth(0, 5);
  SkinSurface surface = frame_surface(limb.stack().database());
  EXPECT_TRUE(surface.texture.empty());  // of a character without
  std::mt19937 random(7);
  for (std::uint32_t o = 0; o < 2 * character.output_count(); ++o) {
    surface.texture.push_back(std::uniform_real_distribution<>(0, 1)(random));
  }
  const Positions moved = frame.rowwise() + Eigen::RowVector3d(0.3, 0, 0);
  const Shuffled sculpt = shuffled(character, moved, surface.texture);
  std::ofstream(path) << sculpt.obj;
  const std::vector<float> back = read_mesh(character, surface.texture, frame, path);
  EXPECT_LT(rms_mm(welded_from_output(character, back.data()), sculpt.sculpted), 1e-4);
  EXPECT_EQ(kind_of([&] { read_mesh(character, {}, frame, path); }), ErrorKind::mismatch);
  std::ofstream(path) << "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0.5\nf 1/1 2/1 3/1\n";
  EXPECT_EQ(kind_of([&] { read_mesh(character, {}, frame, path); }), ErrorKind::file);
  std::ofstream(path) << "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0.5 0.5\nf 1/1 2/2 3/1\n";
  EXPECT_EQ(kind_of([&] { read_mesh(character, {}, frame, path); }), ErrorKind::file);
}

TEST(FrameFiles, AnObjHasATextureAndAMaterialForEveryRegion) {
  const CuratedLimb limb;
  const Character& character = limb.character();
  const auto path = limb.folder() / "frame.obj";
  const std::vector<float> shape = output_from_welded(character, limb.truth(0, 5));
  SkinSurface surface = frame_surface(limb.stack().database());
  surface.texture.assign(2 * std::size_t{character.output_count()}, 0.25);
  write_frame_obj(character, surface, shape, path);
  EXPECT_EQ(read_mesh(character, surface.texture, limb.truth(0, 5), path), shape);
  std::ifstream file(path);
  std::map<std::string, int> faces;
  std::string line, material;
  int textured = 0;
  while (std::getline(file, line)) {
    if (line.starts_with("usemtl ")) material = line.substr(7);
    if (line.starts_with("f ")) ++faces[material];
    if (line == "vt 0.25 0.75") ++textured;
  }
  EXPECT_EQ(textured, static_cast<int>(character.output_count()));
  int sum = 0;
  for (const SurfaceMaterial& region : surface.materials) sum += faces[region.name];
  EXPECT_EQ(sum, character.output_triangles.rows());
  // A triangle of which one joint holds all is of that joint's material.
  EXPECT_GT(faces.at(character.skeleton.joints[0].name), 0);
  EXPECT_GT(faces.at(character.skeleton.joints[1].name), 0);
}

// The JSON of a .glb.
Json json_of_glb(const std::filesystem::path& path) {
  const std::string bytes = testing::read_bytes(path);
  std::uint32_t size = 0;
  std::memcpy(&size, bytes.data() + 12, sizeof(size));
  return Json::parse(bytes.substr(20, size));
}

TEST(FrameFiles, AGltfRestsInThePoseAndComesBack) {
  const CuratedLimb limb;
  const auto path = limb.folder() / "frame.glb";
  const Positions frame = limb.truth(0, 12);
  SkinSurface surface = frame_surface(limb.stack().database());
  for (std::uint32_t k = 0; k < 2 * limb.character().output_count(); ++k) surface.texture.push_back(k / 8192.0);
  write_frame_gltf(limb.character(), surface, frame, limb.pose(0, 12), path);
  const Character read = read_character(path);
  // A primitive of every region, all of them of the same vertices: nothing is torn along their borders.
  const Json json = json_of_glb(path);
  const Json& primitives = json["meshes"][0]["primitives"];
  ASSERT_EQ(primitives.size(), surface.materials.size());
  std::size_t corners = 0;
  for (std::size_t m = 0; m < primitives.size(); ++m) {
    EXPECT_EQ(json["materials"][primitives[m]["material"].get<std::size_t>()]["name"], surface.materials[m].name);
    EXPECT_EQ(primitives[m]["attributes"], primitives[0]["attributes"]);
    corners += json["accessors"][primitives[m]["indices"].get<std::size_t>()]["count"].get<std::size_t>();
  }
  EXPECT_EQ(corners, 3 * static_cast<std::size_t>(limb.character().output_triangles.rows()));
  EXPECT_EQ(read.vertices.rows(), limb.character().vertices.rows());
  EXPECT_EQ(read.triangles.rows(), limb.character().triangles.rows());
  const std::vector<double> texture = read_texture_coordinates(path);
  ASSERT_EQ(texture.size(), primitives.size() * surface.texture.size());
  for (std::size_t k = 0; k < texture.size(); ++k) EXPECT_EQ(texture[k], surface.texture[k % surface.texture.size()]);
  EXPECT_LT(rms_mm(read.vertices, frame), 1e-3);
  // The skeleton rests in the pose: its own bind pose leaves the skin where it is.
  EXPECT_LT(rms_mm(skin_linear(read, bind_pose(read.skeleton)), frame), 1e-3);
  for (int k = 0; k < 4; ++k) {
    EXPECT_NEAR(read.skeleton.joints[1].bind.rotation[k], limb.pose(0, 12).joints[1].rotation[k], 1e-6);
  }
  const std::vector<float> back = read_mesh(limb.character(), {}, frame, path);
  EXPECT_LT(rms_mm(welded_from_output(limb.character(), back.data()), frame), 1e-3);
}

TEST(Bake, WritesWhatTheStackMakes) {
  const CuratedLimb limb;
  add_modifier(limb.path(), {.type = "smooth", .frames = {{{"take", "one"}}}});
  add_modifier(limb.path(), {.type = "drop", .frames = {{{"take", "one"}, {"frames", "1-3"}}}});
  add_modifier(limb.path(), {.type = "symmetry"});
  const ShapeStack stack = limb.stack();
  std::filesystem::create_directory(limb.folder() / "baked");
  const Dataset baked = bake_dataset(stack, limb.folder() / "baked");
  const ShapeStack again(read_pose_database(read_dataset(limb.folder() / "baked" / "dataset.json")));
  ASSERT_EQ(baked.takes.size(), 4u);
  EXPECT_EQ(baked.takes[0].frames.front(), 4);
  EXPECT_LT(rms_mm(again.shape(0), stack.shape(3)), 1e-3);
  EXPECT_TRUE(baked.modifiers.empty());
}

// A joint that all of the skin hangs under turns the body and bends none of it: poses are no further apart for it.
TEST(ModifierScope, PosesAreToldByJointsThatBendSkin) {
  const CuratedLimb limb;
  PoseDatabase database = read_pose_database(read_dataset(limb.path()));
  const Json near = {{{"near", {{"take", "one"}, {"frame", 1}, {"degrees", 1}}}}};
  const std::vector<char> told_by_the_elbow = selected_frames(database, near, "a test");
  EXPECT_EQ(std::count(told_by_the_elbow.begin(), told_by_the_elbow.end(), true), 2);
  for (auto& weights : database.character.weights) weights = {{2, 1.0}};
  const std::vector<char> told_by_none = selected_frames(database, near, "a test");
  EXPECT_EQ(std::count(told_by_none.begin(), told_by_none.end(), true), 2 * kSweepFrames);
  EXPECT_TRUE(joints_moving(database.character, Eigen::VectorXd::Ones(database.character.vertices.rows())).empty());
}

}  // namespace
}  // namespace bodyopt::trainer
