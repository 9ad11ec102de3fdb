#include "trainer/curate/unposed_space.h"

#include <utility>

#include "trainer/train/skinning/ddm_basis.h"
#include "trainer/train/skinning/mesh_table.h"

namespace bodyopt {

using Eigen::Index;

UnposedSpace::UnposedSpace(const Character& character) : UnposedSpace(character, build_ddm_basis(character, {})) {}

UnposedSpace::UnposedSpace(const Character& character, Basis ddm)
    : basis_(std::move(ddm)), order_(morton_order(character.vertices)) {}

UnposedSpace::Frame UnposedSpace::frame(const Pose& pose) const {
  const std::vector<VertexPlacement> placements = ddm_placements(basis_, pose);
  Frame frame;
  frame.placements_.resize(order_.size());
  for (std::size_t k = 0; k < order_.size(); ++k) frame.placements_[order_[k]] = placements[k];
  return frame;
}

Positions UnposedSpace::Frame::offsets(const Positions& shape) const {
  Positions result(shape.rows(), 3);
  for (Index v = 0; v < shape.rows(); ++v) {
    result.row(v) = placements_[static_cast<std::size_t>(v)].unposed(shape.row(v));
  }
  return result;
}

Positions UnposedSpace::Frame::shape(const Positions& offsets) const {
  Positions result(offsets.rows(), 3);
  for (Index v = 0; v < offsets.rows(); ++v) {
    result.row(v) = placements_[static_cast<std::size_t>(v)].posed(offsets.row(v));
  }
  return result;
}

}  // namespace bodyopt
