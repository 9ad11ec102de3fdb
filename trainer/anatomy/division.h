// Lean tissue divided among muscles, each of the volume that anatomists measure.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "trainer/anatomy/inner_tissue.h"
#include "trainer/anatomy/muscle_candidates.h"

namespace bodyopt {

// Of one half of a body; muscles are those of this half, numbered as in `muscles`.
struct Division {
  struct OfMuscle {
    int muscle = -1;                      // in the list given
    std::vector<int> slips;               // in that list: all that share this region alike, `muscle` among them
    Positions path;                       // 48 x 3, half space: drawn to its bones and to the middle of its own region
    double belly_from = 0, belly_to = 1;  // along the path
    double volume = 0, target = 0;        // cubic metres; target: a table's, scaled, or else what its radius says
    int pieces = 0;                       // of its region, connected through faces of cells
    double ends_off_bone[2] = {0, 0};     // metres: origin, insertion; to the nearest bone of its joints
    int end_joint[2] = {-1, -1};          // the bones that its ends are tied to
    std::string limb;                     // of limb_factors; empty: none
  };
  std::vector<OfMuscle> muscles;
  std::vector<int> label;                      // S: in `muscles` above, -1: none
  std::vector<bool> is_tendon;                 // S: lies on a tendon of the muscle in `label`
  Positions fibre;                             // S x 3: unit, from origin to insertion; zero where no muscle is
  std::map<std::string, double> limb_factors;  // by how much the published volumes were scaled, limb by limb
};

// corrections: of volumes, by the muscles' names in the list; they count as asked for, beside limb factors.
Division divide_muscles(const HalfBody& body, const BodyGrid& grid, const InnerTissue& tissue,
                        const std::vector<Muscle>& muscles, const AnatomyCorrections& corrections = {});

// Lean tissue divided so that every muscle gets the volume that it should have: to the muscle whose spindle is nearest,
// of radii that are found by the volumes that come out (an additively weighted Voronoi diagram about the muscles'
// paths, constrained in capacity; Aurenhammer, Hoffmann and Aronov 1998).

class VolumeDivision {
 public:
  // Targets in cubic metres (M). `scale`: of lengths, against a man of 60 l. Paths are moved, their ends stay.
  VolumeDivision(const LeanSamples& lean, std::vector<HalfMuscle>& muscles, std::vector<double> targets, double scale);

  // Volumes first, then paths to the middle of what they got, several times; last, every region in one piece.
  void divide();

  const std::vector<int>& label() const { return label_; }       // L: muscle, -1: none's
  const std::vector<double>& volume() const { return volume_; }  // M, cubic metres
  std::vector<double> along_path() const;                        // L: 0 to 1 along the path of the sample's muscle

 private:
  struct Steps;
  void assign();
  void assign_in_one_piece();
  void measure();
  void adapt(Steps& steps);
  void centre_paths();
  double error() const;
  std::vector<double> radii() const;

  const LeanSamples& lean_;
  std::vector<HalfMuscle>& muscles_;
  const std::vector<double> targets_;
  const double scale_;
  std::vector<Positions> first_path_;  // M
  MuscleCandidates candidates_;
  std::vector<double> squares_;  // M, square metres: of the spindles' radii, negative for less than none
  std::vector<int> label_;
  std::vector<double> volume_;
};

}  // namespace bodyopt
