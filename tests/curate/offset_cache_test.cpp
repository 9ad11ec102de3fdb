// What was worked out of a frame is read the next time, to the bit, and only while it is right.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>
#include <set>
#include <thread>

#include "dataset/modifier.h"
#include "tests/curate/curated_limb.h"
#include "trainer/curate/edit_stack.h"

namespace bodyopt::trainer {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kAll = 2 * kSweepFrames;
constexpr std::size_t kDifferent = kAll - 2;  // a sweep ends as it begins: the same shape in the same pose is kept once

std::set<fs::path> kept_files(const CuratedLimb& limb) {
  std::set<fs::path> files;
  std::error_code none;
  for (const fs::directory_entry& entry : fs::directory_iterator(limb.folder() / "modifiers" / "cache", none)) {
    files.insert(entry.path());
  }
  return files;
}

std::vector<Positions> all_shapes(const CuratedLimb& limb) {
  const ShapeStack stack = limb.stack();
  std::vector<Positions> shapes;
  for (std::size_t n = 0; n < stack.database().frames.size(); ++n) shapes.push_back(stack.shape(n));
  return shapes;
}

// The same, without anything that was kept.
std::vector<Positions> shapes_anew(const CuratedLimb& limb) {
  fs::remove_all(limb.folder() / "modifiers" / "cache");
  return all_shapes(limb);
}

// How many frames an edit makes something be worked out in.
std::size_t worked_out(const CuratedLimb& limb) {
  const std::size_t before = kept_files(limb).size();
  all_shapes(limb);
  return kept_files(limb).size() - before;
}

void add_stack(const CuratedLimb& limb) {
  add_modifier(limb.path(), {.type = "inflate", .parameters = {{"distance_mm", -2}}});
  add_modifier(limb.path(), {.type = "smooth", .strength = 0.5});
  add_modifier(limb.path(), {.type = "relax"});
  add_modifier(limb.path(), {.type = "volume"});
}

TEST(OffsetCache, GivesTheBitsThatWorkingOutGives) {
  const CuratedLimb limb;
  add_stack(limb);
  const std::vector<Positions> first = all_shapes(limb);
  EXPECT_EQ(kept_files(limb).size(), 2 * kDifferent);
  EXPECT_EQ(all_shapes(limb), first);
  EXPECT_EQ(shapes_anew(limb), first);
}

TEST(OffsetCache, AnEditWorksOutWhatFollowsItInTheFramesThatItTouches) {
  const CuratedLimb limb;
  add_stack(limb);
  EXPECT_EQ(worked_out(limb), 2 * kDifferent);
  EXPECT_EQ(worked_out(limb), 0u);
  change_modifier(limb.path(), "volume", {.strength = 0.3});  // nothing that is kept follows it
  EXPECT_EQ(worked_out(limb), 0u);
  change_modifier(limb.path(), "relax", {.strength = 0.3});  // what smooth left is read
  EXPECT_EQ(worked_out(limb), kDifferent);
  change_modifier(limb.path(), "relax", {.name = "slide"});  // the same by another name
  EXPECT_EQ(worked_out(limb), 0u);
  change_modifier(limb.path(), "inflate", {.frames = Json{{{"take", "one"}, {"frames", "1-38"}}}});
  EXPECT_EQ(worked_out(limb), 2 * (kAll - 38 - 1));  // those that it leaves now; of two two are alike
  add_modifier(limb.path(),
               {.type = "freeze", .frames = {{{"take", "two"}, {"frames", "3-4"}}}, .mask = {{"joints", {"joint1"}}}});
  EXPECT_EQ(worked_out(limb), 2 * 2u);
  undo_modifiers(limb.path());
  EXPECT_EQ(worked_out(limb), 0u);
}

// A sculpt below what smooths: only the poses that it spreads to are smoothed again.
TEST(OffsetCache, ASculptTouchesThePosesThatItReaches) {
  const CuratedLimb limb;
  add_modifier(limb.path(), {.type = "smooth"});
  all_shapes(limb);
  Positions mesh = limb.character().vertices + limb.stack().offsets(15, 0);
  mesh.row(100) *= 1.01;
  sculpt_frame(limb, "bump", "one", 16, output_from_welded(limb.character(), mesh), true, 13);  // at 90 degrees
  move_modifier(limb.path(), "bump", 1);
  std::size_t reached = 0;
  const ShapeStack stack = limb.stack();
  for (std::size_t n = 0; n < kAll; ++n) reached += stack.offsets(n, 1) != stack.offsets(n, 0) ? 1 : 0;
  EXPECT_EQ(worked_out(limb), reached);
  EXPECT_GT(reached, 4u);
  EXPECT_LT(reached, kAll / 2);
}

// Every way in which what is made of a frame may change makes something else of it than what was kept.
TEST(OffsetCache, KnowsWhatIsNoLongerRight) {
  const CuratedLimb limb;
  add_modifier(limb.path(), {.name = "fluke",
                             .type = "inflate",
                             .frames = {{{"take", "one"}, {"frames", "11"}}},
                             .parameters = {{"distance_mm", 6}}});
  add_modifier(limb.path(), {.type = "despike", .parameters = {{"limit_mm", 0.5}}});
  add_stack(limb);
  add_modifier(limb.path(), {.type = "detail", .parameters = {{"take", "one"}, {"frame", 16}}});
  std::vector<Positions> before = all_shapes(limb);
  const auto expect_noticed = [&](const char* what, const std::function<void()>& edit) {
    edit();
    const std::vector<Positions> cached = all_shapes(limb);
    EXPECT_NE(cached, before) << what;
    EXPECT_EQ(cached, shapes_anew(limb)) << what;
    before = cached;
  };
  const auto set = [&](const char* name, const char* key, const Json& value) {
    return [&limb, name, key, value] { change_modifier(limb.path(), name, {.parameters = {{key, value}}}); };
  };
  expect_noticed("distance", set("inflate", "distance_mm", -3));
  expect_noticed("radius", set("smooth", "radius_mm", 15));
  expect_noticed("relax", set("relax", "radius_mm", 25));
  expect_noticed("cap", set("volume", "cap_mm", 0.01));
  expect_noticed("source", set("detail", "frame", 12));
  expect_noticed("limit", set("despike", "limit_mm", 100));
  expect_noticed("mask", [&] { change_modifier(limb.path(), "relax", {.mask = Json{{"joints", {"joint1"}}}}); });
  expect_noticed("place", [&] { move_modifier(limb.path(), "inflate", 5); });
  expect_noticed("off", [&] { enable_modifier(limb.path(), "smooth", false); });
  // Another shape under the same name, of the same size: of one frame, and of one that others take detail from.
  expect_noticed("raw shapes", [&] {
    std::fstream file(limb.folder() / "one.pc2", std::ios::in | std::ios::out | std::ios::binary);
    const float moved = 0;  // by 28 mm: despike leaves it
    file.seekp(32 + 12 * static_cast<std::streamoff>(limb.character().output_count()) * 11);
    file.write(reinterpret_cast<const char*>(&moved), sizeof(moved));
  });
}

TEST(OffsetCache, WhatIsDamagedIsWorkedOutAgain) {
  const CuratedLimb limb;
  add_stack(limb);
  const std::vector<Positions> first = all_shapes(limb);
  const auto damage = [&](const std::function<void(const fs::path&)>& how) {
    for (const fs::path& path : kept_files(limb)) how(path);
    EXPECT_EQ(all_shapes(limb), first);
    EXPECT_EQ(all_shapes(limb), first);  // what was damaged has been replaced
  };
  damage([](const fs::path& path) { fs::resize_file(path, fs::file_size(path) / 2); });
  damage([](const fs::path& path) { std::ofstream(path, std::ios::app) << "more"; });
  damage([](const fs::path& path) { fs::resize_file(path, 0); });
  damage([](const fs::path& path) {
    std::fstream file(path, std::ios::in | std::ios::out | std::ios::binary);
    file.seekp(1000);
    file.put('\x55').put('\x56');
  });
  // One frame's under another's name.
  const std::set<fs::path> files = kept_files(limb);
  const fs::path &one = *files.begin(), &other = *std::next(files.begin());
  fs::copy_file(one, other, fs::copy_options::overwrite_existing);
  EXPECT_EQ(all_shapes(limb), first);
}

TEST(OffsetCache, WhereNothingCanBeKeptNothingIs) {
  const CuratedLimb limb;
  add_stack(limb);
  const std::vector<Positions> first = all_shapes(limb);
  fs::remove_all(limb.folder() / "modifiers" / "cache");
  std::ofstream(limb.folder() / "modifiers" / "cache") << "a file in the folder's place";
  EXPECT_EQ(all_shapes(limb), first);
}

TEST(OffsetCache, TwoThatWorkOutTheSameAtOnceAgree) {
  const CuratedLimb limb;
  add_stack(limb);
  std::vector<Positions> here, there;
  std::thread other([&] { there = all_shapes(limb); });
  here = all_shapes(limb);
  other.join();
  EXPECT_EQ(here, there);
  EXPECT_EQ(kept_files(limb).size(), 2 * kDifferent);
  EXPECT_EQ(all_shapes(limb), here);
}

}  // namespace
}  // namespace bodyopt::trainer
