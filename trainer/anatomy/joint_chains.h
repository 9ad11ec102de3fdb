// The joints of a body as an anatomist sees them. An axis runs from the tail to the head, limbs leave it, and some
// joints are no bones.
#pragma once

#include <string>
#include <vector>

#include "trainer/anatomy/half_body.h"

namespace bodyopt::trainer {

struct JointLimb {
  enum class Use : std::uint8_t { leg, arm, wing, fin, none };  // leg: its skin reaches the ground; none: ears, props
  Use use = Use::none;
  std::vector<int> joints;  // all that hang at its first one, parents first
  bool is_left = true;      // on the side of +x
  double skin = 0;          // its share of the skin's area
  double flatness = 1;      // its thickness to its width: of a wing little
};

struct JointChains {
  std::vector<int> parent;               // J: of the rig, but that detached feet hang where their skin does
  std::vector<double> skin;              // J: the share of the skin's area that follows a joint
  std::vector<Eigen::Vector3d> centre;   // J: of that skin
  std::vector<int> limb;                 // J: of which limb it is, -1: of none
  std::vector<bool> is_head, is_excess;  // J: at or below a head; by its name no bone: control, cloth, ear, prop
  std::vector<int> axis;                 // joints with skin, and those between them, from tail to head
  std::vector<JointLimb> limbs;

  bool has_skin(int joint) const { return skin[static_cast<std::size_t>(joint)] > 1e-3; }
  int count(JointLimb::Use use) const;  // on the side that has more
};

// `body`: of a whole body (halves_of() keeps all of the skin in either half), x out of the median plane.
JointChains find_chains(const HalfBody& body);

// J: the joint whose bone ends at this one, and which it moves with; -1 where no bone does.
std::vector<int> bone_parents(const JointChains& chains);

// Does a joint's name have one of these words? Words of four letters and more also count within another one.
bool is_named(const std::string& joint, std::initializer_list<std::string_view> words);

}  // namespace bodyopt::trainer
