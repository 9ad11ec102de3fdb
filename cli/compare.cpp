// bodyopt compare: how far two caches are apart.
#include "dataset/compare.h"

#include <spdlog/spdlog.h>

#include <limits>
#include <nlohmann/json.hpp>

#include "base/progress.h"
#include "cli/arguments/common.h"
#include "runtime/core/error.h"
#include "trainer/curate/named_shapes.h"

namespace bodyopt::cli {
namespace {

struct CompareArguments {
  std::string a, b;
  double fail_above = std::numeric_limits<double>::infinity();
  JsonOption json;
};

void run(const CompareArguments& arguments) {
  arguments.json.require_writable();
  const trainer::NamedShapes a(arguments.a), b(arguments.b);
  if (a.point_count() != b.point_count() || a.sample_count() != b.sample_count()) {
    throw Error(ErrorKind::mismatch,
                format("{} has {} points and {} samples, {} has {} points and {} samples: they are caches of different "
                       "meshes or frame ranges",
                       arguments.a, a.point_count(), a.sample_count(), arguments.b, b.point_count(), b.sample_count()));
  }
  if (a.start_frame() != b.start_frame() || a.sample_rate() != b.sample_rate()) {
    spdlog::warn("{} starts at frame {} and has one frame in {}, {} at {} and one in {}: are they of the same frames?",
                 arguments.a, a.start_frame(), a.sample_rate(), arguments.b, b.start_frame(), b.sample_rate());
  }
  ErrorAccumulator accumulator(a.point_count());
  Progress progress("compare", a.sample_count());
  for (std::uint32_t k = 0; k < a.sample_count(); ++k) {
    accumulator.add(static_cast<int>(k), a.sample(k), b.sample(k));
    progress.advance();
  }
  const ErrorStatistics errors = accumulator.finish();
  Json result = to_json(errors);
  result["worst_sample"] = errors.worst_frame;
  result["worst_vertex"] = errors.worst_vertex;
  result["samples"] = a.sample_count();
  result["points"] = a.point_count();
  arguments.json.emit(result, describe(errors) + format("\nworst: sample {} (counted from 0), vertex {}\n",
                                                        errors.worst_frame, errors.worst_vertex));
  if (errors.max > arguments.fail_above) {
    throw Error(ErrorKind::quality,
                format("the maximum of {:.4f} mm is above the limit of {:g} mm (sample {}, vertex {})", errors.max,
                       arguments.fail_above, errors.worst_frame, errors.worst_vertex));
  }
}

}  // namespace

void add_compare(CLI::App& app) {
  const auto [verb, arguments] = add_verb<CompareArguments>(
      app, "compare", "Measure the distance between two caches: RMS, p99, maximum and jitter in mm", run);
  add_required(verb, "a", arguments.a, "A",
               "Point cache (.pc2, .mdd), draft (.nodes), or DATASET#TAKE: a take through its modifiers");
  add_required(verb, "b", arguments.b, "B", "The same of the same mesh and frames");
  add_option(verb, "--fail-above", arguments.fail_above, "Exit with 2 when the maximum is above MM millimetres")
      ->type_name("MM")
      ->check(number_from(0, std::numeric_limits<double>::infinity()));
  arguments.json.add(verb);
}

}  // namespace bodyopt::cli
