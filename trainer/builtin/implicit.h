// A solid as a smooth union of rounded parts, by signed distance. Rest space, metres.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace bodyopt {

// A capsule whose radius goes linearly from one end to the other, in a frame that may be stretched: with a segment of
// length 0 and radius 1 it is an ellipsoid, with a flattened frame a limb of oval section.
struct RoundedPart {
  Eigen::Matrix3d to_local;  // rest offset to the stretched frame, whose first axis is the segment
  Eigen::Vector3d start;     // first end of the segment, rest space
  double length = 0;         // of the segment, in the stretched frame
  double start_radius = 1;   // in the stretched frame
  double end_radius = 1;
  double bulge = 0;          // added to the radius a third along the segment, less towards its ends
  double blend = 0.02;       // metres over which the part melts into those before it
  bool keep_inside = false;  // intersect with the parts before it instead of joining them
};

// A tapered capsule from a to b. `flat_axis` (perpendicular to b - a) and `flat` squeeze its section: 0.5 halves the
// thickness along that axis.
RoundedPart limb(const Eigen::Vector3d& a, const Eigen::Vector3d& b, double radius_a, double radius_b, double blend,
                 const Eigen::Vector3d& flat_axis = Eigen::Vector3d::Zero(), double flat = 1);

// A muscle from tendon a to tendon b, `bulge` metres thicker a third along.
RoundedPart spindle(const Eigen::Vector3d& a, const Eigen::Vector3d& b, double radius_a, double radius_b, double bulge,
                    double blend);

// An ellipsoid with half-axes `half` along `along`, `across` (made perpendicular to it) and their cross product.
RoundedPart belly(const Eigen::Vector3d& centre, const Eigen::Vector3d& along, const Eigen::Vector3d& across,
                  const Eigen::Vector3d& half, double blend);

struct DistanceSample {
  double distance;           // metres, negative inside; exact to first order near a part's surface
  Eigen::Vector3d gradient;  // about unit length
};

DistanceSample sample(const std::vector<RoundedPart>& parts, const Eigen::Vector3d& point);
inline double distance(const std::vector<RoundedPart>& parts, const Eigen::Vector3d& point) {
  return sample(parts, point).distance;
}

// The surface point below or above `point`, by Newton steps along the gradient. `depth` > 0 aims at that distance
// inside instead.
Eigen::Vector3d project(const std::vector<RoundedPart>& parts, Eigen::Vector3d point, double depth = 0);

}  // namespace bodyopt
