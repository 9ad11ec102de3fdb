#include "trainer/builtin/anatomy.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace bodyopt {
namespace {

using Eigen::Vector3d;

constexpr double kDegree = std::numbers::pi / 180;

const Vector3d kShoulder(-0.182, 1.432, -0.012);

double smoothstep(double low, double high, double x) {
  const double t = std::clamp((x - low) / (high - low), 0.0, 1.0);
  return t * t * (3 - 2 * t);
}

// Everything behind a plane, as a ball so large that its surface is flat.
RoundedPart behind_plane(const Vector3d& point, const Vector3d& normal, double blend) {
  constexpr double kRadius = 20;
  RoundedPart part =
      belly(point - kRadius * normal, normal, normal.unitOrthogonal(), Vector3d::Constant(kRadius), blend);
  part.keep_inside = true;
  return part;
}

void append(std::vector<RoundedPart>& parts, const std::vector<RoundedPart>& more) {
  parts.insert(parts.end(), more.begin(), more.end());
}

std::vector<RoundedPart> shoulder_parts() {
  const SegmentFrame arm = upper_arm_frame();
  const Vector3d lift = Vector3d::UnitY();
  return {
      // The fold in front of the armpit (pectoral tail) and behind it (latissimus and teres major).
      limb({-0.105, 1.375, 0.072}, arm.at(0.080, 0.020, 0.000), 0.036, 0.022, 0.04),
      limb({-0.108, 1.270, -0.056}, arm.at(0.070, -0.024, -0.006), 0.036, 0.022, 0.05),
      // Deltoid: front, middle, back.
      belly(arm.at(0.050, 0.031, 0.014), arm.along - 0.1 * arm.side, arm.front, {0.092, 0.030, 0.038}, 0.025),
      belly(arm.at(0.050, 0.000, 0.029), arm.along - 0.1 * arm.side, arm.front, {0.100, 0.040, 0.032}, 0.025),
      belly(arm.at(0.050, -0.031, 0.014), arm.along - 0.1 * arm.side, arm.front, {0.092, 0.030, 0.038}, 0.025),
      limb({-0.150, 1.472, -0.028}, {-0.185, 1.472, -0.014}, 0.020, 0.020, 0.03, lift, 0.8),
  };
}

std::vector<RoundedPart> upper_arm_parts() {
  const SegmentFrame arm = upper_arm_frame();
  const SegmentFrame fore = forearm_frame();
  return {
      limb(arm.at(0, 0, 0), arm.at(kUpperArmLength, 0, 0), 0.047, 0.027, 0.03),
      belly(arm.at(0.168, 0.027, -0.007), arm.along, arm.side, {0.110, 0.036, 0.034}, 0.015),   // biceps
      belly(arm.at(0.135, -0.024, -0.014), arm.along, arm.side, {0.125, 0.031, 0.033}, 0.015),  // triceps, long head
      belly(arm.at(0.155, -0.024, 0.020), arm.along, arm.side, {0.090, 0.025, 0.030}, 0.015),   // lateral head
      limb(arm.at(0.180, -0.020, 0), fore.at(0.000, -0.012, 0), 0.030, 0.022, 0.02, arm.front, 0.8),
      spindle(fore.at(0.06, 0.006, 0), arm.at(0.12, 0.004, 0.010), 0.018, 0.018, 0.013, 0.02),  // brachialis
  };
}

std::vector<RoundedPart> forearm_parts() {
  const SegmentFrame arm = upper_arm_frame();
  const SegmentFrame fore = forearm_frame();
  return {
      limb(fore.at(-0.012, 0.000, -0.021), fore.at(-0.012, 0.000, 0.018), 0.015, 0.015, 0.04),  // epicondyles
      limb(fore.at(-0.012, -0.018, 0.001), fore.at(0.16, -0.010, 0.002), 0.011, 0.013, 0.02),   // olecranon and ulna
      limb(fore.at(0.11, 0, 0), fore.at(kForearmLength, 0, 0), 0.024, 0.0265, 0.04, fore.side, 0.70),
      spindle(fore.at(0, 0, 0), fore.at(0.250, 0, 0), 0.027, 0.017, 0.011, 0.02),
      spindle(fore.at(-0.015, 0.000, -0.018), fore.at(0.250, 0.004, -0.006), 0.013, 0.010, 0.016, 0.02),  // flexors
      spindle(fore.at(-0.040, 0.000, 0.014), fore.at(0.250, -0.006, 0.004), 0.012, 0.010, 0.016, 0.02),   // extensors
      spindle(arm.at(0.210, 0.000, 0.012), fore.at(0.220, 0.010, 0.002), 0.012, 0.010, 0.017, 0.02),  // brachioradialis
  };
}

std::vector<RoundedPart> finger_parts(const Finger& finger, double blend) {
  std::vector<RoundedPart> parts;
  for (int k = 0; k < 3; ++k) {
    // Between phalanges the end spheres coincide already; only the root melts into the hand.
    parts.push_back(
        limb(finger.joints[k], finger.joints[k + 1], finger.radii[k], finger.radii[k + 1], k == 0 ? blend : 0.002));
  }
  return parts;
}

std::vector<RoundedPart> hand_parts() {
  const SegmentFrame hand = hand_frame();
  std::vector<RoundedPart> parts{
      limb(hand.at(-0.01, 0, 0), hand.at(0.03, 0, 0), 0.027, 0.028, 0.02, hand.side, 0.62),
      belly(hand.at(0.045, 0, -0.002), hand.along, hand.front, {0.05, 0.036, 0.0125}, 0.015),
      belly(hand.at(0.040, 0.024, -0.013), hand.at(0.055, 0.050, -0.022) - hand.at(0.012, 0.018, -0.008), hand.side,
            {0.036, 0.016, 0.018}, 0.015),  // ball of the thumb
      belly(hand.at(0.045, -0.024, -0.010), hand.along, hand.side, {0.040, 0.014, 0.015},
            0.015),  // little finger's side
  };
  const double roots[4] = {0.017, 0.006, -0.005, -0.016};
  const std::vector<Finger> all = fingers();
  for (int k = 0; k < 4; ++k) {
    const Finger& finger = all[k];
    parts.push_back(limb(hand.at(0.015, roots[k], 0.0), finger.joints[0], 0.0125, finger.radii[0] + 0.001, 0.012));
  }
  append(parts, finger_parts(thumb(), 0.008));
  for (const Finger& finger : all) append(parts, finger_parts(finger, 0.004));
  return parts;
}

}  // namespace

