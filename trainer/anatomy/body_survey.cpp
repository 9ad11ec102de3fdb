#include "trainer/anatomy/body_survey.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/parallel.h"
#include "geometry/thickness.h"

namespace bodyopt::trainer {
namespace {

using Eigen::Index;
using Eigen::Vector3d;

bool is_middle(BodyRegion region) {
  return is_trunk(region) || region == BodyRegion::neck || region == BodyRegion::head;
}

// The joint with the largest weight there; of equal ones the first.
int joint_at(const SkinWeights& weights, const SkinPoint& skin) {
  const std::vector<JointWeight> sums = weights_at(weights, skin);
  const auto largest = std::ranges::max_element(sums, {}, &JointWeight::weight);
  return largest == sums.end() ? -1 : static_cast<int>(largest->joint);
}

BodyRegion region_at(const SkinWeights& weights, const std::vector<BodyRegion>& regions, const SkinPoint& skin) {
  std::array<double, kBodyRegions> sums{};
  for (int k = 0; k < 3; ++k) {
    for (const JointWeight& own : weights[skin.vertices[static_cast<std::size_t>(k)]])
      sums[static_cast<std::size_t>(regions[own.joint])] += skin.weights[k] * own.weight;
  }
  return static_cast<BodyRegion>(std::ranges::max_element(sums) - sums.begin());
}

}  // namespace

bool is_trunk(BodyRegion region) { return region == BodyRegion::trunk || region == BodyRegion::hip; }

BodySurvey::BodySurvey(const HalfBody& body, const BodyGrid& grid, const std::vector<BodyRegion>& regions)
    : body_(body),
      grid_(grid),
      regions_(regions),
      skin_(body.vertices, body.triangles),
      half_thickness_(bodyopt::half_thickness(body.vertices, body.triangles, skin_)),
      fat_(Eigen::VectorXd::Zero(body.vertices.rows())),
      spots_(static_cast<std::size_t>(grid.size())) {
  parallel_for_short(spots_.size(), [&](std::size_t s) {
    spots_[s] = spot_under(grid.points.row(static_cast<Index>(s)), grid.skin[s]);
  });
}

void BodySurvey::set_fat(const Eigen::VectorXd& thickness) {
  fat_ = thickness;
  for (std::size_t s = 0; s < spots_.size(); ++s) spots_[s].fat = at_point(fat_, grid_.skin[s]);
}

Spot BodySurvey::spot(const Vector3d& point) const { return spot_under(point, skin_(point)); }

Spot BodySurvey::spot_under(const Vector3d& point, const SkinPoint& skin) const {
  return {point,
          (skin.position - point).norm(),
          at_point(half_thickness_, skin),
          at_point(fat_, skin),
          joint_at(body_.weights, skin),
          region_at(body_.weights, regions_, skin)};
}

Eigen::MatrixXd BodySurvey::region_weights() const {
  Eigen::MatrixXd weights = Eigen::MatrixXd::Zero(body_.vertices.rows(), kBodyRegions);
  for (std::size_t v = 0; v < body_.weights.size(); ++v) {
    for (const JointWeight& own : body_.weights[v])
      weights(static_cast<Index>(v), static_cast<Index>(regions_[own.joint])) += own.weight;
  }
  return weights;
}

std::optional<BodySurvey::Depths> BodySurvey::depths(double height, double aside) const {
  const double cell = grid_.cell;
  const auto low_x = static_cast<int>(std::floor((aside - grid_.low.x()) / cell - 1.5));
  const auto low_y = static_cast<int>(std::floor((height - grid_.low.y()) / cell - 1));
  std::optional<Depths> found;
  for (int x = std::max(0, low_x); x < std::min(grid_.count.x(), low_x + 4); ++x) {
    for (int y = std::max(0, low_y); y < std::min(grid_.count.y(), low_y + 2); ++y) {
      for (int z = 0; z < grid_.count.z(); ++z) {
        const int s = grid_.sample_at(Eigen::Vector3i(x, y, z));
        if (s < 0 || !is_middle(spots_[static_cast<std::size_t>(s)].region)) continue;
        const double at = grid_.points(s, 2);
        if (!found) found = {at - cell / 2, at + cell / 2};
        found->back = std::min(found->back, at - cell / 2);
        found->front = std::max(found->front, at + cell / 2);
      }
    }
  }
  return found;
}

std::optional<BodySurvey::Section> BodySurvey::section(const Vector3d& at, const Vector3d& axis, BodyRegion region,
                                                       const Vector3d& across) const {
  Vector3d sum = Vector3d::Zero();
  double low = 0, high = 0;
  int count = 0;
  for (const Spot& spot : spots_) {
    if (spot.region != region || std::abs((spot.point - at).dot(axis)) > grid_.cell) continue;
    const double aside = (spot.point - at).dot(across);
    low = count == 0 ? aside : std::min(low, aside);
    high = count == 0 ? aside : std::max(high, aside);
    sum += spot.point - at;
    ++count;
  }
  if (count == 0) return std::nullopt;
  const Vector3d aside = sum / count;
  return Section{at + aside - aside.dot(axis) * axis, (high - low) / 2};
}

}  // namespace bodyopt::trainer
