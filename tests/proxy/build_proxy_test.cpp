#include "trainer/proxy/build_proxy.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <numbers>

#include "runtime/core/error.h"
#include "runtime/deformer/deformer.h"
#include "runtime/host/carry_skin.h"
#include "runtime/threads/tbb_executor.h"
#include "tests/support/capsule_limb.h"
#include "tests/support/gpu_fixture.h"
#include "tests/support/on_threads.h"
#include "tests/support/same_basis.h"
#include "tests/support/temporary_folder.h"
#include "trainer/proxy/level_skins.h"
#include "trainer/train/data/learned_poses.h"
#include "trainer/train/judge/test_errors.h"
#include "trainer/train/skinning/ddm.h"

namespace bodyopt::trainer {
namespace {

using namespace testing;

const SampleSet& samples() {
  static const SampleSet set = limb_samples(160, 60);
  return set;
}

const std::vector<Level>& levels() {
  static const std::vector<Level> built = [] {
    std::vector<std::string> notes;
    return build_proxy(samples(), {.errors = {3e-4, 1e-3}}, notes).levels;
  }();
  return built;
}

// RMS distance of a level, carried, from the held-out shapes, mm; by a loop of its own.
double carried_error(const Level& level, const std::string& device) {
  DeviceChoice choice = device == "cpu" ? DeviceChoice{.name = "cpu"} : test_device();
  Deformer deformer(level.basis, choice);
  double sum = 0, count = 0;
  for (const Sample& sample : samples().heldout) {
    const Evaluation frame = deformer.evaluate({&sample.pose, 1});
    const std::vector<float> full = carry_skin(level.basis.mesh, level.carried, frame.positions, frame.normals);
    const Positions truth = sample.shape.read();
    for (Eigen::Index v = 0; v < truth.rows(); ++v) {
      const Eigen::Vector3f x(full.data() + 3 * v);
      sum += (x.cast<double>().transpose() - truth.row(v)).squaredNorm();
      count += 1;
    }
  }
  return 1e3 * std::sqrt(sum / count);
}

TEST(BuildProxy, LevelsAreSmallerAndNearTheFullSkin) {
  ASSERT_EQ(levels().size(), 2u);
  const Level &fine = levels()[0], &coarse = levels()[1];
  EXPECT_LT(fine.basis.mesh.vertex_count(), 450u);
  EXPECT_LT(coarse.basis.mesh.vertex_count(), fine.basis.mesh.vertex_count() * 3 / 4);
  EXPECT_LT(total_bytes(coarse.basis), total_bytes(fine.basis));
  // Without anything learned the full skin is 3 mm off.
  Deformer bare(build_ddm_basis(samples().character, {}), {.name = "cpu"});
  const double ddm = heldout_errors(samples().heldout, heldout_by_basis(samples(), bare)).rms;
  EXPECT_LT(carried_error(fine, "cpu"), 0.3 * ddm);
  EXPECT_LT(carried_error(coarse, "cpu"), 0.6 * ddm);
  EXPECT_LT(carried_error(fine, "cpu"), carried_error(coarse, "cpu"));
}

TEST(BuildProxy, TheReportSaysWhatIsTrue) {
  const ProxyReport report = read_proxy_report(levels()[0].basis);
  ASSERT_EQ(report.levels.size(), 2u);
  const auto vertices = static_cast<std::size_t>(samples().character.vertices.rows());
  EXPECT_EQ(report.full_vertices, vertices);
  EXPECT_EQ(report.measured_on, std::to_string(samples().heldout.size()) + " held-out frames");
  for (std::size_t k = 0; k < 2; ++k) {
    const LevelReport& level = report.levels[k];
    EXPECT_EQ(level.vertices, levels()[k].basis.mesh.vertex_count());
    EXPECT_EQ(level.bytes, static_cast<double>(total_bytes(levels()[k].basis)));
    EXPECT_EQ(level.map_bytes, 12.0 * static_cast<double>(vertices));
    EXPECT_NEAR(level.rms, carried_error(levels()[k], "cpu"), 1e-3);
    EXPECT_LT(level.skin_rms, 1.1 * level.rms);  // exact vertices carry it better, on other frames
    EXPECT_GT(level.skin_rms, 0.3 * level.rms);
    EXPECT_LT(level.distance_rms, level.error);
  }
  EXPECT_TRUE(read_proxy_report(levels()[1].basis).levels.empty());
  EXPECT_EQ(levels()[0].basis.metadata.count(kLearnedPoses), 1u);
  EXPECT_EQ(levels()[1].basis.metadata.count(kLearnedPoses), 0u);
  Basis damaged = levels()[0].basis;
  damaged.metadata["levels"] = "{\"levels\": 3}";
  EXPECT_THROW(read_proxy_report(damaged), Error);
}

TEST(BuildProxy, RestIsRest) {
  for (const Level& level : levels()) {
    Deformer deformer(level.basis, {.name = "cpu"});
    const Pose rest = bind_pose(level.basis.skeleton);
    const Evaluation frame = deformer.evaluate({&rest, 1});
    const std::vector<float> full = carry_skin(level.basis.mesh, level.carried, frame.positions, frame.normals);
    for (Eigen::Index k = 0; k < samples().character.vertices.size(); ++k) {
      EXPECT_NEAR(static_cast<double>(full[static_cast<std::size_t>(k)]), samples().character.vertices.data()[k], 5e-6);
    }
  }
}

TEST(BuildProxy, RunsOnADeviceAsOnTheCpu) {
  const TemporaryFolder folder;
  save_levels(levels(), folder / "limb.safetensors");
  Deformer cpu(load_basis(folder / "limb.safetensors"), {.name = "cpu"});
  Deformer device(load_basis(folder / "limb.safetensors"), test_device());
  const std::vector<Pose> poses = {samples().heldout[3].pose, samples().heldout[40].pose};
  const Evaluation a = cpu.evaluate(poses), b = device.evaluate(poses);
  ASSERT_EQ(a.positions.size(), b.positions.size());
  for (std::size_t k = 0; k < a.positions.size(); ++k) EXPECT_NEAR(a.positions[k], b.positions[k], 1e-5f);
  EXPECT_NEAR(carried_error(levels()[1], "device"), carried_error(levels()[1], "cpu"), 1e-3);
}

TEST(BuildProxy, IsTheSameOnAnyNumberOfThreads) {
  std::vector<std::string> notes;
  const auto build = [&] { return build_proxy(samples(), {.errors = {3e-4, 1e-3}}, notes).levels; };
  const std::vector<Level> again = on_threads(thread_count() == 1 ? 3 : 1, build);
  for (std::size_t k = 0; k < 2; ++k) {
    EXPECT_EQ(difference(levels()[k].basis, again[k].basis), "") << k;
    EXPECT_TRUE(same_bits(levels()[k].carried.points, again[k].carried.points)) << k;
  }
}

void expect_refused(const SampleSet& set, const std::vector<double>& errors, ErrorKind kind, const std::string& named) {
  std::vector<std::string> notes;
  try {
    build_proxy(set, {.errors = errors}, notes);
    ADD_FAILURE() << "not refused, expected '" << named << "'";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), kind) << error.what();
    EXPECT_NE(std::string(error.what()).find(named), std::string::npos) << error.what();
  }
}

