// One session of a character that has everything, to the last bit on one device: what the viewport shows and exports,
// what `eval` makes of the session, a farm's shot that is cut in three, the library from C++ and Python, and what it
// records for a host program. Across devices, to the tolerance.
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "assets/caches/pc2.h"
#include "include/bodyopt/bodyopt.hpp"
#include "include/bodyopt/vulkan.h"
#include "runtime/basis/character_unit.h"
#include "runtime/core/error.h"
#include "runtime/core/extent.h"
#include "runtime/core/json.h"
#include "runtime/host/tolerances.h"
#include "runtime/vulkan/commands.h"
#include "shots/session/posed_clip.h"
#include "shots/shot_files.h"
#include "tests/support/attached_limb.h"
#include "tests/support/breathing.h"
#include "tests/support/read_bytes.h"
#include "tests/support/run_program.h"
#include "tests/support/run_verb.h"
#include "tests/viewport/characters_fixture.h"
#include "tests/viewport/played_viewport.h"
#include "trainer/dynamics/build_dynamics.h"
#include "trainer/modifiers/bake_stack.h"

namespace bodyopt::testing {
namespace same_shot_test {

using namespace trainer;
using namespace shots;
using namespace viewport;

namespace fs = std::filesystem;

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

// The samples of a cache, one after the other.
std::vector<float> samples_of(const std::string& cache) {
  const Pc2Reader reader(cache);
  std::vector<float> all;
  for (std::uint32_t k = 0; k < reader.sample_count(); ++k) {
    const std::vector<float> sample = reader.sample(k);
    all.insert(all.end(), sample.begin(), sample.end());
  }
  return all;
}

constexpr int kIn = 2, kOut = 11;

// What a program that has the animator's clip gives the library: its poses before modifiers, from the clip's first
// frame on, and the channels of the model.
struct GivenClip {
  GivenClip(const std::string& session, const api::Model& model) {
    ShotFiles files;
    take_session(session, files);
    const Basis basis = load_basis(files.basis);
    const Clip clip = posed_clip(files.clip.read(basis, kept_unit(basis)), basis.skeleton, {}, files.session.pose);
    fps = clip.fps;
    for (std::uint32_t c = 0; c < api::describe(model).channel_count; ++c) {
      auto channel = api::make<bodyopt_channel>();
      api::check(bodyopt_describe_channel(model.get(), c, &channel));
      constants.push_back(channel.constant);
      columns.push_back(std::ranges::find(clip.controls, std::string(channel.name)) - clip.controls.begin());
    }
    for (int f = 0; f < kOut; ++f) add(clip.poses[static_cast<std::size_t>(f)]);
  }

  void add(const Pose& pose) {
    for (const JointTransform& t : pose.joints) {
      joints.insert(joints.end(), t.translation.begin(), t.translation.end());
      joints.insert(joints.end(), t.rotation.begin(), t.rotation.end());
      joints.insert(joints.end(), t.scale.begin(), t.scale.end());
    }
    for (std::size_t c = 0; c < columns.size(); ++c) {
      const auto column = static_cast<std::size_t>(columns[c]);
      channels.push_back(column < pose.controls.size() ? pose.controls[column] : constants[c]);
    }
    numbers.push_back(static_cast<int>(numbers.size()) + 1);
  }

  // Frames `begin` and before `end` of the clip, which begins at 1.
  bodyopt_poses frames(int begin, int end) const {
    const auto first = static_cast<std::size_t>(begin - 1), all = numbers.size();
    auto poses = api::make<bodyopt_poses>();
    poses.frame_count = static_cast<std::uint32_t>(end - begin);
    poses.joint_count = static_cast<std::uint32_t>(joints.size() / all / 10);
    poses.joints = joints.data() + joints.size() / all * first;
    poses.frame_numbers = numbers.data() + first;
    poses.shows_modifiers = 1;
    poses.goes_on = begin > 1;
    poses.frames_per_second = fps;
    poses.channels = channels.data() + columns.size() * first;
    poses.channel_count = static_cast<std::uint32_t>(columns.size());
    return poses;
  }

  double fps = 0;
  std::vector<double> joints;
  std::vector<float> channels, constants;
  std::vector<std::ptrdiff_t> columns;  // of the clip's controls, of each channel; their number: it has none
  std::vector<int> numbers;
};

void write(const fs::path& path, const auto& values) {
  std::ofstream(path, std::ios::binary)
      .write(reinterpret_cast<const char*>(values.data()),
             static_cast<std::streamsize>(values.size() * sizeof(values[0])));
}

class SameShot : public PlayedTest {
 protected:
  static void TearDownTestSuite() {
    made_.reset();
    PlayedTest::TearDownTestSuite();
  }

  // In this test's folder what the first test made.
  SameShot() {
    if (made_) {
      fs::copy(made_->path(), ".", fs::copy_options::recursive | fs::copy_options::overwrite_existing);
      return;
    }
    make_shot();
    made_ = std::make_unique<TemporaryFolder>();
    fs::copy(".", made_->path());
  }

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
    add_breathing(basis);
    save_basis(basis, "hero.safetensors");
    save_attachments(attached_to_limb({sleeve(0.004)}), "hero.attached.safetensors");
  }

