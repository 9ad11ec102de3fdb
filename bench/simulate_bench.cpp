// How much the quasi-static solver's shapes depend on their path, and on the size of the tets.
#include <benchmark/benchmark.h>

#include <cmath>

#include "bench/subdivide.h"
#include "trainer/builtin/arm.h"
#include "trainer/simulate/quasi_static.h"

namespace bodyopt::bench {
namespace {

constexpr int kHeldoutFrames = 144;

struct Arm {
  BuiltinArm arm = build_arm();
  Clip clip = arm_heldout(arm.character.skeleton, kHeldoutFrames);
  QuasiStaticBody body{arm.character, arm.muscles, AnatomyField(arm.character, arm.muscles),
                       fill_skin(arm.character, 0)};
};

const Arm& arm() {
  static const Arm built;
  return built;
}

const Pose& pose_of(int frame) { return arm().clip.poses[static_cast<std::size_t>(frame - 1)]; }

// Millimetres between skins.
struct SkinDifference {
  double rms, max;
};
SkinDifference skin_difference(const Positions& a, const Positions& b) {
  const auto skin = arm().arm.character.vertices.rows();
  const Eigen::VectorXd distance = 1e3 * (a.topRows(skin) - b.topRows(skin)).rowwise().norm();
  return {std::sqrt(distance.squaredNorm() / static_cast<double>(skin)), distance.maxCoeff()};
}

// A frame solved as `simulate` does, and reached through the pose of another frame: how far the shapes differ.
void BM_Path(benchmark::State& state) {
  const Pose& pose = pose_of(static_cast<int>(state.range(0)));
  const Pose through[] = {pose_of(static_cast<int>(state.range(1))), pose};
  for (auto _ : state) {
    const SolvedPose straight = arm().body.solve(pose);
    state.PauseTiming();
    const SolvedPose around = arm().body.solve_along(through, {});
    const SkinDifference difference = skin_difference(straight.nodes, around.nodes);
    state.counters["iterations"] = straight.status.iterations;
    state.counters["skin_rms_mm"] = difference.rms;
    state.counters["skin_max_mm"] = difference.max;
    state.counters["contact_mm"] = 1e3 * straight.status.contact_depth;
    state.ResumeTiming();
  }
}

const QuasiStaticBody& refined_body() {
  const auto build = [] {
    const Character fine = halve_all_edges(arm().arm.character).character;
    return QuasiStaticBody(fine, arm().arm.muscles, 0.0);
  };
  static const QuasiStaticBody built = build();
  return built;
}

// A frame in tets of half the edge, skin and inside: how far the skin's own vertices move.
void BM_HalvedTets(benchmark::State& state) {
  const Pose& pose = pose_of(static_cast<int>(state.range(0)));
  const SolvedPose coarse = arm().body.solve(pose);
  refined_body();
  for (auto _ : state) {
    const SolvedPose fine = refined_body().solve(pose);
    state.PauseTiming();
    const SkinDifference difference = skin_difference(coarse.nodes, fine.nodes);
    state.counters["iterations"] = fine.status.iterations;
    state.counters["tets"] = static_cast<double>(refined_body().mesh().tets.rows());
    state.counters["skin_rms_mm"] = difference.rms;
    state.counters["skin_max_mm"] = difference.max;
    state.ResumeTiming();
  }
}

constexpr auto kUnit = benchmark::kMillisecond;
BENCHMARK(BM_HalvedTets)->ArgName("frame")->DenseRange(12, 144, 24)->Iterations(1)->Unit(kUnit);
BENCHMARK(BM_Path)
    ->ArgNames({"frame", "through"})
    ->ArgsProduct({benchmark::CreateDenseRange(6, 144, 12), {72}})
    ->Iterations(1)
    ->Unit(kUnit);

}  // namespace
}  // namespace bodyopt::bench

BENCHMARK_MAIN();
