// One half of a body, seen as its left: so every table and shape of anatomy is written once.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <optional>
#include <string>
#include <vector>

#include "assets/character.h"
#include "assets/joint_roles.h"
#include "assets/muscles.h"
#include "trainer/anatomy/body_kind.h"

namespace bodyopt {

// Space of a half body: x points out of the median plane to the side that is looked at, y up, z forward, metres. For
// the right half it is a mirror image: triangles are turned over and the sides of all roles swapped.
struct HalfBody {
  Eigen::Affine3d from_rest = Eigen::Affine3d::Identity();  // rest space to this one; a reflection for the right half
  Positions vertices;                                       // V x 3: all of the skin
  Triangles triangles;                                      // T x 3
  SkinWeights weights;                                      // V
  std::vector<Eigen::Vector3d> places;                      // J: where the joints stand
  std::vector<NamedJoint> joints;                           // J
  std::vector<std::optional<JointRole>> roles;              // J: left is the side that is looked at
  bool has_plane = true;      // false: no median plane was found (a single arm): all of the body is this half
  bool is_own_mirror = true;  // the skin is its own mirror image; then this half stands for both

  int find(BodyPart part, BodySide side = BodySide::left, std::size_t nested = 0) const;  // joint, or -1
  // The same muscle path in this space, with the joints of this half.
  Muscle path_of(const Muscle& muscle) const;
};

// The halves of a body: one where its skin is its own mirror image (vertices and open edges within 1e-4 of its extent)
// or where it has no median plane, as limbs alone; otherwise the left and the right one. kind: as recognised where not
// given.
std::vector<HalfBody> halves_of(const Character& character, std::optional<BodyKind> kind = {});

// The left half before anything is known of the body: it may have no median plane, nor be its own mirror image.
HalfBody body_in_frame(const Character& character);

// J: the joint on the other side of each joint; itself in the middle, -1 where there is none.
std::vector<int> mirrored_joints(const Character& character);

// Which way a body stands and looks in its file.

// A turn between coordinate axes, from rest space to one in which the body stands y up, with its left at +x, so that it
// looks along z: up as the file's nodes have it (turn_upright), left by the joints that are named so; where none are,
// the axis about which the skin is its own mirror image more closely.
Eigen::Matrix3d body_frame(const Character& character);

// The same character, its skin and joints turned by a rotation.
Character turned(const Character& character, const Eigen::Matrix3d& rotation);

}  // namespace bodyopt
