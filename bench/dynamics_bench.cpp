// The solves of diffuse and jiggle beside sparse direct ones, on the same systems and threads; and a whole step.
#include <benchmark/benchmark.h>
#include <tbb/global_control.h>

#include <Eigen/CholmodSupport>
#include <Eigen/SparseCholesky>
#include <memory>

#include "geometry/mesh.h"
#include "runtime/cpu/dynamics_kernels.h"
#include "runtime/host/jiggle.h"
#include "runtime/threads/tbb_executor.h"
#include "trainer/builtin/arm.h"
#include "trainer/dynamics/block_inverse.h"
#include "trainer/dynamics/build_dynamics.h"
#include "trainer/dynamics/jiggle.h"
#include "trainer/dynamics/jiggle_fields.h"
#include "trainer/train/skinning/ddm.h"

namespace bodyopt::bench {
namespace {

// The built-in arm.
struct Body {
  Body() : arm(ordered_arm()), basis(trainer::build_ddm_basis(arm, {})) {
    make_tables(trainer::make_dynamics_tets(arm.vertices, arm.triangles, arm.weights, kTets));
    nodes = rows_of(dynamics.tets.nodes);
    right_side = Eigen::VectorXf::Random(matrix.rows());
  }

  static Character ordered_arm() {
    const Character character = trainer::build_arm().character;
    return trainer::in_order(character, trainer::morton_order(character.vertices));
  }

  // Makes tables as build_dynamics does, and the matrix whose inverse the block inverse of jiggle is.
  void make_tables(const trainer::DynamicsTets& tets) {
    const TetMesh& mesh = tets.cage.mesh;
    const trainer::JiggleSettings settings;
    const trainer::Materials materials;
    trainer::JiggleAnatomy anatomy =
        trainer::find_anatomy(arm, trainer::AnatomyField(arm, {}), 0, tets.cage, materials);
    const trainer::JiggleFields fields = trainer::spread_settings(settings, arm, {}, {}, tets, anatomy);
    anatomy.bone_springs +=
        trainer::core_springs(arm.vertices, arm.triangles, tets.cage, fields.flesh, materials.bone_springs);
    std::vector<std::string> notes;
    const trainer::JiggleSystem system =
        trainer::make_jiggle_system(settings, fields, arm.skeleton, mesh, anatomy, materials, notes);
    dynamics.tets = trainer::make_tet_table(tets, fields.skin_amount, fields.skin_limit);
    dynamics.diffuse = trainer::make_diffuse_table(mesh, static_cast<Eigen::Index>(tets.surface.size()));
    dynamics.jiggle = trainer::make_jiggle_table(mesh, system, {});
    matrix = trainer::jiggle_matrix(mesh, system, {});
  }

  static constexpr std::int64_t kTets = 25000;  // at most

  Character arm;
  Basis basis;
  Dynamics dynamics;
  Positions nodes;
  trainer::SparseMatrix matrix;
  Eigen::VectorXf right_side;
};

const Body& body() {
  static const Body built;
  return built;
}

double megabytes(const BlockInverse& inverse) {
  const auto bytes = [](const auto& values) { return static_cast<double>(values.size() * sizeof(values[0])); };
  return 1e-6 * (bytes(inverse.values) + bytes(inverse.up) + bytes(inverse.down) + bytes(inverse.slot_unknown) +
                 bytes(inverse.child_slots));
}

// A solve reads these of the matrices: W twice.
double megabytes_read(const BlockInverse& inverse) {
  std::uint64_t values = inverse.values.size();
  for (const InverseStrip& strip : inverse.down) values += std::uint64_t{strip.row_count} * strip.input_count;
  return 4e-6 * static_cast<double>(values);
}

void describe(benchmark::State& state, const Body& b) {
  state.counters["tets"] = b.dynamics.tets.tet_count();
  state.counters["unknowns"] = static_cast<double>(b.matrix.rows());
}

std::span<const float> span_of(const Eigen::VectorXf& values) {
  return {values.data(), static_cast<std::size_t>(values.size())};
}

// Limits oneTBB to `count` threads.
class Threads {
 public:
  explicit Threads(std::int64_t count)
      : limit_(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(count)),
        executor_(make_tbb_executor()) {}
  Executor& executor() { return *executor_; }

