// Files that are cut off, changed, taken away and brought back while they are played.
#include <gtest/gtest.h>

#include "tests/support/attached_limb.h"
#include "tests/support/hostile_bytes.h"
#include "tests/support/random_tables.h"
#include "tests/viewport/played_viewport.h"
#include "tests/viewport/twin_level.h"

namespace bodyopt::testing {
namespace {

using namespace draw;
using namespace viewport;

// A limb with all the files that a character can have.
class DamagedFilesTest : public PlayedTest {
 protected:
  DamagedFilesTest() {
    const Basis& basis = limb_.made.basis;
    write_truth(basis, read_clip(limb_.clip, basis.skeleton, {}), 0.002f, truth_);
    save_levels({twin(basis)}, proxy_);
    save_attachments(attached_to_limb({blade()}), folder_ / "limb.attached.safetensors");
  }

  ViewerOptions all_files() const {
    ViewerOptions options = small();
    options.files = {limb_.basis, limb_.clip, truth_};
    options.proxy = proxy_;
    return options;
  }

  JigglingCharacter limb_{folder_};
  std::string truth_ = (folder_ / "limb_truth.pc2").string(), proxy_ = (folder_ / "limb_proxy.safetensors").string();
  Random random_{20260101};
};

TEST_F(DamagedFilesTest, AreSaidAndTheSessionGoesOn) {
  const auto viewport = open(all_files(), kBarePicture + "; jiggle off; skeleton on; compare truth; layout overlay");
  const Image first = still(*viewport);
  viewport->keys({"J", "Space"});
  for (const char* name : {"limb.safetensors", "limb.dynamics.safetensors", "limb.attached.safetensors", "limb.glb",
                           "limb_truth.pc2", "limb_proxy.safetensors"}) {
    const std::filesystem::path path = folder_ / name;
    const std::string bytes = read_bytes(path);
    const auto size = static_cast<std::uint32_t>(bytes.size());
    ::testing::internal::CaptureStderr();
    write_bytes(path, bytes.substr(0, random_.below(size)));
    viewport->let_pass(1.5);
    const std::string said = ::testing::internal::GetCapturedStderr();
    EXPECT_NE(said.find(name), std::string::npos) << name << " was cut off; said:\n" << said;
    std::string changed = bytes;
    for (int k = 0; k < 5; ++k) changed[random_.below(size)] ^= static_cast<char>(1 + random_.below(255));
    for (const std::string& found : {changed, std::string()}) {
      write_bytes(path, found);
      viewport->let_pass(0.75);
      viewport->key("F5");
    }
    std::filesystem::remove(path);
    viewport->let_pass(0.5);
    viewport->key("F5");
    viewport->let_pass(0.5);
    write_bytes(path, bytes);
  }
  viewport->let_pass(1.5);
  viewport->keys({"J", "Space", "Home"});
  EXPECT_TRUE(still(*viewport).rgba == first.rgba);
}

}  // namespace
}  // namespace bodyopt::testing
