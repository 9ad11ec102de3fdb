// Files that are cut off, changed, taken away and brought back while they are played; and names in any script.
#include <gtest/gtest.h>

#include "runtime/basis/levels.h"
#include "tests/proxy_viewer/window_fixture.h"
#include "tests/support/attached_limb.h"
#include "tests/support/hostile_bytes.h"
#include "tests/support/random_tables.h"

namespace bodyopt::testing {
namespace {

// A level that is the character itself: each vertex is carried by one of its own triangles.
Level twin(const Basis& basis) {
  Level level{basis, {std::vector<CarriedPoint>(basis.mesh.output_count()), 1e-6f}};
  const std::vector<std::uint32_t>& corners = basis.mesh.output_triangles;
  for (std::uint32_t k = 0; k < corners.size(); ++k) {
    const auto weight = [&](std::uint32_t corner) { return static_cast<std::uint8_t>(k % 3 == corner ? 255 : 0); };
    level.carried.points[corners[k]] = {k / 3, weight(1), weight(2), 0, 0, 0};
  }
  return level;
}

// A limb with all the files that a character can have.
class DamagedFilesTest : public WindowTest {
 protected:
  DamagedFilesTest() {
    const Basis& basis = limb_.made.basis;
    write_truth(basis, read_clip(limb_.clip, basis.skeleton, {}), 0.002f, truth_);
    save_levels({twin(basis)}, proxy_);
    save_attachments(attached_to_limb({blade()}), folder_ / "limb.attached.safetensors");
  }

  std::string all_files() const { return limb_.basis + " " + limb_.clip + " " + truth_ + " --proxy " + proxy_; }

  JigglingCharacter limb_{folder_};
  std::string truth_ = (folder_ / "limb_truth.pc2").string(), proxy_ = (folder_ / "limb_proxy.safetensors").string();
  Random random_{20260101};
};

TEST_F(DamagedFilesTest, AreSaidAndTheSessionGoesOn) {
  const auto program =
      open(all_files() + " --validate", kPlain + "; jiggle off; skeleton on; compare truth; layout overlay");
  const Image first = picture("ready.png");
  display_->hands("key j key space");
  for (const char* name : {"limb.safetensors", "limb.dynamics.safetensors", "limb.attached.safetensors", "limb.glb",
                           "limb_truth.pc2", "limb_proxy.safetensors"}) {
    const std::filesystem::path path = folder_ / name;
    const std::string bytes = read_bytes(path), said_before = program->output();
    const auto size = static_cast<std::uint32_t>(bytes.size());
    write_bytes(path, bytes.substr(0, random_.below(size)));
    EXPECT_TRUE(comes_true([&] { return program->output().substr(said_before.size()).find(name) != std::string::npos; },
                           kPatience))
        << name << " was cut off; said:\n"
        << program->output();
    std::string changed = bytes;
    for (int k = 0; k < 5; ++k) changed[random_.below(size)] ^= static_cast<char>(1 + random_.below(255));
    for (const std::string& found : {changed, std::string()}) {
      write_bytes(path, found);
      display_->hands("sleep 0.8 key F5");
    }
    std::filesystem::remove(path);
    display_->hands("sleep 0.4 key F5 sleep 0.4");
    ASSERT_TRUE(program->runs()) << name << "\n" << program->output();
    write_bytes(path, bytes);
  }
  display_->hands("key j key space");
  EXPECT_TRUE(comes_true(
      [&] {
        display_->hands("key Home");
        return screenshot().rgba == first.rgba;
      },
      kPatience))
      << program->output();
  display_->ask_to_close(window_);
  expect_end(*program, 0);
}

TEST_F(DamagedFilesTest, NamesMayBeOfAnyScript) {
  const auto renamed = [&](const std::string& path, const std::string& name) {
    std::filesystem::rename(path, folder_ / name);
    return "'" + (folder_ / name).string() + "'";
  };
  const std::string script = "--do 'frame 7; compare truth; panels on; screenshot ";
  ASSERT_EQ(run_program(command(all_files() + " --headless " + script + "plain.png'")).exit_code, 0);
  const std::string basis = renamed(limb_.basis, "Скульптор 彫刻家 🗿.safetensors");
  const std::string clip = renamed(limb_.clip, "歩く é.glb"), truth = renamed(truth_, "حقيقة.pc2");
  renamed((folder_ / "limb.dynamics.safetensors").string(), "Скульптор 彫刻家 🗿.dynamics.safetensors");
  renamed((folder_ / "limb.attached.safetensors").string(), "Скульптор 彫刻家 🗿.attached.safetensors");
  const std::string files = basis + " " + clip + " " + truth + " --proxy " + renamed(proxy_, "ελαφρύ.safetensors");
  const ProgramResult result = run_program(command(files + " --validate --headless " + script +
                                                   "写真.png; panels off; save-state état.json' -o 'кадр ####.png'"));
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
