#include "trainer/anatomy/division.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <queue>
#include <tuple>

#include "base/disjoint_sets.h"
#include "trainer/anatomy/muscle_paths.h"

namespace bodyopt::trainer {
namespace {

using Eigen::Index;

// Lengths are relative to those of a man of 60 l, those of an arm or a leg alone to his.
double scale_of(const HalfBody& body, const BodyGrid& grid) {
  return std::cbrt(grid.size() * grid.volume() / (body.has_plane ? 0.03 : 0.004));
}

Division::OfMuscle described(const HalfMuscle& muscle, const std::array<BoneFoot, 2>& feet) {
  Division::OfMuscle result;
  result.muscle = muscle.muscles.front();
  result.slips = muscle.muscles;
  result.path = muscle.path;
  result.belly_from = muscle.belly_from;
  result.belly_to = muscle.belly_to;
  for (const std::size_t end : {0U, 1U}) {
    result.ends_off_bone[end] = feet[end].distance;
    result.end_joint[end] = feet[end].joint;
  }
  if (muscle.whole) result.limb = muscle.whole->limb;
  return result;
}

// Samples of a muscle that share a face are of one piece; tendons are of none.
void count_pieces(const BodyGrid& grid, Division& division) {
  DisjointSets pieces(division.label.size());
  const auto is_belly = [&](std::size_t s) { return division.label[s] >= 0 && !division.is_tendon[s]; };
  for (std::size_t s = 0; s < division.label.size(); ++s) {
    for (const int other : grid.beside(static_cast<int>(s))) {
      const auto o = static_cast<std::size_t>(other);
      if (other >= 0 && is_belly(s) && is_belly(o) && division.label[s] == division.label[o]) pieces.join(s, o);
    }
  }
  for (std::size_t s = 0; s < division.label.size(); ++s) {
    if (is_belly(s) && pieces.lowest(s) == s) ++division.muscles[static_cast<std::size_t>(division.label[s])].pieces;
  }
}

// Slips of one region each count for their share of it.
void correct_volumes(const std::vector<HalfMuscle>& own, const std::vector<Muscle>& muscles,
                     const AnatomyCorrections& corrections, std::vector<double>& volumes) {
  for (std::size_t m = 0; m < own.size(); ++m) {
    const double slip = volumes[m] / static_cast<double>(own[m].muscles.size());
    double volume = 0;
    for (const int muscle : own[m].muscles) {
      const auto found = corrections.muscles.find(muscles[static_cast<std::size_t>(muscle)].name);
      const AnatomyCorrections::OfMuscle of =
          found == corrections.muscles.end() ? AnatomyCorrections::OfMuscle{} : found->second;
      volume += of.volume > 0 ? of.volume : of.factor * slip;
    }
    volumes[m] = volume;
  }
}

constexpr int kRounds = 6, kStepsARound = 40, kLastSteps = 80, kConnectedSteps = 80;
constexpr double kBellySection = 0.6;  // mean section of a belly, of its largest
// Metres, of a man of 60 l.
constexpr double kFarthest = 0.004;  // from the spindle of a muscle: beyond, tissue is nobody's
constexpr double kLargestReach = 0.09, kReachBeyond = 0.022;
constexpr double kReachOfRadius = 2.6;
constexpr double kLeastSquare = -0.06 * 0.06, kLargestSquare = 0.15 * 0.15;
constexpr double kFirstStep = 0.006 * 0.006, kFirstConnectedStep = 0.004 * 0.004, kLargestStep = 0.03 * 0.03;
constexpr double kGuidedWay = 0.01, kWay = 0.02;  // that a path may be moved, with and without a table of sections
constexpr double kMedianGap = 0.0015;
constexpr double kSmallVolume = 5e-6;  // cubic metres: below, errors count less

double square_of_radius(const HalfMuscle& muscle, double target) {
  return target / (std::numbers::pi * kBellySection * std::max(path_length(muscle.path), 1e-6));
}

std::vector<double> reaches(const std::vector<HalfMuscle>& muscles, const std::vector<double>& targets, double scale) {
  std::vector<double> reach;
  for (std::size_t m = 0; m < muscles.size(); ++m) {
    const double radius = std::sqrt(square_of_radius(muscles[m], targets[m]));
    reach.push_back(std::min(kLargestReach * scale, kReachOfRadius * radius + kReachBeyond * scale));
  }
  return reach;
}

// How each point of a path moves to the middle of its nearest samples. sums: those of their places, and their number.
Positions way_to_middle(const HalfMuscle& muscle, const Eigen::MatrixXd& sums) {
  constexpr double kStepToMiddle = 0.6, kFewest = 0.3;
  const Eigen::MatrixXd count = smoothed_along(sums.col(3), 3);
  Positions way = smoothed_along(sums.leftCols(3) - sums.col(3).asDiagonal() * muscle.path, 3);
  for (Index k = 0; k < kPathPoints; ++k) {
    const bool is_belly = belly_section(muscle, static_cast<double>(k) / (kPathPoints - 1)) > 0;
    way.row(k) *= is_belly && count(k, 0) > kFewest ? kStepToMiddle / count(k, 0) : 0;
  }
  way = smoothed_along(way, 2);
  way.row(0).setZero();
  way.bottomRows(1).setZero();
  return way;
}

// Keeps a path within `most` of where it was at first, and on its side of the median plane.
void keep_near(const Positions& moved, const Positions& first, double most, Positions& path) {
  for (Index k = 0; k < kPathPoints; ++k) {
    const Eigen::RowVector3d way = moved.row(k) - first.row(k);
    const double length = way.norm();
    path.row(k) = first.row(k) + (length > most ? most / length : 1.0) * way;
    if (first(k, 0) >= 0) path(k, 0) = std::max(path(k, 0), std::min(kMedianGap, first(k, 0)));
  }
}

// Keeps of each muscle's samples the largest piece that is connected through faces (label, L, -1: none's). Returns the
// others, which lose their label.
std::vector<int> keep_largest_pieces(const LeanSamples& lean, std::size_t muscles, std::vector<int>& label) {
  DisjointSets pieces(lean.size());
  for (std::size_t i = 0; i < lean.size(); ++i) {
    for (const int beside : lean.neighbours[i]) {
      const auto j = static_cast<std::size_t>(beside);
      if (beside >= 0 && label[i] >= 0 && label[j] == label[i]) pieces.join(i, j);
    }
  }
  std::vector<int> size(lean.size(), 0);  // at a piece's lowest sample
  for (std::size_t i = 0; i < lean.size(); ++i) ++size[pieces.lowest(i)];
  std::vector<std::size_t> largest(muscles, lean.size());  // its lowest sample
  for (std::size_t i = 0; i < lean.size(); ++i) {
    if (label[i] < 0) continue;
    std::size_t& best = largest[static_cast<std::size_t>(label[i])];
    if (best == lean.size() || size[i] > size[best]) best = i;
  }
  std::vector<int> loose;
  for (std::size_t i = 0; i < lean.size(); ++i) {
    if (label[i] < 0 || pieces.lowest(i) == largest[static_cast<std::size_t>(label[i])]) continue;
    loose.push_back(static_cast<int>(i));
    label[i] = -1;
  }
  return loose;
}

// Gives loose samples, the least distance first, to muscles that have a neighbour of theirs already and whose spindle
// is nearer than `farthest` (radii: M).
void grow_into(const LeanSamples& lean, const MuscleCandidates& candidates, const std::vector<double>& radii,
               double farthest, const std::vector<int>& loose, std::vector<int>& label) {
  using Step = std::tuple<double, int, int>;  // distance, sample, muscle
  std::priority_queue<Step, std::vector<Step>, std::greater<>> steps;
  std::vector<bool> is_loose(lean.size(), false);
  for (const int i : loose) is_loose[static_cast<std::size_t>(i)] = true;
  const auto offer = [&](int sample, int muscle) {
    const auto i = static_cast<std::size_t>(sample);
    const std::size_t entry = candidates.find(i, muscle);
    if (entry == candidates.begin(i + 1)) return;
    const double distance = candidates.distance(entry, radii[static_cast<std::size_t>(muscle)]);
    if (distance < farthest) steps.emplace(distance, sample, muscle);
  };
  for (const int i : loose) {
    for (const int beside : lean.neighbours[static_cast<std::size_t>(i)]) {
      if (beside >= 0 && label[static_cast<std::size_t>(beside)] >= 0)
        offer(i, label[static_cast<std::size_t>(beside)]);
    }
  }
  while (!steps.empty()) {
    const auto [distance, sample, muscle] = steps.top();
    steps.pop();
    const auto i = static_cast<std::size_t>(sample);
    if (label[i] >= 0) continue;
    label[i] = muscle;
    for (const int beside : lean.neighbours[i]) {
      if (beside < 0 || !is_loose[static_cast<std::size_t>(beside)] || label[static_cast<std::size_t>(beside)] >= 0)
        continue;
      offer(beside, muscle);
    }
  }
}

// Rprop (Riedmiller and Braun 1993) gives each radius a step of its own.
struct Steps {
  Steps(std::size_t muscles, double first) : length(muscles, first), sign(muscles, 0) {}
  std::vector<double> length;
  std::vector<int> sign;
};

// Divides lean tissue so that every muscle gets the volume that it should have: a sample goes to the nearest spindle.
// The spindles' radii follow from the volumes that come out. This is an additively weighted Voronoi diagram about the
// muscles' paths, constrained in capacity (Aurenhammer, Hoffmann and Aronov 1998).
class VolumeDivision {
 public:
  // Targets in cubic metres (M). `scale`: of lengths, against a man of 60 l. Paths are moved, their ends stay.
  VolumeDivision(const LeanSamples& lean, std::vector<HalfMuscle>& muscles, std::vector<double> targets, double scale)
      : lean_(lean),
        muscles_(muscles),
        targets_(std::move(targets)),
        scale_(scale),
        candidates_(lean, muscles, reaches(muscles, targets_, scale)),
        label_(lean.size(), -1),
        volume_(muscles.size(), 0) {
    for (std::size_t m = 0; m < muscles.size(); ++m) {
      first_path_.push_back(muscles[m].path);
      squares_.push_back(square_of_radius(muscles[m], targets_[m]));
    }
  }

