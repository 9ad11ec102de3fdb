// Where a human's joints are, whatever its rig calls them, and the shapes that its bones and cavities follow.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "trainer/anatomy/body_survey.h"

namespace bodyopt {

// Lengths in the tables of bones are those of a man of 1.75 m.
constexpr double kReferenceStature = 1.75;

// Half space. A place is nothing where neither the rig nor the other side of the body has it.
struct HumanFrame {
  struct Place {
    int joint = -1;  // that a bone there belongs to
    Eigen::Vector3d at;
  };
  double mm = 1e-3;  // metres of this body for a millimetre of the tables
  std::optional<Place> hip, knee, ankle, toe;
  std::optional<Place> clavicle, shoulder, elbow, wrist, palm;
  std::optional<Place> pelvis, neck, head;
  std::vector<Place> spine;          // from below upwards
  std::vector<Place> cervical;       // necks, from below upwards
  std::vector<std::string> missing;  // what of these a rig lacks, for people

  bool has_leg() const { return hip && knee && ankle; }
  bool has_arm() const { return shoulder && elbow && wrist; }
  // The joint of the spine that holds a height: the highest that starts below it, the pelvis' below all.
  int spine_joint(double height) const;
};
HumanFrame frame_of(const HalfBody& body);

// A value at heights, straight in between, its ends beyond them.
class Table {
 public:
  Table() = default;
  Table(std::vector<std::pair<double, double>> rows) : rows_(std::move(rows)) {}  // ascending
  double operator()(double at) const;

 private:
  std::vector<std::pair<double, double>> rows_;
};

// Of a vector the part across a unit axis, unit; `otherwise` where nothing is left.
Eigen::Vector3d across(const Eigen::Vector3d& vector, const Eigen::Vector3d& axis, const Eigen::Vector3d& otherwise);

}  // namespace bodyopt