  // shot.json, seen.pc2 by the viewport and whole.pc2 by `eval`.
  void make_shot() {
    make_hero();
    ViewerOptions options = small();
    options.files = {"hero.safetensors", "limb_bend.glb"};
    open(options,
         "frame 2; turn joint1 20 0 0; control flesh.amount 0; key; frame 9; turn joint1 90 0 0; "
         "control breath.depth 2; key; jiggle on; jiggle-amount 1.5; correction 0.75; in 2; out 11; save shot.json; "
         "export-skin seen.pc2");
    evaluate("--out whole.pc2 --json whole.json");
  }

  static void evaluate(const std::string& options, const std::string& device = name()) {
    const ProgramResult ran = run_verb("eval --session shot.json --jiggle --device '" + device + "' " + options);
    ASSERT_EQ(ran.exit_code, 0) << ran.output;
  }
  static std::string name() { return device_->info().name; }
  static api::Model load() {
    return api::load_model("hero.safetensors", "hero.dynamics.safetensors", "hero.attached.safetensors");
  }

  static void expect_same(const std::string& cache, const std::string& other) {
    for (const char* ending : {".pc2", ".sleeve.pc2"}) {
      const std::string bytes = read_bytes(cache + ending);
      EXPECT_GT(bytes.size(), 1000u);
      EXPECT_TRUE(bytes == read_bytes(other + ending)) << cache << " and " << other << ", " << ending;
    }
  }

  static inline std::unique_ptr<TemporaryFolder> made_;
};

TEST_F(SameShot, IsTheSameWhoeverEvaluatesIt) {
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
                                         {"device", name()},
                                         {"frame_ms", 12000},
                                         {"out", "farm.pc2"}}}}};
  const ProgramResult planned = run_verb("farm plan shots.json --task-minutes 0.7 --out plan --json plan.json");
  ASSERT_EQ(planned.exit_code, 0) << planned.output;
  EXPECT_EQ(Json::parse(read_bytes("plan.json")).at("waves"), 4);  // three parts, and what joins them
  const ProgramResult ran = run_verb("farm run plan");
  ASSERT_EQ(ran.exit_code, 0) << ran.output;
  expect_same("whole", "farm");
}

// The skin and what is attached to it, after ten frames of all stages.
TEST_F(SameShot, IsTheSameOnTheCpuToTheTolerance) {
  evaluate("--out cpu.pc2", "cpu");
  constexpr StageTolerance kTolerance = tolerance_of(Stage::output, "positions");
  const double size = box_diagonal(std::span<const float>(load_basis("hero.safetensors").mesh.rest));
  for (const std::string ending : {".pc2", ".sleeve.pc2"}) {
    const std::vector<float> found = samples_of("whole" + ending), expected = samples_of("cpu" + ending);
    ASSERT_EQ(found.size(), expected.size());
    double worst = 0;
    for (std::size_t k = 0; k < found.size(); ++k) worst = std::max(worst, std::abs(double{found[k]} - expected[k]));
    EXPECT_LE(worst, kTolerance.absolute + kTolerance.of_size * size) << ending;
  }
}

// The buffers that are drawn, frame by frame as they are played.
TEST_F(SameShot, IsWhatTheViewportPlays) {
  const Json told = Json::parse(read_bytes("whole.json")).at("per_frame");
  ViewerOptions options = small();
  options.files = {"shot.json"};
  const auto viewport = open(options);
  viewport->prompt("coverage on");
  const Pc2Reader played("whole.pc2"), sleeves("whole.sleeve.pc2");
  for (int frame = kIn; frame <= kOut; ++frame) {
    viewport->prompt("frame " + std::to_string(frame));
    const Session& session = viewport->session();
    const Actor& lead = session.scene.lead();
    ASSERT_EQ(shown_method(lead, session.controls.settings), SkinMethod::jiggle);
    const std::vector<float> buffer = download(*device_, *lead.skin(SkinMethod::jiggle).positions);
    std::vector<float> skin;
    for (const std::uint32_t v : lead.basis().mesh.output_vertex) {
      skin.insert(skin.end(), buffer.begin() + 3 * v, buffer.begin() + 3 * v + 3);
    }
    const auto sample = static_cast<std::uint32_t>(frame - kIn);
    EXPECT_TRUE(skin == played.sample(sample)) << frame;
    EXPECT_EQ(session.scene.lead_expected()->rms_mm, told.at(sample).at("expected_rms_mm").get<double>()) << frame;
    EXPECT_TRUE(lead.worn_points(skin, session.scene.lead_pose(session.controls)) == sleeves.sample(sample)) << frame;
  }
}

