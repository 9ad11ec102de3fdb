#include "trainer/anatomy/spine_curve.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "geometry/mesh.h"

namespace bodyopt::trainer {
namespace {

using Eigen::Vector3d;

constexpr int kRows = 80;
constexpr int kRowSmoothings = 4;

// How deep vertebrae lie below the back, as a share of the section's height.
struct SpineDepth {
  double tail, trunk, neck;
};
// They are in the order of BodyKind.
constexpr SpineDepth kUsualDepth{0.48, 0.2, 0.45};
constexpr SpineDepth kSpineDepths[] = {{0.5, 0.3, 0.45},  kUsualDepth, kUsualDepth, {0.4, 0.32, 0.35},
                                       {0.48, 0.38, 0.4}, kUsualDepth, kUsualDepth};

Vector3d in_plane(const BodyGrid& grid, const Vector3d& point) { return {grid.cell / 2, point.y(), point.z()}; }

bool is_in(const BodyGrid& grid, const Vector3d& point) { return grid.sample_at(point) >= 0; }

// Joints of the axis, moved to the median plane; for a joint outside the body, the middle of its skin.
struct Stop {
  Vector3d place;
  int joint;
};
std::vector<Stop> stops_of(const BodySurvey& survey, const JointChains& chains) {
  std::vector<Stop> stops;
  const double apart = 0.01 * longest_extent(survey.body().vertices);
  for (const int joint : chains.axis) {
    const auto j = static_cast<std::size_t>(joint);
    Vector3d place = in_plane(survey.grid(), survey.body().places[j]);
    if (!is_in(survey.grid(), place)) place = in_plane(survey.grid(), chains.centre[j]);
    if (!is_in(survey.grid(), place)) continue;
    if (stops.empty() || (place - stops.back().place).norm() > apart) stops.push_back({place, joint});
  }
  // Controls may stand anywhere: what the curve would double back for is left out.
  for (std::size_t k = 1; k + 1 < stops.size();) {
    const Vector3d before = stops[k].place - stops[k - 1].place, after = stops[k + 1].place - stops[k].place;
    const bool doubles_back = before.dot(after) < -0.1 * before.norm() * after.norm();
    if (doubles_back) stops.erase(stops.begin() + static_cast<std::ptrdiff_t>(k));
    k = doubles_back ? std::max<std::size_t>(k, 2) - 1 : k + 1;
  }
  return stops;
}

// The first stop moved out to where the body ends.
void reach_out(const BodyGrid& grid, std::vector<Stop>& stops, const Vector3d& along, bool first) {
  const Stop& end = first ? stops.front() : stops.back();
  const double way = 0.9 * way_out(grid, end.place, along, 0.5 * grid.cell * grid.count.maxCoeff());
  const Stop tip{end.place + way * along, end.joint};
  stops.insert(first ? stops.begin() : stops.end(), tip);
}

}  // namespace

double way_out(const BodyGrid& grid, const Vector3d& from, const Vector3d& along, double most) {
  const double step = grid.cell / 2;
  double way = 0;
  while (way < most && is_in(grid, from + (way + step) * along)) way += step;
  return way;
}

SpineCurve::SpineCurve(const BodySurvey& survey, const JointChains& chains, BodyKind kind) {
  lay(survey, chains);
  if (empty()) return;
  measure(survey);
  find_trunk(chains, kind);
  lift(kind);
}

void SpineCurve::lay(const BodySurvey& survey, const JointChains& chains) {
  const BodyGrid& grid = survey.grid();
  std::vector<Stop> stops = stops_of(survey, chains);
  if (stops.empty()) return;
  const Vector3d first = stops.size() > 1 ? Vector3d(stops[1].place - stops[0].place).normalized() : Vector3d::UnitZ();
  const Vector3d last =
      stops.size() > 1 ? Vector3d(stops.back().place - stops[stops.size() - 2].place).normalized() : Vector3d::UnitZ();
  reach_out(grid, stops, -first, true);
  // Below a skull the spine ends.
  if (!chains.is_head[static_cast<std::size_t>(chains.axis.back())]) reach_out(grid, stops, last, false);
  double length = 0;
  for (std::size_t k = 1; k < stops.size(); ++k) length += (stops[k].place - stops[k - 1].place).norm();
  if (length < 4 * grid.cell) return;
  double passed = 0;
  for (std::size_t k = 1; k < stops.size(); ++k) {
    const double part = (stops[k].place - stops[k - 1].place).norm();
    while (static_cast<double>(rows_.size()) * length / kRows <= passed + part) {
      const double share = part > 0 ? (static_cast<double>(rows_.size()) * length / kRows - passed) / part : 0;
      Row row;
      row.middle = stops[k - 1].place + share * (stops[k].place - stops[k - 1].place);
      row.joint = survey.spot(row.middle).joint;
      rows_.push_back(row);
    }
    passed += part;
  }
}

void SpineCurve::turn() {
  const Vector3d out = Vector3d::UnitX();
  for (std::size_t k = 0; k < rows_.size(); ++k) {
    const Row &before = rows_[k == 0 ? 0 : k - 1], &after = rows_[std::min(k + 1, rows_.size() - 1)];
    rows_[k].forward = (after.middle - before.middle).normalized();
    rows_[k].dorsal = rows_[k].forward.cross(out).normalized();
    rows_[k].along = k == 0 ? 0 : rows_[k - 1].along + (rows_[k].middle - before.middle).norm();
  }
}

void SpineCurve::spread() {
  const std::vector<Row> old = rows_;
  std::vector<double> passed{0};
  for (std::size_t k = 1; k < old.size(); ++k)
    passed.push_back(passed.back() + (old[k].middle - old[k - 1].middle).norm());
  std::size_t from = 0;
  for (std::size_t k = 0; k < rows_.size(); ++k) {
    const double wanted = passed.back() * static_cast<double>(k) / static_cast<double>(rows_.size() - 1);
    while (from + 2 < old.size() && passed[from + 1] < wanted) ++from;
    const double part = passed[from + 1] - passed[from];
    const double share = part > 0 ? std::clamp((wanted - passed[from]) / part, 0.0, 1.0) : 0;
    rows_[k].middle = old[from].middle + share * (old[from + 1].middle - old[from].middle);
  }
}

void SpineCurve::measure(const BodySurvey& survey) {
  const BodyGrid& grid = survey.grid();
  const double most = 0.5 * grid.cell * grid.count.maxCoeff();
  turn();
  // Controls far from the body's middle would bend the curve. Each section's middle is therefore found along y or z,
  // whichever is the shorter way through the body, then across the curve.
  for (Row& row : rows_) {
    const auto ways = [&](const Vector3d& across) {
      return std::pair(way_out(grid, row.middle, across, most), way_out(grid, row.middle, -across, most));
    };
    const auto [up, down] = ways(Vector3d::UnitY());
    const auto [before, behind] = ways(Vector3d::UnitZ());
    row.middle += up + down < before + behind ? 0.5 * (up - down) * Vector3d::UnitY()
                                              : 0.5 * (before - behind) * Vector3d::UnitZ();
  }
  spread();
  smooth(rows_, &Row::middle, kRowSmoothings);
  spread();
  turn();
  for (Row& row : rows_) {
    row.up = way_out(grid, row.middle, row.dorsal, most);
    row.down = way_out(grid, row.middle, -row.dorsal, most);
    row.half_width = std::min(way_out(grid, row.middle, Vector3d::UnitX(), most), 0.9 * (row.up + row.down));
    if (const int s = grid.sample_at(row.middle); s >= 0) row.joint = survey.spots()[static_cast<std::size_t>(s)].joint;
  }
  smooth(rows_, &Row::up, kRowSmoothings);
  smooth(rows_, &Row::down, kRowSmoothings);
  smooth(rows_, &Row::half_width, kRowSmoothings);
  for (std::size_t k = 0; k + 1 < rows_.size(); ++k) {
    const Eigen::Vector2d from = rows_[k].middle.tail<2>(), step = rows_[k + 1].middle.tail<2>() - from;
    segments_.push_back({from, step / std::max(step.norm(), 1e-12), step.norm()});
  }
}

void SpineCurve::find_trunk(const JointChains& chains, BodyKind kind) {
  const double last = static_cast<double>(rows_.size() - 1);
  const bool has_no_limbs = kind == BodyKind::snake || kind == BodyKind::fish;
  hip_ = (kind == BodyKind::fish ? 0.45 : 0.15) * last;
  shoulder_ = (kind == BodyKind::fish ? 0.85 : 0.9) * last;
  if (has_no_limbs) return;
  double low = last, high = 0;
  for (const JointLimb& limb : chains.limbs) {
    if (limb.use == JointLimb::Use::none) continue;
    const double row = row_near(chains.centre[static_cast<std::size_t>(limb.joints.front())]);
    low = std::min(low, row);
    high = std::max(high, row);
  }
  if (low > high) return;
  hip_ = low;
  shoulder_ = std::max(high, std::min(last, low + 0.1 * last));
}

void SpineCurve::lift(BodyKind kind) {
  const SpineDepth& depth = kSpineDepths[static_cast<std::size_t>(kind)];
  constexpr double kRump = 0.5;  // of the height at the hips: a tail is thinner, what lies before it is still trunk
  const double last = static_cast<double>(rows_.size() - 1), fade = 0.06 * last;
  const Row hips = at(hip_);
  for (std::size_t k = 0; k < rows_.size(); ++k) {
    Row& row = rows_[k];
    const double place = static_cast<double>(k);
    const double thinner = 1 - (row.up + row.down) / std::max(hips.up + hips.down, 1e-9);
    const double tail = place < hip_ ? std::clamp(thinner / kRump, 0.0, 1.0) : 0;
    const double neck = std::clamp((place - shoulder_) / fade - 0.5, 0.0, 1.0);
    const double share = tail * depth.tail + neck * depth.neck + (1 - tail - neck) * depth.trunk;
    row.place = row.middle + (row.up - share * (row.up + row.down)) * row.dorsal;
  }
  smooth(rows_, &Row::place, kRowSmoothings);
}

SpineCurve::Row SpineCurve::at(double row) const {
  const double within = std::clamp(row, 0.0, static_cast<double>(rows_.size() - 1));
  const auto k = std::min(static_cast<std::size_t>(within), rows_.size() - 2);
  const double share = within - static_cast<double>(k);
  const Row &a = rows_[k], &b = rows_[k + 1];
  const auto blend = [&](auto Row::*value) { return std::lerp(a.*value, b.*value, share); };
  const auto blend_places = [&](Vector3d Row::*value) -> Vector3d { return a.*value + share * (b.*value - a.*value); };
  return {blend(&Row::along),
          blend_places(&Row::middle),
          blend_places(&Row::place),
          blend_places(&Row::forward).normalized(),
          blend_places(&Row::dorsal).normalized(),
          blend(&Row::up),
          blend(&Row::down),
          blend(&Row::half_width),
          (share < 0.5 ? a : b).joint};
}

SpineCurve::Spot SpineCurve::spot(const Vector3d& point, double from, double to) const {
  const auto first = static_cast<std::size_t>(std::max(from, 0.0));
  const auto last = std::min(static_cast<std::size_t>(std::ceil(to)), rows_.size() - 1);
  const Eigen::Vector2d flat = point.tail<2>();
  double nearest = std::numeric_limits<double>::infinity();
  Spot spot;
  for (std::size_t k = first; k < last; ++k) {
    const auto& [start, along, length] = segments_[k];
    const Eigen::Vector2d offset = flat - start;
    const double way = offset.dot(along), within = std::clamp(way, 0.0, length);
    const double apart = (offset - within * along).squaredNorm();
    if (apart >= nearest) continue;
    nearest = apart;
    spot.row = static_cast<double>(k) + within / std::max(length, 1e-12);
    spot.height = offset.x() * along.y() - offset.y() * along.x();
    const bool is_end = (k == first && way < 0) || (k + 1 == last && way > length);
    spot.beyond = is_end ? std::abs(way - within) : 0;  // at a bend the curve goes on
  }
  spot.aside = std::abs(point.x());
  return spot;
}

double SpineCurve::row_near(const Vector3d& point) const {
  return spot(point, 0, static_cast<double>(rows_.size() - 1)).row;
}

}  // namespace bodyopt::trainer
