// What check tells of a character on the command line.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "assets/characters/character.h"
#include "runtime/core/json.h"
#include "tests/simulate/limb.h"
#include "tests/support/read_bytes.h"
#include "tests/support/run_verb.h"
#include "tests/support/temporary_folder.h"

namespace bodyopt {
namespace check_program_test {

// A limb with a hole in its side; a small one inside it rides, and no side shows it.
Character with_hole_and_loose_piece() {
  const Character limb = make_limb();
  Character both = limb;
  const Eigen::Index vertices = limb.vertices.rows(), faces = limb.triangles.rows(), hole = 8;
  both.vertices.resize(2 * vertices, 3);
  both.vertices << limb.vertices, 0.2 * limb.vertices;
  both.vertices.bottomRows(vertices).col(0).array() += 0.05;
  both.triangles.resize(2 * faces - hole, 3);
  both.triangles << limb.triangles.topRows(2), limb.triangles.bottomRows(faces - hole - 2),
      (limb.triangles.array() + static_cast<std::uint32_t>(vertices)).matrix();
  both.weights.insert(both.weights.end(), limb.weights.begin(), limb.weights.end());
  for (const std::uint32_t v : limb.output_vertex) {
    both.output_vertex.push_back(v + static_cast<std::uint32_t>(vertices));
  }
  both.output_triangles = both.triangles;
  return both;
}

// The numbers of all places, by the kind of place.
std::map<std::string, std::vector<Json>> numbers_in(const Json& result) {
  std::map<std::string, std::vector<Json>> numbers;
  for (const char* kind : {"self_intersections", "holes", "flipped", "near_parts", "glued_parts", "riders"}) {
    for (const Json& place : result.at(kind)) numbers[kind].push_back(place.at("number"));
  }
  return numbers;
}

TEST(CheckProgram, PlacesHaveTheNumbersOfTheTextAndOfThePicture) {
  const TemporaryFolder folder;
  const std::string character = (folder / "limb.glb").string(), picture = (folder / "places.png").string();
  write_character(with_hole_and_loose_piece(), character);
  const auto json_of = [&](const std::string& options) {
    const ProgramResult result =
        run_verb("check " + character + options + " --json " + (folder / "check.json").string());
    EXPECT_EQ(result.exit_code, 0) << result.output;
    return Json::parse(testing::read_bytes(folder / "check.json"));
  };
  const Json listed = json_of("");
  auto numbers = numbers_in(listed);
  ASSERT_EQ(numbers["holes"].size(), 1u);
  ASSERT_GE(numbers["riders"].size(), 1u);
  std::size_t next = 1;
  for (const char* kind : {"self_intersections", "holes", "flipped", "near_parts", "glued_parts", "riders"}) {
    for (const Json& number : numbers[kind]) EXPECT_EQ(number, next++) << kind;
  }
  const std::string text = run_verb("check " + character).output;
  const Json &hole = listed.at("holes").front(), &loose = listed.at("riders").back();
  for (const Json& place : {hole, loose}) {
    const std::string line = place.at("number").dump() + "  " + place.at("joint").get<std::string>() + ": " +
                             place.at("vertices").dump() + " vertices, one is " + place.at("vertex").dump() + " at";
    EXPECT_NE(text.find(line), std::string::npos) << line << "\n" << text;
  }
  auto drawn = numbers_in(json_of(" --picture " + picture));
  EXPECT_EQ(drawn["holes"], numbers["holes"]);
  ASSERT_EQ(drawn["riders"].size(), numbers["riders"].size());
  for (const Json& number : drawn["riders"]) EXPECT_TRUE(number.is_null()) << number;
}

}  // namespace check_program_test
}  // namespace bodyopt
