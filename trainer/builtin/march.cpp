#include "trainer/builtin/march.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <unordered_map>

namespace bodyopt {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3i;

constexpr int kBlock = 4;  // cubes per side of a block that is skipped as a whole when far from the surface

// The cube's corners by bit: x 1, y 2, z 4. Six tetrahedra around the diagonal 0-7 (Kuhn); neighbours agree on faces.
constexpr int kTets[6][4] = {{0, 1, 3, 7}, {0, 3, 2, 7}, {0, 2, 6, 7}, {0, 6, 4, 7}, {0, 4, 5, 7}, {0, 5, 1, 7}};

class Marcher {
 public:
  Marcher(const Solid& solid, const Vector3d& low, const Vector3d& high, double step, double depth)
      : solid_(solid), low_(low), step_(step), depth_(depth) {
    for (int k = 0; k < 3; ++k) cubes_[k] = kBlock * static_cast<int>(std::ceil((high - low)[k] / (step * kBlock)));
    values_.assign(static_cast<std::size_t>(cubes_.x() + 1) * (cubes_.y() + 1) * (cubes_.z() + 1),
                   std::numeric_limits<double>::quiet_NaN());
  }

  Surface run() {
    const double reach = 1.25 * std::sqrt(3.0) * 0.5 * kBlock * step_;
    for (int z = 0; z < cubes_.z(); z += kBlock) {
      for (int y = 0; y < cubes_.y(); y += kBlock) {
        for (int x = 0; x < cubes_.x(); x += kBlock) {
          const Vector3d centre = low_ + step_ * Vector3d(x + 0.5 * kBlock, y + 0.5 * kBlock, z + 0.5 * kBlock);
          if (std::abs(solid_.distance(centre) + depth_) < reach) march_block({x, y, z});
        }
      }
    }
    return std::move(surface_);
  }

 private:
  int node(const Vector3i& at) const { return at.x() + (cubes_.x() + 1) * (at.y() + (cubes_.y() + 1) * at.z()); }

  Vector3d position(int n) const {
    const int row = cubes_.x() + 1, column = cubes_.y() + 1;
    return low_ + step_ * Vector3d(n % row, n / row % column, n / row / column);
  }

  double value(int n) {
    if (std::isnan(values_[n])) values_[n] = solid_.distance(position(n)) + depth_;
    return values_[n];
  }

  void march_block(const Vector3i& first) {
    for (int z = 0; z < kBlock; ++z) {
      for (int y = 0; y < kBlock; ++y) {
        for (int x = 0; x < kBlock; ++x) march_cube(first + Vector3i(x, y, z));
      }
    }
  }

  void march_cube(const Vector3i& first) {
    int corners[8];
    for (int c = 0; c < 8; ++c) corners[c] = node(first + Vector3i(c & 1, c >> 1 & 1, c >> 2));
    for (const auto& tet : kTets) march_tet({corners[tet[0]], corners[tet[1]], corners[tet[2]], corners[tet[3]]});
  }

  // Corners of a positively oriented tetrahedron, inside ones first: swaps in pairs keep the orientation.
  void march_tet(std::array<int, 4> n) {
    int inside = 0;
    bool odd = false;
    for (int k = 0; k < 4; ++k) {
      if (value(n[k]) >= 0) continue;
      if (k != inside) {
        std::swap(n[k], n[inside]);
        odd = !odd;
      }
      ++inside;
    }
    if (inside == 0 || inside == 4) return;
    if (odd) {
      const int pair = inside == 3 ? 0 : 2;  // two corners on the same side of the surface
      std::swap(n[pair], n[pair + 1]);
    }
    if (inside == 1) {
      add(crossing(n[0], n[1]), crossing(n[0], n[2]), crossing(n[0], n[3]));
    } else if (inside == 3) {
      add(crossing(n[0], n[3]), crossing(n[1], n[3]), crossing(n[2], n[3]));
    } else {
      const int a = crossing(n[0], n[2]), b = crossing(n[0], n[3]), c = crossing(n[1], n[3]), d = crossing(n[1], n[2]);
      add(a, b, c);
      add(a, c, d);
    }
  }

  void add(int a, int b, int c) { surface_.triangles.push_back({a, b, c}); }

  int crossing(int a, int b) {
    const auto [low, high] = std::minmax(a, b);
    const auto [found, fresh] = crossings_.try_emplace(
        static_cast<std::uint64_t>(low) << 32 | static_cast<unsigned>(high), static_cast<int>(surface_.points.size()));
    if (fresh) {
      // Kept away from the nodes, so that no triangle vanishes.
      const double t = std::clamp(value(low) / (value(low) - value(high)), 0.05, 0.95);
      surface_.points.push_back((1 - t) * position(low) + t * position(high));
    }
    return found->second;
  }

  const Solid& solid_;
  Vector3d low_;
  double step_;
  double depth_;
  Vector3i cubes_;
  std::vector<double> values_;
  std::unordered_map<std::uint64_t, int> crossings_;
  Surface surface_;
};

}  // namespace

Surface march(const Solid& solid, const Vector3d& low, const Vector3d& high, double step, double depth) {
  return Marcher(solid, low, high, step, depth).run();
}

}  // namespace bodyopt
