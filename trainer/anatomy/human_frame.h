// The joints of a human, whatever its rig calls them, and the shapes that its bones and cavities follow.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/json_file.h"
#include "trainer/anatomy/body_survey.h"
#include "trainer/anatomy/inner_tissue.h"

namespace bodyopt::trainer {

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

// The part of a vector across a unit axis, unit; `otherwise` where nothing is left.
Eigen::Vector3d across(const Eigen::Vector3d& vector, const Eigen::Vector3d& axis, const Eigen::Vector3d& otherwise);

// Places inside a body, relative to its landmarks.

// One point of a table: {"at": {"acromion": 0.5, "sacrum": 0.5}, "mm": [outwards, up, forwards], "under_fat": mm}.
struct LandmarkPoint {
  std::vector<std::pair<std::string, double>> at;    // landmarks and their shares, 1 in all
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();  // millimetres of a man of 1.75 m
  std::optional<double> under_fat;                   // millimetres: it goes to lean tissue so far under the fat
};
LandmarkPoint read_landmark_point(const JsonObject& json);

// Landmarks of InnerTissue, and joints of a half body by the names of their parts: "thigh_joint", "neck_joint" ...
class LandmarkPlaces {
 public:
  LandmarkPlaces(const HalfBody& body, const LeanSamples& lean);

  // Half space; none where a landmark is missing.
  std::optional<Eigen::Vector3d> place(const LandmarkPoint& point) const;
  double millimetre() const { return millimetre_; }  // of a man of 1.75 m, in metres of this body

 private:
  const LeanSamples& lean_;
  std::map<std::string, Eigen::Vector3d> places_;
  double millimetre_;
};

}  // namespace bodyopt::trainer