  // Volumes first, then paths to the middle of what they got, several times; last, every region in one piece.
  void divide() {
    if (muscles_.empty()) return;
    const double square = scale_ * scale_;
    for (int round = 0; round < kRounds; ++round) {
      Steps steps(muscles_.size(), kFirstStep * square);
      const bool is_last = round + 1 == kRounds;
      for (int k = 0; k < (is_last ? kLastSteps : kStepsARound); ++k) {
        assign();
        measure();
        adapt(steps);
      }
      if (is_last) break;
      centre_paths();
      candidates_.update(lean_, muscles_);
    }
    Steps steps(muscles_.size(), kFirstConnectedStep * square);
    std::vector<int> best_label;
    double least = 0;
    for (int k = 0; k < kConnectedSteps; ++k) {
      assign_in_one_piece();
      measure();
      if (best_label.empty() || error() < least) {
        least = error();
        best_label = label_;
      }
      adapt(steps);
    }
    label_ = best_label;
    measure();
  }

  const std::vector<int>& label() const { return label_; }       // L: muscle, -1: none's
  const std::vector<double>& volume() const { return volume_; }  // M, cubic metres

  // L: 0 to 1 along the path of the sample's muscle
  std::vector<double> along_path() const {
    std::vector<double> along(lean_.size(), 0);
    for (std::size_t i = 0; i < lean_.size(); ++i) {
      if (label_[i] >= 0) along[i] = candidates_.along(candidates_.find(i, label_[i]));
    }
    return along;
  }

