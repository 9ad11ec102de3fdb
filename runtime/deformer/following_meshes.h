// Meshes that follow a skin, carried along by the CPU, whatever device made the skin.
#pragma once

#include <span>
#include <utility>
#include <vector>

#include "runtime/basis/attachments.h"
#include "runtime/basis/levels.h"
#include "runtime/core/executor.h"
#include "runtime/host/attach_tables.h"
#include "runtime/host/rig.h"

namespace bodyopt {

// What follows the skin of a level of detail: attached meshes, and the skin of the full character.
class FollowingMeshes {
 public:
  // Of one thread, used again.
  struct Memory {
    Pose pose;
    RigFrame rig;
    std::vector<float> vertices, stretches, frames, full_skin;
    std::vector<std::vector<float>> attached;
  };

  // The basis must outlive it. They belong together (load_attachments and load_levels see to it).
  FollowingMeshes(const Basis& basis, Attachments attached, CarriedSkin full_skin = {})
      : basis_(basis),
        rig_(basis.skeleton),
        attached_(std::move(attached)),
        tables_(attach_tables(basis.mesh, attached_)),
        full_skin_(std::move(full_skin)) {}

  const Basis& basis() const { return basis_; }
  const Attachments& attached() const { return attached_; }
  const AttachTables& tables() const { return tables_; }       // of the attached meshes
  const CarriedSkin& full_skin() const { return full_skin_; }  // empty, where the level carries none

  // The attached meshes of one frame: x = c + R (u - c_rest) for every vertex at u. c is the mean of its anchor's
  // points on the posed skin. R is the rotation nearest to how the skin around them moved (Müller et al. 2005,
  // "Meshless deformations based on shape matching"). It is fitted to edges and normals of the skin around the points'
  // corners, from rest to posed. An anchor without points moves by its joint's skinning matrix.
  // positions: O x 3, the skin's output vertices, metres, world (Evaluation::positions, or a point cache); joints: its
  // pose. Returns N x 3 per mesh, metres, world. The same bits every time. No NaN for finite input: where skin has
  // collapsed, R is that of the anchor's joint. Throws Error(mismatch) for other counts.
  const std::vector<std::vector<float>>& carry(std::span<const float> positions, std::span<const JointTransform> joints,
                                               Memory& memory) const;
  std::vector<std::vector<float>> carry(std::span<const float> positions,
                                        std::span<const JointTransform> joints) const {
    Memory memory;
    return carry(positions, joints, memory);
  }
  // The same of frame after frame, F x O x 3: `take` gets the frame, the mesh and its points.
  void carry_each(std::span<const float> positions, std::span<const Pose> poses, Memory& memory,
                  const auto& take) const {
    if (attached_.meshes.empty()) return;
    const std::size_t stride = 3 * std::size_t{basis_.mesh.output_count()};
    for (std::size_t f = 0; f < poses.size(); ++f) {
      carry(positions.subspan(f * stride, stride), poses[f].joints, memory);
      for (std::size_t m = 0; m < memory.attached.size(); ++m) take(f, m, memory.attached[m]);
    }
  }

  // See carry_skin().
  const std::vector<float>& carry_full_skin(std::span<const float> positions, std::span<const float> normals,
                                            Memory& memory, Executor& threads = calling_thread()) const;

 private:
  const Basis& basis_;
  Rig rig_;
  Attachments attached_;
  AttachTables tables_;
  CarriedSkin full_skin_;
};

}  // namespace bodyopt
