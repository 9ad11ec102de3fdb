#include "trainer/anatomy/landmark_points.h"

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

namespace bodyopt {
namespace {

using Eigen::Index;
using Eigen::Vector3d;

constexpr double kStature = 1.75;   // metres
constexpr double kDepthCounts = 3;  // a millimetre of depth, against one of place
constexpr std::pair<const char*, BodyPart> kJoints[] = {{"hips_joint", BodyPart::hips},
                                                        {"spine_joint", BodyPart::spine},
                                                        {"neck_joint", BodyPart::neck},
                                                        {"head_joint", BodyPart::head},
                                                        {"thigh_joint", BodyPart::thigh},
                                                        {"shin_joint", BodyPart::shin},
                                                        {"foot_joint", BodyPart::foot},
                                                        {"clavicle_joint", BodyPart::clavicle},
                                                        {"upper_arm_joint", BodyPart::upper_arm},
                                                        {"forearm_joint", BodyPart::forearm},
                                                        {"hand_joint", BodyPart::hand}};

}  // namespace

LandmarkPoint read_landmark_point(const JsonObject& json) {
  json.allow({"at", "mm", "under_fat"});
  LandmarkPoint point;
  if (!json.has("at") || !json.json()["at"].is_object()) json.refuse("'at' is not an object of landmarks and shares");
  double sum = 0;
  for (const auto& [name, share] : json.json()["at"].items()) {
    point.at.emplace_back(name, share.get<double>());
    sum += point.at.back().second;
  }
  if (std::abs(sum - 1) > 1e-6) json.refuse("the shares of 'at' do not add up to 1");
  if (json.has("mm")) {
    const Json& offset = json.array("mm");
    if (offset.size() != 3) json.refuse("'mm' is not three numbers");
    for (std::size_t k = 0; k < 3; ++k) point.offset[static_cast<Index>(k)] = offset[k].get<double>();
  }
  if (json.has("under_fat")) point.under_fat = json.number("under_fat", 0, 100);
  return point;
}

LandmarkPlaces::LandmarkPlaces(const HalfBody& body, const LeanSamples& lean)
    : lean_(lean), places_(lean.tissue.landmarks) {
  millimetre_ = 1e-3 / kStature * (body.vertices.col(1).maxCoeff() - body.vertices.col(1).minCoeff());
  for (const auto& [name, part] : kJoints) {
    const int joint = body.find(part);
    if (joint >= 0) places_.emplace(name, body.places[static_cast<std::size_t>(joint)]);
  }
}

std::optional<Vector3d> LandmarkPlaces::place(const LandmarkPoint& point) const {
  Vector3d place = millimetre_ * point.offset;
  for (const auto& [name, share] : point.at) {
    const auto found = places_.find(name);
    if (found == places_.end()) return std::nullopt;
    place += share * found->second;
  }
  if (!point.under_fat) return place;
  double least = std::numeric_limits<double>::max();
  int nearest = -1;
  for (std::size_t i = 0; i < lean_.size(); ++i) {
    const int s = lean_.sample[i];
    const double deep = lean_.tissue.fat[s] - millimetre_ * *point.under_fat;
    const double away = (lean_.points.row(static_cast<Index>(i)).transpose() - place).squaredNorm() +
                        kDepthCounts * kDepthCounts * deep * deep;
    if (away >= least) continue;
    least = away;
    nearest = s;
  }
  return nearest < 0 ? place : Vector3d(lean_.grid.points.row(nearest));
}

}  // namespace bodyopt
