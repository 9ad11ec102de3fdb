// Where muscles meet bone.
#pragma once

#include <array>
#include <vector>

#include "trainer/anatomy/lean_samples.h"
#include "trainer/anatomy/muscle_paths.h"

namespace bodyopt {

struct BoneFoot {
  int joint = -1;  // -1: there is no bone
  Eigen::Vector3d place = Eigen::Vector3d::Zero();
  double distance = 0;  // metres, from the point asked for
};

// The surface of a half body's bones.
class BoneSurface {
 public:
  BoneSurface(const HalfBody& body, const BodyGrid& grid, const InnerTissue& tissue);

  // Of the bones of a joint, its parent, its grandparent and its children, the nearest place; of any bone where these
  // have none.
  BoneFoot foot(const Eigen::Vector3d& point, int joint) const;

 private:
  BoneFoot nearest(const Eigen::Vector3d& point, const std::vector<bool>& joints) const;

  const HalfBody& body_;
  const BodyGrid& grid_;
  const InnerTissue& tissue_;
  std::vector<int> samples_;  // in bone
};

// Draws the ends of paths to the nearest bone where that is not farther than 45 mm (of a man of 1.75 m), the ends'
// thirds along with them; what is farther away stays.
void draw_to_bone(const BoneSurface& bones, double scale, std::vector<HalfMuscle>& muscles);

// S: the muscle whose tendon lies there, -1: none's. A tendon reaches from a belly's end along the path to its bone.
std::vector<int> tendon_samples(const LeanSamples& lean, const std::vector<HalfMuscle>& muscles,
                                const std::vector<std::array<BoneFoot, 2>>& feet);

}  // namespace bodyopt
