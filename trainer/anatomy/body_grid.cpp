#include "trainer/anatomy/body_grid.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "geometry/mend_surface.h"
#include "geometry/mesh.h"
#include "runtime/core/error.h"

namespace bodyopt::trainer {
namespace {

using Eigen::Index;
using Eigen::Vector3d;
using Eigen::Vector3i;

constexpr double kReferenceCell = 0.005, kReferenceVolume = 0.06;  // metres, cubic metres
constexpr double kFewestCells = 60, kMostCells = 1000;             // along the longest side of a body

// Columns of cells along one axis, and how the skin winds about their cells.
class Columns {
 public:
  Columns(const HalfBody& body, const BodyGrid& grid, int axis)
      : grid_(grid), along_(axis), first_((axis + 1) % 3), second_((axis + 2) % 3), rows_(grid.count[along_] + 1) {
    winding_.assign(static_cast<std::size_t>(grid.count[first_] * grid.count[second_]) * rows_, 0);
    const double outwards = enclosed_volume(body.vertices, body.triangles) < 0 ? -1 : 1;
    for (Index t = 0; t < body.triangles.rows(); ++t) {
      add_crossings(corners_of(body.vertices, body.triangles, t), outwards);
    }
    for (std::size_t n = 0; n < winding_.size(); ++n) {
      if (n % rows_ != 0) winding_[n] += winding_[n - 1];
    }
  }

  bool is_inside(const Vector3i& cell) const {
    return winding_[place(cell) + static_cast<std::size_t>(cell[along_])] > 0;
  }
  // Does a line along the column leave the skin as often as it enters?
  bool is_closed(const Vector3i& cell) const { return winding_[place(cell) + rows_ - 1] == 0; }

 private:
  std::size_t place(const Vector3i& cell) const {
    return static_cast<std::size_t>(cell[first_] * grid_.count[second_] + cell[second_]) * rows_;
  }
  // Lines run a little beside the cells' middles, where a modeller's round numbers have no edges.
  double line(int axis, int cell) const {
    const double beside = axis == first_ ? 1.37e-5 : 0.96e-5;
    return grid_.low[axis] + (cell + 0.5 + beside) * grid_.cell;
  }

  void add_crossings(const std::array<Vector3d, 3>& corners, double outwards) {
    const auto [a, b, c] = corners;
    const auto cross = [&](const Vector3d& u, const Vector3d& v) {
      return u[first_] * v[second_] - u[second_] * v[first_];
    };
    const double area = cross(b - a, c - a);
    if (area == 0) return;
    Vector3i from = Vector3i::Zero(), to = Vector3i::Zero();
    for (const int axis : {first_, second_}) {
      const auto [low, high] = std::minmax({a[axis], b[axis], c[axis]});
      from[axis] = std::max(0, static_cast<int>(std::floor((low - grid_.low[axis]) / grid_.cell)) - 1);
      to[axis] = std::min(grid_.count[axis], static_cast<int>(std::floor((high - grid_.low[axis]) / grid_.cell)) + 1);
    }
    Vector3d at = Vector3d::Zero();
    for (Vector3i cell = from; cell[first_] < to[first_]; ++cell[first_]) {
      at[first_] = line(first_, cell[first_]);
      for (cell[second_] = from[second_]; cell[second_] < to[second_]; ++cell[second_]) {
        at[second_] = line(second_, cell[second_]);
        const double u = cross(b - at, c - at) / area, v = cross(c - at, a - at) / area, w = 1 - u - v;
        if (u < 0 || v < 0 || w < 0) continue;
        const double crossing = (u * a[along_] + v * b[along_] + w * c[along_] - grid_.low[along_]) / grid_.cell;
        const auto row = std::clamp(std::ceil(crossing - 0.5), 0.0, static_cast<double>(grid_.count[along_]));
        winding_[place(cell) + static_cast<std::size_t>(row)] -= area * outwards > 0 ? 1 : -1;
      }
    }
  }

