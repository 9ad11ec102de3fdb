// One session of a character that has everything, to the last bit on one device: what the viewport exports, what `eval`
// makes of the session, and a farm's shot that is cut in three.
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "runtime/core/json.h"
#include "tests/proxy_viewer/played_viewport.h"
#include "tests/support/attached_limb.h"
#include "tests/support/random_tables.h"
#include "tests/support/read_bytes.h"
#include "tests/support/run_verb.h"
#include "trainer/dynamics/build_dynamics.h"
#include "trainer/modifiers/bake_stack.h"

namespace bodyopt::testing {
namespace same_shot_test {

namespace fs = std::filesystem;

// The trained limb, which breathes: its skin is moved at random, its elbow turned, litre for litre.
void add_breath(Basis& basis) {
  SkinModifiers& modifiers = basis.modifiers;
  SkinModifier breath;
  breath.name = "breath";
  breath.type = "breathing";
  breath.first_component = modifiers.component_count();
  breath.component_count = 2;
  breath.numbers = {1};
  breath.turns = {{1, 0, 0.1f, 0, 0}};
  Random random(3);
  SkinModifiers all = modifiers;
  all.blend.clear();
  all.blend_begin = {0};
  for (std::size_t block = 0; block + 1 < modifiers.blend_begin.size(); ++block) {
    const auto begin = modifiers.blend.begin();
    all.blend.insert(all.blend.end(), begin + modifiers.blend_begin[block], begin + modifiers.blend_begin[block + 1]);
    const auto first = static_cast<std::uint32_t>(block * kBlockSize);
    const std::uint32_t lanes = std::min(kBlockSize, basis.mesh.vertex_count() - first);
    for (std::uint32_t k = 0; k < breath.component_count; ++k) {
      all.blend.push_back(random_blend_entry(random, 0.01, breath.first_component + k, lanes));
    }
    all.blend_begin.push_back(static_cast<std::uint32_t>(all.blend.size()));
  }
  all.stack.push_back(breath);
  basis.modifiers = all;
}

// The skin at the clip's pose of a frame, swollen in the middle.
void write_sculpt(const Basis& basis, const Pose& pose, const fs::path& path) {
  std::vector<float> mesh = Deformer(basis, DeviceChoice{.name = "cpu"}).evaluate({&pose, 1}).positions;
  for (std::size_t o = 0; o < basis.mesh.output_count(); ++o) {
    const float height = basis.mesh.rest[3 * basis.mesh.output_vertex[o] + 2] - 0.3f;
    mesh[3 * o] += 0.02f * std::exp(-height * height / 0.005f);
  }
  Pc2Writer writer(path, basis.mesh.output_count(), 1);
  writer.append(mesh);
  writer.close();
}

class SameShot : public PlayedTest {
 protected:
  // hero.safetensors, with a sleeve and dynamics beside it, and bend.glb.
  void make_hero() {
    Basis basis = TrainedCharacter(folder_).made;
    const Clip clip = bending_clip(basis.skeleton);
    write_clip(clip, basis.skeleton, "limb_bend.glb");
    write_character(limb_character(), "limb.glb");
    const ProgramResult jiggles = run_verb(
        "dynamics limb.glb --basis trained.safetensors --out hero.dynamics.safetensors --dynamics-resolution 600");
    ASSERT_EQ(jiggles.exit_code, 0) << jiggles.output;
    write_sculpt(basis, clip.poses[8], "sculpt.pc2");
    std::ofstream("stack.json") << R"({"schema": "bodyopt-modifiers-1", "modifiers": [
      {"name": "elbow", "type": "sculpt", "mesh": "sculpt.pc2", "clip": "limb_bend.glb", "frame": 9, "spread_degrees": 30},
      {"name": "flesh", "type": "sag", "dynamics": "hero.dynamics.safetensors"},
      {"name": "folds", "type": "push_out"}]})";
    std::vector<std::string> notes;
    basis.modifiers = bake_stack("stack.json", basis, notes);
    add_breath(basis);
    save_basis(basis, "hero.safetensors");
    save_attachments(attached_to_limb({sleeve(0.004)}), "hero.attached.safetensors");
  }

  static void expect_same(const std::string& cache, const std::string& other) {
    for (const char* ending : {".pc2", ".sleeve.pc2"}) {
      const std::string bytes = read_bytes(cache + ending);
      EXPECT_GT(bytes.size(), 1000u);
      EXPECT_TRUE(bytes == read_bytes(other + ending)) << cache << " and " << other << ", " << ending;
    }
  }
};

TEST_F(SameShot, IsTheSameWhoeverEvaluatesIt) {
  make_hero();
  ViewerOptions options = small();
  options.files = {"hero.safetensors", "limb_bend.glb"};
  {
    const auto viewport = open(
        options,
        "frame 2; turn joint1 20 0 0; control flesh.amount 0; key; frame 9; turn joint1 90 0 0; control breath.depth 2; "
        "key; jiggle on; jiggle-amount 1.5; correction 0.75; in 2; out 11; save shot.json; export-skin seen.pc2");
  }

  const std::string device = device_->info().name;
  const ProgramResult whole =
      run_verb("eval --session shot.json --jiggle --device '" + device + "' --out whole.pc2 --json whole.json");
  ASSERT_EQ(whole.exit_code, 0) << whole.output;
  expect_same("seen", "whole");
  // All of it is in the shot.
  const Json told = Json::parse(read_bytes("whole.json"));
  ASSERT_EQ(told.at("modifiers").size(), 4u);
  for (const Json& move : told.at("modifiers")) EXPECT_GT(move.at("largest_mm"), 0.05) << move;
  EXPECT_GT(told.at("per_frame").back().at("jiggle_max_mm"), 0.05);

  std::ofstream("shots.json") << Json{{"schema", "bodyopt-shots-1"},
                                      {"elements",
                                       {{{"shot", "sq010"},
                                         {"element", "hero"},
                                         {"session", "shot.json"},
                                         {"jiggle", true},
                                         {"device", device},
                                         {"frame_ms", 12000},
                                         {"out", "farm.pc2"}}}}};
  const ProgramResult planned = run_verb("farm plan shots.json --task-minutes 0.7 --out plan --json plan.json");
  ASSERT_EQ(planned.exit_code, 0) << planned.output;
  EXPECT_EQ(Json::parse(read_bytes("plan.json")).at("waves"), 4);  // three parts, and what joins them
  const ProgramResult ran = run_verb("farm run plan");
  ASSERT_EQ(ran.exit_code, 0) << ran.output;
  expect_same("whole", "farm");
}

}  // namespace same_shot_test
}  // namespace bodyopt::testing
