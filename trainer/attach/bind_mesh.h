// Binds a mesh to a skin: every connected piece of it follows the skin, or is fixed to a spot of it, or to a joint.
#pragma once

#include <string>
#include <vector>

#include "geometry/nearest_skin.h"
#include "runtime/basis/attachments.h"
#include "runtime/basis/basis.h"
#include "trainer/attach/loose_meshes.h"

namespace bodyopt {

// A basis' skin at rest, as meshes that are to follow it see it.
class RestSkin {
 public:
  explicit RestSkin(const Basis& basis);
  RestSkin(const RestSkin&) = delete;
  RestSkin& operator=(const RestSkin&) = delete;

  const Skeleton& skeleton() const { return skeleton_; }
  double diagonal() const { return diagonal_; }  // of its bounding box, metres

  SkinPoint nearest(const Eigen::Vector3d& point) const { return search_(point); }
  // Of skin that faces as `normal` does, where that is no more than twice as far as the nearest: so a sleeve finds the
  // arm, and not the flank beside it, and a lining the skin under it, and not the other side of the body.
  SkinPoint facing(const Eigen::Vector3d& point, const Eigen::Vector3d& normal) const;

  Eigen::Vector3d normal(const SkinPoint& point) const;  // interpolated; unit, or zero
  // By joint, 1 in sum: how much each moves the skin there, as Direct Delta Mush has smoothed the skin weights.
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

// What is done by itself, per piece. A mesh that hangs on a joint is fixed to it. A small piece (1/20 of the character
// at most, corner to corner) that lies on the outside of the skin is fixed to the skin; one inside it, or in a hollow
// of it, to the joint. Of large ones what lies along the skin (nine tenths of it no further off than 1/40 of the
// character), or is itself skinned to several joints, follows the skin; the others are fixed to the joint. The joint is
// that of the mesh's own weights, or the one that moves most of the skin nearest to the piece.
// Throws Error(mismatch) where the mesh is nowhere near the skin, Error(file) where it has no area.
AttachedMesh bind_mesh(const LooseMesh& mesh, const RestSkin& skin, const AttachOptions& options);

// The further meshes of a basis' own character. Those that cannot be bound are left out, each with a note.
std::vector<AttachedMesh> bind_own_meshes(const std::vector<LooseMesh>& meshes, const Basis& basis,
                                          std::vector<std::string>& notes);

}  // namespace bodyopt
