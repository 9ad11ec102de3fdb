#include "trainer/builtin/arm_muscles.h"

#include <stdexcept>

#include "trainer/builtin/anatomy.h"

namespace bodyopt {
namespace {

using Eigen::Vector3d;

struct PathPoint {
  const char* joint;
  Vector3d position;
};

struct MusclePlan {
  const char* name;
  double radius;                // metres, at the belly
  std::vector<PathPoint> path;  // origin first
};

constexpr double kTendonDepth = 0.005;  // metres under the skin, at least
constexpr double kBellyDepth = 0.9;     // of the belly's radius: the muscle shapes the skin above it

// The scapula moves with the clavicle joint; radius and ulna are shared out among elbow, forearm and forearm_twist.
std::vector<MusclePlan> plan_muscles() {
  const SegmentFrame arm = upper_arm_frame(), fore = forearm_frame(), hand = hand_frame();
  const Finger middle = fingers()[1];
  const Vector3d olecranon = fore.at(-0.012, -0.020, 0.001);
  return {
      {"trapezius_upper", 0.013, {{"torso", {-0.025, 1.550, -0.040}}, {"clavicle", {-0.150, 1.470, -0.026}}}},
      {"deltoid_anterior",
       0.019,
       {{"clavicle", {-0.140, 1.464, 0.028}},
        {"shoulder", arm.at(0.055, 0.043, 0.022)},
        {"shoulder", arm.at(0.145, 0.010, 0.026)}}},
      {"deltoid_middle",
       0.021,
       {{"clavicle", {-0.190, 1.474, -0.012}},
        {"shoulder", arm.at(0.055, 0.000, 0.045)},
        {"shoulder", arm.at(0.150, 0.000, 0.028)}}},
      {"deltoid_posterior",
       0.019,
       {{"clavicle", {-0.150, 1.458, -0.055}},
        {"shoulder", arm.at(0.055, -0.043, 0.022)},
        {"shoulder", arm.at(0.145, -0.010, 0.026)}}},
      {"pectoralis_clavicular",
       0.018,
       {{"clavicle", {-0.055, 1.448, 0.050}},
        {"clavicle", {-0.118, 1.418, 0.062}},
        {"shoulder", arm.at(0.080, 0.022, 0.004)}}},
      {"pectoralis_sternal",
       0.022,
       {{"torso", {-0.012, 1.350, 0.095}},
        {"torso", {-0.090, 1.362, 0.085}},
        {"shoulder", arm.at(0.090, 0.020, 0.000)}}},
      {"latissimus",
       0.020,
       {{"torso", {-0.050, 1.190, -0.085}},
        {"torso", {-0.120, 1.290, -0.070}},
        {"shoulder", arm.at(0.070, 0.004, -0.018)}}},
      {"teres_major",
       0.015,
       {{"clavicle", {-0.105, 1.335, -0.085}},
        {"clavicle", {-0.150, 1.365, -0.060}},
        {"shoulder", arm.at(0.080, -0.004, -0.020)}}},
      {"infraspinatus",
       0.015,
       {{"clavicle", {-0.075, 1.395, -0.090}},
        {"clavicle", {-0.140, 1.420, -0.065}},
        {"shoulder", arm.at(0.012, -0.030, 0.014)}}},
      {"biceps_long",
       0.019,
       {{"clavicle", arm.at(-0.012, 0.012, 0.008)},
        {"shoulder", arm.at(0.030, 0.030, 0.008)},
        {"shoulder", arm.at(0.165, 0.042, 0.006)},
        {"shoulder", arm.at(0.275, 0.030, 0.002)},
        {"elbow", fore.at(0.045, 0.008, 0.003)}}},
      {"biceps_short",
       0.019,
       {{"clavicle", {-0.150, 1.435, 0.022}},
        {"shoulder", arm.at(0.160, 0.040, -0.018)},
        {"shoulder", arm.at(0.275, 0.028, -0.004)},
        {"elbow", fore.at(0.045, 0.006, 0.000)}}},
      {"brachialis",
       0.018,
       {{"shoulder", arm.at(0.160, 0.012, 0.010)},
        {"shoulder", arm.at(0.240, 0.018, 0.008)},
        {"elbow", fore.at(0.032, 0.008, -0.002)}}},
      {"triceps_long",
       0.021,
       {{"clavicle", arm.at(0.012, -0.012, -0.020)},
        {"shoulder", arm.at(0.130, -0.040, -0.016)},
        {"shoulder", arm.at(0.260, -0.030, -0.002)},
        {"elbow", olecranon}}},
      {"triceps_lateral",
       0.018,
       {{"shoulder", arm.at(0.060, -0.018, 0.014)},
        {"shoulder", arm.at(0.150, -0.036, 0.024)},
        {"shoulder", arm.at(0.260, -0.028, 0.006)},
        {"elbow", olecranon}}},
      {"triceps_medial",
       0.015,
       {{"shoulder", arm.at(0.130, -0.012, -0.006)},
        {"shoulder", arm.at(0.220, -0.022, -0.012)},
        {"elbow", olecranon}}},
      {"brachioradialis",
       0.014,
       {{"shoulder", arm.at(0.230, 0.004, 0.020)},
        {"elbow", fore.at(0.030, 0.024, 0.018)},
        {"forearm", fore.at(0.110, 0.024, 0.012)},
        {"forearm_twist", fore.at(0.245, 0.020, 0.006)}}},
      {"pronator_teres",
       0.010,
       {{"shoulder", arm.at(0.292, 0.008, -0.022)},
        {"elbow", fore.at(0.035, 0.020, -0.014)},
        {"forearm", fore.at(0.110, 0.014, 0.008)}}},
      {"wrist_flexors",
       0.016,
       {{"shoulder", arm.at(0.292, 0.000, -0.028)},
        {"elbow", fore.at(0.060, 0.004, -0.028)},
        {"forearm", fore.at(0.110, 0.006, -0.022)},
        {"forearm_twist", fore.at(0.215, 0.006, -0.014)},
        {"wrist", hand.at(0.030, 0.004, -0.012)}}},
      {"wrist_extensors",
       0.015,
       {{"shoulder", arm.at(0.290, 0.000, 0.024)},
        {"elbow", fore.at(0.060, -0.008, 0.026)},
        {"forearm", fore.at(0.110, -0.010, 0.022)},
        {"forearm_twist", fore.at(0.215, -0.004, 0.014)},
        {"wrist", hand.at(0.030, 0.000, 0.010)}}},
      {"finger_flexors",
       0.010,
       {{"elbow", fore.at(0.040, -0.004, -0.014)},
        {"forearm", fore.at(0.110, 0.000, -0.014)},
        {"forearm_twist", fore.at(0.225, 0.000, -0.010)},
        {"wrist", hand.at(0.050, 0.008, -0.008)},
        {"fingers", 0.5 * (middle.joints[0] + middle.joints[1])}}},
  };
}

// Moves a point that is less than `depth` under the skin deeper, as far as the limb is thick enough.
Vector3d tuck(const Solid& body, const Vector3d& point, double depth) {
  return body.distance(point) > -depth ? body.project(point, depth) : point;
}

}  // namespace

std::vector<Muscle> arm_muscles(const Skeleton& skeleton) {
  const Solid body(body_parts());
  std::vector<Muscle> muscles;
  for (const MusclePlan& plan : plan_muscles()) {
    Muscle muscle;
    muscle.name = plan.name;
    muscle.radius = plan.radius;
    for (std::size_t k = 0; k < plan.path.size(); ++k) {
      const bool tendon = k == 0 || k + 1 == plan.path.size();
      const Vector3d p = tuck(body, plan.path[k].position, tendon ? kTendonDepth : kBellyDepth * plan.radius);
      const int joint = skeleton.find(plan.path[k].joint);
      if (joint < 0) throw std::logic_error(std::string("no joint ") + plan.path[k].joint);
      muscle.path.push_back({static_cast<std::uint32_t>(joint), {p.x(), p.y(), p.z()}});
    }
    muscles.push_back(muscle);
  }
  return muscles;
}

}  // namespace bodyopt
