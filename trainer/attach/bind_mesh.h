// Binds a mesh to a skin: each connected piece follows the skin, or is fixed to a spot of it or to a joint.
#pragma once

#include <string>
#include <vector>

#include "geometry/nearest_skin.h"
#include "runtime/basis/attachments.h"
#include "runtime/basis/basis.h"
#include "trainer/attach/loose_meshes.h"

namespace bodyopt::trainer {

// A basis' skin at rest, as meshes that are to follow it see it.
class RestSkin {
 public:
  explicit RestSkin(const Basis& basis);
  RestSkin(const RestSkin&) = delete;
  RestSkin& operator=(const RestSkin&) = delete;

  const Skeleton& skeleton() const { return skeleton_; }
  double diagonal() const { return diagonal_; }  // of its bounding box, metres

  SkinPoint nearest(const Eigen::Vector3d& point) const { return search_(point); }
  // The nearest skin that faces as `normal` does; any skin where none does within twice the distance of the nearest. So
  // a sleeve finds the arm, not the flank beside it, and a lining the skin under it.
  SkinPoint facing(const Eigen::Vector3d& point, const Eigen::Vector3d& normal) const;

  Eigen::Vector3d normal(const SkinPoint& point) const;  // interpolated; unit, or zero
  // How much each joint moves the skin there, as Direct Delta Mush has smoothed the skin weights; 1 in sum.
  std::vector<double> joint_weights(const SkinPoint& point) const;

 private:
  const Skeleton& skeleton_;
  const DdmTable& ddm_;
  Positions vertices_, normals_;
  Triangles triangles_;
  double diagonal_;
  NearestSkin search_;
};

enum class AttachMode {
  automatic,
  skin,   // every vertex follows the point of the skin nearest to it: clothes
  piece,  // rigid, on the skin it is nearest to: nails, buttons
  joint,  // rigid, with a joint: eyes, teeth, props
};

struct AttachOptions {
  AttachMode mode = AttachMode::automatic;
  int joint = -1;   // for AttachMode::joint; -1: that which moves the skin nearest to a piece
  double unit = 1;  // metres per unit that the mesh was read with, for messages
};

// AttachMode::automatic chooses for each piece; what hangs on a joint is fixed to it. A small piece (1/20 of the
// character at most, corner to corner) on the skin's outside is fixed to the skin. A small one inside it, or in a
// hollow, is fixed to the joint. A large one that is skinned to several joints, or nine tenths of which lie within 1/40
// of the character, follows the skin. Others are fixed to the joint: that of the mesh's own weights, or the one that
// moves most of the skin nearest to the piece. Throws Error(mismatch) where a mesh on no joint is nowhere near the
// skin, Error(file) where thousands of its vertices lie at one point.
AttachedMesh bind_mesh(const LooseMesh& mesh, const RestSkin& skin, const AttachOptions& options);

// The further meshes of a basis' own character. Those that cannot be bound are left out, each with a note.
std::vector<AttachedMesh> bind_own_meshes(const std::vector<LooseMesh>& meshes, const Basis& basis,
                                          std::vector<std::string>& notes);

}  // namespace bodyopt::trainer
