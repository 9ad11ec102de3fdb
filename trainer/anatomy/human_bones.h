// The bones and cavities of a human, from tables of landmarks about its joints. Half space; millimetres of tables are
// those of a man of 1.75 m.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "trainer/anatomy/bone.h"
#include "trainer/anatomy/human_frame.h"

namespace bodyopt {

// What bones are placed by, and where they go.
struct HumanSkeleton {
  const BodySurvey& survey;
  const HumanFrame& frame;
  std::vector<Bone> bones{};
  std::map<std::string, Eigen::Vector3d> landmarks{};

  double mm(double millimetres) const { return millimetres * frame.mm; }
  Eigen::Vector3d mm(double x, double y, double z) const { return frame.mm * Eigen::Vector3d(x, y, z); }
  static constexpr double kCover = 3.5;  // millimetres
  void add(int joint, std::function<double(const Spot&)> distance, double cover = kCover);
  // What lies deeper than a share of the half thickness of a region, for fingers and toes. share(joint): 0 for none.
  void add_cores(BodyRegion region, const std::function<double(int)>& share);
  // Joints of the spine from below: each holds what lies above it, and below the next.
  void add_by_height(std::vector<HumanFrame::Place> places, const std::function<double(const Spot&)>& distance);
};

// The vertebrae's middles, from the sacrum to the skull.
struct SpineLine {
  double low = 0, high = 0;  // heights
  Table forward;             // z of height
  Table half_width, half_depth;
};
SpineLine spine_line(const HumanSkeleton& skeleton);

// Ribs and breastbone: a shell about the lungs, of which every other strip is rib.
class RibCage {
 public:
  RibCage(const HumanSkeleton& skeleton, double crest_height);
  double distance(const Spot& spot) const;  // to its outer surface, roughly; negative inside
  double bone_distance(const Spot& spot) const;
  double shell() const { return 10 * mm_; }  // metres thick
  double bottom() const { return bottom_; }
  double costal_arch(const Spot& spot) const;  // height at which it ends, above or below a place

 private:
  double wall_distance(const Spot& spot) const;  // open above and below
  Table half_width_, back_, front_;              // of height
  double top_, bottom_, mm_;
};

void add_leg(HumanSkeleton& skeleton);
void add_foot(HumanSkeleton& skeleton);
void add_arm(HumanSkeleton& skeleton);
void add_hand(HumanSkeleton& skeleton);
void add_pelvis(HumanSkeleton& skeleton);
void add_spine(HumanSkeleton& skeleton, const SpineLine& spine);
void add_rib_cage(HumanSkeleton& skeleton, const RibCage& cage);
void add_shoulder_girdle(HumanSkeleton& skeleton, const RibCage& cage);
void add_head(HumanSkeleton& skeleton);

// To the wall of chest, belly, pelvis and throat, roughly; negative inside.
std::function<double(const Spot&)> human_cavity(const HumanSkeleton& skeleton, const SpineLine& spine,
                                                const RibCage& cage);

}  // namespace bodyopt
