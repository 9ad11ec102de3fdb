#include "trainer/anatomy/division.h"

#include <cmath>

#include "base/disjoint_sets.h"
#include "trainer/anatomy/division_steps.h"
#include "trainer/anatomy/muscle_ends.h"
#include "trainer/anatomy/volume_division.h"

namespace bodyopt {
namespace {

using Eigen::Index;

// Lengths are told against a man of 60 l, those of an arm or a leg alone against his.
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

}  // namespace bodyopt
