#include "trainer/curate/unposed_space.h"

#include <utility>

#include "runtime/cpu/ddm_frames.h"
#include "runtime/host/rig.h"
#include "trainer/train/skinning/ddm_basis.h"
#include "trainer/train/skinning/mesh_table.h"

namespace bodyopt {

using Eigen::Index;

UnposedSpace::UnposedSpace(const Character& character) : UnposedSpace(character, build_ddm_basis(character, {})) {}

UnposedSpace::UnposedSpace(const Character& character, Basis ddm)
    : basis_(std::move(ddm)), order_(morton_order(character.vertices)) {}

UnposedSpace::Frame UnposedSpace::frame(const Pose& pose) const {
  using RowMajor3 = Eigen::Matrix<float, 3, 3, Eigen::RowMajor>;
  const RigFrame rig = pose_rig(basis_.skeleton, pose);
  const Eigen::Vector3d root = Eigen::Vector3f(rig.origin).cast<double>();
  Frame frame;
  frame.placements_.resize(order_.size());
  const auto count = static_cast<std::uint32_t>(order_.size());
  const std::vector<float> frames = cpu::vertex_frames(basis_.ddm, count, rig.skinning.data());
  for (std::size_t k = 0; k < order_.size(); ++k) {
    const float *r = &frames[12 * k], *t = r + 9;
    const DdmVertex& v = basis_.ddm.vertices[k];
    frame.placements_[order_[k]] = {Eigen::Map<const RowMajor3>(r).cast<double>(),
                                    root + Eigen::Map<const Eigen::Vector3f>(t).cast<double>(),
                                    Eigen::Vector3f(v.offset_x, v.offset_y, v.offset_z).cast<double>()};
  }
  return frame;
}

Positions UnposedSpace::Frame::offsets(const Positions& shape) const {
  Positions result(shape.rows(), 3);
  for (Index v = 0; v < shape.rows(); ++v) {
    const Placement& placed = placements_[static_cast<std::size_t>(v)];
    result.row(v) = placed.rotation.transpose() * (shape.row(v).transpose() - placed.origin) - placed.rest;
  }
  return result;
}

Positions UnposedSpace::Frame::shape(const Positions& offsets) const {
  Positions result(offsets.rows(), 3);
  for (Index v = 0; v < offsets.rows(); ++v) {
    const Placement& placed = placements_[static_cast<std::size_t>(v)];
    result.row(v) = placed.origin + placed.rotation * (placed.rest + offsets.row(v).transpose());
  }
  return result;
}

}  // namespace bodyopt