 private:
  // One thread does it: it takes 4 ms, hundreds of times, and waiting for others often costs more where they are busy.
  void assign() {
    const std::vector<double> radius = radii();
    for (std::size_t i = 0; i < lean_.size(); ++i) {
      double least = kFarthest * scale_;
      label_[i] = -1;
      for (std::size_t entry = candidates_.begin(i); entry < candidates_.begin(i + 1); ++entry) {
        const int muscle = candidates_.muscle(entry);
        const double distance = candidates_.distance(entry, radius[static_cast<std::size_t>(muscle)]);
        if (distance >= least) continue;
        least = distance;
        label_[i] = muscle;
      }
    }
  }

  void assign_in_one_piece() {
    assign();
    const std::vector<int> loose = keep_largest_pieces(lean_, muscles_.size(), label_);
    grow_into(lean_, candidates_, radii(), kFarthest * scale_, loose, label_);
  }

  void measure() {
    std::ranges::fill(volume_, 0);
    for (const int muscle : label_) {
      if (muscle >= 0) ++volume_[static_cast<std::size_t>(muscle)];
    }
    for (double& volume : volume_) volume *= lean_.grid.volume();
  }

  void adapt(Steps& steps) {
    const double square = scale_ * scale_;
    for (std::size_t m = 0; m < muscles_.size(); ++m) {
      const double wanted = targets_[m] - volume_[m];
      const int sign = std::abs(wanted) <= 0.01 * targets_[m] ? 0 : wanted > 0 ? 1 : -1;
      double& length = steps.length[m];
      if (sign * steps.sign[m] < 0) length *= 0.5;
      if (sign * steps.sign[m] > 0) length = std::min(1.15 * length, kLargestStep * square);
      if (sign != 0) steps.sign[m] = sign;
      squares_[m] += sign * std::min(length, 1.5 * square_of_radius(muscles_[m], std::abs(wanted)));
      squares_[m] = std::clamp(squares_[m], kLeastSquare * square, kLargestSquare * square);
    }
  }

