// regions.json: painted weights, vertex colours, and every way to get them wrong.
#include "dataset/regions_file.h"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "assets/gltf/gltf_skin.h"
#include "base/json_file.h"
#include "tests/assets/character_checks.h"
#include "tests/support/hostile_bytes.h"
#include "tests/support/read_bytes.h"

namespace bodyopt {
namespace {

// The square of two_joint_square() with a fifth output vertex, a seam duplicate of the third, and colours.
GltfBlob coloured_square() {
  GltfBlob blob = two_joint_square();
  auto& attributes = primitive(blob)["attributes"];
  attributes["POSITION"] = blob.vectors({0, 0, 0, 1, 0, 0, 1, 2, 0, 0, 2, 0, 1, 2, 0});
  attributes["JOINTS_0"] = blob.joints({0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0});
  attributes["WEIGHTS_0"] = blob.quads({1, 0, 0, 0, 0.75f, 0.25f, 0, 0, 0, 1, 0, 0, 0.5f, 0.5f, 0, 0, 0, 1, 0, 0});
  attributes["COLOR_0"] =
      blob.add(std::vector<std::uint8_t>{255, 0, 0, 9, 51, 102, 0, 9, 0, 0, 0, 9, 0, 255, 0, 9, 204, 0, 0, 9}, 5121,
               "VEC4", 4, true);
  attributes["COLOR_1"] = blob.vectors({0, 0, 0, 0, 0, 0.5f, 0, 0, 0, 0, 0, 0, 0, 0, 0});
  return blob;
}

class RegionsFile : public ::testing::Test {
 protected:
  RegionsFile() : character(read(coloured_square(), folder)) {
    dataset.folder = folder / "";
    dataset.character = "c.glb";
    dataset.regions = "r.json";
  }

  std::vector<RegionWeights> regions_of(const Json& json) {
    put_bytes(folder / "r.json", json.dump());
    return read_regions(dataset, character);
  }

  void expect(ErrorKind kind, const std::string& named, const Json& json) {
    const std::string text = error_of(kind, [&] { regions_of(json); });
    EXPECT_NE(text.find(named), std::string::npos) << text;
  }

