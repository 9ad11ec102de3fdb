// Lean tissue divided so that every muscle gets the volume that it should have: to the muscle whose spindle is nearest,
// of radii that are found by the volumes that come out (an additively weighted Voronoi diagram about the muscles'
// paths, constrained in capacity; Aurenhammer, Hoffmann and Aronov 1998).
#pragma once

#include <vector>

#include "trainer/anatomy/muscle_candidates.h"

namespace bodyopt {

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
