#include <algorithm>
#include <cmath>

#include "trainer/anatomy/animal.h"

namespace bodyopt {
namespace {

// Of lungs, heart and gut: horses and other quadrupeds have thin flanks, birds a breast full of muscle, fish their gut
// in the lower third, between thick flanks. By BodyKind.
constexpr CavityWalls kWalls[] = {{0.22, 0.16, 0.5}, {0.18, 0.10, 0.6}, {0.25, 0.36, 0.7}, {0.42, 0.22, 1, 0.1},
                                  {0.35, 0.12, 1},   {0.3, 0.25},       {0.22, 0.16, 0.5}};

// The skin of upper limbs reaches over the trunk.
bool may_hold_cavity(BodyRegion region) {
  constexpr BodyRegion kNone[] = {BodyRegion::head, BodyRegion::neck, BodyRegion::tail,
                                  BodyRegion::foot, BodyRegion::hand, BodyRegion::fin};
  return std::ranges::find(kNone, region) == std::end(kNone);
}

}  // namespace

bool holds_piece_of_trunk(const Animal& animal, int joint) {
  return animal.kind == BodyKind::limb && joint >= 0 && animal.chains.has_skin(joint) &&
         is_named(animal.name(joint), {"torso", "body", "chest", "spine", "hips"});
}

double rib_shell_distance(const Animal& animal, const Spot& spot) {
  constexpr double kWall = 0.013;  // of the body's size: muscle over the ribs
  return spot.fat + kWall * animal.size - spot.depth;
}

double vertebra_radius(const Animal& animal, const SpineCurve::Row& row) {
  constexpr double kShare = 0.11, kMost = 0.0095;  // of the section's height, of the body's size
  const double part = kShare * (row.up + row.down), most = kMost * animal.size;
  return 2 * part * most / (part + most);
}

AnimalCavity::AnimalCavity(const Animal& animal)
    : animal_(animal), walls_(kWalls[static_cast<std::size_t>(animal.kind)]) {
  if (animal.spine.empty() || animal.kind == BodyKind::limb) return;
  const double hip = animal.spine.hip(), shoulder = animal.spine.shoulder();
  // The thoracic inlet lies a little before the shoulders' roots, the pelvic outlet at the hips.
  to_ = shoulder + 0.03 * (shoulder - hip);
  from_ = hip + 0.03 * (shoulder - hip);
}

double AnimalCavity::distance(const bodyopt::Spot& spot, const SpineCurve::Spot& at, double grown) const {
  constexpr double kPower = 2.4;  // of a section: a little fuller than an ellipse
  const SpineCurve::Row row = animal_.spine.at(at.row);
  const double spine = (row.place - row.middle).dot(row.dorsal) - 1.2 * vertebra_radius(animal_, row);
  const double floor = -row.down + walls_.below * (row.up + row.down);
  const double end = walls_.end * (to_ - from_),
               from_end = std::min(at.row - from_, to_ - at.row) / std::max(end, 1e-9);
  const double narrow = 1 - std::clamp(from_end, 0.0, 1.0), taper = std::sqrt(std::max(1 - narrow * narrow, 0.0));
  const double half = 0.5 * (spine - floor), middle = 0.5 * (spine + floor);
  const double wide = taper * (1 - walls_.aside) * row.half_width + grown, high = taper * half + grown;
  if (wide <= 0 || high <= 0 || from_end < 0 || at.is_beyond()) return animal_.size;
  const double place =
      std::pow(std::pow(at.aside / wide, kPower) + std::pow(std::abs(at.height - middle) / high, kPower), 1 / kPower);
  const double section = (place - 1) * std::min(wide, high);
  return std::max(section, spot.fat + 0.12 * row.half_width - grown - spot.depth);
}

double AnimalCavity::distance(const bodyopt::Spot& spot) const {
  if (holds_piece_of_trunk(animal_, spot.joint)) return rib_shell_distance(animal_, spot);
  if (empty() || !may_hold_cavity(spot.region)) return animal_.size;
  return distance(spot, animal_.spine.spot(spot.point, from_, to_));
}

}  // namespace bodyopt
