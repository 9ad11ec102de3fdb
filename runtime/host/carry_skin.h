// The full skin from a level's: what a proxy shows, in the topology of the full character.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "runtime/basis/attachments.h"
#include "runtime/basis/levels.h"
#include "runtime/core/executor.h"
#include "runtime/core/transform.h"

namespace bodyopt {

// Where a point of a triangle lies: its position, and the interpolated normal, the triangle's first edge at right
// angles to it, and the normal times that. Unit vectors; zero where the triangle has no extent.
struct CarryFrame {
  float position[3], normal[3], edge[3], across[3];
};

// `positions`, `normals`: O x 3 of one frame, the mesh's output vertices.
CarryFrame carry_frame(const MeshTable& mesh, std::span<const float> positions, std::span<const float> normals,
                       const CarriedPoint& point);

// positions, normals F x O x 3 of a level's output vertices, as an Evaluation has them; its mesh, and where it carries
// the full skin (Level::carried) -> F x P x 3, metres, posed: every output vertex of the full character. At rest and
// under rigid motion it is exact to half a step along each axis of the frame.
std::vector<float> carry_skin(const MeshTable& mesh, const CarriedSkin& carried, std::span<const float> positions,
                              std::span<const float> normals, Executor& threads = calling_thread());

// Carries attached geometry along with the skin, on the host, whatever device made the skin.

// x = c + R (u - c_rest) for every vertex at u. c is the mean of its anchor's points on the posed skin. R is the
// rotation nearest to how the skin around them moved (Müller et al. 2005, "Meshless deformations based on shape
// matching"): the edges and the normals of the skin around the points' corners, posed against rest. An anchor without
// points moves by its joint's skinning matrix.
class AttachmentCarrier {
 public:
  // Both must outlive it, and belong together (load_attachments sees to it).
  AttachmentCarrier(const Basis& basis, const Attachments& attachments);

  // One frame. positions: O x 3, the skin's output vertices, metres, world (Evaluation::positions, or a point cache);
  // joints: its pose. Returns N x 3 per mesh, metres, world. The same bits every time. No NaN for finite input: where
  // skin has collapsed, R is that of the anchor's joint. Throws Error(mismatch) for other counts.
  std::vector<std::vector<float>> carry(std::span<const float> positions, std::span<const JointTransform> joints) const;

 private:
  using Matrix = std::array<double, 9>;  // row-major

  Matrix motion_around(std::uint32_t vertex, std::span<const float> positions) const;
  Affine frame(const AttachedMesh& mesh, std::size_t anchor, std::span<const float> positions,
               std::span<const Matrix> motions, const Affine& joint) const;
  Vec3 rest(std::uint32_t vertex) const;
  Vec3 posed(std::uint32_t vertex, std::span<const float> positions) const;

  const Basis& basis_;
  const Attachments& attachments_;
  std::vector<std::uint32_t> output_of_;  // V: an output vertex of each vertex
  std::vector<std::uint32_t> corners_;    // vertices that are corners of points, ascending
  std::vector<std::uint32_t> slot_of_;    // V: index into corners_
};

}  // namespace bodyopt
