// Places inside a body, told by its landmarks.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "assets/json_file.h"
#include "trainer/anatomy/lean_samples.h"

namespace bodyopt {

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

}  // namespace bodyopt
