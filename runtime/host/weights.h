// How much is shown of what a deformer does.
#pragma once

namespace bodyopt {

// Of a weight, either way: an animator's exaggeration, and far from where positions would no longer be finite.
inline constexpr float kMostWeight = 1000;

// How much is shown of what was learned, and of the jiggle: methods to compare by eye. 1, as trained, changes no bit; a
// weight changes no state.
struct Weights {
  float correction = 1, jiggle = 1;
  bool kernels = true;  // without: of what was learned the part that is linear in joints and strains
  bool operator==(const Weights&) const = default;
};

}  // namespace bodyopt
