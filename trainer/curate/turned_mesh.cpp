#include "trainer/curate/turned_mesh.h"

#include <algorithm>
#include <limits>

#include "assets/axis_turns.h"
#include "runtime/core/error.h"
#include "trainer/curate/match_vertices.h"

namespace bodyopt {
namespace {

constexpr double kOtherExtent = 0.1;  // of the size: how far a sculpt hardly moves the skin's extent
constexpr double kTurnedBack = 0.25;  // of that as it is: what turning leaves of it where the mesh is turned

// 3 x 3, of ones and zeros.
Eigen::Matrix3d matrix_of(const Quat& turn) {
  Eigen::Matrix3d matrix;
  for (int axis = 0; axis < 3; ++axis) {
    Vec3 unit{};
    unit[static_cast<std::size_t>(axis)] = 1;
    const Vec3 turned = rotate(turn, unit);
    matrix.col(axis) = Eigen::Vector3d(turned[0], turned[1], turned[2]).array().round();
  }
  return matrix;
}

// How far the sides of the boxes around two sets of points are apart at most, as a part of the first's diagonal.
double extents_apart(const Positions& known, const Positions& given) {
  const Eigen::RowVector3d low = known.colwise().minCoeff(), high = known.colwise().maxCoeff();
  const double apart = std::max((given.colwise().minCoeff() - low).cwiseAbs().maxCoeff(),
                                (given.colwise().maxCoeff() - high).cwiseAbs().maxCoeff());
  return apart / std::max((high - low).norm(), std::numeric_limits<double>::min());
}

double extents_apart(std::span<const WrittenSkin> written, const Positions& given) {
  double least = std::numeric_limits<double>::infinity();
  for (const WrittenSkin& one : written) least = std::min(least, extents_apart(one.skin, given));
  return least;
}

bool lies_on_one(std::span<const WrittenSkin> written, const Positions& given) {
  return std::ranges::any_of(written, [&](const WrittenSkin& one) {
    return 2 * vertices_in_place(one.skin, given, unmoved_distance(one.skin)) >= static_cast<std::size_t>(given.rows());
  });
}

}  // namespace

Eigen::Matrix3d turn_back(std::span<const WrittenSkin> written, const Positions& given,
                          const std::filesystem::path& path) {
  const Eigen::Matrix3d none = Eigen::Matrix3d::Identity();
  if (given.rows() == 0) return none;
  const double as_it_is = extents_apart(written, given);
  if (as_it_is < kOtherExtent) return none;
  bool may_be_turned = false;
  for (const Quat& turn : axis_turns()) {
    const Eigen::Matrix3d matrix = matrix_of(turn);
    const Positions turned = given * matrix.transpose();
    if (extents_apart(written, turned) > kTurnedBack * as_it_is) continue;
    if (lies_on_one(written, turned)) return matrix;
    may_be_turned = true;
  }
  if (!may_be_turned) return none;
  throw Error(ErrorKind::mismatch,
              path.string() +
                  ": the mesh is as high as the frame is deep or wide: it was written with another axis up, or "
                  "turned, and too little of it lies where it was to tell how (write it with Y up, as it was exported; "
                  "Blender's export has 'Up')");
}

}  // namespace bodyopt
