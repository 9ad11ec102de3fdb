// A body without tables of its own: any but a human. Bones lie along chains of joints, as thick as the body allows.
#pragma once

#include "trainer/anatomy/bone.h"
#include "trainer/anatomy/spine_curve.h"

namespace bodyopt::trainer {

struct Animal {
  const BodySurvey& survey;
  const JointChains& chains;
  const SpineCurve& spine;
  BodyKind kind;
  double size;  // metres: the longest extent, the unit of radii

  const Eigen::Vector3d& place(int joint) const { return survey.body().places[static_cast<std::size_t>(joint)]; }
  const std::string& name(int joint) const { return survey.body().joints[static_cast<std::size_t>(joint)].name; }
};

// A joint that holds the piece of trunk which a lone limb comes with.
bool holds_piece_of_trunk(const Animal& animal, int joint);
// Distance to the middle of the ribs in that piece, metres; negative inside.
double rib_shell_distance(const Animal& animal, const Spot& spot);

// Shares of a section that chest and belly leave.
struct CavityWalls {
  double aside, below;  // of the half width, of the height: muscle and bone there
  double chest = 0;     // the part of the cavity, from its front, that ribs are about
  double end = 0.18;    // of its length: its ends narrow over so much
};

class AnimalCavity {
 public:
  explicit AnimalCavity(const Animal& animal);
  bool empty() const { return to_ <= from_; }
  double from() const { return from_; }
  double to() const { return to_; }
  double chest_from() const { return to_ - walls_.chest * (to_ - from_); }
  // Distance to its wall, roughly, metres; negative inside. `grown`: of a cavity so much larger on all sides.
  double distance(const Spot& spot, const SpineCurve::Spot& at, double grown = 0) const;
  double distance(const Spot& spot) const;

 private:
  const Animal& animal_;
  CavityWalls walls_;
  double from_ = 0, to_ = 0;  // rows of the spine
};

// Radii are multiplied by `thickness`.
std::vector<Bone> girdle_bones(const Animal& animal, double thickness);
// Vertebrae with their spinous processes; ribs, breastbone.
std::vector<Bone> axis_bones(const Animal& animal, const AnimalCavity& cavity, double thickness);
// The skull lies deep in the head, where that has a joint of its own.
std::vector<Bone> skull_bones(const Animal& animal);

// The inside of any body but a human's. Throws nothing for bodies without bones: notes say what could not be placed.
InnerTissue find_animal_tissue(const HalfBody& body, const BodyGrid& grid, const InnerTissueOptions& options);

}  // namespace bodyopt::trainer
