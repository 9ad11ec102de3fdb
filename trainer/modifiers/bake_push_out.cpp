// Push-out: which joints fold skin, and which skin may lie in such a fold: what stands within two of the bone's lengths
// around the joint. What crosses is found by the kernel (shaders/include/fold.h).
#include "geometry/mesh.h"
#include "runtime/core/error.h"
#include "runtime/host/skin_tables.h"
#include "trainer/modifiers/bake_modifier.h"
#include "trainer/modifiers/joint_holds.h"

namespace bodyopt::trainer {
namespace {

constexpr double kReach = 2;  // of the bone's length
// Bones shorter than this part of the body's size do not count. Webs of fingers and toes are as thick as such bones are
// long, and lie in each other in many a pose.
constexpr double kShortestBone = 0.05;

// Skin on one side only does not fold.
bool has_both_sides(const Basis& basis, std::uint32_t joint, const Vec3& place, double reach) {
  const std::vector<char> below = at_or_below(basis.skeleton, joint);
  bool sides[2] = {false, false};
  const Positions rest = rows_of(basis.mesh.rest);
  for (Eigen::Index v = 0; v < rest.rows(); ++v) {
    const Vec3 way = Vec3{rest(v, 0), rest(v, 1), rest(v, 2)} - place;
    if (length(way) < reach) sides[below[basis.ddm.vertices[static_cast<std::size_t>(v)].base_joint] ? 1 : 0] = true;
  }
  return sides[0] && sides[1];
}

}  // namespace

BakedModifier bake_push_out(const BakeInput& input) {
  const Basis& basis = input.basis;
  const Positions rest = rows_of(basis.mesh.rest);
  const double body = longest_extent(rest);
  BakedModifier baked;
  baked.numbers.push_back(static_cast<float>(1e-3 * bake_number(input, "limit_mm", 80, 0, 1000)));
  for (std::uint32_t joint = 0; joint < basis.skeleton.size(); ++joint) {
    if (basis.skeleton.joints[joint].parent < 0) continue;
    const Vec3 place = bind_place(basis.skeleton, joint), bone = bone_of(basis.skeleton, joint);
    const double size = length(bone);
    if (!(size > kShortestBone * body) || !has_both_sides(basis, joint, place, kReach * size)) continue;
    baked.joints.push_back(joint);
    for (const double x : place) baked.numbers.push_back(static_cast<float>(x));
    baked.numbers.push_back(static_cast<float>(kReach * size));
    for (const double x : bone) baked.numbers.push_back(static_cast<float>(x / size));
    baked.components.resize(baked.components.size() + 3, Positions::Zero(basis.mesh.vertex_count(), 3));
  }
  if (baked.joints.empty()) {
    throw Error(ErrorKind::mismatch, input.place, ": no joint of the character bends skin: it cannot fold");
  }
  return baked;
}

}  // namespace bodyopt::trainer