TEST_F(SameShot, IsWhatTheLibraryShows) {
  const api::Model model = load();
  const api::Device device = api::open_device(name());
  auto options = api::make<bodyopt_instance_options>();
  options.device = device.get();
  options.jiggles = 1;
  const api::Instance instance = api::create_instance(model, options);
  api::check(bodyopt_set_weights(instance.get(), 0.75f, 1.5f));
  const GivenClip clip("shot.json", model);
  const auto nothing = api::make<bodyopt_skin>();
  const bodyopt_poses before = clip.frames(1, kIn);  // from where the breath and the jiggle go on
  api::check(bodyopt_jiggle(instance.get(), &before, &nothing));
  std::vector<float> skin(samples_of("whole.pc2").size()), worn(samples_of("whole.sleeve.pc2").size());
  bodyopt_floats attached{worn.data(), worn.size() * sizeof(float), 0, 0};
  auto wanted = api::make<bodyopt_skin>();
  wanted.positions = {skin.data(), skin.size() * sizeof(float), 0, 0};
  wanted.attached = &attached;
  wanted.attached_count = 1;
  const bodyopt_poses poses = clip.frames(kIn, kOut + 1);
  api::check(bodyopt_jiggle(instance.get(), &poses, &wanted));
  EXPECT_TRUE(skin == samples_of("whole.pc2"));
  EXPECT_TRUE(worn == samples_of("whole.sleeve.pc2"));
}

// On its own device, all frames in one command buffer. The sleeve is carried there by the device, elsewhere by the CPU.
TEST_F(SameShot, IsWhatAHostProgramRecords) {
  auto host = api::make<bodyopt_vulkan_device>();
  host.instance = device_->instance();
  host.physical_device = device_->physical();
  host.device = device_->handle();
  host.queue = device_->queue();
  host.queue_family = device_->queue_family();
  bodyopt_device* shared = nullptr;
  api::check(bodyopt_share_device(&host, &shared));
  const api::Device device(shared);
  const api::Model model = load();
  auto options = api::make<bodyopt_instance_options>();
  options.device = shared;
  options.jiggles = 1;
  options.recorded_frames = kOut - kIn + 1;
  const api::Instance instance = api::create_instance(model, options);
  api::check(bodyopt_set_weights(instance.get(), 0.75f, 1.5f));
  const GivenClip clip("shot.json", model);
  const auto nothing = api::make<bodyopt_skin>();
  const bodyopt_poses before = clip.frames(1, kIn), poses = clip.frames(kIn, kOut + 1);
  api::check(bodyopt_jiggle(instance.get(), &before, &nothing));
  const std::vector<float> skin = samples_of("whole.pc2"), sleeves = samples_of("whole.sleeve.pc2");
  const vulkan::Buffer skin_there = vulkan::floats(*device_, skin.size(), "the host's skin"),
                       sleeves_there = vulkan::floats(*device_, sleeves.size(), "the host's sleeves");
  const auto output_in = [](const vulkan::Buffer& buffer) {
    return bodyopt_vulkan_output{buffer.handle(), buffer.size(), 0, 0};
  };
  const bodyopt_vulkan_output attached = output_in(sleeves_there);
  vulkan::Commands commands(*device_);
  commands.begin();
  auto recording = api::make<bodyopt_recording>();
  recording.commands = commands.handle();
  recording.positions = output_in(skin_there);
  recording.attached = &attached;
  recording.attached_count = 1;
  api::check(bodyopt_record(instance.get(), &poses, &recording));
  commands.end();
  commands.run();
  EXPECT_TRUE(download(*device_, skin_there) == skin);
  const std::vector<float> found = download(*device_, sleeves_there);
  ASSERT_EQ(found.size(), sleeves.size());
  for (std::size_t k = 0; k < found.size(); ++k) ASSERT_NEAR(found[k], sleeves[k], 2e-6) << k;
}

TEST_F(SameShot, IsWhatPythonShows) {
#ifndef BODYOPT_PYTHON
  GTEST_SKIP() << "built without Python";
#else
  if (run_program(std::string(BODYOPT_PYTHON) + " -c 'import numpy'").exit_code != 0) GTEST_SKIP() << "without numpy";
  const GivenClip clip("shot.json", load());
  fs::create_directories("modules/bodyopt");
  for (const std::string file : {"__init__.py", "verbs.py"}) {
    fs::create_symlink(kSourceFolder + "/bindings/python/bodyopt/" + file, "modules/bodyopt/" + file);
  }
  for (const auto& file : fs::directory_iterator(BODYOPT_PYTHON_MODULES)) {
    fs::create_symlink(file.path(), "modules/bodyopt" / file.path().filename());
  }
  write("joints", clip.joints);
  write("channels", clip.channels);
  const ProgramResult ran = run_program(concat("PYTHONPATH=modules ", BODYOPT_PYTHON, " ", kSourceFolder,
                                               "/tests/viewport/same_shot.py '", name(), "' ", clip.fps, " ", kIn));
  ASSERT_EQ(ran.exit_code, 0) << ran.output;
  for (const std::string cache : {"whole", "whole.sleeve"}) {
    const std::vector<float> expected = samples_of(cache + ".pc2");
    EXPECT_TRUE(read_bytes(cache + ".python") ==
                std::string(reinterpret_cast<const char*>(expected.data()), expected.size() * sizeof(float)))
        << cache;
  }
#endif
}

}  // namespace same_shot_test
}  // namespace bodyopt::testing
