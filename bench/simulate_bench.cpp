// How much the quasi-static solver's shapes depend on their path, and on the size of the tets.
#include <benchmark/benchmark.h>

#include <cmath>
#include <memory>

#include "trainer/builtin/arm.h"
#include "trainer/simulate/simulate.h"
#include "trainer/tets/second_order.h"

namespace bodyopt::bench {
namespace {

constexpr int kHeldoutFrames = 144;

struct Arm {
  trainer::BuiltinArm arm = trainer::build_arm();
  Clip clip = trainer::arm_heldout(arm.character.skeleton, kHeldoutFrames);
  trainer::QuasiStaticBody body = trainer::make_body(arm.character, arm.muscles, {});
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
  const Eigen::VectorXd distance = 1e3 * (a - b).rowwise().norm();
  return {std::sqrt(distance.squaredNorm() / static_cast<double>(distance.size())), distance.maxCoeff()};
}

// A frame solved as `simulate` does, and reached through the pose of another frame: how far the shapes differ.
void BM_Path(benchmark::State& state) {
  const Pose& pose = pose_of(static_cast<int>(state.range(0)));
  const Pose through[] = {pose_of(static_cast<int>(state.range(1))), pose};
  for (auto _ : state) {
    const trainer::SolvedPose straight = arm().body.solve(pose);
    state.PauseTiming();
    const trainer::SolvedPose around = arm().body.solve_along(through, {});
    const SkinDifference difference = skin_difference(arm().body.skin(straight.nodes), arm().body.skin(around.nodes));
    state.counters["iterations"] = straight.status.iterations;
    state.counters["skin_rms_mm"] = difference.rms;
    state.counters["skin_max_mm"] = difference.max;
    state.counters["contact_mm"] = 1e3 * straight.status.contact_depth;
    state.ResumeTiming();
  }
}

// Makes a body of second order in a cage of so many nodes.
trainer::QuasiStaticBody refined_body(Eigen::Index nodes) {
  const Character& character = arm().arm.character;
  const trainer::Cage cage = trainer::filled_cage(character.vertices, character.triangles, character.weights, nodes);
  const trainer::AnatomyField anatomy(character, arm().arm.muscles);
  trainer::QuasiStaticBody body(character, arm().arm.muscles, anatomy, trainer::second_order(cage));
  body.walk_in(std::make_unique<trainer::QuasiStaticBody>(character, arm().arm.muscles, anatomy, cage));
  return body;
}

// A frame in three times as many tets, on the skin and inside: how far the skin moves.
void BM_Refined(benchmark::State& state) {
  static const trainer::QuasiStaticBody refined = refined_body(9000);
  const Pose& pose = pose_of(static_cast<int>(state.range(0)));
  const trainer::SolvedPose coarse = arm().body.solve(pose);
  for (auto _ : state) {
    const trainer::SolvedPose fine = refined.solve(pose);
    state.PauseTiming();
    const SkinDifference difference = skin_difference(arm().body.skin(coarse.nodes), refined.skin(fine.nodes));
    state.counters["iterations"] = fine.status.iterations;
    state.counters["tets"] = static_cast<double>(refined.mesh().tets.rows()) / 8;
    state.counters["skin_rms_mm"] = difference.rms;
    state.counters["skin_max_mm"] = difference.max;
    state.ResumeTiming();
  }
}

constexpr auto kUnit = benchmark::kMillisecond;
BENCHMARK(BM_Refined)->ArgName("frame")->DenseRange(12, 144, 24)->Iterations(1)->Unit(kUnit);
BENCHMARK(BM_Path)
    ->ArgNames({"frame", "through"})
    ->ArgsProduct({benchmark::CreateDenseRange(6, 144, 12), {72}})
    ->Iterations(1)
    ->Unit(kUnit);

}  // namespace
}  // namespace bodyopt::bench

BENCHMARK_MAIN();
