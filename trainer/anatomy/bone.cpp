#include "trainer/anatomy/bone.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "base/parallel.h"

namespace bodyopt::trainer {

std::vector<Bone> corrected_bones(const std::vector<Bone>& bones, const HalfBody& body,
                                  const AnatomyCorrections& corrections) {
  std::vector<Bone> result;
  for (const Bone& bone : bones) {
    AnatomyCorrections::OfBone of;
    if (bone.joint >= 0) of = corrections.of_bone(body.joints[static_cast<std::size_t>(bone.joint)].name);
    if (!of.carries.value_or(true)) continue;
    result.push_back(bone);
    if (of.thicker == 0) continue;
    result.back().distance = [distance = bone.distance, thicker = of.thicker](const Spot& spot) {
      return distance(spot) - thicker;
    };
  }
  return result;
}

void find_bone(const BodySurvey& survey, const std::vector<Bone>& bones, InnerTissue& tissue) {
  const std::vector<Spot>& spots = survey.spots();
  tissue.bone.setConstant(static_cast<Eigen::Index>(spots.size()), kFarFromBone);
  tissue.bone_joint.assign(spots.size(), -1);
  parallel_for_short(spots.size(), [&](std::size_t s) {
    double& nearest = tissue.bone[static_cast<Eigen::Index>(s)];
    for (const Bone& bone : bones) {
      const double distance = std::max(bone.distance(spots[s]), bone.cover - spots[s].depth);
      if (distance >= nearest) continue;
      nearest = distance;
      tissue.bone_joint[s] = bone.joint;
    }
  });
}

using Eigen::Vector3d;

namespace {

// How far along a segment its point nearest to another is, 0 to 1.
double place_along(const Vector3d& point, const Vector3d& a, const Vector3d& b) {
  const Vector3d along = b - a;
  const double squared = along.squaredNorm();
  return squared > 0 ? std::clamp((point - a).dot(along) / squared, 0.0, 1.0) : 0;
}

}  // namespace

double sphere_distance(const Vector3d& point, const Vector3d& centre, double radius) {
  return (point - centre).norm() - radius;
}

double cone_distance(const Vector3d& point, const Vector3d& a, const Vector3d& b, double radius_a, double radius_b) {
  const double along = place_along(point, a, b);
  return (point - a - along * (b - a)).norm() - std::lerp(radius_a, radius_b, along);
}

double chain_distance(const Vector3d& point, const std::vector<ChainLink>& links) {
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k + 1 < links.size(); ++k) {
    const ChainLink &a = links[k], &b = links[k + 1];
    nearest = std::min(nearest, cone_distance(point, a.place, b.place, a.radius, b.radius));
  }
  return nearest;
}

double ellipsoid_distance(const Vector3d& point, const Vector3d& centre, const Eigen::Matrix3d& axes,
                          const Vector3d& radii) {
  const Vector3d unit = (axes * (point - centre)).cwiseQuotient(radii);
  return (unit.norm() - 1) * radii.minCoeff();
}

double plate_distance(const Vector3d& point, const Vector3d& a, const Vector3d& b, const Vector3d& c, double half) {
  const Vector3d normal = (b - a).cross(c - a).normalized();
  const std::array<std::pair<const Vector3d&, const Vector3d&>, 3> edges{{{a, b}, {b, c}, {c, a}}};
  bool is_over = true;
  double to_edge = std::numeric_limits<double>::infinity();
  for (const auto& [from, to] : edges) {
    is_over = is_over && (to - from).cross(point - from).dot(normal) >= 0;
    to_edge = std::min(to_edge, cone_distance(point, from, to, 0, 0));
  }
  return (is_over ? std::abs((point - a).dot(normal)) : to_edge) - half;
}

}  // namespace bodyopt::trainer
