#include "trainer/proxy/level_skins.h"

#include <cmath>
#include <cstdio>
#include <numeric>

#include "assets/wording.h"
#include "base/parallel.h"
#include "base/spread_evenly.h"
#include "geometry/extent.h"
#include "geometry/table_rows.h"
#include "runtime/core/error.h"
#include "runtime/core/transformed.h"
#include "runtime/deformer/deformer.h"
#include "runtime/host/carry_skin.h"
#include "runtime/host/device_choice.h"
#include "runtime/threads/tbb_executor.h"
#include "trainer/proxy/skin_map.h"
#include "trainer/train/data/unposed_shapes.h"

namespace bodyopt {
namespace {

constexpr double kFinestError =
    1.0 / 500;  // of the longest extent: with its map a human keeps within 15 % of the bytes
constexpr std::size_t kDefaultLevels = 3;
constexpr std::size_t kShapesOfSkin = 16;  // more give the same skins
constexpr std::size_t kFewestVertices = 100;

std::string millimetres(double metres) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g mm", 1e3 * metres);
  return text;
}

// Why so many vertices are no level after one of `before`; empty: they are.
std::string objection(std::size_t vertices, std::size_t before, double error) {
  const std::string what =
      "an error of " + millimetres(error) + " leaves " + std::to_string(vertices) + " vertices of the skin, ";
  if (vertices < kFewestVertices) {
    return what + "expected " + std::to_string(kFewestVertices) +
           " at least: the error is too large for this character";
  }
  if (vertices >= before) {
    return what + "no fewer than the " + std::to_string(before) +
           " before: levels need errors that differ more, or larger ones";
  }
  return "";
}

}  // namespace

std::vector<double> default_errors(const Character& character) {
  std::vector<double> errors = {kFinestError * longest_extent(character.vertices)};
  while (errors.size() < kDefaultLevels) errors.push_back(2 * errors.back());
  return errors;
}

std::vector<Positions> shapes_of_skin(const SampleSet& set) {
  std::vector<Positions> shapes = {set.character.vertices};
  for (const Sample& sample : some_samples(set.train, kShapesOfSkin)) shapes.push_back(sample.shape.read());
  return shapes;
}

std::vector<LevelSkin> level_skins(const Character& character, const std::vector<Positions>& shapes,
                                   const std::vector<double>& asked, std::vector<std::string>& notes) {
  std::vector<LevelSkin> skins;
  std::string problems;
  for (const double error : asked.empty() ? default_errors(character) : asked) {
    SimplifiedSkin skin = simplify_skin(character, shapes, error);
    const std::size_t before =
        skins.empty() ? static_cast<std::size_t>(character.vertices.rows()) : skins.back().skin.vertices.size();
    const std::string problem = objection(skin.vertices.size(), before, error);
    if (problem.empty()) {
      skins.push_back({error, std::move(skin)});
    } else if (!asked.empty()) {
      throw Error(ErrorKind::usage, problem);
    } else {
      problems += (problems.empty() ? "" : "; ") + problem;
      if (skin.vertices.size() < kFewestVertices) break;  // larger errors leave fewer yet
    }
  }
  if (skins.empty()) throw Error(ErrorKind::usage, problems);
  if (!problems.empty()) {
    const std::string verb = skins.size() == 1 ? "there is only " : "there are only ";
    notes.push_back(verb + count_of(skins.size(), "level", "levels") + ": " + problems);
  }
  return skins;
}

double carried_rms_mm(const Level& level, const Character& full, const std::vector<Sample>& samples,
                      const std::vector<Sample>& proxy) {
  const MeshTable& mesh = level.basis.mesh;
  std::vector<double> sums(samples.size());
  parallel_for(samples.size(), [&](std::size_t n) {
    std::vector<float> vertices(mesh.rest.size());
    const Positions shape = proxy[n].shape.read();
    for (std::size_t o = 0; o < mesh.output_vertex.size(); ++o) {
      for (int i = 0; i < 3; ++i) {
        vertices[3 * std::size_t{mesh.output_vertex[o]} + static_cast<std::size_t>(i)] =
            static_cast<float>(shape(static_cast<Eigen::Index>(o), i));
      }
    }
    const ShownSkin skin = show_skin(mesh, vertices);
    const std::vector<float> carried = carry_skin(mesh, level.carried, skin.positions, skin.normals);
    sums[n] = (welded_from_output(full, carried.data()) - samples[n].shape.read()).squaredNorm();
  });
  const double count = static_cast<double>(samples.size()) * static_cast<double>(full.vertices.rows());
  return 1e3 * std::sqrt(std::accumulate(sums.begin(), sums.end(), 0.0) / count);
}

ErrorStatistics level_errors(const Level& level, const Character& full, const std::vector<Sample>& samples) {
  Deformer deformer(level.basis, {.name = "cpu"});
  const std::unique_ptr<Executor> threads = make_tbb_executor();
  ErrorAccumulator errors(static_cast<std::uint32_t>(full.vertices.rows()));
  for (const Sample& sample : samples) {
    const Evaluation frame = deformer.evaluate({&sample.pose, 1});
    const std::vector<float> carried =
        carry_skin(level.basis.mesh, level.carried, frame.positions, frame.normals, *threads);
    errors.add(sample.frame, floats_of(welded_from_output(full, carried.data())), floats_of(sample.shape.read()));
  }
  return errors.finish();
}

std::vector<Sample> some_samples(const std::vector<Sample>& samples, std::size_t most) {
  return transformed(spread_evenly(samples.size(), most), [&](const std::size_t k) { return samples[k]; });
}

}  // namespace bodyopt
