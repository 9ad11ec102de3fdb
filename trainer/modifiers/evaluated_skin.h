// The skin that a basis shows, as geometry is computed on, and how far each modifier moves it.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "geometry/mesh.h"
#include "runtime/basis/basis.h"

namespace bodyopt {

class Deformer;

class EvaluatedSkin {
 public:
  explicit EvaluatedSkin(Basis basis);
  ~EvaluatedSkin();
  // One for each pose: V x 3, runtime order, metres, world, quasi-static, on the CPU.
  std::vector<Positions> operator()(std::span<const Pose> poses);

 private:
  std::unique_ptr<Deformer> deformer_;
};

// The same basis without what modifiers add.
Basis without_modifiers(Basis basis);

// Of a modifier that is switched on, over some poses.
struct ModifierMove {
  std::string modifier;
  double largest = 0;    // metres, of one vertex, beside the skin without this modifier alone
  std::size_t pose = 0;  // in which it is
};

// In the stack's order. `poses` have the weights of the basis' modifiers (drive_modifiers). The skin is quasi-static.
std::vector<ModifierMove> measure_moves(const Basis& basis, std::span<const Pose> poses);

}  // namespace bodyopt
