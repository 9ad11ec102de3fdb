// Training at film size: a dataset's skin made finer, trained, beside a matrix product and an SVD of the same frames.
#include <benchmark/benchmark.h>
#include <sys/resource.h>
#include <unistd.h>

#include <Eigen/Cholesky>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <memory>
#include <string>

#include "assets/pc2.h"
#include "assets/shape_reader.h"
#include "base/parallel.h"
#include "bench/over_large.h"
#include "bench/randomised_svd.h"
#include "bench/subdivide.h"
#include "dataset/dataset.h"
#include "runtime/core/error.h"
#include "runtime/cpu/kernels.h"
#include "trainer/train/data/samples.h"
#include "trainer/train/fit/train.h"
#include "trainer/train/skinning/mesh_table.h"
#include "trainer/train/skinning/unpose.h"

namespace bodyopt::bench {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kVertices = 30000;

// What a task took: seconds, and processor seconds of all cores, which other work beside changes less.
struct Cost {
  double seconds = 0, core_seconds = 0;
};

class CostWatch {
 public:
  Cost cost() const {
    return {std::chrono::duration<double>(Clock::now() - start_).count(), core_seconds() - start_core_seconds_};
  }

 private:
  using Clock = std::chrono::steady_clock;

  static double core_seconds() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    const auto seconds = [](const timeval& time) { return time.tv_sec + 1e-6 * time.tv_usec; };
    return seconds(usage.ru_utime) + seconds(usage.ru_stime);
  }

  Clock::time_point start_ = Clock::now();
  double start_core_seconds_ = core_seconds();
};

// The most that was resident since the last call of reset(), GiB; mapped files count as far as they are.
struct PeakMemory {
  static void reset() { std::ofstream("/proc/self/clear_refs") << "5"; }
  static double gib() {
    std::ifstream status("/proc/self/status");
    for (std::string word; status >> word;) {
      double kib = 0;
      if (word == "VmHWM:" && status >> kib) return kib / (1 << 20);
    }
    return 0;
  }
};

void write_shapes(const SampleSet& coarse, const Subdivision& fine, const fs::path& path) {
  Pc2Writer writer(path, fine.character.output_count(), static_cast<std::uint32_t>(coarse.train.size()));
  for (const Sample& sample : coarse.train) {
    writer.append(output_from_welded(fine.character, with_middles(sample.shape.read(), fine)));
  }
  writer.close();
}

// The training frames of a dataset in a finer skin. The cache has no name any more once it is open: it goes with the
// process, however that ends.
SampleSet finer(SampleSet set) {
  const Subdivision fine = halve_longest_edges(set.character, kVertices);
  const fs::path path = fs::temp_directory_path() / ("bodyopt_train_bench." + std::to_string(getpid()) + ".pc2");
  write_shapes(set, fine, path);
  const auto cache = std::make_shared<const ShapeCache>(std::make_shared<const ShapeReader>(path),
                                                        std::make_shared<const Character>(fine.character));
  fs::remove(path);
  for (std::size_t k = 0; k < set.train.size(); ++k) set.train[k].shape = {cache, static_cast<std::uint32_t>(k)};
  set.character = fine.character;
  set.regions.clear();  // painted on the coarse skin
  set.heldout.clear();
  return set;
}

const SampleSet& film() {
  static const SampleSet set =
      finer(read_samples(read_dataset(fs::path(std::getenv("BODYOPT_TRAIN_DATA")) / "dataset.json")));
  return set;
}

struct Training {
  Basis basis;
  Cost cost;
  double peak_gib = 0;
};

const Training& training() {
  const auto run = [] {
    film();
    PeakMemory::reset();
    const CostWatch watch;
    Basis basis = train(film(), {}).basis;
    return Training{std::move(basis), watch.cost(), PeakMemory::gib()};
  };
  static const Training result = run();
  return result;
}

// The un-posed motion of all frames, N x 3V, runtime order, metres: what the basis' components are of.
const RowMajorMatrix& unposed() {
  const auto unpose = [] {
    const Basis& basis = training().basis;
    const std::vector<std::uint32_t> order = morton_order(film().character.vertices);
    RowMajorMatrix motion(film().train.size(), 3 * order.size());
    parallel_for(film().train.size(), [&](std::size_t k) {
      const Sample& sample = film().train[k];
      const Positions delta = unpose_ddm(basis, sample.pose, in_order(sample.shape.read(), order));
      motion.row(static_cast<Eigen::Index>(k)) =
          Eigen::Map<const Eigen::RowVectorXd>(delta.data(), delta.size()).cast<float>();
    });
    return motion;
  };
  static const RowMajorMatrix motion = unpose();
  return motion;
}

Eigen::Index rank() { return training().basis.residual.coefficient_count(); }

// Millimetres, root mean square over frames and vertices, of what is left of the motion without coefficients (N x K)
// times components (K x 3V).
double left_mm(const Eigen::MatrixXf& coefficients, const RowMajorMatrix& components) {
  constexpr Eigen::Index kFrames = 64;
  const RowMajorMatrix& motion = unposed();
  double sum = 0;
  for (Eigen::Index first = 0; first < motion.rows(); first += kFrames) {
    const Eigen::Index count = std::min(kFrames, motion.rows() - first);
    const RowMajorMatrix left = motion.middleRows(first, count) - coefficients.middleRows(first, count) * components;
    for (Eigen::Index k = 0; k < count; ++k) sum += static_cast<double>(left.row(k).squaredNorm());
  }
  return 1e3 * std::sqrt(3 * sum / static_cast<double>(motion.size()));
}

