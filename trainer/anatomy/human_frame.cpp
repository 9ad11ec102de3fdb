#include "trainer/anatomy/human_frame.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "geometry/mesh.h"

namespace bodyopt::trainer {
namespace {

using Eigen::Index;
using Eigen::Vector3d;
using Place = HumanFrame::Place;

std::optional<Place> place_of(const HalfBody& body, BodyPart part, std::size_t nested = 0) {
  const int joint = body.find(part, BodySide::left, nested);
  if (joint < 0) return std::nullopt;
  return Place{joint, body.places[static_cast<std::size_t>(joint)]};
}

// A place on this side; for a limb that this side lost, the mirror image of the other side's joint.
std::optional<Place> side_place(const HalfBody& body, BodyPart part) {
  if (const auto own = place_of(body, part)) return own;
  const int other = body.find(part, BodySide::right);
  if (other < 0) return std::nullopt;
  const Vector3d at = body.places[static_cast<std::size_t>(other)];
  return Place{-1, {-at.x(), at.y(), at.z()}};
}

std::vector<Place> chain(const HalfBody& body, BodyPart part) {
  std::vector<Place> places;
  while (const auto next = place_of(body, part, places.size())) places.push_back(*next);
  return places;
}

// The skin farthest from the ankle along the ground tells where toes are; they begin at seven tenths of that way.
std::optional<Place> toe_by_skin(const HalfBody& body, const Place& ankle) {
  constexpr double kToesBegin = 0.7;
  double reach = 0;
  double sole = ankle.at.y();
  for (std::size_t v = 0; v < body.weights.size(); ++v) {
    if (body.weights[v].empty() || static_cast<int>(body.weights[v].front().joint) != ankle.joint) continue;
    const Vector3d vertex = body.vertices.row(static_cast<Eigen::Index>(v));
    reach = std::max(reach, vertex.z() - ankle.at.z());
    sole = std::min(sole, vertex.y());
  }
  if (!(reach > 0)) return std::nullopt;
  return Place{ankle.joint, {ankle.at.x(), sole + 0.25 * (ankle.at.y() - sole), ankle.at.z() + kToesBegin * reach}};
}

void tell_missing(HumanFrame& frame) {
  const auto tell = [&](bool has, const char* what) {
    if (!has) frame.missing.emplace_back(what);
  };
  tell(frame.has_leg() && frame.hip->joint >= 0, "hip, knee and ankle");
  tell(frame.has_arm() && frame.shoulder->joint >= 0, "shoulder, elbow and wrist");
  tell(frame.head.has_value(), "the head");
  tell(!frame.spine.empty(), "the spine");
}

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

int HumanFrame::spine_joint(double height) const {
  int joint = pelvis ? pelvis->joint : -1;
  for (const auto* places : {&spine, &cervical}) {
    for (const Place& place : *places) {
      if (place.at.y() < height) joint = place.joint;
    }
  }
  return joint;
}

HumanFrame frame_of(const HalfBody& body) {
  HumanFrame frame;
  frame.mm = 1e-3 * box_sides(body.vertices).y() / kReferenceStature;
  frame.hip = side_place(body, BodyPart::thigh);
  frame.knee = side_place(body, BodyPart::shin);
  frame.ankle = side_place(body, BodyPart::foot);
  frame.toe = side_place(body, BodyPart::toe);
  if (frame.ankle && !frame.toe) frame.toe = toe_by_skin(body, *frame.ankle);
  frame.shoulder = side_place(body, BodyPart::upper_arm);
  frame.elbow = side_place(body, BodyPart::forearm);
  frame.wrist = side_place(body, BodyPart::hand);
  frame.palm = side_place(body, BodyPart::palm);
  frame.clavicle = side_place(body, BodyPart::clavicle);
  frame.pelvis = place_of(body, BodyPart::hips);
  frame.spine = chain(body, BodyPart::spine);
  frame.cervical = chain(body, BodyPart::neck);
  frame.head = place_of(body, BodyPart::head);
  if (!frame.cervical.empty()) frame.neck = frame.cervical.front();
  if (!frame.neck && frame.head) frame.neck = frame.head;
  tell_missing(frame);
  return frame;
}

double Table::operator()(double at) const {
  if (rows_.empty()) return 0;
  if (at <= rows_.front().first) return rows_.front().second;
  for (std::size_t k = 1; k < rows_.size(); ++k) {
    const auto& [from, low] = rows_[k - 1];
    const auto& [to, high] = rows_[k];
    if (at <= to) return to > from ? std::lerp(low, high, (at - from) / (to - from)) : high;
  }
  return rows_.back().second;
}

Vector3d across(const Vector3d& vector, const Vector3d& axis, const Vector3d& otherwise) {
  const Vector3d rest = vector - vector.dot(axis) * axis;
  return rest.norm() > 1e-6 * vector.norm() && rest.norm() > 0 ? rest.normalized() : otherwise;
}

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
  millimetre_ = 1e-3 / kReferenceStature * (body.vertices.col(1).maxCoeff() - body.vertices.col(1).minCoeff());
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

}  // namespace bodyopt::trainer
