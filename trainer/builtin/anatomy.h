// Where the parts of the built-in character are: a right arm on a torso stub, from a man of 1.8 m who stands with the
// arm lifted sideways and the palm turned in. Rest space: metres, Y up, facing +Z, the right arm towards -X.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "trainer/builtin/implicit.h"

namespace bodyopt {

// Coordinates of one segment of the limb. Axes are unit and perpendicular.
struct SegmentFrame {
  Eigen::Vector3d origin;
  Eigen::Vector3d along;  // towards the fingertips
  Eigen::Vector3d front;  // towards the biceps; towards the thumb on the hand
  Eigen::Vector3d side;   // away from the body; to the back of the hand on the hand

  // Metres along the three axes.
  Eigen::Vector3d at(double u, double f, double s) const { return origin + u * along + f * front + s * side; }
};

SegmentFrame upper_arm_frame();  // origin: centre of the shoulder joint
SegmentFrame forearm_frame();    // origin: centre of the elbow
SegmentFrame hand_frame();       // origin: centre of the wrist

// Lengths between joints, metres.
inline constexpr double kUpperArmLength = 0.305;
inline constexpr double kForearmLength = 0.262;

// Angles of the rest pose, degrees.
inline constexpr double kRestAbduction = 50;  // upper arm away from straight down
inline constexpr double kRestElbowFlexion = 20;

// One finger: knuckle, middle joint, end joint, tip. The thumb starts at its base in the wrist.
struct Finger {
  Eigen::Vector3d joints[4];
  double radii[4];
};
std::vector<Finger> fingers();  // index, middle, ring, little
Finger thumb();

std::vector<RoundedPart> torso_parts();
// The whole skin: the torso, then everything that moves with the arm.
std::vector<RoundedPart> body_parts();

// The wanted length of a triangle's edge, metres: coarse on the chest, fine on the fingers.
double edge_length(const Eigen::Vector3d& point);

}  // namespace bodyopt
