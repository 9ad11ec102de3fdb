// Carries attached meshes along with the skin, by the CPU's kernels, whatever device made the skin.
#pragma once

#include <span>
#include <vector>

#include "runtime/basis/attachments.h"
#include "runtime/basis/basis.h"
#include "runtime/host/attach_tables.h"
#include "runtime/host/rig.h"

namespace bodyopt {

// x = c + R (u - c_rest) for every vertex at u. c is the mean of its anchor's points on the posed skin. R is the
// rotation nearest to how the skin around them moved (Müller et al. 2005, "Meshless deformations based on shape
// matching"). It is fitted to edges and normals of the skin around the points' corners, from rest to posed. An anchor
// without points moves by its joint's skinning matrix.
class AttachmentCarrier {
 public:
  // Of one thread, used again.
  struct Memory {
    Pose pose;
    RigFrame rig;
    std::vector<float> vertices, stretches, frames;
    std::vector<std::vector<float>> carried;
  };

  // The basis must outlive it. They belong together (load_attachments sees to it).
  AttachmentCarrier(const Basis& basis, const Attachments& attachments)
      : basis_(basis), rig_(basis.skeleton), tables_(attach_tables(basis.mesh, attachments)) {}

  // One frame. positions: O x 3, the skin's output vertices, metres, world (Evaluation::positions, or a point cache);
  // joints: its pose. Returns N x 3 per mesh, metres, world. The same bits every time. No NaN for finite input: where
  // skin has collapsed, R is that of the anchor's joint. Throws Error(mismatch) for other counts.
  const std::vector<std::vector<float>>& carry(std::span<const float> positions, std::span<const JointTransform> joints,
                                               Memory& memory) const;
  std::vector<std::vector<float>> carry(std::span<const float> positions,
                                        std::span<const JointTransform> joints) const {
    Memory memory;
    return carry(positions, joints, memory);
  }

 private:
  const Basis& basis_;
  Rig rig_;
  AttachTables tables_;
};

}  // namespace bodyopt
