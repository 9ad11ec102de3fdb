// The library shows modifiers as `bodyopt eval` does: breath, a sculpt, sag and push-out on a trained limb.
#include <algorithm>
#include <fstream>
#include <span>

#include "assets/caches/pc2.h"
#include "assets/clips/clip.h"
#include "tests/library/c_api.h"
#include "tests/support/breathing.h"
#include "tests/support/run_program.h"
#include "tests/support/temporary_folder.h"

namespace bodyopt::testing {
namespace modifiers_program_test {

constexpr std::uint32_t kFrames = 30;

// A basis with the four of them, and a clip that folds the limb.
class LibraryModifiers : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = std::make_unique<TemporaryFolder>();
    const std::string sculpt = *folder_ / "sculpt.pc2";
    run("eval " + hero() + " --clip " + kept_file("bend.glb") + " --frames 11 --device cpu --out " + sculpt);
    std::ofstream(*folder_ / "stack.json") << R"({"schema": "bodyopt-modifiers-1", "modifiers": [
      {"name": "elbow", "type": "sculpt", "mesh": ")" +
                                                  sculpt + R"(", "clip": ")" + kept_file("bend.glb") +
                                                  R"(", "frame": 10, "spread_degrees": 60},
      {"name": "flesh", "type": "sag", "controls": {"amount": 3}, "dynamics": ")" +
                                                  hero_dynamics() + R"("},
      {"name": "folds", "type": "push_out"}]})";
    run("modifiers " + hero() + " " + (*folder_ / "stack.json").string() + " --out " + basis_file());
    Basis basis = load_basis(basis_file());
    add_breathing(basis).constants = {{"rate", 50}};
    save_basis(basis, basis_file());
    Clip clip;
    for (std::uint32_t f = 0; f < kFrames; ++f) {
      clip.poses.push_back(bind_pose(basis.skeleton));
      clip.poses.back().joints[1].rotation = axis_angle({0, 0, 1}, 0.1 * f) * clip.poses.back().joints[1].rotation;
    }
    write_clip(clip, basis.skeleton, clip_file());
  }
  static void TearDownTestSuite() { folder_.reset(); }

  static void run(const std::string& arguments) {
    const ProgramResult result = run_bodyopt(arguments);
    ASSERT_EQ(result.exit_code, 0) << arguments << '\n' << result.output;
  }
  static std::string basis_file() { return *folder_ / "shown.safetensors"; }
  static std::string clip_file() { return *folder_ / "fold.glb"; }

  // What the program shows, with these of its options.
  static std::vector<float> shown_by_eval(const std::string& options = {}) {
    const std::string out = *folder_ / "out.pc2";
    run("eval " + basis_file() + " --clip " + clip_file() + " --device cpu --out " + out + options);
    const Pc2Reader reader(out);
    std::vector<float> all;
    for (std::uint32_t k = 0; k < reader.sample_count(); ++k) {
      const std::vector<float> sample = reader.sample(k);
      all.insert(all.end(), sample.begin(), sample.end());
    }
    return all;
  }

  LibraryModifiers() {
    given_.all.shows_modifiers = 1;
    given_.all.frames_per_second = clip_.fps;
    for (std::uint32_t c = 0; c < api::describe(model_).channel_count; ++c) channels_.push_back(channel(c));
  }

  bodyopt_channel channel(std::uint32_t number) const {
    auto channel = api::make<bodyopt_channel>();
    api::check(bodyopt_describe_channel(model_.get(), number, &channel));
    return channel;
  }
  // Of each frame the constants, but for one channel.
  void set_channel(const std::string& name, float value) {
    values_.clear();
    for (std::uint32_t f = 0; f < kFrames; ++f) {
      for (const bodyopt_channel& c : channels_) values_.push_back(name == c.name ? value : c.constant);
    }
    given_.all.channels = values_.data();
    given_.all.channel_count = static_cast<std::uint32_t>(channels_.size());
  }

  // Frames `begin` to `end`.
  std::vector<float> shown(const api::Instance& instance, std::uint32_t begin = 0, std::uint32_t end = kFrames) {
    bodyopt_poses poses = given_.all;
    poses.frame_count = end - begin;
    poses.joints += std::size_t{10} * poses.joint_count * begin;
    poses.goes_on = begin > 0;
    Arrays skin(basis_, end - begin);
    api::check(bodyopt_evaluate(instance.get(), &poses, &skin.all));
    return skin.positions;
  }
  std::vector<float> shown() { return shown(make_instance(model_)); }

  void refuses(bodyopt_result expected, const std::string& said) {
    Arrays skin(basis_, kFrames);
    EXPECT_EQ(bodyopt_evaluate(make_instance(model_).get(), &given_.all, &skin.all), expected);
    EXPECT_NE(std::string(bodyopt_last_error()).find(said), std::string::npos) << bodyopt_last_error();
  }

  static inline std::unique_ptr<TemporaryFolder> folder_;
  const Basis basis_ = load_basis(basis_file());
  const Clip clip_ = read_clip(clip_file(), basis_.skeleton, {});
  const api::Model model_ = api::load_model(basis_file());
  PoseArrays given_{clip_.poses};
  std::vector<bodyopt_channel> channels_;
  std::vector<float> values_;  // of all frames
};

