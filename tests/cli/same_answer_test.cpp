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

  // The character's file with other nodes.
  void change(const std::function<void(Json&)>& nodes) const {
    const std::string bytes = read_bytes(files_.character);
    std::uint32_t size = 0;
    std::memcpy(&size, bytes.data() + 12, sizeof size);
    Json root = Json::parse(bytes.substr(20, size));
    nodes(root);
    put_bytes(files_.character, GltfBlob::glb_of(root.dump(), bytes.substr(28 + size)));
  }

  void expect_of_every_verb(int exit_code, const std::string& said) const {
    const std::string& limb = files_.character;
    for (const std::string& command :
         {"info " + limb, "train --ddm-only " + limb + " --out " + at("new.safetensors"),
          "check " + limb + " --clip " + files_.motion, "rig " + limb + " --out " + at("rig"),
          "rom " + limb + " --from " + files_.motion + " --out " + at("rom.glb"),
          "simulate " + limb + " --clip " + files_.motion + " --frames 1-2 --draft --out " + at("data"),
          "transfer basis " + at("limb.safetensors") + " " + limb + " --out " + at("moved.safetensors"),
          "anatomy " + limb}) {
      const ProgramResult result = run_verb(command);
      EXPECT_EQ(result.exit_code, exit_code) << command << "\n" << result.output;
      EXPECT_NE(result.output.find(said), std::string::npos) << command << "\n" << result.output;
    }
  }

  TemporaryFolder folder_;
  LimbFiles files_;
};

TEST_F(SameAnswer, OfWhatStretchesOrTurnsInsideOut) {
  ASSERT_EQ(run_verb("train --ddm-only " + files_.character + " --out " + at("limb.safetensors")).exit_code, 0);
  change([](Json& root) {
    Json& scene = root["scenes"][0]["nodes"];
    for (Json& node : scene) {
      if (!root["nodes"][node.get<std::size_t>()].contains("children")) continue;
      root["nodes"].push_back({{"name", "armature"}, {"scale", {1, 1.4, 0.7}}, {"children", {node}}});
      node = root["nodes"].size() - 1;
    }
  });
  expect_of_every_verb(0, "The nodes stretch the whole skin one way");
  change([](Json& root) { root["nodes"][root["skins"][0]["joints"][1].get<std::size_t>()]["scale"] = {-1, 1, 1}; });
  expect_of_every_verb(4, "turn the skin inside out");
}

}  // namespace
}  // namespace bodyopt
