#include "trainer/proxy/level_skins.h"

#include <cstdio>

#include "assets/wording.h"
#include "geometry/extent.h"
#include "runtime/core/error.h"
#include "trainer/proxy/level_errors.h"
#include "trainer/train/skinning/mesh_table.h"

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

}  // namespace bodyopt
