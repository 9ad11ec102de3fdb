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

// Parts joined in order.
class Solid {
 public:
  Solid() = default;
  explicit Solid(std::vector<RoundedPart> parts) : parts_(std::move(parts)) {}
  // The same, made fast inside the box from `low` to `high`: each cell of a grid knows the parts that matter there.
  Solid(std::vector<RoundedPart> parts, const Eigen::Vector3d& low, const Eigen::Vector3d& high);

  DistanceSample sample(const Eigen::Vector3d& point) const;
  double distance(const Eigen::Vector3d& point) const { return sample(point).distance; }

  // The surface point near `point`, or the one `depth` metres inside, by Newton steps along the gradient.
  Eigen::Vector3d project(Eigen::Vector3d point, double depth = 0) const;

 private:
  static constexpr double kCell = 0.03;  // metres

  int cell_of(const Eigen::Vector3d& point) const;  // -1 outside the grid

  std::vector<RoundedPart> parts_;
  Eigen::Vector3d low_ = Eigen::Vector3d::Zero();
  Eigen::Vector3i cells_ = Eigen::Vector3i::Zero();
  std::vector<std::vector<RoundedPart>> near_;  // parts that matter in each cell
};

}  // namespace bodyopt
