// The paths of muscles on one half of a body.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "trainer/anatomy/half_body.h"
#include "trainer/anatomy/muscle_targets.h"

namespace bodyopt {

constexpr int kPathPoints = 48;

// What is to have one region: a muscle, or the slips that share one.
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
// At equal distances along a polyline (P x 3, 2 or more).
Positions resampled(const Positions& path, int count);
// Along a path, by a Gauss kernel of so many points; beyond the ends stand the ends.
Eigen::MatrixXd smoothed_along(const Eigen::MatrixXd& rows, double width);

// M: the muscle on the other side of each, by its name or its place; -1: none.
std::vector<int> mirrored_muscles(const HalfBody& body, const std::vector<Muscle>& muscles);

// M, metres: how far a path lies on average from the mirror image of its counterpart's; 0 without a counterpart.
std::vector<double> off_mirror_images(const HalfBody& body, const std::vector<Muscle>& muscles);

// Those on this half's side of the median plane. Of a body that is its own mirror image, paths of left and right are
// averaged, and a muscle that only the right side has is here, too.
std::vector<HalfMuscle> muscles_of_half(const HalfBody& body, const std::vector<Muscle>& muscles);

}  // namespace bodyopt