TEST(BuildProxy, RefusesErrorsThatMakeNoLevel) {
  expect_refused(samples(), {0.5}, ErrorKind::usage, "500 mm leaves");
  expect_refused(samples(), {0.5}, ErrorKind::usage, "too large for this character");
  expect_refused(samples(), {1e-9}, ErrorKind::usage, "no fewer than the 578 before");
  expect_refused(samples(), {2e-3, 2e-3}, ErrorKind::usage, "errors that differ more");
  SampleSet none = samples();
  none.train.clear();
  expect_refused(none, {2e-3}, ErrorKind::mismatch, "12 frames at least");
}

// Training says what it thinks of the data: nothing is said, so nothing was trained.
TEST(BuildProxy, AnErrorThatMakesNoLevelIsSaidBeforeAnyTraining) {
  SampleSet few = limb_samples(14, 0);
  std::vector<std::string> notes;
  ASSERT_EQ(build_proxy(few, {.errors = {1e-3}}, notes).levels.size(), 1u);
  ASSERT_FALSE(notes.empty());
  notes.clear();
  EXPECT_THROW(build_proxy(few, {.errors = {1e-3, 0.5}}, notes), Error);
  EXPECT_EQ(notes, std::vector<std::string>());
}

// A limb of half the vertices on which the third of the default errors leaves too few.
TEST(BuildProxy, DefaultErrorsStopWhereNoLevelIsLeft) {
  const SampleSet set = limb_samples(24, 0);
  std::vector<std::string> notes;
  const auto [built, report] = build_proxy(set, {}, notes);
  ASSERT_GE(built.size(), 1u);
  ASSERT_LT(built.size(), 3u);
  EXPECT_EQ(report.levels.size(), built.size());
  EXPECT_EQ(to_json(read_proxy_report(built[0].basis)), to_json(report));
  const bool said = std::any_of(notes.begin(), notes.end(), [](const std::string& note) {
    const bool one = note.starts_with("there is only 1 level: ");
    return (one || note.starts_with("there are only 2 levels: ")) && note.find("mm leaves") != std::string::npos;
  });
  EXPECT_TRUE(said);

  SampleSet coarse = set;  // not even the first
  coarse.character.vertices *= 0.05;
  coarse.character.vertices.row(0) << 0, 0, 10;
  expect_refused(coarse, {}, ErrorKind::usage, "too large for this character");
}