SegmentFrame upper_arm_frame() {
  const double s = std::sin(kRestAbduction * kDegree), c = std::cos(kRestAbduction * kDegree);
  return {kShoulder, Vector3d(-s, -c, 0), Vector3d::UnitZ(), Vector3d(-c, s, 0)};
}

SegmentFrame forearm_frame() {
  const SegmentFrame arm = upper_arm_frame();
  const double s = std::sin(kRestElbowFlexion * kDegree), c = std::cos(kRestElbowFlexion * kDegree);
  return {arm.at(kUpperArmLength, 0, 0), c * arm.along + s * arm.front, c * arm.front - s * arm.along, arm.side};
}

SegmentFrame hand_frame() {
  SegmentFrame frame = forearm_frame();
  frame.origin = frame.at(kForearmLength, 0, 0);
  return frame;
}

std::vector<Finger> fingers() {
  struct Shape {
    double along, front;  // knuckle in the hand's frame, metres
    double spread;        // degrees towards the thumb
    double phalanges[3];  // metres
    double radius;        // at the knuckle, metres
  };
  constexpr Shape kShapes[] = {
      {0.092, 0.0335, 9, {0.043, 0.026, 0.018}, 0.0100},
      {0.096, 0.0115, 2.5, {0.047, 0.029, 0.019}, 0.0102},
      {0.091, -0.0110, -5, {0.044, 0.027, 0.018}, 0.0098},
      {0.082, -0.0325, -13, {0.034, 0.021, 0.016}, 0.0088},
  };
  constexpr double kCurl[] = {12, 26, 36};  // degrees towards the palm, of each phalanx
  const SegmentFrame hand = hand_frame();
  std::vector<Finger> all;
  for (const Shape& shape : kShapes) {
    Finger finger;
    finger.joints[0] = hand.at(shape.along, shape.front, 0.001);
    const Vector3d straight =
        std::cos(shape.spread * kDegree) * hand.along + std::sin(shape.spread * kDegree) * hand.front;
    for (int k = 0; k < 3; ++k) {
      const double curl = kCurl[k] * kDegree;
      finger.joints[k + 1] =
          finger.joints[k] + shape.phalanges[k] * (std::cos(curl) * straight - std::sin(curl) * hand.side);
    }
    const double taper[] = {1, 0.93, 0.86, 0.76};
    for (int k = 0; k < 4; ++k) finger.radii[k] = taper[k] * shape.radius;
    all.push_back(finger);
  }
  return all;
}

