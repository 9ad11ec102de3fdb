// The library as `cmake --install` gives it to others: the examples are built against it and run, and nothing but
// bodyopt.h can be seen of it.
#include <algorithm>
#include <fstream>
#include <functional>
#include <numeric>
#include <span>
#include <sstream>

#include "assets/clips/clip.h"
#include "runtime/basis/attachments.h"
#include "tests/library/c_api.h"
#include "tests/support/breathing.h"
#include "tests/support/gpu_fixture.h"
#include "tests/support/no_vulkan_loader.h"
#include "tests/support/read_bytes.h"
#include "tests/support/run_program.h"
#include "tests/support/temporary_folder.h"

namespace bodyopt::testing {
namespace installed_test {

namespace fs = std::filesystem;

class Installed : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
#ifdef BODYOPT_SANITIZED
    return;
#endif
    folder_ = std::make_unique<TemporaryFolder>();
    expect_runs("cmake --install " + kBuildFolder + " --component library --prefix " + prefix());
    expect_runs("cmake -S " + kSourceFolder + "/examples/embedding -B " + built() +
                " -G Ninja -DCMAKE_PREFIX_PATH=" + prefix() + " && cmake --build " + built());
  }
  static void TearDownTestSuite() { folder_.reset(); }

  void SetUp() override {
#ifdef BODYOPT_SANITIZED
    GTEST_SKIP() << "a sanitized library needs sanitized programs";
#endif
  }

  // Where the Python module was installed.
  static std::string modules() {
    const std::string found = run_program("find " + prefix() + " -name '_runtime*.so'").output;
    return fs::path(found).parent_path().parent_path();
  }
  static void write(const fs::path& path, const auto& values) {
    std::ofstream(path, std::ios::binary)
        .write(reinterpret_cast<const char*>(values.data()),
               static_cast<std::streamsize>(values.size() * sizeof(values[0])));
  }

  static void expect_runs(const std::string& command) {
    const ProgramResult result = run_program(command);
    EXPECT_EQ(result.exit_code, 0) << command << '\n' << result.output;
  }
  // The pictures of the clip's first frame are those of the bind pose, and its last ones are others.
  static void play_clip(const Basis& basis, const std::string& draw) {
    Clip clip;
    clip.poses.assign(13, bind_pose(basis.skeleton));
    clip.poses.back().joints[1].rotation = clip.poses.back().joints[1].rotation * axis_angle({0, 0, 1}, 0.8);
    const std::string file = *folder_ / "clip.glb", played = *folder_ / "played", rested = *folder_ / "rested";
    write_clip(clip, basis.skeleton, file);
    for (const std::string& folder : {played, rested}) fs::create_directory(folder);
    expect_runs(draw + played + " " + file);
    expect_runs(draw + rested);
    const auto differing = [&](const std::string& frame) {
      const std::string a = read_bytes(played + frame), b = read_bytes(rested + frame);
      return std::inner_product(a.begin(), a.end(), b.begin(), 0, std::plus<>(), std::not_equal_to<>());
    };
    EXPECT_LT(differing("/frame0.ppm"), 20);  // matrices of the clip are rounded: a pixel at an edge may flip
    EXPECT_GT(differing("/frame12.ppm"), 2000);
    Skeleton other = basis.skeleton;
    other.joints[1].name = "tail";
    write_clip(clip, other, file);
    const ProgramResult refused = run_program(draw + played + " " + file);
    EXPECT_EQ(refused.exit_code, 1);
    EXPECT_NE(refused.output.find("no joint"), std::string::npos) << refused.output;
  }
  static std::string prefix() { return *folder_ / "prefix"; }
  static std::string built() { return *folder_ / "built"; }
  static std::string library() { return run_program("find " + prefix() + " -name 'libbodyopt.so'").output; }

  static inline std::unique_ptr<TemporaryFolder> folder_;
};

// The positions of an OBJ file, as text of nine digits gives them back to the bit.
std::vector<float> read_obj(const fs::path& path) {
  std::ifstream file(path);
  std::vector<float> positions;
  float x, y, z;
  for (std::string word; file >> word && word == "v" && file >> x >> y >> z;) {
    positions.insert(positions.end(), {x, y, z});
  }
  return positions;
}

