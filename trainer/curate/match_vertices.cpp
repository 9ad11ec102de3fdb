#include "trainer/curate/match_vertices.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <utility>

#include "assets/clips/axis_turns.h"
#include "base/wording.h"
#include "geometry/spatial_search.h"
#include "runtime/core/error.h"

namespace bodyopt::trainer {
namespace {

using Eigen::Index;
// The corner that a triangle has beside a directed edge; -1 where two triangles claim it.
using Opposite = std::map<std::pair<std::uint32_t, std::uint32_t>, int>;

Opposite opposite_corners(const Triangles& triangles) {
  Opposite corners;
  for (Index t = 0; t < triangles.rows(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const std::pair edge(triangles(t, k), triangles(t, (k + 1) % 3));
      const auto [there, added] = corners.emplace(edge, static_cast<int>(triangles(t, (k + 2) % 3)));
      if (!added) there->second = -1;
    }
  }
  return corners;
}

constexpr int kDisputed = -2;

// Points that have an owner each, to be found by places.
class OwnedPoints {
 public:
  OwnedPoints(Positions points, std::vector<int> owners, double tolerance)
      : points_(std::move(points)),
        owners_(std::move(owners)),
        tolerance_(tolerance),
        grid_(points_, all(), tolerance) {}
  // The one owner of points within the tolerance, -1 where there is none or are several.
  int only_owner_at(const Eigen::RowVector3d& place) const {
    int found = -1;
    bool several = false;
    const Eigen::RowVector3d reach = Eigen::RowVector3d::Constant(tolerance_);
    grid_.visit(place - reach, place + reach, [&](int n) {
      if ((points_.row(n) - place).norm() > tolerance_) return;
      const int owner = owners_[static_cast<std::size_t>(n)];
      several = several || (found >= 0 && found != owner);
      found = owner;
    });
    return several ? -1 : found;
  }

 private:
  std::vector<int> all() const {
    std::vector<int> all(owners_.size());
    std::iota(all.begin(), all.end(), 0);
    return all;
  }

  Positions points_;
  std::vector<int> owners_;
  double tolerance_;
  PointGrid grid_;
};

// Takes over what was found of those that are not matched yet: of a known vertex that one alone claims.
void claim(const std::vector<int>& found, std::vector<int>& match, std::vector<char>& taken) {
  std::vector<int> claims(taken.size(), 0);
  const auto is_open = [&](std::size_t v) {
    return match[v] < 0 && found[v] >= 0 && !taken[static_cast<std::size_t>(found[v])];
  };
  for (std::size_t v = 0; v < found.size(); ++v) {
    if (is_open(v)) ++claims[static_cast<std::size_t>(found[v])];
  }
  for (std::size_t v = 0; v < found.size(); ++v) {
    if (is_open(v) && claims[static_cast<std::size_t>(found[v])] == 1) match[v] = found[v];
  }
  for (const int known : match) {
    if (known >= 0) taken[static_cast<std::size_t>(known)] = true;
  }
}

std::vector<int> by_place(const Positions& known, const Positions& given, double tolerance) {
  std::vector<int> owners(static_cast<std::size_t>(known.rows()));
  std::iota(owners.begin(), owners.end(), 0);
  const OwnedPoints points(known, std::move(owners), tolerance);
  std::vector<int> found;
  for (Index v = 0; v < given.rows(); ++v) found.push_back(points.only_owner_at(given.row(v)));
  return found;
}

std::vector<int> by_texture(const TexturedSurface& known, const TexturedSurface& given) {
  constexpr double kSame = 2e-6;  // files round to six digits
  Positions places(static_cast<Index>(known.texture.size()), 3);
  std::vector<int> owners;
  for (const TexturedVertex& at : known.texture) {
    places.row(static_cast<Index>(owners.size())) << at.u, at.v, 0;
    owners.push_back(static_cast<int>(at.vertex));
  }
  std::vector<int> found(static_cast<std::size_t>(given.vertices.rows()), -1);
  if (owners.empty()) return found;
  const OwnedPoints points(std::move(places), std::move(owners), kSame);
  for (const TexturedVertex& at : given.texture) {
    const int owner = points.only_owner_at(Eigen::RowVector3d(at.u, at.v, 0));
    int& known_vertex = found[at.vertex];
    if (owner < 0 || known_vertex == owner) continue;
    known_vertex = known_vertex == -1 ? owner : kDisputed;
  }
  return found;
}

// The third corner of triangles of which two are known. Whether any was found.
bool grow(const Opposite& opposite, const Triangles& given, std::vector<int>& match, std::vector<char>& taken) {
  bool grown = false;
  for (Index t = 0; t < given.rows(); ++t) {
    for (int k = 0; k < 3; ++k) {
      int& third = match[given(t, (k + 2) % 3)];
      const int a = match[given(t, k)], b = match[given(t, (k + 1) % 3)];
      if (third >= 0 || a < 0 || b < 0) continue;
      const auto found = opposite.find({static_cast<std::uint32_t>(a), static_cast<std::uint32_t>(b)});
      if (found == opposite.end() || found->second < 0 || taken[static_cast<std::size_t>(found->second)]) continue;
      third = found->second;
      taken[static_cast<std::size_t>(third)] = true;
      grown = true;
    }
  }
  return grown;
}

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

std::size_t vertices_in_place(const Positions& known, const Positions& given, double tolerance) {
  const std::vector<int> found = by_place(known, given, tolerance);
  return static_cast<std::size_t>(std::ranges::count_if(found, [](int vertex) { return vertex >= 0; }));
}

std::vector<int> match_vertices(const TexturedSurface& known, const TexturedSurface& given, double tolerance) {
  std::vector<char> taken(static_cast<std::size_t>(known.vertices.rows()), false);
  std::vector<int> match(static_cast<std::size_t>(given.vertices.rows()), -1);
  claim(by_place(known.vertices, given.vertices, tolerance), match, taken);
  claim(by_texture(known, given), match, taken);
  const Opposite opposite = opposite_corners(known.triangles);
  while (grow(opposite, given.triangles, match, taken)) {
  }
  return match;
}

Eigen::Matrix3d turn_back(std::span<const WrittenSkin> written, const Positions& given,
                          const std::filesystem::path& path) {
  Eigen::Matrix3d none = Eigen::Matrix3d::Identity();
  if (given.rows() == 0) return none;
  const double as_it_is = extents_apart(written, given);
  if (as_it_is < kOtherExtent) return none;
  bool may_be_turned = false;
  for (const Quat& turn : axis_turns()) {
    Eigen::Matrix3d matrix = matrix_of(turn);
    const Positions turned = given * matrix.transpose();
    if (extents_apart(written, turned) > kTurnedBack * as_it_is) continue;
    if (lies_on_one(written, turned)) return matrix;
    may_be_turned = true;
  }
  if (!may_be_turned) return none;
  throw Error(ErrorKind::mismatch, path,
              ": the mesh is as high as the frame is deep or wide: it was written with another axis up, or "
              "turned, and too little of it lies where it was to tell how (write it with Y up, as it was exported; "
              "Blender's export has 'Up')");
}

}  // namespace bodyopt::trainer
