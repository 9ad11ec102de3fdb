// Training at film size: a dataset's skin made finer, and trained.
#include <benchmark/benchmark.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>
#include <memory>
#include <string>

#include "assets/caches/pc2.h"
#include "assets/caches/shape_reader.h"
#include "bench/subdivide.h"
#include "dataset/dataset.h"
#include "runtime/core/error.h"
#include "runtime/core/stopwatch.h"
#include "trainer/train/data/samples.h"
#include "trainer/train/fit/train.h"

namespace bodyopt::bench {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kVertices = 30000;

// The cost of a task: seconds, and processor seconds of all cores, which other work beside changes less.
struct Cost {
  double seconds = 0, core_seconds = 0;
};

class CostWatch {
 public:
  Cost cost() const { return {watch_.seconds(), core_seconds() - start_core_seconds_}; }

 private:
  static double core_seconds() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    const auto seconds = [](const timeval& time) { return time.tv_sec + 1e-6 * time.tv_usec; };
    return seconds(usage.ru_utime) + seconds(usage.ru_stime);
  }

  Stopwatch watch_;
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

void write_shapes(const trainer::SampleSet& coarse, const Subdivision& fine, const fs::path& path) {
  Pc2Writer writer(path, fine.character.output_count(), static_cast<std::uint32_t>(coarse.train.size()));
  for (const trainer::Sample& sample : coarse.train) {
    writer.append(output_from_welded(fine.character, with_middles(sample.shape.read(), fine)));
  }
  writer.close();
}

// The training frames of a dataset in a finer skin. The cache has no name any more once it is open: it goes with the
// process, however that ends.
trainer::SampleSet finer(trainer::SampleSet set) {
  const Subdivision fine = halve_longest_edges(set.character, kVertices);
  const fs::path path = fs::temp_directory_path() / ("bodyopt_train_bench." + std::to_string(getpid()) + ".pc2");
  write_shapes(set, fine, path);
  const auto cache = std::make_shared<const trainer::ShapeCache>(std::make_shared<const ShapeReader>(path),
                                                                 std::make_shared<const Character>(fine.character));
  fs::remove(path);
  for (std::size_t k = 0; k < set.train.size(); ++k) set.train[k].shape = {cache, static_cast<std::uint32_t>(k)};
  set.character = fine.character;
  set.regions.clear();  // painted on the coarse skin
  set.heldout.clear();
  return set;
}

const trainer::SampleSet& film() {
  static const trainer::SampleSet set =
      finer(trainer::read_samples(read_dataset(fs::path(std::getenv("BODYOPT_TRAIN_DATA")) / "dataset.json")));
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
    Basis basis = trainer::train(film(), {}).basis;
    return Training{std::move(basis), watch.cost(), PeakMemory::gib()};
  };
  static const Training result = run();
  return result;
}

bool has_data(benchmark::State& state) {
  const char* folder = std::getenv("BODYOPT_TRAIN_DATA");
  if (folder != nullptr && fs::exists(fs::path(folder) / "dataset.json")) return true;
  state.SkipWithError("BODYOPT_TRAIN_DATA names no dataset");
  return false;
}

void BM_Train(benchmark::State& state) {
  if (!has_data(state)) return;
  for (auto _ : state) {
    state.SetIterationTime(training().cost.seconds);
    state.counters["core_s"] = training().cost.core_seconds;
  }
  state.counters["frames"] = static_cast<double>(film().train.size());
  state.counters["vertices"] = static_cast<double>(film().character.vertices.rows());
  state.counters["coefficients"] = training().basis.residual.coefficient_count();
  state.counters["bytes_per_vertex"] = static_cast<double>(total_bytes(training().basis)) / kVertices;
  state.counters["peak_gib"] = training().peak_gib;
}

BENCHMARK(BM_Train)->Iterations(1)->UseManualTime()->Unit(benchmark::kSecond);

}  // namespace
}  // namespace bodyopt::bench

BENCHMARK_MAIN();
