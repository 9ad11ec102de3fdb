#include "trainer/anatomy/human_bones.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace bodyopt::trainer {
namespace {

using Eigen::Vector3d;

// Directions of the arm as it hangs or is held out: along both of its bones, the elbow's axis, and where it bends to.
struct ArmAxes {
  Vector3d upper, fore, hinge, flexor, outer, radial;
};

// The direction of the thumb's skin, as its joint may lie on the forearm's axis; forwards without one.
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

// Directions at a bone of the leg: down along it, outwards, and forwards.
struct LegAxes {
  Vector3d down, out, forward;
  LegAxes(const Vector3d& from, const Vector3d& to) {
    down = (to - from).normalized();
    out = across(Vector3d::UnitX(), down, Vector3d::UnitX());
    forward = out.cross(down);
    if (forward.z() < 0) forward = -forward;
  }
  Eigen::Matrix3d rows() const { return (Eigen::Matrix3d() << out, forward, down).finished().transpose(); }
};

// A rig's hip and knee do not lie on the bone's axis. The shaft goes through the sections of the thigh, a little to the
// front and outside of their middle.
Vector3d shaft_place(const HumanSkeleton& skeleton, const LegAxes& axes, double down, double out) {
  constexpr double kForward = 0.06, kReach = 30;
  const Vector3d at = (1 - down) * skeleton.frame.hip->at + down * skeleton.frame.knee->at;
  const auto section = skeleton.survey.section(at, axes.down, BodyRegion::thigh, axes.out);
  if (!section) return at;
  const Vector3d aside = section->middle + section->half_width * (out * axes.out + kForward * axes.forward) - at;
  const double way = aside.norm(), farthest = skeleton.mm(kReach);
  return way > farthest ? Vector3d(at + farthest / way * aside) : Vector3d(at + aside);
}

// Shin and greater trochanter are felt below the skin: a bone moves outwards until only fat is over it.
Vector3d under_the_fat(const HumanSkeleton& skeleton, const Vector3d& from, const Vector3d& towards, double radius,
                       double farthest) {
  const double step = skeleton.mm(1);
  for (double way = 0; way < farthest; way += step) {
    const Spot spot = skeleton.survey.spot(from + way * towards);
    if (spot.depth < spot.fat + radius + skeleton.mm(1)) return spot.point;
  }
  return from + farthest * towards;
}

void add_femur(HumanSkeleton& skeleton) {
  const auto& [hip_joint, hip] = *skeleton.frame.hip;
  const Vector3d knee = skeleton.frame.knee->at;
  const LegAxes axes(hip, knee);
  const auto mm = [&](double length) { return skeleton.mm(length); };
  const double head = mm(23.5), neck = mm(14), greater = mm(16);
  const Vector3d trochanter = under_the_fat(skeleton, hip + mm(6) * axes.down, axes.out, greater, mm(46));
  const std::vector<ChainLink> shaft{{trochanter, mm(15)},
                                     {hip + mm(36) * axes.out + mm(45) * axes.down, mm(14)},
                                     {shaft_place(skeleton, axes, 0.3, 0.22), mm(13.5)},
                                     {shaft_place(skeleton, axes, 0.5, 0.12), mm(13)},
                                     {shaft_place(skeleton, axes, 0.7, 0.05), mm(13.5)},
                                     {hip + 0.86 * (knee - hip), mm(16)},
                                     {knee - mm(14) * axes.down, mm(21)}};
  skeleton.add(hip_joint, [=, hip = hip](const Spot& spot) {
    return std::min({sphere_distance(spot.point, hip, head), cone_distance(spot.point, hip, trochanter, neck, greater),
                     chain_distance(spot.point, shaft)});
  });
  const Vector3d condyles = knee - mm(4) * axes.down, radii(mm(38), mm(28), mm(19));
  skeleton.add(hip_joint, [=, rows = axes.rows()](const Spot& spot) {
    return ellipsoid_distance(spot.point, condyles, rows, radii);
  });
  skeleton.landmarks["greater_trochanter"] = trochanter + greater * axes.out;
  skeleton.landmarks["femoral_condyle"] = knee + mm(36) * axes.out;
  skeleton.landmarks["knee"] = knee;
}

void add_shank(HumanSkeleton& skeleton) {
  const auto& [joint, knee] = *skeleton.frame.knee;
  const Vector3d ankle = skeleton.frame.ankle->at, along = ankle - knee;
  const LegAxes axes(knee, ankle);
  const auto mm = [&](double length) { return skeleton.mm(length); };
  const Vector3d forward_and_in = (axes.forward - 0.7 * axes.out).normalized();
  std::vector<ChainLink> tibia{{knee + mm(26) * axes.down, mm(30)}};
  for (const auto& [down, radius, shaft] :
       {std::array{0.16, 20., 21.}, {.33, 14., 13.5}, {.6, 12.5, 11.5}, {.85, 13., 13.}})
    tibia.push_back({under_the_fat(skeleton, knee + down * along, forward_and_in, mm(radius), mm(35)), mm(shaft)});
  tibia.push_back({ankle - mm(6) * axes.down, mm(19)});
  const Vector3d plateau = knee + mm(28) * axes.down, radii(mm(36), mm(26), mm(20));
  const std::vector<ChainLink> fibula{{knee + mm(38) * axes.out - mm(18) * axes.forward + mm(35) * axes.down, mm(9)},
                                      {knee + 0.5 * along + mm(26) * axes.out - mm(10) * axes.forward, mm(6)},
                                      {ankle + mm(27) * axes.out - mm(6) * axes.forward + mm(8) * axes.down, mm(10)}};
  const Vector3d malleolus = ankle - mm(24) * axes.out;
  const double malleolus_radius = mm(11);
  skeleton.add(joint, [=, rows = axes.rows()](const Spot& spot) {
    return std::min({chain_distance(spot.point, tibia), ellipsoid_distance(spot.point, plateau, rows, radii),
                     chain_distance(spot.point, fibula), sphere_distance(spot.point, malleolus, malleolus_radius)});
  });
  skeleton.landmarks["tibial_tuberosity"] = tibia[1].place + tibia[1].radius * axes.forward;
  skeleton.landmarks["fibular_head"] = fibula.front().place;
}

void add_patella(HumanSkeleton& skeleton) {
  const auto& [joint, knee] = *skeleton.frame.knee;
  const LegAxes axes(skeleton.frame.hip->at, knee);
  const auto mm = [&](double length) { return skeleton.mm(length); };
  const Vector3d patella = under_the_fat(skeleton, knee - mm(8) * axes.down, axes.forward, mm(9), mm(80));
  const Vector3d radii(mm(21), mm(10), mm(22));
  skeleton.add(joint, [=, rows = axes.rows()](const Spot& spot) {
    return ellipsoid_distance(spot.point, patella, rows, radii);
  });
  skeleton.landmarks["patella"] = patella;
}

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

void add_leg(HumanSkeleton& skeleton) {
  if (!skeleton.frame.has_leg()) return;
  add_femur(skeleton);
  add_shank(skeleton);
  add_patella(skeleton);
}

void add_foot(HumanSkeleton& skeleton) {
  if (!skeleton.frame.ankle || !skeleton.frame.toe) return;
  const auto& [joint, ankle] = *skeleton.frame.ankle;
  const Vector3d toe = skeleton.frame.toe->at, up = Vector3d::UnitY();
  const auto mm = [&](double length) { return skeleton.mm(length); };
  const Vector3d forward = across(toe - ankle, up, Vector3d::UnitZ());
  Vector3d out = up.cross(forward);
  if (out.x() < 0) out = -out;
  const Eigen::Matrix3d rows = (Eigen::Matrix3d() << out, forward, up).finished().transpose();
  double sole = ankle.y();
  for (const Spot& spot : skeleton.survey.spots()) {
    if (spot.region == BodyRegion::foot) sole = std::min(sole, spot.point.y());
  }
  const Vector3d talus = ankle - mm(16) * up + mm(8) * forward, talus_radii(mm(21), mm(28), mm(17));
  Vector3d heel = ankle - mm(38) * forward;
  heel.y() = std::max(sole + mm(30), ankle.y() - mm(48));
  const std::vector<ChainLink> calcaneus{{heel, mm(21)}, {ankle - mm(34) * up + mm(25) * forward, mm(17)}};
  const Vector3d tarsus = ankle - mm(30) * up + mm(45) * forward, tarsus_radii(mm(28), mm(26), mm(15));
  skeleton.add(
      joint, [=](const Spot& spot) { return chain_distance(spot.point, calcaneus); }, 8);
  skeleton.add(joint, [=](const Spot& spot) {
    return std::min(ellipsoid_distance(spot.point, talus, rows, talus_radii),
                    ellipsoid_distance(spot.point, tarsus, rows, tarsus_radii));
  });
  for (int ray = 0; ray < 5; ++ray) {
    const double aside = mm(15) * (ray - 2), radius = mm(8), end_radius = mm(ray == 0 ? 9 : 6.5);
    const Vector3d from = tarsus + 0.6 * aside * out + mm(10) * forward;
    const Vector3d to = toe + aside * out - mm(4 + 6 * std::abs(ray - 1)) * forward;
    skeleton.add(joint, [=](const Spot& spot) { return cone_distance(spot.point, from, to, radius, end_radius); });
  }
  skeleton.add_cores(BodyRegion::foot, [foot = joint](int j) { return j == foot ? 0 : 0.52; });
  skeleton.landmarks["heel"] = heel - mm(20) * forward;
}

}  // namespace

