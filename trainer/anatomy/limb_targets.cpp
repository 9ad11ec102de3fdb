#include <algorithm>
#include <array>

#include "trainer/anatomy/division_steps.h"
#include "trainer/anatomy/muscle_candidates.h"

namespace bodyopt {
namespace {

using Eigen::Index;
using Eigen::Vector3d;

struct FilledLimb {
  const char* name;
  double filled;  // of its lean tissue by muscles: what else there is are vessels, nerves, fascia, in the calf
                  // tendons, in the trunk the muscles between the ribs and the diaphragm
};
constexpr std::array<FilledLimb, 5> kLimbs{
    {{"leg", 0.867}, {"calf", 0.83}, {"arm", 0.98}, {"forearm", 0.985}, {"trunk", 0.74}}};
constexpr double kLeastFactor = 0.2;
constexpr double kMostFactor = 1.6;  // more is a limb whose other muscles are missing: what they leave is other lean
constexpr int kPasses = 10;

// The limb that a place's lean tissue belongs to; kLimbs.size(): none. The hips are the leg's up to the iliac crest.
std::size_t limb_at(BodyRegion region, double height, double crest) {
  constexpr std::size_t kLeg = 0, kTrunk = 4, kNone = kLimbs.size();
  // Rows are in the order of BodyRegion.
  constexpr std::array<std::size_t, kBodyRegions> kOfRegion{kTrunk, kTrunk, kTrunk, kNone, kLeg,  1,
                                                            kNone,  2,      3,      kNone, kNone, kNone};
  return region == BodyRegion::hip && height < crest ? kLeg : kOfRegion[static_cast<std::size_t>(region)];
}

using Shares = std::array<double, kLimbs.size() + 1>;  // one by one of kLimbs, and of none

// Which share of a muscle's belly lies in which limb.
Shares belly_shares(const LeanSamples& lean, const HalfMuscle& muscle, double crest) {
  Shares shares{};
  double sum = 0;
  for (Index k = 0; k < muscle.path.rows(); ++k) {
    const double section = belly_section(muscle, static_cast<double>(k) / static_cast<double>(muscle.path.rows() - 1));
    const Vector3d place = muscle.path.row(k);
    const int sample = lean.grid.sample_at(place);
    if (sample < 0) continue;
    shares[limb_at(lean.tissue.region[static_cast<std::size_t>(sample)], place.y(), crest)] += section;
    sum += section;
  }
  for (double& share : shares) share /= std::max(sum, 1e-12);
  return shares;
}

Shares lean_volumes(const LeanSamples& lean, double crest) {
  Shares volumes{};
  for (std::size_t i = 0; i < lean.size(); ++i) {
    volumes[limb_at(lean.region(i), lean.points(static_cast<Index>(i), 1), crest)] += lean.grid.volume();
  }
  return volumes;
}

// M: the published volume of each, without a factor.
std::vector<double> published_volumes(const std::vector<HalfMuscle>& muscles) {
  std::map<const WholeMuscle*, double> by_radius;
  for (const HalfMuscle& muscle : muscles) by_radius[muscle.whole] += muscle.volume_by_radius;
  std::vector<double> volumes;
  for (const HalfMuscle& muscle : muscles) {
    const double own = muscle.volume_by_radius;
    volumes.push_back(muscle.whole ? muscle.whole->volume * own / by_radius[muscle.whole] : own);
  }
  return volumes;
}

}  // namespace

LimbTargets limb_targets(const LeanSamples& lean, const std::vector<HalfMuscle>& muscles) {
  const auto crest = lean.tissue.landmarks.find("iliac_crest");
  const double height = crest == lean.tissue.landmarks.end() ? 1e9 : crest->second.y();
  const Shares room = lean_volumes(lean, height);
  LimbTargets targets;
  targets.volume = published_volumes(muscles);
  std::vector<std::size_t> limb;
  std::vector<Shares> shares;
  for (const HalfMuscle& muscle : muscles) {
    const auto of_limb = std::find_if(kLimbs.begin(), kLimbs.end(), [&](const FilledLimb& one) {
      return muscle.whole && muscle.whole->limb == one.name;
    });
    limb.push_back(static_cast<std::size_t>(of_limb - kLimbs.begin()));
    shares.push_back(belly_shares(lean, muscle, height));
  }
  Shares factors{};
  factors.fill(1);
  // Muscles reach into limbs of others: a few passes settle what they take there.
  for (int pass = 0; pass < kPasses; ++pass) {
    for (std::size_t l = 0; l < kLimbs.size(); ++l) {
      double own = 0, others = 0;
      for (std::size_t m = 0; m < muscles.size(); ++m) {
        const double volume = targets.volume[m] * shares[m][l];
        (limb[m] == l ? own : others) += limb[m] == l ? volume : factors[limb[m]] * volume;
      }
      if (own > 0) factors[l] = std::clamp((kLimbs[l].filled * room[l] - others) / own, kLeastFactor, kMostFactor);
    }
  }
  for (std::size_t m = 0; m < muscles.size(); ++m) {
    targets.volume[m] *= factors[limb[m]];
    if (limb[m] < kLimbs.size()) targets.factors[kLimbs[limb[m]].name] = factors[limb[m]];
  }
  return targets;
}

}  // namespace bodyopt
