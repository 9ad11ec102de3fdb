#include "dataset/dataset.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "runtime/core/json.h"
#include "tests/support/hostile_bytes.h"
#include "tests/support/temporary_folder.h"

namespace bodyopt {
namespace {

using namespace testing;
Dataset small_dataset() {
  Dataset dataset;
  dataset.character = "../hero.glb";
  dataset.unit = 0.01;
  dataset.muscles = "muscles.json";
  dataset.materials = "soft.json";
  dataset.regions = "regions.json";
  dataset.takes = {
      {"walk", "clips/walk.glb#walk 1", "", 23.976, -3, {-3, -2, -1, 5, 7, 9}, "walk.pc2", "walk.status.json", {5, 7}},
      {"run", "run.bvh", "flex.json", 24, 1, {10, 1, 2, 3}, "run.pc2", "", {}}};
  dataset.takes[1].joint_map = "names.json";
  dataset.takes[1].up = "-z";
  return dataset;
}

void expect_same(const Dataset& a, const Dataset& b) {
  EXPECT_EQ(a.character, b.character);
  EXPECT_EQ(a.unit, b.unit);
  EXPECT_EQ(a.muscles, b.muscles);
  EXPECT_EQ(a.materials, b.materials);
  EXPECT_EQ(a.regions, b.regions);
  ASSERT_EQ(a.takes.size(), b.takes.size());
  for (std::size_t k = 0; k < a.takes.size(); ++k) {
    const DatasetTake &x = a.takes[k], &y = b.takes[k];
    EXPECT_EQ(x.name, y.name);
    EXPECT_EQ(x.clip, y.clip);
    EXPECT_EQ(x.controls, y.controls);
    EXPECT_EQ(x.fps, y.fps);
    EXPECT_EQ(x.first_frame, y.first_frame);
    EXPECT_EQ(x.frames, y.frames);
    EXPECT_EQ(x.shapes, y.shapes);
    EXPECT_EQ(x.shapes_status, y.shapes_status);
    EXPECT_EQ(x.heldout, y.heldout);
    EXPECT_EQ(x.joint_map, y.joint_map);
    EXPECT_EQ(x.up, y.up);
  }
}

void read(const std::filesystem::path& path) { read_dataset(path); }

TEST(DatasetFile, RoundTrip) {
  const TemporaryFolder folder;
  const Dataset dataset = small_dataset();
  write_dataset(dataset, folder / "dataset.json");
  const Dataset loaded = read_dataset(folder / "dataset.json");
  expect_same(dataset, loaded);
  EXPECT_EQ(loaded.folder, folder.path());
  write_dataset(loaded, folder / "again.json");
  EXPECT_EQ(read_bytes(folder / "dataset.json"), read_bytes(folder / "again.json"));
}

TEST(DatasetFile, IsMeantForPeople) {
  const TemporaryFolder folder;
  write_dataset(small_dataset(), folder / "dataset.json");
  const std::string text = read_bytes(folder / "dataset.json");
  EXPECT_EQ(text.rfind("{\n  \"schema\": \"bodyopt-dataset-1\",\n  \"character\": \"../hero.glb\",\n", 0), 0u) << text;
  EXPECT_NE(text.find("\"frames\": \"-3--1,5-9x2\""), std::string::npos) << text;
  EXPECT_NE(text.find("\"frames\": \"10,1-3\""), std::string::npos) << text;
  EXPECT_EQ(text.back(), '\n');
}

TEST(DatasetFile, AbsolutePathsAreWrittenRelative) {
  const TemporaryFolder folder;
  Dataset dataset = small_dataset();
  dataset.character = (folder / "in/hero.glb").string();
  dataset.takes[0].clip = (folder / "clip.glb").string() + "#walk";
  dataset.takes[0].shapes = (folder / "out/walk.pc2").string();
  dataset.takes[0].joint_map = (folder / "names.json").string();
  std::filesystem::create_directory(folder / "out");
  write_dataset(dataset, folder / "out/dataset.json");
  const Dataset loaded = read_dataset(folder / "out/dataset.json");
  EXPECT_EQ(loaded.character, "../in/hero.glb");
  EXPECT_EQ(loaded.takes[0].clip, "../clip.glb#walk");
  EXPECT_EQ(loaded.takes[0].shapes, "walk.pc2");
  EXPECT_EQ(loaded.takes[0].joint_map, "../names.json");
}

TEST(DatasetFile, AbsolutePathsAreRead) {
  const TemporaryFolder folder;
  write_bytes(folder / "dataset.json", R"({"schema": "bodyopt-dataset-1", "character": "/hero.glb", "takes": []})");
  const Dataset dataset = read_dataset(folder / "dataset.json");
  EXPECT_EQ(dataset.folder / dataset.character, "/hero.glb");
  EXPECT_EQ(dataset.unit, 0);
}

TEST(DatasetFile, EveryTruncationIsRefused) {
  const TemporaryFolder folder;
  write_dataset(small_dataset(), folder / "dataset.json");
  // Without its last line break the text is still whole.
  expect_every_truncation_refused(read, folder / "cut.json", read_bytes(folder / "dataset.json"), 1);
}

TEST(DatasetFile, DamagedBytesGiveRefusalOrADataset) {
  const TemporaryFolder folder;
  write_dataset(small_dataset(), folder / "dataset.json");
  const std::size_t refused = damage_bytes(read, folder / "b.json", read_bytes(folder / "dataset.json"), 5000);
  EXPECT_GT(refused, 2500u);
}

// The good file with one part replaced.
TEST(DatasetFile, WrongPartsAreRefusedByName) {
  const TemporaryFolder folder;
  write_dataset(small_dataset(), folder / "dataset.json");
  const Json good = Json::parse(read_bytes(folder / "dataset.json"));
  const auto expect = [&](const std::string& named, const std::function<void(Json&)>& change) {
    Json bad = good;
    change(bad);
    expect_refused(read, folder / "b.json", bad.dump(), named);
  };
  expect("schema is 'bodyopt-dataset-2'", [](Json& j) { j["schema"] = "bodyopt-dataset-2"; });
  expect("\"schema\"", [](Json& j) { j.erase("schema"); });
  expect("\"schema\"", [](Json& j) { j["schema"] = 1; });
  expect("\"schema\"", [](Json& j) { j = Json::array(); });
  expect("unknown key 'charakter'", [](Json& j) { j["charakter"] = "x"; });
  expect("lacks 'character'", [](Json& j) { j.erase("character"); });
  expect("'character' is empty", [](Json& j) { j["character"] = ""; });
  expect("'character' is not text", [](Json& j) { j["character"] = 3; });
  expect("'regions' is empty", [](Json& j) { j["regions"] = ""; });
  expect("'unit' is -1", [](Json& j) { j["unit"] = -1; });
  expect("'unit' is \"cm\"", [](Json& j) { j["unit"] = "cm"; });
  expect("'takes' is not a list", [](Json& j) { j["takes"] = "walk"; });
  expect("lacks 'takes'", [](Json& j) { j.erase("takes"); });
  expect("takes[1] is not an object", [](Json& j) { j["takes"][1] = 3; });
  expect("takes[1] has the name of an earlier take", [](Json& j) { j["takes"][1]["name"] = "walk"; });
  expect("takes[1] 'name' is empty", [](Json& j) { j["takes"][1]["name"] = ""; });
  expect("takes[0] has the unknown key 'held_out'", [](Json& j) { j["takes"][0]["held_out"] = "1-2"; });
  expect("takes[0] lacks 'clip'", [](Json& j) { j["takes"][0].erase("clip"); });
  expect("takes[0] lacks 'shapes'", [](Json& j) { j["takes"][0].erase("shapes"); });
  expect("takes[0] 'fps' is 0", [](Json& j) { j["takes"][0]["fps"] = 0; });
  expect("takes[0] 'first_frame' is 1.5, expected a whole number", [](Json& j) { j["takes"][0]["first_frame"] = 1.5; });
  expect("takes[0] 'first_frame' is 1e+300", [](Json& j) { j["takes"][0]["first_frame"] = 1e300; });
  expect("takes[0] 'frames'", [](Json& j) { j["takes"][0]["frames"] = "1:5"; });
  expect("takes[0] 'frames'", [](Json& j) { j["takes"][0]["frames"] = "1-2000000000"; });
  expect("takes[0] 'frames' is not text", [](Json& j) { j["takes"][0]["frames"] = {1, 2}; });
  expect("takes[0] names no frames", [](Json& j) { j["takes"][0]["frames"] = ""; });
  expect("takes[0] holds out frame 6", [](Json& j) { j["takes"][0]["heldout"] = "5-6"; });
}

TEST(DatasetFile, HostileTextIsRefused) {
  const TemporaryFolder folder;
  const auto expect = [&](const std::string& text, const std::string& named) {
    expect_refused(read, folder / "b.json", text, named);
  };
  const std::string start = "{\"schema\": \"bodyopt-dataset-1\", \"character\": ";
  expect("", "JSON");
  expect("null", "schema");
  expect(std::string(1'000'000, '['), "nested deeper");
  expect(start + std::string(1'000'000, '['), "nested deeper");
  expect(start + std::string(30, '[') + std::string(30, ']') + "}", "'character' is not text");
  expect(start + "\"a\", \"character\": \"b\", \"takes\": []}", "twice");
  expect(start + "\"\xff\", \"takes\": []}", "JSON");
  expect(start + "\"a\", \"unit\": NaN, \"takes\": []}", "JSON");
  expect(start + "\"a\", \"unit\": 1e999, \"takes\": []}", "JSON");
}

TEST(DatasetFile, WhatCannotBeReadBackIsNotWritten) {
  const TemporaryFolder folder;
  const auto write = [](const Dataset& dataset) {
    return [dataset](const auto& path) { write_dataset(dataset, path); };
  };
  Dataset twice = small_dataset(), not_text = small_dataset();
  twice.takes[0].frames = {1, 2, 2, 3};
  not_text.takes[0].name = "\xff";
  EXPECT_TRUE(refuses(write(twice), folder / "a.json", "a frame twice"));
  EXPECT_TRUE(refuses(write(not_text), folder / "a.json", "not UTF-8"));
  EXPECT_TRUE(refuses(write(small_dataset()), folder / "nowhere/a.json", "no folder"));
  EXPECT_TRUE(refuses(write(small_dataset()), folder.path(), "a folder"));
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
  EXPECT_TRUE(refuses(read, folder / "nowhere.json", "missing"));
  EXPECT_TRUE(refuses(read, folder.path(), "a folder"));
}

const std::vector<FrameStatus> kStatus = {{1, 9.5e-5, true, 40, 0.25, 0, 1e-3, -0.01, 0xfedcba9876543210},
                                          {-7, 0.1 + 0.2, false, 500, 1e-9, 12, 0, 0.25}};

void read_status(const std::filesystem::path& path) { read_frame_status(path); }

TEST(FrameStatusFile, RoundTripIsBitExact) {
  const TemporaryFolder folder;
  std::vector<FrameStatus> status = kStatus;
  status[1].volume_change = -1.3;                       // a muscle turned inside out
  status.push_back({3, std::nan(""), false, 0, 0, 0});  // the solver blew up
  status[2].volume_change = std::numeric_limits<double>::infinity();
  write_frame_status(status, folder / "status.json");
  const std::vector<FrameStatus> loaded = read_frame_status(folder / "status.json");
  ASSERT_EQ(loaded.size(), 3u);
  for (std::size_t k = 0; k < 2; ++k) {
    EXPECT_EQ(loaded[k].frame, status[k].frame);
    EXPECT_EQ(loaded[k].residual, status[k].residual);
    EXPECT_EQ(loaded[k].converged, status[k].converged);
    EXPECT_EQ(loaded[k].iterations, status[k].iterations);
    EXPECT_EQ(loaded[k].seconds, status[k].seconds);
    EXPECT_EQ(loaded[k].inverted_tets, status[k].inverted_tets);
    EXPECT_EQ(loaded[k].contact_depth, status[k].contact_depth);
    EXPECT_EQ(loaded[k].volume_change, status[k].volume_change);
    EXPECT_EQ(loaded[k].inputs, status[k].inputs);
  }
  EXPECT_EQ(loaded[2].residual, std::numeric_limits<double>::infinity());
  EXPECT_FALSE(loaded[2].converged);
  EXPECT_TRUE(std::isnan(loaded[2].contact_depth));  // not measured
}

TEST(FrameStatusFile, TruncatedAndDamagedFilesAreRefused) {
  const TemporaryFolder folder;
  write_frame_status(kStatus, folder / "status.json");
  const std::string bytes = read_bytes(folder / "status.json");
  expect_every_truncation_refused(read_status, folder / "b.json", bytes, 1);
  EXPECT_GT(damage_bytes(read_status, folder / "b.json", bytes, 3000), 1500u);
}

TEST(FrameStatusFile, WrongPartsAreRefusedByName) {
  const TemporaryFolder folder;
  write_frame_status(kStatus, folder / "status.json");
  const Json good = Json::parse(read_bytes(folder / "status.json"));
  const auto expect = [&](const std::string& named, const std::function<void(Json&)>& change) {
    Json bad = good;
    change(bad);
    expect_refused(read_status, folder / "b.json", bad.dump(), named);
  };
  expect("schema is", [](Json& j) { j["schema"] = "bodyopt-dataset-1"; });
  expect("unknown key", [](Json& j) { j["frames"][0]["force"] = 1; });
  expect("frames[0] lacks 'residual'", [](Json& j) { j["frames"][0].erase("residual"); });
  expect("'residual' is -0.1", [](Json& j) { j["frames"][0]["residual"] = -0.1; });
  expect("'converged'", [](Json& j) { j["frames"][0]["converged"] = 1; });
  expect("'inputs' is not 16", [](Json& j) { j["frames"][0]["inputs"] = "fedcba987654321"; });
  expect("'inputs' is not 16", [](Json& j) { j["frames"][0]["inputs"] = "fedcba987654321g"; });
  expect("'iterations' is -1", [](Json& j) { j["frames"][0]["iterations"] = -1; });
  expect("frames[1] names frame 1 again", [](Json& j) { j["frames"][1]["frame"] = 1; });
  expect("frames[1] says 'converged'", [](Json& j) { j["frames"][1]["converged"] = true; });
  expect("frames[0] says 'converged'", [](Json& j) { j["frames"][0]["residual"] = nullptr; });
  expect("frames[0] says 'converged'", [](Json& j) { j["frames"][0]["inverted_tets"] = 1; });
}

}  // namespace
}  // namespace bodyopt
