#include <Eigen/Geometry>
#include <algorithm>

#include "trainer/anatomy/human_bones.h"
#include "trainer/anatomy/shapes.h"

namespace bodyopt {
namespace {

using Eigen::Vector3d;

// Of the arm as it hangs or is held out: along both of its bones, the elbow's axis, and where it bends to.
struct ArmAxes {
  Vector3d upper, fore, hinge, flexor, outer, radial;
};

// Towards the thumb by its skin, as its joint may lie on the forearm's axis; forwards without one.
Vector3d radial_direction(const HalfBody& body, const Vector3d& wrist, const Vector3d& fore) {
  const int thumb = body.find(BodyPart::thumb);
  Vector3d sum = Vector3d::Zero();
  double total = 0;
  for (std::size_t v = 0; thumb >= 0 && v < body.weights.size(); ++v) {
    for (const JointWeight& own : body.weights[v]) {
      if (static_cast<int>(own.joint) != thumb) continue;
      sum += own.weight * (body.vertices.row(static_cast<Eigen::Index>(v)).transpose() - wrist);
      total += own.weight;
    }
  }
  const Vector3d forward = across(Vector3d::UnitZ(), fore, Vector3d::UnitY());
  return total > 0 ? across(sum / total, fore, forward) : forward;
}

ArmAxes arm_axes(const HumanSkeleton& skeleton) {
  constexpr double kStraight = 0.08;  // sine of the elbow's angle below which it does not tell its axis
  const HumanFrame& frame = skeleton.frame;
  ArmAxes axes;
  axes.upper = (frame.elbow->at - frame.shoulder->at).normalized();
  axes.fore = (frame.wrist->at - frame.elbow->at).normalized();
  const Vector3d forward = across(Vector3d::UnitZ(), axes.upper, Vector3d::UnitY());
  const Vector3d hinge = axes.upper.cross(axes.fore);
  axes.flexor = hinge.norm() < kStraight ? forward : across(axes.fore, axes.upper, forward);
  axes.hinge = axes.upper.cross(axes.flexor);
  axes.outer = -axes.hinge;
  axes.radial = radial_direction(skeleton.survey.body(), frame.wrist->at, axes.fore);
  return axes;
}

void add_humerus(HumanSkeleton& skeleton, const ArmAxes& axes) {
  const auto& [joint, shoulder] = *skeleton.frame.shoulder;
  const Vector3d elbow = skeleton.frame.elbow->at, along = elbow - shoulder;
  const auto mm = [&](double length) { return skeleton.mm(length); };
  const std::vector<ChainLink> shaft{{shoulder + mm(8) * axes.upper, mm(21)},
                                     {shoulder + mm(45) * axes.upper, mm(13.5)},
                                     {shoulder + 0.5 * along, mm(11)},
                                     {shoulder + 0.8 * along, mm(11.5)},
                                     {elbow, mm(14)}};
  const Eigen::Matrix3d rows = (Eigen::Matrix3d() << axes.hinge, axes.flexor, axes.upper).finished().transpose();
  const Vector3d condyles(mm(31), mm(15), mm(17));
  const double head = mm(23.5);
  skeleton.add(joint, [=, shoulder = shoulder](const Spot& spot) {
    return std::min({sphere_distance(spot.point, shoulder, head), chain_distance(spot.point, shaft),
                     ellipsoid_distance(spot.point, elbow, rows, condyles)});
  });
  skeleton.landmarks["medial_epicondyle"] = elbow - mm(30) * axes.outer;
  skeleton.landmarks["lateral_epicondyle"] = elbow + mm(30) * axes.outer;
}

void add_ulna_and_radius(HumanSkeleton& skeleton, const ArmAxes& axes) {
  const auto& [joint, elbow] = *skeleton.frame.elbow;
  const Vector3d wrist = skeleton.frame.wrist->at, middle = 0.5 * (elbow + wrist);
  const auto mm = [&](double length) { return skeleton.mm(length); };
  const std::vector<ChainLink> ulna{{elbow - mm(16) * axes.flexor - mm(8) * axes.outer, mm(12)},
                                    {elbow + mm(30) * axes.fore - mm(9) * axes.flexor - mm(8) * axes.outer, mm(11)},
                                    {middle - mm(9) * axes.outer - mm(4) * axes.flexor, mm(7)},
                                    {wrist - mm(12) * axes.radial, mm(6)}};
  const std::vector<ChainLink> radius{{elbow + mm(17) * axes.outer + mm(16) * axes.fore, mm(10.5)},
                                      {elbow + mm(50) * axes.fore + mm(13) * axes.outer, mm(7)},
                                      {middle + mm(11) * axes.outer + mm(3) * axes.radial, mm(7.5)},
                                      {wrist + mm(9) * axes.radial, mm(12)}};
  skeleton.add(joint, [=](const Spot& spot) {
    return std::min(chain_distance(spot.point, ulna), chain_distance(spot.point, radius));
  });
  skeleton.landmarks["olecranon"] = ulna.front().place - mm(10) * axes.flexor;
  skeleton.landmarks["radial_styloid"] = radius.back().place;
}

bool is_finger(BodyPart part) { return part >= BodyPart::thumb; }

}  // namespace

void add_arm(HumanSkeleton& skeleton) {
  if (!skeleton.frame.has_arm()) return;
  const ArmAxes axes = arm_axes(skeleton);
  add_humerus(skeleton, axes);
  add_ulna_and_radius(skeleton, axes);
}

void add_hand(HumanSkeleton& skeleton) {
  constexpr double kFinger = 0.45, kPalm = 0.62;  // of the half thickness
  const HalfBody& body = skeleton.survey.body();
  std::vector<bool> finger;
  for (std::size_t j = 0; j < body.joints.size(); ++j) {
    const int parent = body.joints[j].parent;
    finger.push_back(body.roles[j] ? is_finger(body.roles[j]->part)
                                   : parent >= 0 && finger[static_cast<std::size_t>(parent)]);
  }
  skeleton.add_cores(BodyRegion::hand,
                     [&](int joint) { return finger[static_cast<std::size_t>(joint)] ? kFinger : kPalm; });
  if (!skeleton.frame.has_arm()) return;
  const auto& [joint, wrist] = *skeleton.frame.wrist;
  const ArmAxes axes = arm_axes(skeleton);
  const Vector3d along = skeleton.frame.palm ? (skeleton.frame.palm->at - wrist).normalized() : axes.fore;
  const Vector3d carpus = wrist + skeleton.mm(18) * along, radii = skeleton.mm(26, 20, 10);
  const Eigen::Matrix3d rows =
      (Eigen::Matrix3d() << axes.radial, axes.fore, axes.radial.cross(axes.fore)).finished().transpose();
  skeleton.add(joint, [=](const Spot& spot) { return ellipsoid_distance(spot.point, carpus, rows, radii); });
}

}  // namespace bodyopt