  TemporaryFolder folder;
  Character character;
  Dataset dataset;
};

Json file_of(const std::vector<Json>& regions, bool complete = false) {
  return {{"schema", "bodyopt-regions-1"}, {"vertex_count", 5}, {"complete", complete}, {"regions", regions}};
}

Json region(const std::string& name, const Json& vertices, const Json& weights) {
  return {{"name", name}, {"vertices", vertices}, {"weights", weights}};
}

TEST_F(RegionsFile, NoneIsNone) {
  dataset.regions = "";
  EXPECT_TRUE(read_regions(dataset, character).empty());
}

TEST_F(RegionsFile, WeightsAreThoseOfTheFileAndSumToOneAtMost) {
  ASSERT_EQ(character.vertices.rows(), 4);
  const auto regions =
      regions_of(file_of({region("low", {1, 0, 3}, {0.5, 1, 0.02}), region("right", {1, 4, 0}, {0.25, 0.75, 0.25})}));
  ASSERT_EQ(regions.size(), 2u);
  EXPECT_EQ(regions[0].name, "low");
  EXPECT_EQ(regions[0].vertices, (std::vector<std::uint32_t>{0, 1}));  // 2 % are dropped
  EXPECT_EQ(regions[0].weights, (std::vector<double>{0.8, 0.5}));
  EXPECT_EQ(regions[1].vertices, (std::vector<std::uint32_t>{0, 1, 2}));  // output vertex 4 is welded vertex 2
  EXPECT_EQ(regions[1].weights, (std::vector<double>{0.2, 0.25, 0.75}));
}

TEST_F(RegionsFile, CompleteFilesSumToOneEverywhere) {
  const auto regions =
      regions_of(file_of({region("a", {0, 1, 2, 3}, {0.2, 1, 1, 0.01}), region("b", {0, 1, 3}, {0.2, 1, 0.03})}, true));
  EXPECT_EQ(regions[0].vertices, (std::vector<std::uint32_t>{0, 1, 2, 3}));
  EXPECT_EQ(regions[0].weights, (std::vector<double>{0.5, 0.5, 1, 0.25}));
  EXPECT_EQ(regions[1].weights, (std::vector<double>{0.5, 0.5, 0.75}));
}

TEST_F(RegionsFile, VertexColoursOfOneChannel) {
  const auto regions = regions_of({{"schema", "bodyopt-regions-1"},
                                   {"regions",
                                    {{{"name", "r"}, {"colour", "COLOR_0"}, {"channel", "red"}},
                                     {{"name", "g"}, {"colour", "COLOR_0"}, {"channel", "green"}},
                                     {{"name", "b"}, {"colour", "COLOR_1"}, {"channel", "blue"}}}}});
  EXPECT_EQ(regions[0].vertices, (std::vector<std::uint32_t>{0, 1, 2}));  // of seam duplicates the larger
  EXPECT_NEAR(regions[0].weights[0], 1, 1e-12);
  EXPECT_NEAR(regions[0].weights[1], 0.2 / 1.1, 1e-12);  // 0.2 red, 0.4 green, 0.5 blue
  EXPECT_NEAR(regions[0].weights[2], 0.8, 1e-12);
  EXPECT_EQ(regions[1].vertices, (std::vector<std::uint32_t>{1, 3}));
  EXPECT_NEAR(regions[1].weights[0], 0.4 / 1.1, 1e-12);
  EXPECT_EQ(regions[2].vertices, std::vector<std::uint32_t>{1});
}

TEST_F(RegionsFile, WhatIsWrittenReadsBackBitForBit) {
  // In floating point 0.7 + 0.2 + 0.1 is not 1.
  const std::vector<RegionWeights> written = {{"a \"b\"", {0, 1, 2}, {1.0 / 3, 0.7, 1}},
                                              {"c", {0, 1, 3}, {1.0 / 3, 0.2, 1}},
                                              {"d", {0, 1}, {1.0 - 2.0 / 3, 0.1}}};
  write_regions(written, character, folder / "r.json");
  const auto loaded = read_regions(dataset, character);
  ASSERT_EQ(loaded.size(), written.size());
  for (std::size_t r = 0; r < written.size(); ++r) {
    EXPECT_EQ(loaded[r].name, written[r].name);
    EXPECT_EQ(loaded[r].vertices, written[r].vertices);
    EXPECT_EQ(loaded[r].weights, written[r].weights);
  }
  const std::string text = read_bytes(folder / "r.json");
  EXPECT_NE(text.find("\"vertices\": [0,1,2,4],\n"), std::string::npos) << text;  // both vertices of the seam, a line
}

TEST_F(RegionsFile, UncoveredVerticesAreCountedAndTheFirstIsPlaced) {
  expect(ErrorKind::mismatch, "3 of 5 vertices uncovered, vertex 2 first, at (1, 2, 0) m near the joint 'tip'",
         file_of({region("a", {0, 1}, {1, 0.1}), region("b", {1}, {0.1})}, true));
}

TEST_F(RegionsFile, WrongPartsAreRefusedByName) {
  const ErrorKind file = ErrorKind::file, mismatch = ErrorKind::mismatch;
  Json other_mesh = file_of({region("a", {0}, {1})});
  other_mesh["vertex_count"] = 6;
  expect(mismatch, "for 6 vertices, the character has 5", other_mesh);
  other_mesh.erase("vertex_count");
  expect(file, "lacks 'vertex_count'", other_mesh);
  expect(file, "'vertices'[1] is 5, expected 0 to 4", file_of({region("a", {0, 5}, {1, 1})}));
  expect(file, "'vertices'[0] is -1", file_of({region("a", {-1}, {1})}));
  expect(file, "'vertices'[0] is 1.5", file_of({region("a", {1.5}, {1})}));
  expect(file, "'vertices'[1] is 3, which is there already", file_of({region("a", {3, 3}, {0, 1})}));
  expect(file, "2 'vertices' and 1 'weights'", file_of({region("a", {0, 1}, {1})}));
  expect(file, "'weights'[1] is -0.5", file_of({region("a", {0, 1}, {1, -0.5})}));
  expect(file, "'weights'[0] is null", file_of({region("a", {0}, {std::nan("")})}));
  expect(file, "'weights'[0] is 255", file_of({region("a", {0}, {255})}));
  expect(file, "regions[1] has the name of an earlier region", file_of({region("a", {0}, {1}), region("a", {1}, {1})}));
  expect(file, "unknown key 'wieghts'", file_of({{{"name", "a"}, {"wieghts", {1}}}}));
  expect(file, "neither or both", file_of({{{"name", "a"}}}));
  Json both = region("a", {0}, {1});
  both["colour"] = "COLOR_0";
  expect(file, "neither or both", file_of({both}));
  expect(mismatch, "'a' has a share of 3 % or more of no vertex", file_of({region("a", {0}, {0.01})}));
  expect(file, "schema is 'bodyopt-muscles-1'", {{"schema", "bodyopt-muscles-1"}});
}

TEST_F(RegionsFile, TruncatedAndDamagedFilesAreRefused) {
  const auto read_one = [&](const std::filesystem::path& path) {
    dataset.regions = path.string();
    read_regions(dataset, character);
  };
  const std::string bytes = file_of({region("a", {0, 1}, {1, 0.25}), region("b", {1, 2, 3}, {0.5, 1, 1})}, true).dump();
  testing::expect_every_truncation_refused(read_one, folder / "b.json", bytes);
  EXPECT_GT(testing::damage_bytes(read_one, folder / "b.json", bytes, 2000), 1000u);
}

TEST_F(RegionsFile, MissingColoursAreToldWithThoseThatAreThere) {
  const auto painted = [](const char* colour, const char* channel) {
    return file_of({{{"name", "a"}, {"colour", colour}, {"channel", channel}}});
  };
  expect(ErrorKind::file, "no vertex colours 'COLOR_2'; it has 'COLOR_0', 'COLOR_1'", painted("COLOR_2", "red"));
  expect(ErrorKind::file, "no vertex colours 'POSITION'", painted("POSITION", "red"));
  expect(ErrorKind::file, "'channel' is 'r', expected red, green or blue", painted("COLOR_0", "r"));
  expect(ErrorKind::mismatch, "no vertex", painted("COLOR_0", "blue"));  // black

  GltfBlob bright = coloured_square();
  primitive(bright)["attributes"]["COLOR_0"] = bright.vectors({0, 0, 0, 0, 0, 0, 2, 0, 0, 0, 0, 0, 0, 0, 0});
  put_bytes(folder / "c.glb", bright.glb());
  expect(ErrorKind::file, "element 2 is not from 0 to 1", painted("COLOR_0", "red"));
  primitive(bright)["attributes"]["COLOR_0"] = bright.vectors({1, 0, 0});
  put_bytes(folder / "c.glb", bright.glb());
  expect(ErrorKind::file, "another count than the positions", painted("COLOR_0", "red"));
  primitive(bright)["attributes"]["COLOR_0"] = 99;
  put_bytes(folder / "c.glb", bright.glb());
  expect(ErrorKind::file, "no accessor 99", painted("COLOR_0", "red"));
}

TEST_F(RegionsFile, UnpaintedPartsOfTheSkinHaveNoColour) {
  GltfBlob blob = coloured_square();
  auto plain = primitive(blob);
  plain["attributes"].erase("COLOR_0");
  blob.root["meshes"][0]["primitives"].insert(blob.root["meshes"][0]["primitives"].begin(), plain);
  character = read(blob, folder);
  ASSERT_EQ(character.output_count(), 10u);
  const std::vector<double> colours = read_vertex_colours(folder / "c.glb", "COLOR_0");
  ASSERT_EQ(colours.size(), 30u);
  EXPECT_EQ(colours[0], 0);
  EXPECT_EQ(colours[15], 1);
}

}  // namespace
}  // namespace bodyopt