// A torus of a ring of 0.5 m and a tube of 0.2 m, one joint: nowhere flat, and as coarse as it is round.
Character torus(int around, int across) {
  Character character = samples().character;
  character.skeleton.joints.resize(1);
  character.vertices.resize(around * across, 3);
  character.triangles.resize(2 * around * across, 3);
  for (int i = 0; i < around; ++i) {
    for (int j = 0; j < across; ++j) {
      const double u = 2 * std::numbers::pi * i / around, v = 2 * std::numbers::pi * j / across;
      const double out = 0.5 + 0.2 * std::cos(v);
      const int here = i * across + j, next = (i + 1) % around * across;
      character.vertices.row(here) << out * std::cos(u), 0.2 * std::sin(v), out * std::sin(u);
      const auto a = static_cast<std::uint32_t>(here), b = static_cast<std::uint32_t>(next + j);
      const auto c = static_cast<std::uint32_t>(next + (j + 1) % across),
                 d = static_cast<std::uint32_t>(i * across + (j + 1) % across);
      character.triangles.row(2 * here) << a, b, c;
      character.triangles.row(2 * here + 1) << a, c, d;
    }
  }
  character.weights.assign(static_cast<std::size_t>(around * across), {{0, 1}});
  return character;
}

// As of characters of few vertices: the first of the default errors takes none off, the others do; or none does.
TEST(LevelSkins, DefaultErrorsBeginWhereTheFirstLevelIs) {
  const Character fine = torus(28, 14), coarse = torus(16, 8);
  std::vector<std::string> notes;
  const std::vector<LevelSkin> skins = level_skins(fine, {fine.vertices}, {}, notes);
  const std::vector<double> errors = default_errors(fine);
  ASSERT_EQ(skins.size(), 2u);
  EXPECT_EQ(skins[0].error, errors[1]);
  EXPECT_EQ(skins[1].error, errors[2]);
  ASSERT_EQ(notes.size(), 1u);
  EXPECT_NE(notes[0].find("there are only 2 levels: an error of 2.8 mm leaves 392"), std::string::npos) << notes[0];
  EXPECT_THROW(level_skins(coarse, {coarse.vertices}, {}, notes), Error);
}

TEST(BuildProxy, MusclesThatReachNoSkinAreSaid) {
  SampleSet set = limb_samples(24, 0);
  Muscle& tiny = set.muscles.emplace_back(set.muscles[0]);
  tiny.name = "tiny";
  for (MusclePoint& point : tiny.path) point.position = {0, 0.02, 0.1};
  std::vector<std::string> notes;
  const std::vector<Level> level = build_proxy(set, {.errors = {2e-3}}, notes).levels;
  EXPECT_EQ(read_proxy_report(level[0].basis).measured_on, "24 training frames");
  const bool said = std::any_of(notes.begin(), notes.end(), [](const std::string& note) {
    return note.find("1 muscle has no fibre on the skin: 'tiny'") != std::string::npos;
  });
  EXPECT_TRUE(said);
}

TEST(TaughtSamples, AreTheTeachersShapes) {
  const Basis teacher = build_ddm_basis(samples().character, {});
  std::vector<Pose> poses;
  std::vector<int> frames;
  for (int k = 0; k < 14; ++k) {
    poses.push_back(samples().heldout[static_cast<std::size_t>(k)].pose);
    frames.push_back(100 + 2 * k);
  }
  const SampleSet taught = taught_samples(samples().character, limb_muscles(), teacher, poses, frames);
  Deformer deformer(teacher, {.name = "cpu"});
  const Evaluation fifth = deformer.evaluate({&poses[5], 1});
  EXPECT_EQ(taught.train[5].frame, 110);
  EXPECT_EQ(taught.train[5].shape.read(), welded_from_output(samples().character, fifth.positions.data()));
  EXPECT_TRUE(taught.heldout.empty());  // no fifth block

  Character other = samples().character;
  other.vertices(7, 2) += 0.01;
  EXPECT_THROW(taught_samples(other, {}, teacher, poses, frames), Error);
}

TEST(TaughtSamples, EveryFifthBlockIsHeldOut) {
  std::vector<Pose> poses;
  std::vector<int> frames;
  for (int k = 0; k < 60; ++k) {
    poses.push_back(samples().train[static_cast<std::size_t>(k)].pose);
    frames.push_back(1 + k);
  }
  const SampleSet taught =
      taught_samples(samples().character, {}, build_ddm_basis(samples().character, {}), poses, frames);
  ASSERT_EQ(taught.heldout.size(), 10u);
  EXPECT_EQ(taught.heldout.front().frame, 41);
  EXPECT_EQ(taught.heldout.back().frame, 50);
  EXPECT_EQ(taught.train.size(), 50u);
  std::vector<std::string> notes;
  const std::vector<Level> level = build_proxy(taught, {.errors = {1e-3}}, notes).levels;
  EXPECT_EQ(read_proxy_report(level[0].basis).measured_on, "10 held-out frames");
}

TEST(FrameTime, IsThatOfAFrame) {
  const FrameTime fine = frame_time(levels()[0]);
  EXPECT_GT(fine.microseconds, 1);
  EXPECT_LT(fine.microseconds, 1e5);
  EXPECT_GT(fine.carrying, 0);
  EXPECT_EQ(frame_time({levels()[0].basis, {}}).carrying, 0);
  EXPECT_EQ(fine.threads, static_cast<int>(thread_count()));
}

}  // namespace
}  // namespace bodyopt::trainer
