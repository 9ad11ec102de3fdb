#include "assets/gltf/gltf_unit.h"

#include <algorithm>
#include <cmath>

#include "assets/gltf/gltf_skeleton.h"
#include "assets/gltf/gltf_skin.h"
#include "base/wording.h"
#include "runtime/core/error.h"

namespace bodyopt {
namespace {

constexpr double kSmallestDiagonal = 0.05, kLargestDiagonal = 50, kPerson = 2;  // metres

bool has_a_size(double diagonal) { return diagonal >= kSmallestDiagonal && diagonal <= kLargestDiagonal; }

// The common unit by which the diagonal is nearest to a person's.
double likely_unit(double diagonal) {
  const auto off = [&](double unit) { return std::abs(std::log(unit * diagonal / kPerson)); };
  double likely = 0.01;
  for (const double unit : {0.001, 1.0, 100.0, 1000.0}) likely = off(unit) < off(likely) ? unit : likely;
  return likely;
}

}  // namespace

double bounding_box_diagonal(const std::vector<Vec3>& points) {
  if (points.empty()) return 0;
  Vec3 low = points[0], high = points[0];
  for (const Vec3& p : points) {
    for (std::size_t i = 0; i < 3; ++i) {
      low[i] = std::min(low[i], p[i]);
      high[i] = std::max(high[i], p[i]);
    }
  }
  return length(high - low);
}

double file_unit(const GltfFile& file, double given, std::vector<std::string>& notes) {
  if (!(given >= 0) || !std::isfinite(given)) {
    throw Error(ErrorKind::usage, "a unit is a positive number of metres, not ", rounded(given));
  }
  const int skin = choose_skin(file);
  if (skin < 0) return given == 0 ? 1 : given;
  std::vector<std::string> unused;
  const double scale = std::cbrt(std::abs(determinant(read_skin_skeleton(file, skin, 1, unused).rest)));
  const double diagonal = scale * bounding_box_diagonal(read_skin_positions(file, skin)),
               metres = (given == 0 ? 1 : given) * diagonal;
  if (!(metres > 0) || !std::isfinite(metres)) file.fail("all vertices of the skin lie at one point");
  if (has_a_size(metres)) return given == 0 ? 1 : given;
  const double likely = likely_unit(diagonal);
  if (given != 0) {
    const std::string scaled = std::abs(scale - 1) > 1e-3 ? ": its joints scale it by " + rounded(scale) : "";
    const std::string advice = ": of a person it would be likely " + rounded(likely) + " m (--unit" + scaled + ")";
    notes.push_back("With a unit of " + rounded(given) + " m the skin's bounding box measures " + rounded(metres) +
                    " m from corner to corner, outside " + rounded(kSmallestDiagonal) + " to " +
                    rounded(kLargestDiagonal) + " m" + (has_a_size(likely * diagonal) ? advice : "") + ".");
    return given;
  }
  if (!has_a_size(likely * diagonal)) {
    file.fail("the skin's bounding box measures ", rounded(diagonal), " from corner to corner, ",
              rounded(diagonal / kPerson), " times a person's 2 metres; expected metres (", rounded(kSmallestDiagonal),
              " to ", rounded(kLargestDiagonal), "). Say what a unit is (--unit)");
  }
  notes.push_back("The skin's bounding box measures " + rounded(diagonal) +
                  " units of the file from corner to corner: a unit is taken as " + rounded(likely) +
                  " m (--unit says another).");
  return likely;
}

}  // namespace bodyopt