TEST_F(Installed, CExampleWritesTheSkin) {
  Deformer deformer(load_basis(hero()), {.name = "cpu"});
  Pose pose = bind_pose(deformer.basis().skeleton);
  pose.joints[1].rotation = pose.joints[1].rotation * axis_angle({0, 0, 1}, 0.785398163);
  const std::vector<float> expected = deformer.evaluate({&pose, 1}).positions;
  for (const std::string program : {"skin_frame", "skin_frame_static"}) {
    const std::string out = *folder_ / (program + ".obj");
    expect_runs(built() + "/" + program + " " + hero() + " 1 " + out);
    const std::vector<float> found = read_obj(out);
    ASSERT_EQ(found.size(), expected.size());
    for (std::size_t k = 0; k < found.size(); ++k) ASSERT_NEAR(found[k], expected[k], 1e-6);
  }
  EXPECT_EQ(run_program(built() + "/skin_frame " + kept_file("limb.glb") + " 1 /dev/null").exit_code, BODYOPT_FILE);
}

TEST_F(Installed, CxxExampleSharesItsDevice) {
  test_device();  // the loader sees the test's device alone
  expect_runs(built() + "/share_device " + hero());
}

// Pixels of a picture that are blue, or those that are red.
std::size_t count_pixels(const std::string& picture, bool blue) {
  const std::size_t begin = picture.find("255\n") + 4;
  std::size_t count = 0;
  for (std::size_t k = begin; k + 2 < picture.size(); k += 3) {
    const int red = static_cast<unsigned char>(picture[k]), other = static_cast<unsigned char>(picture[k + 2]);
    if (blue ? other > red + 20 : red > other + 20) ++count;
  }
  return count;
}

// A shirt around the middle of the limb, which lies along x: a shell of its skin, each vertex on a point of that.
Attachments shirt_of(const Basis& basis) {
  AttachedMesh shirt;
  shirt.name = "shirt";
  const std::vector<float>& rest = basis.mesh.rest;
  const auto [low, high] = std::minmax_element(rest.begin(), rest.end());
  for (std::uint32_t v = 0; v < basis.mesh.vertex_count(); ++v) {
    const float* x = &rest[3 * std::size_t{v}];
    shirt.rest.insert(shirt.rest.end(), {x[0], 1.2f * x[1], 1.2f * x[2]});
    shirt.vertex_anchor.push_back(v);
    shirt.anchors.push_back({0, x[0], x[1], x[2]});
    shirt.point_begin.push_back(v);
    shirt.points.push_back({v, v, v, 1, 0, 0});
  }
  shirt.point_begin.push_back(basis.mesh.vertex_count());
  const auto is_worn = [&](std::uint32_t v) { return std::abs(rest[3 * v] - (*low + *high) / 2) < (*high - *low) / 6; };
  const std::vector<std::uint32_t>& corners = basis.mesh.triangles;
  for (std::size_t k = 0; k < corners.size(); k += 3) {
    const std::span<const std::uint32_t> triangle(&corners[k], 3);
    if (std::ranges::all_of(triangle, is_worn)) {
      shirt.triangles.insert(shirt.triangles.end(), triangle.begin(), triangle.end());
    }
  }
  Attachments attached{{shirt}, load_attachments(kept_file("hero.attached.safetensors")).metadata};
  return attached;
}

// A body and its clothes, and both move with the breath.
TEST_F(Installed, CxxExampleDrawsABreathingCharacter) {
  test_device();
  Basis basis = load_basis(hero());
  add_breathing(basis);
  const std::string breathing = *folder_ / "breathing.safetensors", shirt = *folder_ / "shirt.safetensors";
  save_basis(basis, breathing);
  save_attachments(shirt_of(basis), shirt);
  expect_runs(built() + "/draw_character " + breathing + " " + shirt + " 13 " + folder_->path().string());
  const std::string first = read_bytes(*folder_ / "frame0.ppm"), last = read_bytes(*folder_ / "frame12.ppm");
  for (const bool blue : {false, true}) {
    EXPECT_GT(count_pixels(first, blue), 1000u) << blue;
    EXPECT_NE(count_pixels(first, blue), count_pixels(last, blue)) << blue;
  }
  EXPECT_NE(run_program(built() + "/draw_character " + breathing + " " + hero() + " 1 .").exit_code, 0);
  play_clip(basis, built() + "/draw_character " + breathing + " " + shirt + " 13 ");
}

TEST_F(Installed, ShowsNothingButItsInterface) {
  const std::string symbols = run_program("nm -D --defined-only " + library()).output;
  std::istringstream lines(symbols);
  std::size_t functions = 0;
  for (std::string address, kind, name; lines >> address >> kind >> name;) {
    if (kind == "A") continue;  // the name of the version
    EXPECT_TRUE(name.starts_with("bodyopt_")) << name;
    ++functions;
  }
  EXPECT_GT(functions, 20u);
  EXPECT_FALSE(fs::exists(prefix() + "/include/runtime"));
  EXPECT_TRUE(fs::exists(prefix() + "/include/bodyopt/bodyopt.h"));
}