// What the basis' components leave, with the best coefficients there are.
double left_by_basis_mm() {
  const ResidualTable& residual = training().basis.residual;
  const RowMajorMatrix identity = RowMajorMatrix::Identity(rank(), rank());
  RowMajorMatrix components(rank(), unposed().cols());
  cpu::residual_blend(residual, {identity.data(), static_cast<std::size_t>(identity.size())},
                      static_cast<std::uint32_t>(rank()), 1,
                      {components.data(), static_cast<std::size_t>(components.size())});
  const Eigen::MatrixXd gram = (components * components.transpose()).cast<double>();
  const Eigen::MatrixXd products = (components * unposed().transpose()).cast<double>();
  const Eigen::MatrixXd best = gram.ldlt().solve(products);
  return left_mm(best.transpose().cast<float>(), components);
}

bool has_data(benchmark::State& state) {
  const char* folder = std::getenv("BODYOPT_TRAIN_DATA");
  if (folder != nullptr && fs::exists(fs::path(folder) / "dataset.json")) return true;
  state.SkipWithError("BODYOPT_TRAIN_DATA names no dataset");
  return false;
}

void report(benchmark::State& state, const Cost& cost) {
  state.SetIterationTime(cost.seconds);
  state.counters["core_s"] = cost.core_seconds;
}

// And how much longer training takes.
void report_peer(benchmark::State& state, const Cost& cost) {
  report(state, cost);
  state.counters["train_ratio"] = training().cost.seconds / cost.seconds;
  state.counters["train_core_ratio"] = training().cost.core_seconds / cost.core_seconds;
}

void BM_Train(benchmark::State& state) {
  if (!has_data(state)) return;
  for (auto _ : state) report(state, training().cost);
  state.counters["frames"] = static_cast<double>(film().train.size());
  state.counters["vertices"] = static_cast<double>(film().character.vertices.rows());
  state.counters["coefficients"] = static_cast<double>(rank());
  state.counters["bytes_per_vertex"] = static_cast<double>(total_bytes(training().basis)) / kVertices;
  state.counters["peak_gib"] = training().peak_gib;
}

// One pass over the data, with as many columns as the basis has coefficients.
void BM_Product(benchmark::State& state) {
  if (!has_data(state)) return;
  const Eigen::MatrixXf columns = Eigen::MatrixXf::Random(unposed().cols(), rank());
  Eigen::MatrixXf product;
  for (auto _ : state) {
    const CostWatch watch;
    product.noalias() = unposed() * columns;
    report_peer(state, watch.cost());
  }
  benchmark::DoNotOptimize(product.data());
}

void BM_RandomisedSvd(benchmark::State& state) {
  if (!has_data(state)) return;
  unposed();
  for (auto _ : state) {
    PeakMemory::reset();
    const CostWatch watch;
    const Svd svd = randomised_svd(unposed(), rank(), 1);
    report_peer(state, watch.cost());
    state.counters["peak_gib"] = PeakMemory::gib();
    state.counters["left_mm"] = left_mm(svd.u * svd.singular.asDiagonal(), svd.v.transpose());
  }
  state.counters["motion_mm"] =
      left_mm(Eigen::MatrixXf::Zero(unposed().rows(), 0), RowMajorMatrix(0, unposed().cols()));
  state.counters["left_by_basis_mm"] = left_by_basis_mm();
}

// Of every eighth frame of the dataset as it is.
void BM_OverLargeBasis(benchmark::State& state) {
  if (!has_data(state)) return;
  SampleSet set = read_samples(read_dataset(fs::path(std::getenv("BODYOPT_TRAIN_DATA")) / "dataset.json"));
  const std::vector<Sample> all = std::move(set.train);
  set.train.clear();
  for (std::size_t k = 0; k < all.size(); k += 8) set.train.push_back(all[k]);
  for (auto _ : state) {
    const CostWatch watch;
    const Basis basis = over_large_basis(set);
    report(state, watch.cost());
    state.counters["frames"] = static_cast<double>(set.train.size());
    state.counters["largest_mm"] = 1e3 * largest_distance(basis, set);
    state.counters["bytes_per_vertex"] = static_cast<double>(total_bytes(basis)) / basis.mesh.vertex_count();
  }
}

BENCHMARK(BM_Train)->Iterations(1)->UseManualTime()->Unit(benchmark::kSecond);
BENCHMARK(BM_Product)->Iterations(1)->UseManualTime()->Unit(benchmark::kSecond);
BENCHMARK(BM_RandomisedSvd)->Iterations(1)->UseManualTime()->Unit(benchmark::kSecond);
BENCHMARK(BM_OverLargeBasis)->Iterations(1)->UseManualTime()->Unit(benchmark::kSecond);

}  // namespace
}  // namespace bodyopt::bench

BENCHMARK_MAIN();
