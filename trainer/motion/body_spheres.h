// A body as spheres that fill its skin, to tell poses in which limbs go through each other.
#pragma once

#include <optional>
#include <utility>

#include "assets/character.h"

namespace bodyopt {

struct BodySphere {
  std::uint32_t joint;  // the sphere moves rigidly with it
  Vec3 centre;          // rest space, metres
  double radius;        // metres
};

// Inscribed spheres of the skin by ball shrinking (Ma, Bae and Choi 2012), the largest first for each joint, until they
// stand half a radius apart.
std::vector<BodySphere> body_spheres(const Character& character);

// Which limbs overlap in a pose, beyond what poses that are trusted do.
class SelfOverlap {
 public:
  explicit SelfOverlap(const Character& character);

  // From now on, overlaps as deep as in this pose count as flesh in contact.
  void trust(const Pose& pose);

  // Two joints whose flesh overlaps more than any trusted pose's and the tolerance; nothing for a clear pose. Flesh of
  // a joint and its nearest ancestor with flesh is never compared: it is one piece.
  std::optional<std::pair<std::uint32_t, std::uint32_t>> find(const Pose& pose) const;

 private:
  struct SpherePair {
    std::uint32_t first, second;
    double trusted = 0;  // depth, metres
  };
  std::vector<Vec3> posed_centres(const Pose& pose) const;
  double depth(const SpherePair& pair, const std::vector<Vec3>& centres) const;

  const Character& character_;
  std::vector<BodySphere> spheres_;
  std::vector<SpherePair> pairs_;
};

}  // namespace bodyopt
