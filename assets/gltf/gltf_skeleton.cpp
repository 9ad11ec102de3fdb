#include "assets/gltf/gltf_skeleton.h"

#include <algorithm>
#include <cmath>

#include "base/wording.h"
#include "runtime/core/error.h"
#include "runtime/core/text.h"
#include "runtime/core/transformed.h"

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

// The scale and mirroring of the whole skin in the default pose.
Vec3 common_scale_and_mirror(std::span<const Affine> shown) {
  const double scale =
      common_scale(transformed(shown, [](const Affine& a) { return std::cbrt(std::abs(determinant(a))); }));
  const auto mirrored = std::ranges::count_if(shown, [](const Affine& a) { return determinant(a) < 0; });
  return {2 * mirrored > std::ssize(shown) ? -scale : scale, scale, scale};
}

// Does it keep all angles?
bool is_even(const Affine& a) {
  const auto column = [&](std::size_t c) { return Vec3{a.m[0][c], a.m[1][c], a.m[2][c]}; };
  const double size = std::pow(std::abs(determinant(a)), 2.0 / 3);
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t k = i; k < 3; ++k) {
      if (!(std::abs(dot(column(i), column(k)) - (i == k ? size : 0)) <= 1e-3 * size)) return false;
    }
  }
  return true;
}

void scale_rest(const Vec3& by, SkinSkeleton& skin, std::vector<std::string>& notes) {
  const auto scale = [&](Affine& a) {
    for (auto& row : a.m) {
      for (std::size_t c = 0; c < 3; ++c) row[c] /= by[c];
    }
  };
  for (Joint& joint : skin.skeleton.joints) scale(joint.inverse_bind);
  for (Affine& shown : skin.shown) scale(shown);
  for (std::size_t i = 0; i < 3; ++i) {
    for (double& x : skin.rest.m[i]) x *= by[i];
  }
  if (by[1] != 1) {
    notes.push_back("The joints scale the whole skin by " + formatted("%.6g", by[1]) +
                    " (mesh and world have different units); the rest shape was scaled by it.");
  }
  if (by[0] < 0) notes.push_back("The joints mirror the whole skin; the rest shape was mirrored.");
}

// A stretch that most of the skin has one way goes into the rest shape, so that joints turn it and no more. `listed`:
// the joints of the skin, of which the first tells. The others are where their nodes are.
void stretch_rest(std::span<const std::uint32_t> listed, SkinSkeleton& skin, std::vector<std::string>& notes) {
  const Affine by = skin.shown[std::ranges::min(listed)];
  if (is_even(by) || std::abs(determinant(by)) < 1e-9) return;
  const Affine back = inverse(by);
  const auto uneven = [&](const Affine& before) {
    return std::ranges::count_if(listed, [&](const std::uint32_t j) { return !is_even(skin.shown[j] * before); });
  };
  if (uneven(back) >= uneven({})) return;
  skin.rest = by * skin.rest;
  std::vector<bool> is_listed(skin.shown.size(), false);
  for (const std::uint32_t j : listed) is_listed[j] = true;
  for (std::size_t j = 0; j < skin.shown.size(); ++j) {
    const Affine before = is_listed[j] ? back : inverse(skin.shown[j]);
    skin.shown[j] = skin.shown[j] * before;
    skin.skeleton.joints[j].inverse_bind = skin.skeleton.joints[j].inverse_bind * before;
  }
  notes.push_back("The nodes stretch the whole skin one way; the rest shape was stretched so.");
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

// One element of joints_of_skins(); `binds` are those of `skin`.
std::vector<std::uint32_t> joints_in_skin(const GltfFile& file, int other, int skin, const std::vector<Affine>& binds) {
  const std::vector<int>&theirs = file.model().skins[static_cast<std::size_t>(other)].joints,
        &own = file.model().skins[static_cast<std::size_t>(skin)].joints;
  std::vector<std::uint32_t> same;
  for (const int joint : theirs) {
    const auto found = std::ranges::find(own, joint);
    if (found == own.end()) return {};
    same.push_back(static_cast<std::uint32_t>(found - own.begin()));
  }
  if (other == skin) return same;
  const std::vector<Affine> their_binds = read_inverse_binds(file, other, theirs.size(), 1);
  double size = 0;
  for (const Affine& bind : binds) size = std::max(size, length({bind.m[0][3], bind.m[1][3], bind.m[2][3]}));
  for (std::size_t j = 0; j < same.size(); ++j) {
    const Affine &a = their_binds[j], &b = binds[same[j]];
    const double scale = std::cbrt(std::abs(determinant(b)));
    for (int r = 0; r < 3; ++r) {
      for (int c = 0; c < 4; ++c) {
        if (!(std::abs(a.m[r][c] - b.m[r][c]) <= 1e-4 * (c == 3 ? size : scale))) return {};
      }
    }
  }
  return same;
}

}  // namespace