TEST_F(LibraryModifiers, AreThoseOfEvalToTheLastBit) {
  const std::vector<float> all = shown();
  EXPECT_EQ(all, shown_by_eval());
  for (const std::string name : {"breath", "elbow", "flesh", "folds"}) {
    set_channel(name, 0);
    const std::vector<float> without = shown();
    EXPECT_NE(without, all) << name << " shows nothing";
    EXPECT_EQ(without, shown_by_eval(" --control " + name + "=0")) << name;
  }
  given_.all.shows_modifiers = 0;
  EXPECT_NE(shown(), all);
}

TEST_F(LibraryModifiers, GoOnFromCallToCall) {
  const std::vector<float> all = shown();
  const api::Instance instance = make_instance(model_);
  std::vector<float> parts;
  for (const auto& [begin, end] : {std::pair{0u, 1u}, {1u, 2u}, {2u, 17u}, {17u, kFrames}}) {
    const std::vector<float> part = shown(instance, begin, end);
    parts.insert(parts.end(), part.begin(), part.end());
    // A call that fails and one without modifiers leave the breath where it is.
    bodyopt_poses other = given_.all;
    other.goes_on = 1;
    Arrays skin(basis_, kFrames);
    skin.all.positions.size = 4;
    EXPECT_EQ(bodyopt_evaluate(instance.get(), &other, &skin.all), BODYOPT_USAGE);
    other.shows_modifiers = 0;
    skin.all.positions.size = skin.positions.size() * sizeof(float);
    EXPECT_EQ(bodyopt_evaluate(instance.get(), &other, &skin.all), BODYOPT_OK);
  }
  EXPECT_EQ(parts, all);
}

// Of frames of which no output is wanted nothing is evaluated.
TEST_F(LibraryModifiers, GoOnPastFramesThatNobodyWants) {
  const std::vector<float> all = shown();
  const api::Instance instance = make_instance(model_);
  for (const std::uint32_t begin : {kFrames - 1, 20u}) {  // back in time, too
    bodyopt_poses past = given_.all;
    past.frame_count = begin;
    const auto nothing = api::make<bodyopt_skin>();
    api::check(bodyopt_evaluate(instance.get(), &past, &nothing));
    const std::vector<float> frame = shown(instance, begin, begin + 1);
    EXPECT_TRUE(std::ranges::equal(frame, std::span(all).subspan(begin * frame.size(), frame.size()))) << begin;
  }
}

TEST_F(LibraryModifiers, TellTheirChannels) {
  const auto rate = std::ranges::find(channels_, std::string("breath.rate"), &bodyopt_channel::name);
  ASSERT_NE(rate, channels_.end());
  EXPECT_EQ(rate->constant, 50);
  EXPECT_EQ(rate->high, 60);
  EXPECT_STREQ(rate->what, "breaths a minute");
  auto channel = api::make<bodyopt_channel>();
  const auto count = static_cast<std::uint32_t>(channels_.size());
  EXPECT_EQ(bodyopt_describe_channel(model_.get(), count, &channel), BODYOPT_USAGE);
  EXPECT_EQ(bodyopt_describe_channel(nullptr, 0, &channel), BODYOPT_USAGE);
  EXPECT_EQ(bodyopt_describe_channel(model_.get(), 0, nullptr), BODYOPT_USAGE);
  channel.struct_size = 8;
  EXPECT_EQ(bodyopt_describe_channel(model_.get(), 0, &channel), BODYOPT_USAGE);
}

TEST_F(LibraryModifiers, RefuseWrongCalls) {
  for (const double rate : {0.0, -24.0, std::nan(""), HUGE_VAL, 1e-9}) {
    given_.all.frames_per_second = rate;
    refuses(BODYOPT_USAGE, "frames_per_second");
  }
  given_.all.frames_per_second = 24;
  set_channel("breath", 1);
  given_.all.channel_count -= 1;
  refuses(BODYOPT_MISMATCH, "channels");
  given_.all.channel_count += 1;
  given_.all.channel_frame_stride = 4;
  refuses(BODYOPT_USAGE, "poses.channel_frame_stride is 4 bytes");
  given_.all.channel_frame_stride = 0;
  given_.all.channels = reinterpret_cast<const float*>(1 + reinterpret_cast<std::uintptr_t>(values_.data()));
  refuses(BODYOPT_USAGE, "'poses.channels' is not aligned");
  given_.all.channels = values_.data();
  values_.back() = std::nanf("");
  refuses(BODYOPT_MISMATCH, "is not a finite number");
}

void keep_text(bodyopt_log_level level, const char* message, void* user) {
  if (level == BODYOPT_LOG_WARNING) *static_cast<std::string*>(user) += message;
}

TEST_F(LibraryModifiers, TellTheLogWhatIsClamped) {
  std::string told;
  set_channel("breath.rate", 60);
  const std::vector<float> most = shown();
  api::check(bodyopt_set_log(keep_text, &told));
  set_channel("breath.rate", 100);
  EXPECT_EQ(shown(), most);
  api::check(bodyopt_set_log(nullptr, nullptr));
  EXPECT_NE(told.find("'breath.rate' leaves its range, 0 to 60"), std::string::npos) << told;
}

}  // namespace modifiers_program_test
}  // namespace bodyopt::testing
