#include "trainer/train/skinning/same_character.h"

#include <cmath>

#include "runtime/core/error.h"

namespace bodyopt {
namespace {

constexpr double kSamePlace = 1e-5;  // metres

}  // namespace

void require_same_character(const MeshTable& mesh, const Skeleton& skeleton, const Basis& basis) {
  const auto refuse = [](const std::string& what) {
    throw Error(ErrorKind::mismatch, "the basis is not of this character: " + what +
                                         "; was the character edited since the training, or is it another one?");
  };
  if (topology_hash(mesh) != topology_hash(basis.mesh)) refuse("its vertices or triangles are others");
  if (skeleton_hash(skeleton) != skeleton_hash(basis.skeleton)) refuse("its skeleton is another");
  for (std::size_t k = 0; k < mesh.rest.size(); ++k) {
    if (std::abs(static_cast<double>(mesh.rest[k] - basis.mesh.rest[k])) <= kSamePlace) continue;
    refuse("its vertices stand elsewhere at rest");
  }
}

}  // namespace bodyopt
