// One half of a body, seen as its left: so every table and shape of anatomy is written once.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <optional>
#include <string>
#include <vector>

#include "assets/characters/character.h"
#include "assets/characters/muscles.h"
#include "assets/clips/joint_roles.h"
#include "trainer/anatomy/body_kind.h"

namespace bodyopt::trainer {

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
  // The same muscle path in this space; its joints keep their numbers.
  Muscle path_of(const Muscle& muscle) const;
};

// A body has one half if skin and joints are their own mirror image, vertices and open edges within 1e-4 of its extent.
// Limbs alone have no median plane, and one half, too; other bodies the left and the right one. `kind`: none: as
// recognised.
std::vector<HalfBody> halves_of(const Character& character, std::optional<BodyKind> kind = {});

// The left half before anything is known of the body: it may have no median plane, nor be its own mirror image.
HalfBody body_in_frame(const Character& character);

// J: the joint on the other side of each joint; itself in the middle, -1 where there is none.
std::vector<int> mirrored_joints(const Character& character);

// The direction in which a body stands and looks in its file.

// A turn between coordinate axes, from rest space to one where the body stands y up, its left at +x, and looks along z.
// Up is as the file's nodes have it (turn_upright), left as joints are named. Without such names, left is along the
// axis about which the skin is more nearly its own mirror image.
Eigen::Matrix3d body_frame(const Character& character);

// Turns skin and joints of a character by a rotation.
Character turned(const Character& character, const Eigen::Matrix3d& rotation);

}  // namespace bodyopt::trainer
