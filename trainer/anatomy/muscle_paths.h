// The paths of muscles on one half of a body.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "trainer/anatomy/half_body.h"
#include "trainer/anatomy/inner_tissue.h"
#include "trainer/anatomy/muscle_targets.h"

namespace bodyopt::trainer {

constexpr int kPathPoints = 48;

// A muscle, or the slips that share one region.
struct HalfMuscle {
  std::vector<int> muscles;             // in the list of all
  std::string name;                     // matching_name() of the first
  const WholeMuscle* whole = nullptr;   // null: no table has it
  Positions path;                       // kPathPoints x 3, half space, at equal distances, origin first
  std::array<int, 2> joint{-1, -1};     // of this half, that the ends move with
  double belly_from = 0, belly_to = 1;  // along the path
  double volume_by_radius = 0;          // cubic metres: of a belly of the muscle's radius, 2 r^2 l
  bool is_guided = false;               // a table says where its middle lies
};

double path_length(const Positions& path);
// Points at equal distances along a polyline (P x 3, 2 or more).
Positions resampled(const Positions& path, int count);
// Smooths rows along a path by a Gaussian kernel of so many points; the ends stand for what lies beyond them.
Eigen::MatrixXd smoothed_along(const Eigen::MatrixXd& rows, double width);

// M: the muscle on the other side of each, by its name or its place; -1: none.
std::vector<int> mirrored_muscles(const HalfBody& body, const std::vector<Muscle>& muscles);

// M, metres: how far a path lies on average from the mirror image of its counterpart's; 0 without a counterpart.
std::vector<double> off_mirror_images(const HalfBody& body, const std::vector<Muscle>& muscles);

// The muscles on this half's side of the median plane. If the body is its own mirror image, paths of left and right are
// averaged, and muscles of the right side alone are here, too.
std::vector<HalfMuscle> muscles_of_half(const HalfBody& body, const std::vector<Muscle>& muscles);

// Attachments of muscles to bone.

struct BoneFoot {
  int joint = -1;  // -1: there is no bone
  Eigen::Vector3d place = Eigen::Vector3d::Zero();
  double distance = 0;  // metres, from the point asked for
};

// The surface of a half body's bones.
class BoneSurface {
 public:
  BoneSurface(const HalfBody& body, const BodyGrid& grid, const InnerTissue& tissue);

  // The nearest place on the bones of a joint, its parent, its grandparent and its children; on any bone if these have
  // none.
  BoneFoot foot(const Eigen::Vector3d& point, int joint) const;

 private:
  BoneFoot nearest(const Eigen::Vector3d& point, const std::vector<bool>& joints) const;

  const HalfBody& body_;
  const BodyGrid& grid_;
  const InnerTissue& tissue_;
  std::vector<int> samples_;  // in bone
};

// Draws the ends of paths to the nearest bone, and the ends' thirds along with them. Ends farther from it than 45 mm
// (in a man of 1.75 m) stay.
void draw_to_bone(const BoneSurface& bones, double scale, std::vector<HalfMuscle>& muscles);

// S: the muscle whose tendon lies there, -1: none's. A tendon reaches from a belly's end along the path to its bone.
std::vector<int> tendon_samples(const LeanSamples& lean, const std::vector<HalfMuscle>& muscles,
                                const std::vector<std::array<BoneFoot, 2>>& feet);

}  // namespace bodyopt::trainer
