// What the shapes of a dataset are through its modifiers.
#include "trainer/curate/shape_stack.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <random>

#include "dataset/modifier.h"
#include "runtime/core/error.h"
#include "tests/curate/curated_limb.h"
#include "tests/support/error_kind.h"
#include "tests/support/read_bytes.h"
#include "trainer/curate/edit_stack.h"
#include "trainer/curate/modifier_scope.h"
#include "trainer/curate/offset_cache.h"
#include "trainer/curate/pose_space.h"

namespace bodyopt::trainer {
namespace {

using testing::kind_of;

std::vector<float> sculpted(const CuratedLimb& limb, int frame) {
  const ShapeStack stack = limb.stack();
  const Positions offsets = stack.offsets(static_cast<std::size_t>(frame - 1), 0) + bulge(limb.character());
  return output_from_welded(limb.character(), limb.character().vertices + offsets);
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
