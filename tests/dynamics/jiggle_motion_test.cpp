// The jiggle over frames, on the CPU: what holds for any body.
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <bit>
#include <fstream>
#include <functional>
#include <limits>
#include <numeric>

#include "runtime/basis/safetensors.h"
#include "runtime/core/error.h"
#include "runtime/cpu/dynamics_kernels.h"
#include "runtime/deformer/deformer.h"
#include "runtime/host/device_choice.h"
#include "runtime/host/jiggle.h"
#include "tests/support/hostile_bytes.h"
#include "tests/support/limb_dynamics.h"
#include "tests/support/random_tables.h"
#include "tests/support/temporary_folder.h"

namespace bodyopt::testing {
namespace {

Deformer limb_deformer(const JiggleOptions& options = {}) {
  return Deformer(limb_model().basis, limb_model().dynamics, options, {.name = "cpu"});
}

std::vector<int> frames_from(int first, std::size_t count) {
  std::vector<int> frames(count);
  std::iota(frames.begin(), frames.end(), first);
  return frames;
}

// Rests, swings for half a second, stops dead.
std::vector<Pose> swing(std::size_t count, double fps = 24) {
  std::vector<Pose> poses;
  for (std::size_t f = 0; f < count; ++f) {
    const double t = std::clamp(static_cast<double>(f) / fps - 0.2, 0.0, 0.5);
    poses.push_back(limb_pose({{0.3 * t, 0, 0}, 3 * t * t, 4 * t * t}));
  }
  return poses;
}

double largest(std::span<const float> values) {
  double most = 0;
  for (const float value : values) most = std::max(most, std::abs(static_cast<double>(value)));
  return most;
}

double largest_difference(std::span<const float> a, std::span<const float> b) {
  double most = 0;
  for (std::size_t k = 0; k < a.size(); ++k) {
    most = std::max(most, std::abs(static_cast<double>(a[k]) - static_cast<double>(b[k])));
  }
  return most;
}

bool same_bits(std::span<const float> a, std::span<const float> b) {
  return std::ranges::equal(a, b, {}, std::bit_cast<std::uint32_t, float>, std::bit_cast<std::uint32_t, float>);
}

bool same_bits(const JiggleState& a, const JiggleState& b) {
  return a.frame == b.frame && a.known == b.known && a.joints == b.joints && a.joint_velocity == b.joint_velocity &&
         same_bits(a.motion.displacement, b.motion.displacement) && same_bits(a.motion.velocity, b.motion.velocity) &&
         same_bits(a.motion.nodes, b.motion.nodes) && same_bits(a.motion.node_velocity, b.motion.node_velocity);
}

// Where the limb at rest comes to rest under accelerations of its nodes, m/s^2: K u = m a, as A u = b m a + inertia u.
std::vector<float> static_displacement(const std::function<Vec3(std::size_t)>& acceleration) {
  const JiggleTable& jiggle = limb_model().dynamics.jiggle;
  const float b = 1 + jiggle.step.stiffness_damping / jiggle.step.stage();
  std::vector<float> u(3 * jiggle.nodes.size()), right_side(u.size()), scratch;
  for (int round = 0; round < 1000; ++round) {
    for (std::size_t n = 0; n < jiggle.nodes.size(); ++n) {
      const Vec3 a = acceleration(n);
      for (std::size_t i = 0; i < 3; ++i) {
        const float force = b * jiggle.nodes[n].mass * static_cast<float>(a[i]);
        right_side[3 * n + i] = force + jiggle.nodes[n].inertia * u[3 * n + i];
      }
    }
    cpu::block_solve(jiggle.inverse, right_side, 1, 1, scratch, u);
  }
  return u;
}

TEST(Jiggle, AHeldPoseStaysHeldForAThousandFrames) {
  for (const auto& [at, frames] : {std::pair(LimbPose{{1, 2, 3}, 1.2, 2.2}, 1000), {LimbPose{}, 100}}) {
    Deformer limb = limb_deformer();
    const std::vector<Pose> poses(static_cast<std::size_t>(frames), limb_pose(at));
    const Evaluation jiggled = limb.jiggle(poses, frames_from(1, poses.size()));
    const Evaluation still = limb.evaluate(std::span(poses).first(1));
    EXPECT_EQ(largest(limb.state().motion.displacement), 0);
    EXPECT_EQ(largest(limb.state().motion.velocity), 0);
    EXPECT_TRUE(same_bits(std::span(jiggled.positions).last(still.positions.size()), still.positions));
    EXPECT_TRUE(same_bits(std::span(jiggled.normals).last(still.normals.size()), still.normals));
  }
}

TEST(Jiggle, FollowsThroughAndComesToRest) {
  Deformer limb = limb_deformer();
  const std::vector<Pose> poses = swing(200);
  const Evaluation jiggled = limb.jiggle(poses, frames_from(1, poses.size()));
  const Evaluation still = limb.evaluate(poses);
  const std::size_t stride = still.positions.size() / poses.size();
  const auto moved = [&](std::size_t f) {
    return largest_difference(std::span(jiggled.positions).subspan(f * stride, stride),
                              std::span(still.positions).subspan(f * stride, stride));
  };
  EXPECT_EQ(moved(4), 0);      // it has not moved yet
  EXPECT_GT(moved(17), 1e-3);  // it stopped a frame ago
  EXPECT_LT(moved(17), 0.05);
  EXPECT_LT(moved(100), moved(17) / 50);
  EXPECT_LT(moved(199), 1e-6);
}

// A body that is turned as one feels the same in its own axes: free decay from the same displacement.
TEST(Jiggle, IsTheSameInATurnedBody) {
  const auto decay = [](double turn) {
    Deformer limb = limb_deformer();
    const Pose pose = limb_pose({{}, turn, 0});
    limb.jiggle({&pose, 1}, std::vector<int>{0});
    JiggleState state = limb.state();
    state.known = 2;
    const Quat rotation = axis_angle({0, 1, 0}, turn);
    for (std::size_t k = 0; k < state.motion.displacement.size(); k += 3) {
      const Vec3 u = rotate(rotation, {0.01 * std::sin(static_cast<double>(k)), 0.004, -0.002});
      for (std::size_t i = 0; i < 3; ++i) state.motion.displacement[k + i] = static_cast<float>(u[i]);
    }
    limb.set_state(state);
    const std::vector<Pose> poses(6, pose);
    limb.jiggle(poses, frames_from(1, 6));
    std::vector<float> own = limb.state().motion.displacement;
    const Quat back = axis_angle({0, 1, 0}, -turn);
    for (std::size_t k = 0; k < own.size(); k += 3) {
      const Vec3 u = rotate(back, {own[k], own[k + 1], own[k + 2]});
      for (std::size_t i = 0; i < 3; ++i) own[k + i] = static_cast<float>(u[i]);
    }
    return own;
  };
  const std::vector<float> upright = decay(0);
  EXPECT_GT(largest(upright), 1e-5);
  EXPECT_LT(largest_difference(upright, decay(2.0)), 1e-5 * largest(upright) + 2e-8);
}

TEST(Jiggle, DoesNotDependOnHowFramesAreCutIntoCalls) {
  const std::vector<Pose> poses = swing(40);
  Deformer whole = limb_deformer(), parts = limb_deformer();
  const Evaluation at_once = whole.jiggle(poses, frames_from(1, 40));
  std::vector<float> piecewise;
  for (std::size_t begin = 0; begin < 40; begin += 7) {
    const std::size_t count = std::min<std::size_t>(7, 40 - begin);
    const Evaluation part =
        parts.jiggle(std::span(poses).subspan(begin, count), frames_from(1 + static_cast<int>(begin), count));
    piecewise.insert(piecewise.end(), part.positions.begin(), part.positions.end());
  }
  EXPECT_TRUE(same_bits(at_once.positions, piecewise));
  EXPECT_TRUE(same_bits(whole.state(), parts.state()));
}

TEST(Jiggle, GoesOnFromAStateFileWithTheSameBits) {
  const TemporaryFolder folder;
  const std::vector<Pose> poses = swing(30);
  Deformer whole = limb_deformer(), first = limb_deformer(), second = limb_deformer();
  const Evaluation at_once = whole.jiggle(poses, frames_from(1001, 30));
  first.jiggle(std::span(poses).first(19), frames_from(1001, 19));
  save_state(first.state(), *first.dynamics(), folder.path() / "shot.state");
  const JiggleState loaded = load_state(folder.path() / "shot.state", *second.dynamics());
  EXPECT_TRUE(same_bits(loaded, first.state()));
  second.set_state(loaded);
  const Evaluation rest = second.jiggle(std::span(poses).subspan(19), frames_from(1020, 11));
  EXPECT_TRUE(same_bits(std::span(at_once.positions).last(rest.positions.size()), rest.positions));
}

TEST(Jiggle, RefusesStatesThatAreDamagedOrOfOtherDynamics) {
  const TemporaryFolder folder;
  const std::filesystem::path path = folder.path() / "shot.state";
  Deformer limb = limb_deformer();
  limb.jiggle(swing(3), frames_from(1, 3));
  save_state(limb.state(), *limb.dynamics(), path);
  try {
    load_state(path, limb_dynamics({.frames_per_second = 30}));
    FAIL() << "a state of other dynamics was taken";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::mismatch);
    EXPECT_NE(std::string(error.what()).find("other dynamics"), std::string::npos) << error.what();
  }
  const auto refused = [&](const std::string& named, const std::function<void(Safetensors&)>& change) {
    Safetensors file = read_safetensors(path);
    change(file);
    file.metadata["checksum"] = content_checksum(file);
    const std::filesystem::path changed = folder.path() / "changed.state";
    write_safetensors(file, changed);
    expect_refused([&](const auto& from) { load_state(from, *limb.dynamics()); }, changed, read_bytes(changed), named);
  };
  for (const char* name :
       {"joints", "joint_velocity", "displacement", "velocity", "nodes", "node_velocity", "origin"}) {
    refused(std::string("tensor '") + name + "' is missing", [&](Safetensors& f) { f.tensors.erase(name); });
    refused(std::string("tensor '") + name + "' has a number that is not finite", [&](Safetensors& f) {
      Tensor& tensor = f.tensors.at(name);
      std::fill(tensor.bytes.end() - static_cast<std::ptrdiff_t>(dtype_size(tensor.dtype)), tensor.bytes.end(),
                std::byte{0xff});
    });
  }
  for (const auto& [name, number] : std::map<std::string, double>{{"joints", 1e9},
                                                                  {"joint_velocity", 1e12},
                                                                  {"displacement", 1e5},
                                                                  {"velocity", -1e7},
                                                                  {"nodes", 1e9},
                                                                  {"node_velocity", 1e30},
                                                                  {"origin", -1e300}}) {
    refused("'" + name + "' has the number", [name = name, number = number](Safetensors& f) {
      Tensor& tensor = f.tensors.at(name);
      const auto small = static_cast<float>(number);
      const bool is_double = tensor.dtype == "F64";
      std::memcpy(tensor.bytes.data(), is_double ? static_cast<const void*>(&number) : &small, is_double ? 8 : 4);
    });
  }
  refused("frame is out of range", [](Safetensors& f) { f.metadata["frame"] = "2147483647"; });
  JiggleState blown_up = limb.state();
  blown_up.motion.velocity[5] = std::nanf("");
  EXPECT_THROW(save_state(blown_up, *limb.dynamics(), folder / "none.state"), Error);
  EXPECT_FALSE(std::filesystem::exists(folder / "none.state"));
  const auto size = std::filesystem::file_size(path);
  for (const double part : {0.0, 0.1, 0.5, 0.99}) {
    const std::filesystem::path cut = folder.path() / "cut.state";
    std::filesystem::copy_file(path, cut, std::filesystem::copy_options::overwrite_existing);
    std::filesystem::resize_file(cut, static_cast<std::uintmax_t>(part * static_cast<double>(size)));
    EXPECT_THROW(load_state(cut, *limb.dynamics()), Error) << part;
  }
}

TEST(Jiggle, RefusesStatesThatDoNotFitTheCharacter) {
  Deformer limb = limb_deformer();
  limb.jiggle(swing(3), frames_from(1, 3));
  const JiggleState good = limb.state();
  const auto refuses = [&](const auto& damage) {
    JiggleState bad = good;
    damage(bad);
    EXPECT_THROW(limb.set_state(bad), Error);
    EXPECT_TRUE(same_bits(limb.state(), good));
  };
  refuses([](JiggleState& s) { s.joints.clear(), s.joint_velocity.clear(); });
  refuses([](JiggleState& s) { s.joint_velocity.pop_back(); });
  refuses([](JiggleState& s) { s.motion.displacement.pop_back(); });
  refuses([](JiggleState& s) { s.motion.velocity.push_back(0); });
  refuses([](JiggleState& s) { s.motion.nodes.clear(); });
  refuses([](JiggleState& s) { s.motion.node_velocity[1] = std::numeric_limits<float>::infinity(); });
  refuses([](JiggleState& s) { s.origin[2] = std::numeric_limits<double>::quiet_NaN(); });
  Deformer still(limb_model().basis, {.name = "cpu"});
  EXPECT_THROW(still.set_state(good), Error);
}

// A joint that stands, then is elsewhere: what a plan says of it.
TEST(JigglePlan, CountsStepsAndIntervals) {
  const JiggleStep step{.frames_per_second = 24, .substeps = 3};
  JiggleState state;
  const auto plan = [&](int frame, double x) {
    const double joint[3] = {x, 0, 0};
    return plan_frame(frame, joint, {x, 1, 2}, 1.8, step, {}, state);
  };
  EXPECT_EQ(plan(10, 0).steps, 0u);
  const JiggleFrame second = plan(11, 0.01);
  EXPECT_EQ(second.kick.start, 1u);
  const JiggleFrame third = plan(15, 0.05);
  EXPECT_EQ(third.start, JiggleStart::goes_on);
  EXPECT_EQ(third.steps, 12u);
  EXPECT_EQ(third.kick.start, 2u);
  EXPECT_FLOAT_EQ(third.kick.inverse_interval, 6);
  EXPECT_FLOAT_EQ(third.kick.origin_step_x, 0.04f);
  EXPECT_EQ(third.kick.origin_step_y, 0);
  EXPECT_TRUE(plan(15, 0.05).repeats);
  EXPECT_EQ(plan(39, 0.05).start, JiggleStart::goes_on);  // a second
  EXPECT_EQ(plan(64, 0.05).start, JiggleStart::gap);
}

TEST(JigglePlan, FindsJumpsByTheChangeOfVelocityOverTheSize) {
  for (const double size : {1.8, 0.45}) {
    const double limit = 2 * std::sqrt(9.81 * size) / 24;  // metres in a frame
    for (const double share : {0.95, 1.05}) {
      JiggleState state;
      const auto plan = [&](int frame, double x) {
        const double joints[6] = {x, 0, 0, 5 + x, 5, 5};
        return plan_frame(frame, joints, {x, 0, 0}, size, {}, {}, state).start;
      };
      plan(1, 0);
      EXPECT_EQ(plan(2, 0.5 * limit), JiggleStart::goes_on);
      EXPECT_EQ(plan(3, limit), JiggleStart::goes_on);  // fast, and steadily
      EXPECT_EQ(plan(4, (1.5 + share) * limit), share < 1 ? JiggleStart::goes_on : JiggleStart::jump);
    }
  }
}

// A gallop is as fast from its first frame on; and after a jump, which starts it anew once.
TEST(JigglePlan, SteadySpeedIsNoJumpFromTheFirstFrameOn) {
  const double size = 1.8, step = 3 * 2 * std::sqrt(9.81 * size) / 24;
  JiggleState state;
  const auto plan = [&](int frame, double x) {
    const double joints[6] = {x, 0, 0, 5 + x, 5, 5};
    return plan_frame(frame, joints, {x, 0, 0}, size, {}, {}, state).start;
  };
  EXPECT_EQ(plan(1, step), JiggleStart::first);
  for (int frame = 2; frame < 6; ++frame) EXPECT_EQ(plan(frame, step * frame), JiggleStart::goes_on) << frame;
  EXPECT_EQ(plan(6, -100 * step), JiggleStart::jump);
  for (int frame = 7; frame < 10; ++frame) EXPECT_EQ(plan(frame, step * (frame - 106)), JiggleStart::goes_on) << frame;
}

TEST(JigglePlan, OfAFewFramesASecondIsNotAllGaps) {
  JiggleState state;
  const double joint[3] = {};
  const JiggleStep slow{.frames_per_second = 0.5f};
  plan_frame(1, joint, {0, 0, 0}, 1.8, slow, {}, state);
  EXPECT_EQ(plan_frame(2, joint, {0, 0, 0}, 1.8, slow, {}, state).start, JiggleStart::goes_on);
}

TEST(Jiggle, StartsAnewAtCutsJumpsGapsAndGoingBack) {
  const std::vector<Pose> poses = swing(20);
  const Pose far = limb_pose({{30, 0, 0}, 0, 0});
  const auto start = [&](const Pose& pose, int frame, const std::vector<int>& cuts = {}) {
    Deformer limb = limb_deformer({.cuts = cuts});
    limb.jiggle(poses, frames_from(1, 20));
    EXPECT_GT(largest(limb.state().motion.displacement), 1e-4);
    const JiggleStart result = limb.jiggle({&pose, 1}, std::vector<int>{frame}).starts.front();
    const bool anew = largest(limb.state().motion.displacement) == 0;
    EXPECT_EQ(anew, result != JiggleStart::goes_on);
    return result;
  };
  EXPECT_EQ(start(poses[19], 21), JiggleStart::goes_on);
  EXPECT_EQ(start(poses[19], 20), JiggleStart::goes_on);  // again
  EXPECT_EQ(start(poses[18], 19), JiggleStart::back);
  EXPECT_EQ(start(far, 21), JiggleStart::jump);
  EXPECT_EQ(start(poses[19], 21, {21}), JiggleStart::cut);
  EXPECT_EQ(start(poses[19], 23, {22}), JiggleStart::cut);
  EXPECT_EQ(start(poses[19], 22, {5, 23}), JiggleStart::goes_on);
  EXPECT_EQ(start(poses[19], 46), JiggleStart::gap);
}

TEST(Jiggle, ARepeatedFrameChangesNothing) {
  Deformer limb = limb_deformer();
  const std::vector<Pose> poses = swing(20);
  const Evaluation once = limb.jiggle(poses, frames_from(1, 20));
  const JiggleState before = limb.state();
  const Evaluation again = limb.jiggle(std::span(poses).last(1), std::vector<int>{20});
  EXPECT_TRUE(same_bits(limb.state(), before));
  EXPECT_TRUE(same_bits(std::span(once.positions).last(again.positions.size()), again.positions));
}

TEST(Jiggle, AFrameThatFailsLeavesTheState) {
  Deformer limb = limb_deformer();
  std::vector<Pose> poses = swing(100);
  limb.jiggle(std::span(poses).first(17), frames_from(1, 17));
  const JiggleState before = limb.state();
  // More frames than a batch: those of the first are stepped before the bad one is met.
  std::vector<Pose> broken(poses.begin() + 17, poses.end());
  broken[80].joints[1].rotation[0] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(limb.jiggle(broken, frames_from(18, broken.size())), Error);
  EXPECT_TRUE(same_bits(limb.state(), before));
  EXPECT_GT(largest(limb.state().motion.displacement), 1e-4);
  limb.jiggle(std::span(poses).subspan(17), frames_from(18, 83));
  EXPECT_LT(largest(limb.state().motion.displacement), 0.1);
}

TEST(Jiggle, NeedsDynamicsAndAFrameNumberForEveryPose) {
  Deformer still(limb_model().basis, {.name = "cpu"});
  const std::vector<Pose> poses = swing(2);
  EXPECT_THROW(still.jiggle(poses, frames_from(1, 2)), Error);
  Deformer limb = limb_deformer();
  EXPECT_THROW(limb.jiggle(poses, frames_from(1, 3)), Error);
}

// At 60 and 120 frames a second the same times give the same shape as at 480, the finer the nearer: second order would
// be a ratio of 0.24, first order one of 0.43.
TEST(Jiggle, ConvergesAsFramesGetShorter) {
  const auto at_times = [](float fps) {
    Deformer limb(limb_model().basis, limb_dynamics({.frames_per_second = fps}), {}, {.name = "cpu"});
    const auto step = static_cast<std::size_t>(fps / 30);
    std::vector<Pose> poses;
    for (std::size_t f = 0; f < 30 * step; ++f) {
      const double t = static_cast<double>(f) / static_cast<double>(fps);
      poses.push_back(limb_pose({{0.05 * std::sin(8 * t) * t, 0, 0}, 0, 0.5 * (1 - std::cos(6 * t)) * t}));
    }
    const Evaluation jiggled = limb.jiggle(poses, frames_from(1, poses.size())), still = limb.evaluate(poses);
    const std::size_t stride = still.positions.size() / poses.size();
    std::vector<float> moved;
    for (std::size_t f = 0; f < poses.size(); f += step) {
      for (std::size_t k = f * stride; k < (f + 1) * stride; ++k) {
        moved.push_back(jiggled.positions[k] - still.positions[k]);
      }
    }
    return moved;
  };
  const std::vector<float> finest = at_times(480);
  const double coarse = largest_difference(at_times(60), finest), fine = largest_difference(at_times(120), finest);
  EXPECT_GT(largest(finest), 3e-4);
  EXPECT_LT(coarse, 0.2 * largest(finest));
  EXPECT_LT(fine, 0.33 * coarse);
}

TEST(Jiggle, FallsByGravityAndHangsStill) {
  Deformer limb = limb_deformer({.gravity_change = {0, -9.81, 0}});
  const std::vector<Pose> poses(240, limb_pose({}));
  limb.jiggle(poses, frames_from(1, 240));
  const NodeMotion motion = limb.state().motion;
  const std::vector<float> expected = static_displacement([](std::size_t) { return Vec3{0, -9.81, 0}; });
  EXPECT_GT(largest(expected), 1e-4);
  EXPECT_LT(largest_difference(motion.displacement, expected), 1e-3 * largest(expected));
  EXPECT_LT(largest(motion.velocity), 1e-4 * largest(expected));
}

// A body that is turned steadily is pulled outwards, as in its own axes by a force of mass x rate^2 x distance; the
// kicks of many frames a second are as good as a force.
TEST(Jiggle, ATurningBodyIsPulledOutwards) {
  constexpr double kRate = 3;  // radians a second
  const Dynamics often = limb_dynamics({.frames_per_second = 480});
  Deformer limb(limb_model().basis, often, {}, {.name = "cpu"});
  std::vector<Pose> poses;
  for (int f = 0; f < 960; ++f) poses.push_back(limb_pose({{}, kRate * f / 480, 0}));
  limb.jiggle(poses, frames_from(1, poses.size()));
  std::vector<float> own = limb.state().motion.displacement;
  const Quat back = axis_angle({0, 1, 0}, -kRate * 959 / 480);
  for (std::size_t k = 0; k < own.size(); k += 3) {
    const Vec3 u = rotate(back, {own[k], own[k + 1], own[k + 2]});
    for (std::size_t i = 0; i < 3; ++i) own[k + i] = static_cast<float>(u[i]);
  }
  const std::vector<float> expected = static_displacement([&](std::size_t n) {
    return Vec3{kRate * kRate * often.tets.nodes[3 * n], 0, kRate * kRate * often.tets.nodes[3 * n + 2]};
  });
  EXPECT_GT(largest(expected), 1e-4);
  EXPECT_LT(largest_difference(own, expected), 0.05 * largest(expected));
}

// Far away the same motion gives the same jiggle, as exactly as single precision has positions there: 4 um at 64 m.
TEST(Jiggle, DoesNotDependOnThePlaceInTheWorld) {
  const auto run = [](double x) {
    Deformer limb = limb_deformer();
    std::vector<Pose> poses = swing(24);
    for (Pose& pose : poses) pose.joints[0].translation[0] += x;
    limb.jiggle(poses, frames_from(1, 24));
    return limb.state().motion.displacement;
  };
  const std::vector<float> here = run(0);
  EXPECT_LT(largest_difference(here, run(64)), 0.02 * largest(here));
}

}  // namespace
}  // namespace bodyopt::testing
