// The quasi-static solver beside plain Newton on the same elastic problem, and how much shapes depend on their path.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <sstream>

#include "bench/newton.h"
#include "bench/subdivide.h"
#include "runtime/host/rig.h"
#include "trainer/builtin/arm.h"
#include "trainer/simulate/quasi_static.h"
#include "trainer/train/skinning/linear_blend.h"

namespace bodyopt::bench {
namespace {

constexpr int kHeldoutFrames = 144;
constexpr double kTolerance = 1e-4, kReferenceTolerance = 1e-9;

// The arm, and the pieces of its body that the elastic problem is made of.
struct Arm {
  BuiltinArm arm = build_arm();
  Clip clip = arm_heldout(arm.character.skeleton, kHeldoutFrames);
  TetMesh mesh = fill_skin(arm.character, 0);
  QuasiStaticBody body{arm.character, arm.muscles, mesh};
  std::vector<TetMaterial> tets;
  std::unique_ptr<Tissue> tissue;
  std::unique_ptr<BoneSprings> springs;
  std::unique_ptr<Metric> metric;

  Arm() {
    const Materials materials;
    tets.assign(static_cast<std::size_t>(mesh.tets.rows()), materials.fat);
    std::vector<double> muscle(tets.size(), 0);
    for (const FibreTet& fibre : body.fibres()) {
      tets[static_cast<std::size_t>(fibre.tet)] = materials.muscle;
      muscle[static_cast<std::size_t>(fibre.tet)] = 1;
    }
    tissue = std::make_unique<Tissue>(mesh, tets, body.fibres());
    springs = std::make_unique<BoneSprings>(mesh, body.bones(), arm.character.skeleton.size());
    metric = std::make_unique<Metric>(
        SparseMatrix(tet_laplacian(mesh, metric_stiffness(tets, muscle, materials)) + springs->stiffness()));
  }
};

const Arm& arm() {
  static const Arm built;
  return built;
}

const Pose& pose_of(int frame) { return arm().clip.poses[static_cast<std::size_t>(frame - 1)]; }

// The pose at four fifths of the path from rest.
Pose before(const Pose& pose) {
  Pose result = bind_pose(arm().arm.character.skeleton);
  constexpr double kShare = 0.8;
  for (std::size_t j = 0; j < pose.joints.size(); ++j) {
    result.joints[j].rotation = slerp(result.joints[j].rotation, pose.joints[j].rotation, kShare);
  }
  return result;
}

struct Start {
  ElasticProblem problem;
  Objective objective;
  Positions nodes;
};

// The elastic problem of a frame, and the shape of a fifth of the path earlier carried on by skinning.
Start start_of(int frame) {
  const Arm& a = arm();
  const Pose& pose = pose_of(frame);
  const Pose earlier = before(pose);
  const auto now = skinning_matrices(a.arm.character.skeleton, pose.joints),
             then = skinning_matrices(a.arm.character.skeleton, earlier.joints);
  Start start;
  start.problem = {a.mesh, a.tets, a.body.fibres(), {}, activations(a.arm.muscles, now), a.springs->stiffness()};
  start.nodes = a.body.solve(earlier).nodes;
  for (Eigen::Index n = 0; n < start.nodes.rows(); ++n) {
    const Vec3 rest{a.mesh.nodes(n, 0), a.mesh.nodes(n, 1), a.mesh.nodes(n, 2)};
    for (std::size_t j = 0; j < now.size(); ++j) {
      const Vec3 moved = a.body.weights()(n, static_cast<Eigen::Index>(j)) * (now[j] * rest - then[j] * rest);
      start.nodes.row(n) += Eigen::RowVector3d(moved[0], moved[1], moved[2]);
    }
  }
  start.objective = [&a, springs = a.springs->pose(now), activation = start.problem.activation](const Positions& x,
                                                                                                Positions& gradient) {
    gradient.setZero();
    const Tissue::Sum sum = a.tissue->add_gradient(x, activation, gradient);
    return ObjectiveValue{sum.energy + a.springs->add_gradient(springs, x, gradient), sum.force_square};
  };
  return start;
}

// Millimetres between skins.
struct SkinDifference {
  double rms, max;
};
SkinDifference skin_difference(const Positions& a, const Positions& b) {
  const auto skin = arm().arm.character.vertices.rows();
  const Eigen::VectorXd distance = 1e3 * (a.topRows(skin) - b.topRows(skin)).rowwise().norm();
  return {std::sqrt(distance.squaredNorm() / static_cast<double>(skin)), distance.maxCoeff()};
}

// Ends the benchmark with an error where a solver has not come to the residual asked of it: its figures would be those
// of another task.
bool reached(benchmark::State& state, const MinimiseResult& result, double tolerance) {
  if (result.residual <= tolerance) return true;
  std::ostringstream message;
  message << "residual " << result.residual << " after " << result.iterations << " iterations, expected " << tolerance;
  state.SkipWithError(message.str().c_str());
  return false;
}

// Whether the shape, and the minimum that it is compared with, were reached.
bool report(benchmark::State& state, const MinimiseResult& result, const Start& start, const Positions& nodes) {
  if (!reached(state, result, kTolerance)) return false;
  state.PauseTiming();
  Positions reference = nodes;  // on from here: where this basin's minimum is
  const MinimiseResult minimum = newton(start.problem, start.objective, kReferenceTolerance, reference);
  if (!reached(state, minimum, kReferenceTolerance)) return false;
  const SkinDifference difference = skin_difference(nodes, reference);
  state.counters["tets"] = static_cast<double>(arm().mesh.tets.rows());
  state.counters["iterations"] = result.iterations;
  state.counters["skin_rms_mm"] = difference.rms;
  state.counters["skin_max_mm"] = difference.max;
  state.ResumeTiming();
  return true;
}

void BM_Ours(benchmark::State& state) {
  const Start start = start_of(static_cast<int>(state.range(0)));
  for (auto _ : state) {
    Positions nodes = start.nodes;
    const StiffModes metric(*arm().metric, nodes.rows(), {}, {});
    const MinimiseResult result = Lbfgs(metric, 0).minimise(start.objective, kTolerance, 4000, nodes);
    if (!report(state, result, start, nodes)) break;
  }
}

void BM_Newton(benchmark::State& state) {
  const Start start = start_of(static_cast<int>(state.range(0)));
  for (auto _ : state) {
    Positions nodes = start.nodes;
    const MinimiseResult result = newton(start.problem, start.objective, kTolerance, nodes);
    if (!report(state, result, start, nodes)) break;
  }
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
    return QuasiStaticBody(fine, arm().arm.muscles, fill_skin(fine, 0));
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
BENCHMARK(BM_Ours)->ArgName("frame")->DenseRange(12, 144, 24)->Iterations(1)->Unit(kUnit);
BENCHMARK(BM_Newton)->ArgName("frame")->DenseRange(12, 144, 24)->Iterations(1)->Unit(kUnit);
BENCHMARK(BM_HalvedTets)->ArgName("frame")->DenseRange(12, 144, 24)->Iterations(1)->Unit(kUnit);
BENCHMARK(BM_Path)
    ->ArgNames({"frame", "through"})
    ->ArgsProduct({benchmark::CreateDenseRange(6, 144, 12), {72}})
    ->Iterations(1)
    ->Unit(kUnit);

}  // namespace
}  // namespace bodyopt::bench

BENCHMARK_MAIN();
