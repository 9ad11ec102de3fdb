#include "runtime/deformer/following_meshes.h"

#include <utility>

#include "runtime/basis/output_order.h"
#include "runtime/core/error.h"
#include "runtime/cpu/attach_kernels.h"
#include "runtime/host/carry_skin.h"

namespace bodyopt {

const std::vector<std::vector<float>>& FollowingMeshes::carry(std::span<const float> positions,
                                                              std::span<const JointTransform> joints,
                                                              Memory& memory) const {
  if (positions.size() != 3 * std::size_t{basis_.mesh.output_count()} || joints.size() != basis_.skeleton.size()) {
    throw Error(ErrorKind::mismatch, "geometry attached to a skin of ", basis_.mesh.output_count(), " points and ",
                basis_.skeleton.size(), " joints was given ", positions.size() / 3, " points and ", joints.size(),
                " joints: those of another character");
  }
  memory.pose.joints.assign(joints.begin(), joints.end());
  rig_.pose(memory.pose, memory.rig);
  memory.vertices = vertices_of(basis_.mesh, positions, std::move(memory.vertices));
  memory.stretches.resize(kStretchNumbers * tables_.corners.size());
  memory.frames.resize(kAnchorNumbers * tables_.anchors.size());
  cpu::output_stretch(tables_, memory.vertices, memory.stretches);
  cpu::output_anchor(tables_, memory.stretches, memory.vertices, memory.rig.skinning, memory.rig.origin, memory.frames);
  memory.attached.resize(tables_.vertex_begin.size() - 1);
  for (std::size_t m = 0; m < memory.attached.size(); ++m) {
    memory.attached[m].resize(3 * (tables_.vertex_begin[m + 1] - tables_.vertex_begin[m]));
    cpu::output_attach(tables_, tables_.vertex_begin[m], memory.frames, memory.attached[m]);
  }
  return memory.attached;
}

const std::vector<float>& FollowingMeshes::carry_full_skin(std::span<const float> positions,
                                                           std::span<const float> normals, Memory& memory,
                                                           Executor& threads) const {
  memory.full_skin = carry_skin(basis_.mesh, full_skin_, positions, normals, threads, std::move(memory.full_skin));
  return memory.full_skin;
}

}  // namespace bodyopt
