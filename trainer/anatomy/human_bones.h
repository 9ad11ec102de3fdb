// The bones and cavities of a human, from tables of landmarks about its joints. Half space; millimetres of tables are
// those of a man of 1.75 m.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "trainer/anatomy/bone.h"
#include "trainer/anatomy/human_frame.h"

namespace bodyopt::trainer {

// The bones as they are placed, and what places them.
struct HumanSkeleton {
  const BodySurvey& survey;
  const HumanFrame& frame;
  std::vector<Bone> bones{};
  std::map<std::string, Eigen::Vector3d> landmarks{};

  double mm(double millimetres) const { return millimetres * frame.mm; }
  Eigen::Vector3d mm(double x, double y, double z) const { return frame.mm * Eigen::Vector3d(x, y, z); }
  static constexpr double kCover = 3.5;  // millimetres
  void add(int joint, std::function<double(const Spot&)> distance, double cover = kCover);
  // Adds what lies deeper than a share of a region's half thickness, for fingers and toes. share(joint): 0 for none.
  void add_cores(BodyRegion region, const std::function<double(int)>& share);
  // Joints of the spine from below: each holds what lies above it, and below the next.
  void add_by_height(std::vector<HumanFrame::Place> places, const std::function<double(const Spot&)>& distance);
};

// V, metres, skin left out: of a man of 15 % body fat. Only the pattern counts, lay_fat() finds the scale.
Eigen::VectorXd human_fat_pattern(const BodySurvey& survey, const HumanFrame& frame);

void add_limbs(HumanSkeleton& skeleton);  // with hands and feet
// Pelvis, spine, ribs and shoulder girdles. Returns how far a place is from the wall of chest, belly, pelvis and
// throat, roughly, metres; negative inside.
std::function<double(const Spot&)> add_trunk(HumanSkeleton& skeleton);
void add_head(HumanSkeleton& skeleton);

}  // namespace bodyopt::trainer
