#include "runtime/deformer/attachment_carrier.h"

#include "runtime/basis/output_order.h"
#include "runtime/core/error.h"
#include "runtime/cpu/attach_kernels.h"
#include "runtime/host/rig.h"

namespace bodyopt {

std::vector<std::vector<float>> AttachmentCarrier::carry(std::span<const float> positions,
                                                         std::span<const JointTransform> joints) const {
  if (positions.size() != 3 * std::size_t{basis_.mesh.output_count()} || joints.size() != basis_.skeleton.size()) {
    throw Error(ErrorKind::mismatch, "geometry attached to a skin of ", basis_.mesh.output_count(), " points and ",
                basis_.skeleton.size(), " joints was given ", positions.size() / 3, " points and ", joints.size(),
                " joints: those of another character");
  }
  Pose pose;
  pose.joints.assign(joints.begin(), joints.end());
  const RigFrame rig = pose_rig(basis_.skeleton, pose);
  const std::vector<float> vertices = vertices_of(basis_.mesh, positions);
  std::vector<float> stretches(kStretchNumbers * tables_.corners.size()),
      frames(kAnchorNumbers * tables_.anchors.size());
  cpu::output_stretch(tables_, vertices, stretches);
  cpu::output_anchor(tables_, stretches, vertices, rig.skinning, rig.origin, frames);
  std::vector<std::vector<float>> carried;
  for (std::size_t m = 0; m + 1 < tables_.vertex_begin.size(); ++m) {
    std::vector<float>& mesh = carried.emplace_back(3 * (tables_.vertex_begin[m + 1] - tables_.vertex_begin[m]));
    cpu::output_attach(tables_, tables_.vertex_begin[m], frames, mesh);
  }
  return carried;
}

}  // namespace bodyopt
