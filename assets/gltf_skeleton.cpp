#include "assets/gltf_skeleton.h"

#include <cmath>
#include <cstdio>

#include "assets/wording.h"
#include "runtime/core/error.h"

namespace bodyopt {
namespace {

// Skin joints in skeleton order.
std::vector<std::size_t> parents_first(const JointFold& fold, const std::vector<int>& nodes) {
  std::vector<std::size_t> order;
  std::vector<bool> placed(nodes.size(), false);
  for (std::size_t j = 0; j < nodes.size(); ++j) {
    std::vector<std::size_t> chain;
    for (int k = static_cast<int>(j); k >= 0 && !placed[static_cast<std::size_t>(k)];
         k = fold.joint_above(static_cast<std::size_t>(nodes[static_cast<std::size_t>(k)]))) {
      placed[static_cast<std::size_t>(k)] = true;
      chain.push_back(static_cast<std::size_t>(k));
    }
    order.insert(order.end(), chain.rbegin(), chain.rend());
  }
  return order;
}

// The factor by which the default pose scales the skin, when it is the same for all joints within 1 %; otherwise 1.
double common_scale(const Skeleton& skeleton, const std::vector<Affine>& default_world) {
  double common = 0;
  for (std::size_t j = 0; j < skeleton.size(); ++j) {
    const double scale = std::cbrt(std::abs(determinant(default_world[j] * skeleton.joints[j].inverse_bind)));
    if (j == 0) common = scale;
    if (!(std::abs(scale - common) <= 0.01 * common)) return 1;
  }
  return common > 0 && std::isfinite(common) && std::abs(common - 1) > 1e-3 ? common : 1;
}

// Local bind transforms from the inverse bind matrices; returns the names of joints whose bind matrix holds shear.
std::vector<std::string> set_binds(const GltfFile& file, Skeleton& skeleton) {
  std::vector<std::string> sheared;
  std::vector<Affine> world(skeleton.size());  // as posed_joints will rebuild it, so that rounding does not add up
  for (std::size_t j = 0; j < skeleton.size(); ++j) {
    Joint& joint = skeleton.joints[j];
    try {
      const Affine bind = inverse(joint.inverse_bind);
      const Affine above = joint.parent < 0 ? Affine{} : world[static_cast<std::size_t>(joint.parent)];
      joint.bind = decompose(inverse(above) * bind);
      world[j] = above * affine_from(joint.bind);
    } catch (const Error&) {
      file.fail("the inverse bind matrix of joint '", joint.name, "' is singular");
    }
    const Affine rest = world[j] * joint.inverse_bind;
    double error = 0;
    for (int r = 0; r < 3; ++r) {
      for (int c = 0; c < 4; ++c) error += std::abs(rest.m[r][c] - (r == c ? 1 : 0));
    }
    if (!(error < 10)) file.fail("the inverse bind matrix of joint '", joint.name, "' is nearly singular");
    if (error > 1e-3) sheared.push_back(joint.name);
  }
  return sheared;
}

}  // namespace

double determinant(const Affine& a) {
  const Vec3 x{a.m[0][0], a.m[0][1], a.m[0][2]}, y{a.m[1][0], a.m[1][1], a.m[1][2]}, z{a.m[2][0], a.m[2][1], a.m[2][2]};
  return dot(x, cross(y, z));
}

std::vector<Affine> read_inverse_binds(const GltfFile& file, int skin, std::size_t joint_count, double unit) {
  const int accessor = file.model().skins[static_cast<std::size_t>(skin)].inverseBindMatrices;
  std::vector<Affine> binds(joint_count);
  if (accessor < 0) return binds;  // the specification's default: identity
  const std::vector<double> columns = file.numbers(accessor, TINYGLTF_TYPE_MAT4, "inverse bind matrices");
  if (columns.size() < 16 * joint_count) {
    file.fail("has ", columns.size() / 16, " inverse bind matrices for ", joint_count, " joints");
  }
  for (std::size_t j = 0; j < joint_count; ++j) {
    const double* m = columns.data() + 16 * j;
    for (std::size_t r = 0; r < 3; ++r) {
      for (std::size_t c = 0; c < 4; ++c) binds[j].m[r][c] = m[4 * c + r] * (c == 3 ? unit : 1);
    }
    if (std::abs(m[3]) + std::abs(m[7]) + std::abs(m[11]) + std::abs(m[15] - 1) > 1e-4) {
      file.fail("inverse bind matrix ", j, " is no affine matrix (its last row is not 0 0 0 1)");
    }
  }
  return binds;
}

SkinSkeleton read_skin_skeleton(const GltfFile& file, int skin, double unit, std::vector<std::string>& notes) {
  const NodeTree tree = read_nodes(file, unit, notes);
  const SkinJoints joints = read_skin_joints(file, skin, notes);
  const JointFold fold(tree, joints.nodes, std::vector<bool>(tree.parent.size(), false));
  const std::vector<JointTransform> locals = fold.locals(tree.local);
  const std::vector<Affine> inverse_binds = read_inverse_binds(file, skin, joints.nodes.size(), unit);

  SkinSkeleton result;
  result.joint_of_skin.resize(joints.nodes.size());
  std::vector<JointTransform> default_locals;
  std::vector<Affine> default_world;
  for (const std::size_t k : parents_first(fold, joints.nodes)) {
    result.joint_of_skin[k] = static_cast<std::uint32_t>(result.skeleton.size());
    const int above = fold.joint_above(static_cast<std::size_t>(joints.nodes[k]));
    Joint joint;
    joint.name = joints.names[k];
    joint.parent = above < 0 ? -1 : static_cast<int>(result.joint_of_skin[static_cast<std::size_t>(above)]);
    joint.default_local = locals[k];
    joint.inverse_bind = inverse_binds[k];
    const Affine own = affine_from(joint.default_local);
    default_world.push_back(joint.parent < 0 ? own : default_world[static_cast<std::size_t>(joint.parent)] * own);
    for (const auto& row : default_world.back().m) {
      for (const double x : row) {
        if (!std::isfinite(x)) file.fail("the transform of joint '", joint.name, "' is out of range");
      }
    }
    result.skeleton.joints.push_back(std::move(joint));
  }

  result.rest_scale = common_scale(result.skeleton, default_world);
  if (result.rest_scale != 1) {
    for (Joint& joint : result.skeleton.joints) {
      for (auto& row : joint.inverse_bind.m) {
        for (int c = 0; c < 3; ++c) row[c] /= result.rest_scale;
      }
    }
    char factor[32];
    std::snprintf(factor, sizeof factor, "%.6g", result.rest_scale);
    notes.push_back(std::string("The joints scale the whole skin by ") + factor +
                    " (mesh and world have different units); the rest shape was scaled by it.");
  }
  const std::vector<std::string> sheared = set_binds(file, result.skeleton);
  if (!sheared.empty()) {
    notes.push_back(
        "Bind matrices with shear, which joints cannot hold (the rest pose will be off): " + list_names(sheared) + ".");
  }
  return result;
}

}  // namespace bodyopt
