// Every verb says the same of the same file.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "tests/assets/gltf_blob.h"
#include "tests/cli/limb_files.h"
#include "tests/support/read_bytes.h"
#include "tests/support/run_verb.h"

namespace bodyopt {
namespace {

using namespace testing;

class SameAnswer : public ::testing::Test {
 protected:
  SameAnswer() : files_(folder_, 1) {}

  std::string at(const std::string& name) const { return (folder_ / name).string(); }

  // A file of the limb with other nodes.
  static void change(const std::string& file, const std::function<void(Json&)>& nodes) {
    const std::string bytes = read_bytes(file);
    std::uint32_t size = 0;
    std::memcpy(&size, bytes.data() + 12, sizeof size);
    Json root = Json::parse(bytes.substr(20, size));
    nodes(root);
    put_bytes(file, GltfBlob::glb_of(root.dump(), bytes.substr(28 + size)));
  }

  // Below an armature that is scaled so.
  static void put_into_armature(Json& root, const Vec3& scale) {
    Json& scene = root["scenes"][0]["nodes"];
    for (Json& node : scene) {
      if (!root["nodes"][node.get<std::size_t>()].contains("children")) continue;
      root["nodes"].push_back({{"name", "armature"}, {"scale", scale}, {"children", {node}}});
      node = root["nodes"].size() - 1;
    }
  }

  std::vector<std::string> with_character(const std::string& file) const {
    return {"info " + file,
            "train --ddm-only " + file + " --out " + at("new.safetensors"),
            "check " + file + " --clip " + files_.motion,
            "rig " + file + " --out " + at("rig"),
            "rom " + file + " --from " + files_.motion + " --out " + at("rom.glb"),
            "simulate " + file + " --clip " + files_.motion + " --frames 1-2 --draft --out " + at("data"),
            "transfer basis " + at("limb.safetensors") + " " + file + " --out " + at("moved.safetensors"),
            "anatomy " + file};
  }

  std::vector<std::string> with_clip(const std::string& file) const {
    const std::string& limb = files_.character;
    return {"eval " + at("limb.safetensors") + " --device cpu --out " + at("new.pc2") + " --clip " + file,
            "check " + limb + " --clip " + file,
            "rig " + limb + " --out " + at("rig") + " --clip " + file,
            "rom " + limb + " --out " + at("rom.glb") + " --from " + file,
            "simulate " + limb + " --frames 1-2 --draft --out " + at("data") + " --clip " + file,
            "transfer basis " + at("limb.safetensors") + " " + limb + " --out " + at("moved.safetensors") +
                " --report " + at("report.html") + " --clip " + file};
  }

  std::vector<std::string> with_cache(const std::string& file) const {
    return {"info " + file, "compare " + file + " " + file,
            "dataset add " + at("shapes") + " --character " + files_.character + " --clip " + files_.motion +
                " --shapes " + file};
  }

  static void expect_of_all(const std::vector<std::string>& commands, int exit_code, const std::string& said) {
    for (const std::string& command : commands) {
      const ProgramResult result = run_verb(command);
      EXPECT_EQ(result.exit_code, exit_code) << command << "\n" << result.output;
      EXPECT_NE(result.output.find(said), std::string::npos) << command << "\n" << result.output;
    }
  }

  void train() const {
    ASSERT_EQ(run_verb("train --ddm-only " + files_.character + " --out " + at("limb.safetensors")).exit_code, 0);
  }

  TemporaryFolder folder_;
  LimbFiles files_;
};

TEST_F(SameAnswer, OfWhatStretchesOrTurnsInsideOut) {
  train();
  change(files_.character, [](Json& root) { put_into_armature(root, {1, 1.4, 0.7}); });
  expect_of_all(with_character(files_.character), 0, "The nodes stretch the whole skin one way");
  change(files_.character, [](Json& root) {
    root["nodes"][root["skins"][0]["joints"][1].get<std::size_t>()]["scale"] = {-1, 1, 1};
  });
  expect_of_all(with_character(files_.character), 4, "turn the skin inside out");
}

TEST_F(SameAnswer, OfCharactersInAnotherUnit) {
  train();
  const LimbFiles larger(folder_, 1000);
  expect_of_all(with_character(larger.character), 0, "a unit is taken as 0.01 m");
}

TEST_F(SameAnswer, OfClipsThatAreShearedOrScaled) {
  train();
  change(files_.motion, [](Json& root) { put_into_armature(root, {1.3, 1.3, 1.3}); });
  expect_of_all(with_clip(files_.motion), 0,
                "are 1.3 times as long as this one's; how far it travels is scaled by 0.7692");
  change(files_.motion, [](Json& root) {
    for (Json& node : root["nodes"]) {
      if (node["name"] == "armature") node["scale"] = {1, 1.4, 0.7};
    }
    root["nodes"][0]["rotation"] = {0, 0, 0.5, std::sqrt(0.75)};
  });
  expect_of_all(with_clip(files_.motion), 0, "m from where they should. Apply scales before the export");
}

// By what they are, with a way to what is read.
TEST_F(SameAnswer, OfWhatIsNotRead) {
  train();
  const struct {
    const char *name, *bytes, *said;
    bool told_by_name = false;
  } files[] = {{"hero.blend", "BLENDER-v304", "a Blender file (.blend): open it in Blender"},
               {"packed.blend", "\x28\xb5\x2f\xfd", "a Blender file (.blend), compressed: open it in Blender", true},
               {"hero.usd", "PXR-USDC", "a USD file: open it in Blender"},
               {"hero.usdz", "PK\x03\x04", "a USD file: open it in Blender", true},
               {"hero.abc", "Ogawa", "an Alembic cache (.abc): Blender and Houdini"},
               {"hero.ma", "//Maya ASCII 2023 scene", "a scene of Maya (.ma): export FBX"},
               {"hero.mb", "FOR8", "a scene of Maya (.mb): export FBX", true},
               {"hero.max", "\xd0\xcf\x11\xe0", "a scene of 3ds Max (.max): export FBX"},
               {"HERO.OBJ", "mtllib hero.mtl", "an OBJ, a mesh without joints", true},
               {"walk.c3d", "\x02\x50", "markers of motion capture (.c3d), without joints", true},
               {"walk.trc", "PathFileType\t4", "markers of motion capture (.trc), without joints"},
               {"walk.amc", "#!OML:ASF", "motion of Acclaim (.amc)", true}};
  for (const auto& [name, bytes, said, told_by_name] : files) {
    for (const std::string& file : {at(name), at("called.glb"), at("called.bvh"), at("called.pc2")}) {
      const std::string extension = file.substr(file.rfind('.'));
      const bool is_called = file != at(name);
      if (is_called && told_by_name) continue;
      put_bytes(file, bytes + std::string(100, ' '));
      if (!is_called || extension == ".glb") expect_of_all(with_character(file), 4, said);
      if (!is_called || extension != ".pc2") expect_of_all(with_clip(file), 4, said);
      if (!is_called || extension == ".pc2") expect_of_all(with_cache(file), 4, said);
    }
  }
}

}  // namespace
}  // namespace bodyopt
