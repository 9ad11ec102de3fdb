#include "trainer/simulate/simulate.h"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <tbb/global_control.h>
#include <unistd.h>

#include <chrono>
#include <cstring>
#include <fstream>
#include <thread>

#include "assets/caches/pc2.h"
#include "base/progress.h"
#include "runtime/core/error.h"
#include "tests/simulate/limb.h"
#include "tests/simulate/one_take.h"
#include "tests/support/read_bytes.h"
#include "tests/support/temporary_folder.h"
#include "trainer/simulate/partial_shapes.h"

namespace bodyopt::trainer {
namespace {

namespace fs = std::filesystem;

void write_bytes(const fs::path& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

Clip bending_clip(const Character& limb, int frames) {
  Clip clip;
  clip.name = "bend";
  clip.first_frame = 11;
  for (int k = 0; k < frames; ++k) clip.poses.push_back(bent(limb, degrees(12.0 * k)));
  return clip;
}

std::vector<int> all_frames(const Clip& clip) {
  std::vector<int> frames;
  for (int frame = clip.first_frame; frame <= clip.last_frame(); ++frame) frames.push_back(frame);
  return frames;
}

struct Outcome {
  std::vector<FrameStatus> status;
  std::string cache;
};

Outcome run(const TemporaryFolder& folder, const Clip& clip, const std::vector<int>& frames, int threads) {
  const Character limb = make_limb();
  Outcome result;
  result.status = simulate_one_take(limb, {make_flexor()}, clip, frames, folder / "take.pc2", folder / "take.json",
                                    SimulateOptions{.tet_size = 0.05, .threads = threads, .anatomy = kLimbAnatomy});
  result.cache = testing::read_bytes(folder / "take.pc2");
  return result;
}

// Runs a simulation in a child process; `ending` is called in the parent with the child's id.
// No file may grow beyond largest_file bytes: the child is killed when it tries.
template <typename Ending>
int run_in_child(const TemporaryFolder& folder, const Clip& clip, std::size_t largest_file, Ending ending) {
  const pid_t child = fork();
  if (child == 0) {
    const rlimit limit{largest_file, largest_file}, no_core{0, 0};
    setrlimit(RLIMIT_FSIZE, &limit);
    setrlimit(RLIMIT_CORE, &no_core);
    catch_interrupts();
    // The parent's other threads are not here.
    const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
    int code = 0;
    try {
      run(folder, clip, all_frames(clip), 1);
    } catch (const Error& error) {
      code = error.exit_code();
    } catch (...) {
      code = 99;
    }
    _exit(code);
  }
  ending(child);
  int status = 0;
  waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
}

// Waits until some frames are done, not all.
void wait_for_records(const fs::path& partial, std::size_t bytes) {
  for (int tick = 0; tick < 20000; ++tick) {
    std::error_code error;
    const auto size = fs::file_size(partial, error);
    if (!error && size >= bytes) return;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
}

std::size_t record_bytes() { return 48 + 12 * static_cast<std::size_t>(make_limb().vertices.rows()) + 8; }

TEST(Simulate, WritesEveryFrameInOrder) {
  const TemporaryFolder folder;
  const Character limb = make_limb();
  Clip clip = bending_clip(limb, 4);
  clip.poses[2] = clip.poses[1];  // frame 13 repeats frame 12
  const Outcome whole = run(folder, clip, {12, 11, 14, 13}, 2);
  ASSERT_EQ(whole.status.size(), 4u);
  const int expected[] = {12, 11, 14, 13};
  for (std::size_t k = 0; k < 4; ++k) {
    EXPECT_EQ(whole.status[k].frame, expected[k]);
    EXPECT_TRUE(whole.status[k].converged);
  }
  const Pc2Reader reader(folder / "take.pc2");
  EXPECT_EQ(reader.sample_count(), 4u);
  EXPECT_EQ(reader.point_count(), limb.output_count());
  EXPECT_EQ(reader.sample(0), reader.sample(3));
  for (std::size_t v = 0; v < limb.output_vertex.size(); ++v) {
    EXPECT_NEAR(reader.sample(1)[3 * v], limb.vertices(static_cast<Eigen::Index>(v), 0), 1e-6);  // frame 11: bind
  }
  EXPECT_EQ(read_frame_status(folder / "take.json").size(), 4u);
  EXPECT_FALSE(fs::exists(folder / "take.pc2.partial"));
}

TEST(Simulate, ThreadsAndOrderChangeNoBit) {
  const TemporaryFolder folder;
  const Clip clip = bending_clip(make_limb(), 6);
  std::vector<int> frames = all_frames(clip);
  const Outcome one = run(folder, clip, frames, 1);
  EXPECT_EQ(run(folder, clip, frames, 3).cache, one.cache);
  std::reverse(frames.begin(), frames.end());
  const std::string reversed = run(folder, clip, frames, 1).cache;
  const std::size_t size = (one.cache.size() - 32) / frames.size();
  for (std::size_t k = 0; k < frames.size(); ++k) {
    EXPECT_EQ(reversed.substr(32 + k * size, size), one.cache.substr(32 + (frames.size() - 1 - k) * size, size));
  }
}

TEST(Simulate, AKilledRunContinuesToTheSameCache) {
  const TemporaryFolder folder, reference;
  const Clip clip = bending_clip(make_limb(), 10);
  const fs::path partial = folder / "take.pc2.partial";
  // The system ends the child in the middle of its third record, however quick it is.
  const int end = run_in_child(folder, clip, 24 + 2 * record_bytes() + record_bytes() / 2, [](pid_t) {});
  EXPECT_EQ(end, -SIGXFSZ);
  EXPECT_FALSE(fs::exists(folder / "take.pc2"));
  const std::string before = testing::read_bytes(partial);
  ASSERT_GE(before.size(), 24 + 2 * record_bytes());
  write_bytes(partial, before.substr(0, before.size() - 5));  // as if killed while writing
  EXPECT_EQ(run(folder, clip, all_frames(clip), 2).cache, run(reference, clip, all_frames(clip), 1).cache);
  EXPECT_FALSE(fs::exists(partial));
}

TEST(Simulate, AFinishedTakeIsNotSolvedAgain) {
  const TemporaryFolder folder;
  const Clip clip = bending_clip(make_limb(), 4);
  const Outcome first = run(folder, clip, {11, 12, 13}, 1);
  const Outcome more = run(folder, clip, {14, 13, 11}, 1);
  // The seconds of solving are stored: they are the same only if nothing was solved.
  EXPECT_EQ(more.status[1].seconds, first.status[2].seconds);
  EXPECT_EQ(more.status[2].seconds, first.status[0].seconds);
  EXPECT_EQ(more.status[0].frame, 14);
  EXPECT_TRUE(more.status[0].converged);
  const std::size_t size = (first.cache.size() - 32) / 3;
  EXPECT_EQ(more.cache.substr(32 + size, size), first.cache.substr(32 + 2 * size, size));
  EXPECT_EQ(more.cache.substr(32 + 2 * size, size), first.cache.substr(32, size));

  const auto passive =
      simulate_one_take(make_limb(), {}, clip, {11, 13}, folder / "take.pc2", folder / "take.json", {0.05, 1});
  EXPECT_NE(testing::read_bytes(folder / "take.pc2").substr(32 + size, size), first.cache.substr(32 + 2 * size, size));
  EXPECT_NE(passive[1].inputs, more.status[1].inputs);
}

TEST(Simulate, AFrameGivenUpIsSolvedByWhoDoesNotGiveUp) {
  const TemporaryFolder folder;
  const Clip clip = bending_clip(make_limb(), 4);
  const auto solve = [&](int give_up_after) {
    return simulate_one_take(make_limb(), {}, clip, {11, 14}, folder / "take.pc2", folder / "take.json",
                             {.tet_size = 0.05, .threads = 1, .give_up_after = give_up_after});
  };
  const std::vector<FrameStatus> given_up = solve(5);
  EXPECT_TRUE(given_up[0].converged);  // at rest
  EXPECT_FALSE(given_up[1].converged);
  EXPECT_EQ(solve(5)[1].seconds, given_up[1].seconds);  // nothing was solved again
  const int taken = given_up[1].iterations;
  EXPECT_GT(solve(taken + 1)[1].iterations, taken);  // tried again
  const std::vector<FrameStatus> solved = solve(SimulateOptions{}.give_up_after);
  EXPECT_EQ(solved[0].seconds, given_up[0].seconds);
  EXPECT_TRUE(solved[1].converged);
  EXPECT_GT(solved[1].iterations, 5);
  EXPECT_EQ(solve(5)[1].seconds, solved[1].seconds);
}

TEST(Simulate, AFrameSolvedAloneIsTheOneThatIsStored) {
  const TemporaryFolder folder;
  const Character limb = make_limb();
  const std::vector<Muscle> muscles{make_flexor()};
  Clip clip = bending_clip(limb, 4);
  clip.controls = {"flexor"};
  for (Pose& pose : clip.poses) pose.controls = {0.5};
  const Outcome stored = run(folder, clip, {12, 14}, 1);
  const QuasiStaticBody body =
      make_body(limb, muscles, SimulateOptions{.tet_size = 0.05, .threads = 1, .anatomy = kLimbAnatomy});
  EXPECT_EQ(frame_key(body, muscles, clip, 12), stored.status[0].inputs);
  EXPECT_EQ(frame_key(body, muscles, clip, 14), stored.status[1].inputs);
  const Positions nodes = solve_frame(body, muscles, clip, 14).nodes;
  const Positions skin = welded_from_output(limb, Pc2Reader(folder / "take.pc2").sample(1).data());
  EXPECT_EQ(body.skin(nodes).cast<float>(), skin.cast<float>());

  Materials soft;
  soft.fat.mu /= 2;
  EXPECT_NE(frame_key(make_body(limb, muscles, {.tet_size = 0.05, .materials = soft, .anatomy = kLimbAnatomy}), muscles,
                      clip, 14),
            stored.status[1].inputs);
  EXPECT_NE(frame_key(make_body(limb, muscles, {.tet_size = 0.02, .anatomy = kLimbAnatomy}), muscles, clip, 14),
            stored.status[1].inputs);
  clip.poses[3].controls = {0.25};
  EXPECT_NE(frame_key(body, muscles, clip, 14), stored.status[1].inputs);
}

TEST(Simulate, MusclesThatWouldDoNothingAreSaid) {
  const TemporaryFolder folder;
  const Character limb = make_limb();
  const Clip clip = bending_clip(limb, 1);
  std::string warning;
  SimulateOptions options{.tet_size = 0.05, .threads = 1, .anatomy = kLimbAnatomy};
  options.warn = [&](const std::string& text) { warning += text; };
  const auto with = [&](const Muscle& other) {
    simulate_one_take(limb, {make_flexor(), other}, clip, {11}, folder / "take.pc2", folder / "take.json", options);
  };
  Muscle thread = make_flexor();
  thread.name = "thread";
  thread.radius = 1e-4;
  with(thread);
  EXPECT_NE(warning.find("'thread'"), std::string::npos) << warning;
  EXPECT_EQ(warning.find("'flexor'"), std::string::npos) << warning;
  Muscle stray = make_flexor();
  stray.name = "stray";
  for (MusclePoint& point : stray.path) point.position[1] += 0.3;
  try {
    with(stray);
    ADD_FAILURE();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::mismatch);
    EXPECT_NE(std::string(error.what()).find("'stray'"), std::string::npos) << error.what();
  }
}

TEST(Simulate, ControlsFlexMusclesByName) {
  const TemporaryFolder folder;
  const Clip relaxed = bending_clip(make_limb(), 2);
  const std::string first = run(folder, relaxed, {11, 12}, 1).cache;
  const std::size_t size = (first.size() - 32) / 2;
  for (const char* name : {"flexor", "fl*", "*"}) {
    Clip clip = relaxed;
    clip.controls = {name};
    clip.poses[0].controls = {0};
    clip.poses[1].controls = {1};
    const TemporaryFolder other;
    const std::string flexed = run(other, clip, {11, 12}, 1).cache;
    EXPECT_EQ(flexed.substr(32, size), first.substr(32, size)) << name;
    EXPECT_NE(flexed.substr(32 + size), first.substr(32 + size)) << name;
  }
  const auto kind = [&](const char* name, float value) {
    Clip clip = relaxed;
    clip.controls = {name};
    for (Pose& pose : clip.poses) pose.controls = {value};
    try {
      run(folder, clip, {12}, 1);
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find(name), std::string::npos) << error.what();
      return error.kind();
    }
    return ErrorKind::interrupted;
  };
  EXPECT_EQ(kind("extensor", 1), ErrorKind::mismatch);
  EXPECT_EQ(kind("x*", 1), ErrorKind::mismatch);
  EXPECT_EQ(kind("flexor", -0.1f), ErrorKind::mismatch);
  EXPECT_EQ(kind("flexor", std::nanf("")), ErrorKind::mismatch);
}

TEST(Simulate, AnInterruptKeepsWhatIsDone) {
  const TemporaryFolder folder;
  const Clip clip = bending_clip(make_limb(), 1000);  // no machine solves them before it is interrupted
  const int end = run_in_child(folder, clip, RLIM_INFINITY, [&](pid_t child) {
    wait_for_records(folder / "take.pc2.partial", 24 + record_bytes());
    kill(child, SIGINT);
  });
  EXPECT_EQ(end, static_cast<int>(ErrorKind::interrupted));
  EXPECT_FALSE(fs::exists(folder / "take.pc2"));
  EXPECT_GE(fs::file_size(folder / "take.pc2.partial"), 24 + record_bytes());
}

TEST(Simulate, KeepsTheFinishedFramesOfTheSameInputsOnly) {
  const TemporaryFolder folder;
  const std::vector<float> values{1, 2, 3};
  const FrameStatus status{0, 5e-5, false, 17, 0.25, 2, 1e-3, -0.02};
  const fs::path path = folder / "p";
  std::vector<std::string> warnings;
  const auto warn = [&](const std::string& warning) { warnings.push_back(warning); };
  {
    PartialShapes partial(path, 42, 3, 100, warn);
    partial.append(7, status, values);
    partial.append(8, status, values);
  }
  const std::string whole = testing::read_bytes(path);
  for (std::size_t size = 0; size < whole.size(); ++size) {
    write_bytes(path, whole.substr(0, size));
    const PartialShapes partial(path, 42, 3, 100, warn);
    const std::size_t records = size < 24 ? 0 : (size - 24) / 68;
    EXPECT_EQ(partial.has(7), records >= 1) << size;
    EXPECT_FALSE(partial.has(8)) << size;
  }
  write_bytes(path, whole);
  {
    const PartialShapes partial(path, 42, 3, 100, warn);
    FrameStatus read;
    EXPECT_EQ(partial.read(8, read), values);
    EXPECT_EQ(read.residual, status.residual);
    EXPECT_EQ(read.seconds, status.seconds);
    EXPECT_EQ(read.iterations, 17);
    EXPECT_EQ(read.inverted_tets, 2);
    EXPECT_EQ(read.contact_depth, 1e-3);
    EXPECT_EQ(read.volume_change, -0.02);
  }
  std::string damaged = whole;
  damaged[24 + 49] ^= 1;
  write_bytes(path, damaged);
  EXPECT_FALSE(PartialShapes(path, 42, 3, 100, warn).has(7));
  write_bytes(path, whole);
  // A frame that was given up is there for who gives up as early.
  {
    FrameStatus given_up = status;
    given_up.residual = std::numeric_limits<double>::infinity();
    PartialShapes(path, 42, 3, 100, warn).append(9, given_up, values);
  }
  EXPECT_TRUE(PartialShapes(path, 42, 3, 17, warn).has(9));
  EXPECT_FALSE(PartialShapes(path, 42, 3, 18, warn).has(9));
  write_bytes(path, whole);
  // What is of other inputs is put aside, not lost.
  warnings.clear();
  EXPECT_FALSE(PartialShapes(path, 43, 3, 100, warn).has(7));
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_NE(warnings[0].find("p.old"), std::string::npos);
  EXPECT_EQ(testing::read_bytes(folder / "p.old"), whole);
}

// No equilibrium without inverted tets: the frame is flagged, its numbers are finite, and it can be read back.
TEST(Simulate, AnImpossiblePoseIsFlagged) {
  const TemporaryFolder folder;
  const Character limb = make_limb();
  Clip clip = bending_clip(limb, 2);
  clip.poses[1].joints[1].translation[0] -= 20;
  const std::vector<FrameStatus> status = run(folder, clip, {11, 12}, 1).status;
  EXPECT_TRUE(status[0].converged);
  EXPECT_FALSE(status[1].converged);
  EXPECT_GT(status[1].inverted_tets, 0);
  const std::vector<FrameStatus> stored = read_frame_status(folder / "take.json");
  EXPECT_FALSE(stored[1].converged);
  EXPECT_EQ(stored[1].volume_change, status[1].volume_change);
  const Pc2Reader cache(folder / "take.pc2");
  for (const float x : cache.sample(1)) ASSERT_TRUE(std::isfinite(x));
}

TEST(Simulate, RefusesScaledBonesByName) {
  const TemporaryFolder folder;
  Clip clip = bending_clip(make_limb(), 2);
  clip.poses[1].joints[1].scale = {1, 1.5, 1};
  EXPECT_EQ(run(folder, clip, {11}, 1).status.size(), 1u);
  try {
    run(folder, clip, {12}, 1);
    ADD_FAILURE() << "accepted";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::mismatch);
    EXPECT_NE(
        std::string(error.what())
            .find("clip '" + clip.name + "': joint '" + make_limb().skeleton.joints[1].name + "' is scaled by 1.0"),
        std::string::npos)
        << error.what();
    EXPECT_NE(std::string(error.what()).find("frame 12"), std::string::npos);
  }
}

TEST(Simulate, RefusesFramesAndFoldersThatAreNotThere) {
  const TemporaryFolder folder;
  const Character limb = make_limb();
  const Clip clip = bending_clip(limb, 2);
  EXPECT_THROW(run(folder, clip, {13}, 1), Error);
  EXPECT_THROW(run(folder, clip, {}, 1), Error);
  EXPECT_THROW(run(folder, clip, {11, 11}, 1), Error);
  EXPECT_THROW(simulate_one_take(limb, {}, clip, {11}, folder / "no/such.pc2", folder / "s.json", {0.05, 1}), Error);
}

}  // namespace
}  // namespace bodyopt::trainer