 private:
  tbb::global_control limit_;
  std::unique_ptr<Executor> executor_;
};

// The argument of all: threads.
void BM_Precompute(benchmark::State& state) {
  const Body& b = body();
  Threads threads(state.range(0));
  for (auto _ : state) benchmark::DoNotOptimize(trainer::invert(b.matrix, b.nodes, 3).values.data());
  describe(state, b);
}

void BM_BlockInverse(benchmark::State& state) {
  const Body& b = body();
  Threads threads(state.range(0));
  const BlockInverse& inverse = b.dynamics.jiggle.inverse;
  Eigen::VectorXf solution(b.matrix.rows());
  std::vector<float> scratch;
  const std::span<float> to(solution.data(), static_cast<std::size_t>(solution.size()));
  for (auto _ : state) {
    cpu::block_solve(inverse, span_of(b.right_side), 1, 1, scratch, to, threads.executor());
    benchmark::DoNotOptimize(solution.data());
  }
  describe(state, b);
  state.counters["MB"] = megabytes(inverse);
  state.counters["MB_read"] = megabytes_read(inverse);
  const Eigen::VectorXd exact =
      Eigen::SimplicialLDLT<trainer::SparseMatrix>(b.matrix).solve(b.right_side.cast<double>());
  state.counters["relative_error"] = (solution.cast<double>() - exact).norm() / exact.norm();
}

template <typename Solver>
void direct_solve(benchmark::State& state) {
  const Body& b = body();
  Threads threads(state.range(0));
  const Solver solver(b.matrix);
  const Eigen::VectorXd right_side = b.right_side.cast<double>();
  Eigen::VectorXd solution(right_side.size());
  for (auto _ : state) {
    solution = solver.solve(right_side);
    benchmark::DoNotOptimize(solution.data());
  }
  describe(state, b);
}
void BM_SimplicialLdlt(benchmark::State& state) { direct_solve<Eigen::SimplicialLDLT<trainer::SparseMatrix>>(state); }
void BM_Cholmod(benchmark::State& state) { direct_solve<Eigen::CholmodSupernodalLLT<trainer::SparseMatrix>>(state); }

// The buffers of a frame.
struct Frame {
  explicit Frame(const Body& b)
      : positions(b.basis.mesh.rest),
        origins(4),
        nodes(b.dynamics.tets.nodes),
        rotations(3 * nodes.size()),
        right_side(nodes.size()),
        solution(nodes.size()),
        u(nodes.size(), 0.01f),
        v(nodes.size(), 0.1f),
        own_u(nodes.size()),
        own_v(nodes.size()),
        next_u(nodes.size()),
        next_v(nodes.size()),
        moved(positions.size()) {}

  std::vector<float> positions, origins, nodes, rotations, right_side, solution, u, v, own_u, own_v, next_u, next_v;
  std::vector<float> moved, scratch;
};

void BM_Diffuse(benchmark::State& state) {
  const Body& b = body();
  Threads threads(state.range(0));
  Frame f(b);
  for (auto _ : state) {
    cpu::diffuse_surface(b.dynamics.tets, f.positions, f.origins, 1, f.nodes, threads.executor());
    cpu::diffuse_gather(b.dynamics.diffuse, b.dynamics.tets.surface_count(), f.nodes, 1, f.right_side,
                        threads.executor());
    cpu::block_solve(b.dynamics.diffuse.inverse, f.right_side, 3, 3, f.scratch, f.nodes, threads.executor());
  }
  describe(state, b);
  state.counters["MB"] = megabytes(b.dynamics.diffuse.inverse);
}

void BM_JiggleStep(benchmark::State& state) {
  const Body& b = body();
  Threads threads(state.range(0));
  const JiggleTable& jiggle = b.dynamics.jiggle;
  Frame f(b);
  const JiggleStages stages = jiggle_stages(jiggle.step, {});
  for (auto _ : state) {
    cpu::jiggle_rotate(b.dynamics.tets, f.nodes, 1, f.rotations, threads.executor());
    cpu::jiggle_begin(jiggle, stages.begin, f.rotations, {}, {}, f.u, f.v, f.own_u, f.own_v, f.right_side,
                      threads.executor());
    cpu::block_solve(jiggle.inverse, f.right_side, 1, 1, f.scratch, f.solution, threads.executor());
    cpu::jiggle_advance(jiggle, *stages.advance, f.rotations, f.solution, f.own_u, f.own_v, f.next_u, f.next_v,
                        f.right_side, threads.executor());
    cpu::block_solve(jiggle.inverse, f.right_side, 1, 1, f.scratch, f.solution, threads.executor());
    cpu::jiggle_end(stages.end, f.rotations, f.solution, f.next_u, f.u, f.v, threads.executor());
    cpu::jiggle_skin(b.dynamics.tets, f.positions, f.u, 1, f.moved, threads.executor());
    benchmark::DoNotOptimize(f.moved.data());
  }
  describe(state, b);
}

void arguments(benchmark::internal::Benchmark* benchmark) {
  benchmark->ArgName("threads")->Unit(benchmark::kMillisecond)->UseRealTime()->Arg(1)->Arg(2);
}

BENCHMARK(BM_Precompute)->Apply(arguments);
BENCHMARK(BM_BlockInverse)->Apply(arguments);
BENCHMARK(BM_SimplicialLdlt)->Apply(arguments);
BENCHMARK(BM_Cholmod)->Apply(arguments);
BENCHMARK(BM_Diffuse)->Apply(arguments);
BENCHMARK(BM_JiggleStep)->Apply(arguments);

}  // namespace
}  // namespace bodyopt::bench

BENCHMARK_MAIN();