void HumanSkeleton::add(int joint, std::function<double(const Spot&)> distance, double cover) {
  if (joint >= 0) bones.push_back({joint, mm(cover), std::move(distance)});
}

void HumanSkeleton::add_cores(BodyRegion region, const std::function<double(int)>& share) {
  const std::vector<BodyRegion>& regions = survey.regions();
  for (int j = 0; j < static_cast<int>(regions.size()); ++j) {
    const double of_half = regions[static_cast<std::size_t>(j)] == region ? share(j) : 0;
    if (of_half == 0) continue;
    const auto distance = [=](const Spot& spot) {
      return spot.joint == j ? of_half * spot.half_thickness - spot.depth : kFarFromBone;
    };
    add(j, distance, 0);
  }
}

void add_head(HumanSkeleton& skeleton) {
  if (!skeleton.frame.head) return;
  const auto& [joint, head] = *skeleton.frame.head;
  const double mm = skeleton.mm(1);
  // The skull ends above the neck, in front with the chin. Skin and muscle lie thin over it, thicker on the face and
  // below the back of the head.
  const Table base({{head.z() + 10 * mm, head.y() + 5 * mm}, {head.z() + 50 * mm, head.y() - 60 * mm}});
  const Table face_below({{head.y() + 10 * mm, 1}, {head.y() + 60 * mm, 0}});
  const Table face_before({{head.z() - 20 * mm, 0}, {head.z() + 20 * mm, 1}});
  const Table nape_below({{head.y() + 10 * mm, 1}, {head.y() + 40 * mm, 0}});
  const Table nape_behind({{head.z() - 30 * mm, 1}, {head.z(), 0}});
  const auto skull = [=](const Spot& spot) {
    if (spot.region != BodyRegion::head) return kFarFromBone;
    const double y = spot.point.y(), z = spot.point.z();
    const double face = face_below(y) * face_before(z), nape = nape_below(y) * nape_behind(z);
    return std::max(spot.fat + (4 + 10 * face + 20 * nape) * mm - spot.depth, base(z) - y);
  };
  skeleton.add(joint, skull, 2);
}

void add_limbs(HumanSkeleton& skeleton) {
  add_leg(skeleton);
  add_foot(skeleton);
  add_arm(skeleton);
  add_hand(skeleton);
}

}  // namespace bodyopt::trainer