TEST_F(Installed, PythonModuleGivesTheSameFrames) {
#ifndef BODYOPT_PYTHON
  GTEST_SKIP() << "built without Python";
#else
  const std::string python = "PYTHONPATH=" + modules() + " " + BODYOPT_PYTHON + " ";
  if (run_program(python + "-c 'import numpy'").exit_code != 0) GTEST_SKIP() << "without numpy";
  Deformer deformer(load_basis(hero()), {.name = "cpu"});
  const std::vector<Pose> poses = turning_poses(deformer.basis(), 4);
  std::vector<Pose> without_controls = poses;
  for (Pose& pose : without_controls) pose.controls.clear();
  write(*folder_ / "poses", PoseArrays(poses).joints);
  write(*folder_ / "skin", deformer.evaluate(without_controls).positions);
  expect_runs(python + kSourceFolder + "/tests/library/module_test.py " + hero() + " " + hero_dynamics() + " " +
              (*folder_ / "poses").string() + " " + (*folder_ / "skin").string());
  expect_runs(python + kSourceFolder + "/examples/embedding/frame_error.py " + hero() + " 1 " +
              (*folder_ / "error.svg").string());
  EXPECT_GT(fs::file_size(*folder_ / "error.svg"), 1000u);
#endif
}

TEST_F(Installed, RunsOnTheCpuWithoutVulkansLoader) {
  const NoVulkanLoader without;
  for (const std::string program : {"skin_frame", "skin_frame_static"}) {
    const std::string with_it = *folder_ / "with.obj", without_it = *folder_ / "without.obj";
    expect_runs(built() + "/" + program + " " + hero() + " 1 " + with_it);
    expect_runs(without.environment() + built() + "/" + program + " " + hero() + " 1 " + without_it);
    EXPECT_EQ(read_obj(without_it), read_obj(with_it));
    EXPECT_FALSE(read_obj(without_it).empty());
  }
  EXPECT_EQ(run_program(without.environment() + built() + "/share_device " + hero()).exit_code,
            127);  // is linked with it
}

TEST_F(Installed, ADeviceOfAMachineWithoutVulkansLoaderIsRefused) {
#ifndef BODYOPT_PYTHON
  GTEST_SKIP() << "built without Python";
#else
  const NoVulkanLoader without;
  const std::string python = "PYTHONPATH=" + modules() + " " + BODYOPT_PYTHON + " ";
  if (run_program(python + "-c 'import numpy'").exit_code != 0) GTEST_SKIP() << "without numpy";
  const ProgramResult result =
      run_program(without.environment() + python + "-c 'import bodyopt; bodyopt.open_device(\"0\")'");
  EXPECT_NE(result.exit_code, 0);
  EXPECT_NE(result.output.find("bodyopt.Error: no Vulkan device '0'"), std::string::npos) << result.output;
  EXPECT_NE(result.output.find("libvulkan.so.1"), std::string::npos) << result.output;
  EXPECT_NE(result.output.find("Debian package: libvulkan1"), std::string::npos) << result.output;
#endif
}

TEST_F(Installed, PkgConfigKnowsItWhereverItLies) {
  const fs::path moved = *folder_ / "moved";
  fs::copy(prefix(), moved, fs::copy_options::recursive | fs::copy_options::copy_symlinks);
  const std::string found = run_program("find " + moved.string() + " -name bodyopt.pc").output;
  ASSERT_NE(found, "");
  const std::string pkg_config = "PKG_CONFIG_PATH=" + fs::path(found).parent_path().string() + " pkg-config ";
  EXPECT_EQ(run_program(pkg_config + "--modversion bodyopt").output, std::string(bodyopt_version()) + "\n");
  const std::string program = (*folder_ / "by_pkg_config").string();
  expect_runs("cc " + kSourceFolder + "/examples/embedding/skin_frame.c -o " + program + " $(" + pkg_config +
              "--cflags --libs bodyopt) -lm");
  expect_runs("LD_LIBRARY_PATH=$(" + pkg_config + "--variable=libdir bodyopt) " + program + " " + hero() + " 1 " +
              program + ".obj");
}

}  // namespace installed_test
}  // namespace bodyopt::testing