int choose_skin(const GltfFile& file) {
  const tinygltf::Model& model = file.model();
  std::vector<std::size_t> vertices(model.skins.size(), 0);
  for (const tinygltf::Node& node : model.nodes) {
    if (node.skin < 0 || node.mesh < 0) continue;
    if (node.skin >= std::ssize(model.skins)) file.fail("a node uses skin ", node.skin, " of ", model.skins.size());
    if (node.mesh >= std::ssize(model.meshes)) file.fail("a node uses mesh ", node.mesh, " of ", model.meshes.size());
    for (const auto& primitive : model.meshes[static_cast<std::size_t>(node.mesh)].primitives) {
      const auto position = primitive.attributes.find("POSITION");
      if (position == primitive.attributes.end() || position->second < 0 ||
          position->second >= std::ssize(model.accessors)) {
        file.fail("a skinned primitive has no positions");
      }
      vertices[static_cast<std::size_t>(node.skin)] +=
          model.accessors[static_cast<std::size_t>(position->second)].count;
    }
  }
  const auto most = std::ranges::max_element(vertices);
  if (most == vertices.end() || *most == 0) return -1;
  int best = static_cast<int>(most - vertices.begin());
  const auto joints_of = [&](int skin) { return model.skins[static_cast<std::size_t>(skin)].joints.size(); };
  for (int skin = 0; skin < std::ssize(vertices); ++skin) {
    const std::size_t count = joints_of(skin);
    if (vertices[static_cast<std::size_t>(skin)] == 0 || count <= joints_of(best)) continue;
    if (!joints_in_skin(file, best, skin, read_inverse_binds(file, skin, count, 1)).empty()) best = skin;
  }
  return best;
}

std::vector<std::vector<std::uint32_t>> joints_of_skins(const GltfFile& file, int skin) {
  const std::size_t count = file.model().skins[static_cast<std::size_t>(skin)].joints.size();
  const std::vector<Affine> binds = read_inverse_binds(file, skin, count, 1);
  std::vector<std::vector<std::uint32_t>> joints;
  for (int other = 0; other < std::ssize(file.model().skins); ++other) {
    joints.push_back(joints_in_skin(file, other, skin, binds));
  }
  return joints;
}

double common_scale(std::vector<double> scales) {
  std::erase_if(scales, [](double scale) { return scale == 0 || !std::isfinite(scale); });
  if (scales.empty()) return 1;
  std::ranges::sort(scales);
  const double median = scales[scales.size() / 2];
  const auto agree =
      std::ranges::count_if(scales, [&](const double scale) { return std::abs(scale - median) <= 0.01 * median; });
  const bool is_unit = !(median > 0.5 && median < 2);
  if (2 * agree <= std::ssize(scales) && !is_unit) return 1;
  return std::abs(median - 1) > 1e-3 ? median : 1;
}

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
  const SkinJoints joints = read_skin_joints(file, skin, tree, notes);
  const JointFold fold(tree, joints.nodes, std::vector<bool>(tree.parent.size(), false));
  const std::vector<JointTransform> locals = fold.locals(tree.local);
  const std::vector<Affine> world = world_of_nodes(tree);
  std::vector<Affine> inverse_binds = read_inverse_binds(file, skin, joints.listed, unit);
  for (std::size_t k = joints.listed; k < joints.nodes.size(); ++k) {
    const Affine& bind = world[static_cast<std::size_t>(joints.nodes[k])];
    if (std::abs(determinant(bind)) < 1e-30) file.fail("'", joints.names[k], "', above joints, is scaled to nothing");
    inverse_binds.push_back(inverse(bind));
  }

  SkinSkeleton result;
  for (std::size_t i = 0; i < 3; ++i) result.rest.m[i][i] = unit;
  result.joint_of_skin.resize(joints.nodes.size());
  for (const std::size_t k : parents_first(fold, joints.nodes)) {
    result.joint_of_skin[k] = static_cast<std::uint32_t>(result.skeleton.size());
    const int above = fold.joint_above(static_cast<std::size_t>(joints.nodes[k]));
    Joint joint;
    joint.name = joints.names[k];
    joint.parent = above < 0 ? -1 : static_cast<int>(result.joint_of_skin[static_cast<std::size_t>(above)]);
    joint.default_local = locals[k];
    joint.inverse_bind = inverse_binds[k];
    result.shown.push_back(world[static_cast<std::size_t>(joints.nodes[k])] * joint.inverse_bind);
    for (const auto& row : result.shown.back().m) {
      for (const double x : row) {
        if (!std::isfinite(x)) file.fail("the transform of joint '", joint.name, "' is out of range");
      }
    }
    result.skeleton.joints.push_back(std::move(joint));
  }

  const std::span listed = std::span<const std::uint32_t>(result.joint_of_skin).first(joints.listed);
  stretch_rest(listed, result, notes);
  const std::vector<Affine> shown = transformed(listed, [&](const std::uint32_t j) { return result.shown[j]; });
  if (const Vec3 scale = common_scale_and_mirror(shown); scale != Vec3{1, 1, 1}) scale_rest(scale, result, notes);
  note_names("Bind matrices with shear, which joints cannot hold (the rest pose will be off): ",
             set_binds(file, result.skeleton), notes);
  return result;
}

}  // namespace bodyopt