Finger thumb() {
  const SegmentFrame hand = hand_frame();
  return {{hand.at(0.016, 0.020, -0.010), hand.at(0.054, 0.050, -0.024), hand.at(0.083, 0.063, -0.031),
           hand.at(0.105, 0.069, -0.035)},
          {0.0155, 0.0125, 0.0112, 0.0088}};
}

std::vector<RoundedPart> torso_parts() {
  const Vector3d right = -Vector3d::UnitX(), up = Vector3d::UnitY();
  std::vector<RoundedPart> parts{
      belly({0, 1.260, 0.000}, up, right, {0.300, 0.150, 0.110}, 0.03),                                // ribcage
      limb({0, 1.390, -0.012}, {-0.095, 1.400, -0.015}, 0.088, 0.062, 0.06),                           // upper chest
      limb({0, 1.430, -0.020}, {0, 1.620, 0.005}, 0.057, 0.053, 0.03),                                 // neck
      limb({-0.030, 1.525, -0.030}, {-0.165, 1.458, -0.024}, 0.036, 0.026, 0.06),                      // trapezius
      belly({-0.086, 1.368, 0.074}, {-0.90, 0.25, -0.30}, up, {0.104, 0.066, 0.030}, 0.05),            // pectoral
      belly({-0.085, 1.390, -0.084}, {-0.75, 0.65, 0.15}, up, {0.090, 0.064, 0.028}, 0.05),            // scapula
      belly({-0.116, 1.210, -0.045}, {-0.12, 1, -0.05}, {-0.6, 0, -0.6}, {0.210, 0.030, 0.07}, 0.06),  // latissimus
  };
  // What lies just under the skin is laid on what is below.
  const Solid below(parts);
  const Vector3d notch = below.project({-0.020, 1.456, 0.060}, 0.004);
  const Vector3d bend = below.project({-0.090, 1.466, 0.050}, 0.003);
  const Vector3d neck = below.project({-0.050, 1.600, 0.010}, 0.008);
  parts.push_back(limb(notch, bend, 0.011, 0.0085, 0.015));  // clavicle
  parts.push_back(limb(bend, {-0.165, 1.474, 0.000}, 0.0085, 0.011, 0.004));
  parts.push_back(limb(notch, neck, 0.009, 0.016, 0.02));  // sternomastoid
  parts.push_back(behind_plane({0.028, 1.3, 0}, Vector3d::UnitX(), 0.035));
  parts.push_back(behind_plane({0, 1.130, 0}, -up, 0.035));
  parts.push_back(behind_plane({0, 1.590, 0.02}, Vector3d(0, 1, 0.15).normalized(), 0.03));
  return parts;
}

std::vector<RoundedPart> body_parts() {
  std::vector<RoundedPart> parts = torso_parts();
  append(parts, shoulder_parts());
  append(parts, upper_arm_parts());
  append(parts, forearm_parts());
  append(parts, hand_parts());
  return parts;
}

double edge_length(const Vector3d& point) {
  const double to_shoulder = smoothstep(0.17, 0.03, (point - kShoulder).x());
  const double to_hand = smoothstep(-0.08, 0.04, hand_frame().along.dot(point - hand_frame().origin));
  const double on_torso = 0.0135 + (0.0096 - 0.0135) * to_shoulder;
  return on_torso + (0.0057 - on_torso) * to_hand;
}

}  // namespace bodyopt
