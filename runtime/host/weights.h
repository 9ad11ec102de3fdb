// The weights of what a deformer shows.
#pragma once

namespace bodyopt {

// The bound of a weight, either way: beyond an animator's exaggeration, and far from positions that are not finite.
inline constexpr float kMostWeight = 1000;

// How much is shown of what was learned, and of the jiggle: methods to compare by eye. With 1, as trained, no bit
// changes. The weight of the jiggle changes no state; that of the correction does.
struct Weights {
  float correction = 1, jiggle = 1;
  bool kernels = true;  // without: of what was learned the part that is linear in joints and strains
  bool operator==(const Weights&) const = default;
};

}  // namespace bodyopt
