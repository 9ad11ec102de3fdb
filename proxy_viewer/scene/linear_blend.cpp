#include "proxy_viewer/scene/linear_blend.h"

#include "runtime/core/error.h"
#include "trainer/train/skinning/linear_blend.h"

namespace bodyopt {

LinearBlend::LinearBlend(const std::filesystem::path& path, const Basis& basis, double unit)
    : character_(read_character(path, unit)) {
  if (character_.output_count() != basis.mesh.output_count() ||
      skeleton_hash(character_.skeleton) != skeleton_hash(basis.skeleton)) {
    throw Error(ErrorKind::mismatch, path.string() + ": is not the character of the basis: it has " +
                                         std::to_string(character_.output_count()) + " vertices and " +
                                         std::to_string(character_.skeleton.size()) + " joints, the basis " +
                                         std::to_string(basis.mesh.output_count()) + " and " +
                                         std::to_string(basis.skeleton.size()));
  }
}

std::vector<float> LinearBlend::skin(const Pose& pose) const {
  return output_from_welded(character_, skin_linear(character_, pose));
}

}  // namespace bodyopt