  const BodyGrid& grid_;
  int along_, first_, second_;
  std::size_t rows_;          // one more than cells: what is crossed beyond the last
  std::vector<int> winding_;  // columns x rows
};

// Cells around the skin, its half's.
BodyGrid empty_grid(const HalfBody& body, double cell) {
  BodyGrid grid;
  grid.cell = cell;
  const Vector3d lowest = body.vertices.colwise().minCoeff(), highest = body.vertices.colwise().maxCoeff();
  grid.low = ((lowest.array() / cell).floor() - 2) * cell;
  if (body.has_plane) grid.low.x() = 0;
  grid.count = ((highest - grid.low).array() / cell).ceil().cast<int>() + 2;
  grid.count = grid.count.cwiseMax(1);
  return grid;
}

// Columns along z decide; where the skin has a hole, those along x and y.
void fill(const HalfBody& body, BodyGrid& grid) {
  const std::array<Columns, 3> columns{Columns(body, grid, 2), Columns(body, grid, 0), Columns(body, grid, 1)};
  bool is_closed = true;
  grid.sample.assign(static_cast<std::size_t>(grid.count.prod()), -1);
  auto next = grid.sample.begin();
  for (int x = 0; x < grid.count.x(); ++x) {
    for (int y = 0; y < grid.count.y(); ++y) {
      for (int z = 0; z < grid.count.z(); ++z, ++next) {
        const Vector3i cell(x, y, z);
        const auto closed = std::ranges::find_if(columns, [&](const auto& c) { return c.is_closed(cell); });
        const auto is_open = [&](const auto& c) { return !c.is_closed(cell); };
        is_closed = is_closed && std::ranges::none_of(columns, is_open);
        if (closed == columns.end() || !closed->is_inside(cell)) continue;
        *next = grid.size();
        grid.cells.push_back(cell);
      }
    }
  }
  if (is_closed) return;
  grid.notes.push_back(
      "the skin is not closed: some lines leave it more often than they enter it; what lies inside is told along other "
      "directions there");
}

}  // namespace

int BodyGrid::sample_at(const Vector3i& at) const {
  if ((at.array() < 0).any() || (at.array() >= count.array()).any()) return -1;
  return sample[static_cast<std::size_t>((at.x() * count.y() + at.y()) * count.z() + at.z())];
}

int BodyGrid::sample_at(const Vector3d& point) const {
  const Vector3d at = (point - low) / cell;
  if (!(at.array() >= 0).all() || !(at.array() < count.cast<double>().array()).all()) return -1;
  return sample_at(Vector3i(at.cast<int>()));
}

std::array<int, 6> BodyGrid::beside(int at) const {
  std::array<int, 6> samples{};
  for (int k = 0; k < 6; ++k) {
    Vector3i place = cells[static_cast<std::size_t>(at)];
    place[k / 2] += k % 2 == 0 ? -1 : 1;
    samples[static_cast<std::size_t>(k)] = sample_at(place);
  }
  return samples;
}

double BodyGrid::on_skin(const Eigen::VectorXd& values, int at) const {
  return at_point(values, skin[static_cast<std::size_t>(at)]);
}

BodyGrid sample_body(const HalfBody& body, double cell) {
  BodyGrid grid;
  if (body.triangles.rows() > 0 && body.vertices.allFinite()) {
    grid = empty_grid(body, cell);
    fill(body, grid);
  }
  if (grid.size() == 0) {
    throw Error(ErrorKind::mismatch,
                concat("the skin encloses no volume to look into: expected a closed surface, found ",
                       body.triangles.rows(), " triangles with nothing between them (a sheet, or missing faces)"),
                ErrorCause::flat);
  }
  const auto count = static_cast<std::size_t>(grid.size());
  grid.points.resize(grid.size(), 3);
  grid.depth.resize(grid.size());
  grid.skin.resize(count);
  const NearestSkin nearest(body.vertices, body.triangles);
  parallel_for_short(count, [&](std::size_t s) {
    const Vector3d point = grid.low + cell * (grid.cells[s].cast<double>().array() + 0.5).matrix();
    grid.points.row(static_cast<Index>(s)) = point.transpose();
    grid.skin[s] = nearest(point);
    grid.depth[static_cast<Index>(s)] = (grid.skin[s].position - point).norm();
  });
  return grid;
}

double default_cell(const Character& character) {
  const double volume = std::abs(enclosed_volume(character.vertices, character.triangles));
  const double extent = longest_extent(character.vertices);
  return std::clamp(kReferenceCell * std::cbrt(volume / kReferenceVolume), extent / kMostCells, extent / kFewestCells);
}

}  // namespace bodyopt::trainer
