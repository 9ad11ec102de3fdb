// The skin that a basis shows, as geometry is computed on.
#pragma once

#include <memory>
#include <span>
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

}  // namespace bodyopt
