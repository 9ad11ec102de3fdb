// Files with names in any script.
#include <gtest/gtest.h>

#include "tests/support/attached_limb.h"
#include "tests/viewport/twin_level.h"
#include "tests/viewport/window_fixture.h"

namespace bodyopt::testing {
namespace {

// A limb with all the files that a character can have.
class NamesOfFilesTest : public WindowTest {
 protected:
  NamesOfFilesTest() {
    const Basis& basis = limb_.made.basis;
    write_truth(basis, read_clip(limb_.clip, basis.skeleton, {}), 0.002f, truth_);
    save_levels({twin(basis)}, proxy_);
    save_attachments(attached_to_limb({blade()}), folder_ / "limb.attached.safetensors");
  }

  std::string all_files() const { return limb_.basis + " " + limb_.clip + " " + truth_ + " --proxy " + proxy_; }

  JigglingCharacter limb_{folder_};
  std::string truth_ = (folder_ / "limb_truth.pc2").string(), proxy_ = (folder_ / "limb_proxy.safetensors").string();
};

TEST_F(NamesOfFilesTest, NamesMayBeOfAnyScript) {
  const auto renamed = [&](const std::string& path, const std::string& name) {
    std::filesystem::rename(path, folder_ / name);
    return "'" + (folder_ / name).string() + "'";
  };
  const std::string script = "--do 'frame 7; compare truth; panels on; screenshot ";
  ASSERT_EQ(view_headless(all_files() + " " + script + "plain.png'").exit_code, 0);
  const std::string basis = renamed(limb_.basis, "Скульптор 彫刻家 🗿.safetensors");
  const std::string clip = renamed(limb_.clip, "歩く é.glb"), truth = renamed(truth_, "حقيقة.pc2");
  renamed((folder_ / "limb.dynamics.safetensors").string(), "Скульптор 彫刻家 🗿.dynamics.safetensors");
  renamed((folder_ / "limb.attached.safetensors").string(), "Скульптор 彫刻家 🗿.attached.safetensors");
  const std::string files = basis + " " + clip + " " + truth + " --proxy " + renamed(proxy_, "ελαφρύ.safetensors");
  const ProgramResult result =
      view_headless(files + " --validate " + script + "写真.png; panels off; save-state état.json' -o 'кадр ####.png'");
  EXPECT_EQ(result.exit_code, 0) << result.output;
  EXPECT_EQ(picture("写真.png").width, 320u);
  for (const char* name : {"кадр 0001.png", "кадр 0012.png", "état.json"}) {
    EXPECT_TRUE(std::filesystem::exists(folder_ / name)) << name;
  }
  const auto program = open(files + " --validate --state état.json", "frame 7");
  display_->ask_to_close(window_);
  expect_end(*program, 0);
}

}  // namespace
}  // namespace bodyopt::testing