  // Lloyd 1982: each path to the middle of its region, smooth along the path.
  void centre_paths() {
    const std::vector<double> along = along_path();
    std::vector<Eigen::MatrixXd> sums(muscles_.size(), Eigen::MatrixXd::Zero(kPathPoints, 4));  // places, count
    for (std::size_t i = 0; i < lean_.size(); ++i) {
      if (label_[i] < 0) continue;
      const auto k = static_cast<Index>(std::lround(along[i] * (kPathPoints - 1)));
      sums[static_cast<std::size_t>(label_[i])].row(k) += lean_.points.row(static_cast<Index>(i)).homogeneous();
    }
    for (std::size_t m = 0; m < muscles_.size(); ++m) {
      const Positions moved = muscles_[m].path + way_to_middle(muscles_[m], sums[m]);
      keep_near(moved, first_path_[m], (muscles_[m].is_guided ? kGuidedWay : kWay) * scale_, muscles_[m].path);
    }
  }

  double error() const {
    double sum = 0;
    for (std::size_t m = 0; m < muscles_.size(); ++m) {
      const double relative = (volume_[m] - targets_[m]) / (targets_[m] + kSmallVolume);
      sum += relative * relative;
    }
    return sum;
  }

  std::vector<double> radii() const {
    std::vector<double> radii;
    for (const double square : squares_) radii.push_back(std::copysign(std::sqrt(std::abs(square)), square));
    return radii;
  }

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

// Lean samples are some of the grid's.
void label_grid(const LeanSamples& lean, const VolumeDivision& power, const std::vector<int>& tendon,
                const Positions& fibres, Division& division) {
  division.label = tendon;
  division.is_tendon.assign(tendon.size(), false);
  division.fibre = Positions::Zero(static_cast<Index>(tendon.size()), 3);
  for (std::size_t s = 0; s < tendon.size(); ++s) division.is_tendon[s] = tendon[s] >= 0;
  for (std::size_t i = 0; i < lean.size(); ++i) {
    if (power.label()[i] < 0) continue;
    const auto s = static_cast<std::size_t>(lean.sample[i]);
    division.label[s] = power.label()[i];
    division.is_tendon[s] = false;
    division.fibre.row(lean.sample[i]) = fibres.row(static_cast<Index>(i));
  }
}

}  // namespace

Division divide_muscles(const HalfBody& body, const BodyGrid& grid, const InnerTissue& tissue,
                        const std::vector<Muscle>& muscles, const AnatomyCorrections& corrections) {
  const LeanSamples lean(grid, tissue);
  const double scale = scale_of(body, grid);
  std::vector<HalfMuscle> own = muscles_of_half(body, muscles);
  guide_paths(body, lean, own);
  const BoneSurface bones(body, grid, tissue);
  draw_to_bone(bones, scale, own);
  LimbTargets targets = limb_targets(lean, own);
  if (!corrections.muscles.empty()) correct_volumes(own, muscles, corrections, targets.volume);
  VolumeDivision power(lean, own, targets.volume, scale);
  power.divide();

  std::vector<std::array<BoneFoot, 2>> feet;
  std::vector<std::array<int, 2>> joints;
  for (const HalfMuscle& muscle : own) {
    feet.push_back({bones.foot(muscle.path.row(0), muscle.joint[0]),
                    bones.foot(muscle.path.row(kPathPoints - 1), muscle.joint[1])});
    joints.push_back({feet.back()[0].joint, feet.back()[1].joint});
  }
  Division division;
  for (std::size_t m = 0; m < own.size(); ++m) {
    division.muscles.push_back(described(own[m], feet[m]));
    division.muscles.back().volume = power.volume()[m];
    division.muscles.back().target = targets.volume[m];
  }
  division.limb_factors = targets.factors;
  label_grid(lean, power, tendon_samples(lean, own, feet),
             fibre_directions(lean, own, joints, power.label(), power.along_path()), division);
  count_pieces(grid, division);
  return division;
}

}  // namespace bodyopt::trainer
