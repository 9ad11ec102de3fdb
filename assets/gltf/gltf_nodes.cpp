#include "assets/gltf/gltf_nodes.h"

#include <cmath>
#include <map>
#include <set>

#include "base/wording.h"

namespace bodyopt {
namespace {

std::string node_label(const tinygltf::Model& model, std::size_t node) {
  const std::string& name = model.nodes[node].name;
  return name.empty() ? "node " + std::to_string(node) : "node '" + name + "'";
}

bool is_identity(const JointTransform& t) {
  return t.translation == Vec3{0, 0, 0} && t.scale == Vec3{1, 1, 1} && std::abs(t.rotation[3]) == 1;
}

Affine from_columns(const std::vector<double>& columns) {
  Affine a;
  for (std::size_t r = 0; r < 3; ++r) {
    for (std::size_t c = 0; c < 4; ++c) a.m[r][c] = columns[4 * c + r];
  }
  return a;
}

bool is_sheared(const Affine& a, const JointTransform& t) {
  double size = 0;
  for (const auto& row : a.m) {
    for (int c = 0; c < 3; ++c) size = std::max(size, std::abs(row[c]));
  }
  const Affine back = affine_from(t);
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) {
      if (std::abs(back.m[r][c] - a.m[r][c]) > 1e-4 * size) return true;
    }
  }
  return false;
}

// Appends nodes above joints that scale one axis more than another. Parents of seen nodes have been seen already, too.
void append_stretching_nodes(const NodeTree& tree, std::vector<int>& joints) {
  std::vector<bool> is_seen(tree.parent.size(), false);
  for (const int joint : joints) is_seen[static_cast<std::size_t>(joint)] = true;
  for (std::size_t k = 0, listed = joints.size(); k < listed; ++k) {
    for (int up = tree.parent[static_cast<std::size_t>(joints[k])]; up >= 0 && !is_seen[static_cast<std::size_t>(up)];
         up = tree.parent[static_cast<std::size_t>(up)]) {
      is_seen[static_cast<std::size_t>(up)] = true;
      if (!scales_evenly(tree.local[static_cast<std::size_t>(up)])) joints.push_back(up);
    }
  }
}

// Parts of a node's transform that could not be taken as they are.
struct NodeRepairs {
  bool sheared = false, has_no_turn = false;
};

void append_transform(const GltfFile& file, std::size_t index, double unit, NodeTree& tree, NodeRepairs& repairs) {
  const tinygltf::Node& node = file.model().nodes[index];
  const auto has = [&](const std::vector<double>& values, std::size_t count) {
    if (!values.empty() && values.size() != count) {
      file.fail(node_label(file.model(), index), " has a transform of ", values.size(), " numbers, expected ", count);
    }
    return !values.empty();
  };
  JointTransform t;
  Affine exact;
  const bool is_matrix = has(node.matrix, 16);
  if (is_matrix) {
    exact = from_columns(node.matrix);
    t = decompose(exact);
    repairs.sheared = is_sheared(exact, t);
  } else {
    if (has(node.translation, 3)) std::copy(node.translation.begin(), node.translation.end(), t.translation.begin());
    if (has(node.scale, 3)) std::copy(node.scale.begin(), node.scale.end(), t.scale.begin());
    if (has(node.rotation, 4)) std::copy(node.rotation.begin(), node.rotation.end(), t.rotation.begin());
  }
  t.translation = unit * t.translation;
  if (!is_finite(t)) file.fail(node_label(file.model(), index), " has a transform that is not finite");
  repairs.has_no_turn = !has_length(t.rotation);
  t.rotation = normalized(t.rotation);
  if (!is_matrix) exact = affine_from(t);
  for (std::size_t r = 0; r < 3; ++r) exact.m[r][3] = t.translation[r];
  tree.local.push_back(t);
  tree.exact.push_back(exact);
}

// Parents before children; shorter than the tree when there is a cycle.
std::vector<std::size_t> topological_order(const tinygltf::Model& model, const std::vector<int>& parent) {
  std::vector<std::size_t> order;
  for (std::size_t n = 0; n < parent.size(); ++n) {
    if (parent[n] < 0) order.push_back(n);
  }
  for (std::size_t next = 0; next < order.size(); ++next) {
    for (const int child : model.nodes[order[next]].children) order.push_back(static_cast<std::size_t>(child));
  }
  return order;
}

}  // namespace

bool scales_evenly(const JointTransform& t) {
  const double size = std::abs(t.scale[0]);
  return std::abs(std::abs(t.scale[1]) - size) <= 1e-6 * size && std::abs(std::abs(t.scale[2]) - size) <= 1e-6 * size;
}

NodeTree read_nodes(const GltfFile& file, double unit, std::vector<std::string>& notes) {
  const tinygltf::Model& model = file.model();
  NodeTree tree;
  tree.parent.assign(model.nodes.size(), -1);
  std::vector<std::string> sheared_nodes, turnless_nodes;
  for (std::size_t n = 0; n < model.nodes.size(); ++n) {
    for (const int child : model.nodes[n].children) {
      if (child < 0 || child >= std::ssize(model.nodes)) {
        file.fail(node_label(model, n), " has the child ", child, ", which does not exist");
      }
      int& parent = tree.parent[static_cast<std::size_t>(child)];
      if (parent >= 0) file.fail(node_label(model, static_cast<std::size_t>(child)), " has two parents");
      parent = static_cast<int>(n);
    }
    NodeRepairs repairs;
    append_transform(file, n, unit, tree, repairs);
    const std::string name = model.nodes[n].name.empty() ? std::to_string(n) : model.nodes[n].name;
    if (repairs.sheared) sheared_nodes.push_back(name);
    if (repairs.has_no_turn) turnless_nodes.push_back(name);
  }
  note_names("Shear in node matrices is dropped: ", sheared_nodes, notes);
  note_names("Rotations of nodes are quaternions of length zero, taken as none: ", turnless_nodes, notes);
  tree.order = topological_order(model, tree.parent);
  if (tree.order.size() != model.nodes.size()) file.fail("its nodes form a cycle");
  return tree;
}

std::vector<Affine> world_of_nodes(const NodeTree& tree) {
  std::vector<Affine> world(tree.parent.size());
  for (const std::size_t n : tree.order) {
    world[n] = tree.parent[n] < 0 ? tree.exact[n] : world[static_cast<std::size_t>(tree.parent[n])] * tree.exact[n];
  }
  return world;
}

SkinJoints read_skin_joints(const GltfFile& file, int skin, const NodeTree& tree, std::vector<std::string>& notes) {
  const tinygltf::Model& model = file.model();
  SkinJoints joints;
  joints.nodes = model.skins[static_cast<std::size_t>(skin)].joints;
  if (joints.nodes.empty()) file.fail("skin ", skin, " has no joints");
  std::set<int> seen;
  for (std::size_t k = 0; k < joints.nodes.size(); ++k) {
    const int node = joints.nodes[k];
    if (node < 0 || node >= std::ssize(model.nodes)) file.fail("joint ", k, " is no node of the file");
    if (!seen.insert(node).second) {
      file.fail(node_label(model, static_cast<std::size_t>(node)), " is listed twice as a joint");
    }
  }
  joints.listed = joints.nodes.size();
  append_stretching_nodes(tree, joints.nodes);
  std::set<std::string> taken;
  for (const int node : joints.nodes) taken.insert(model.nodes[static_cast<std::size_t>(node)].name);
  std::set<std::string> used;
  std::map<std::string, int> copies;
  std::vector<std::string> unnamed, renamed;
  for (std::size_t k = 0; k < joints.nodes.size(); ++k) {
    const std::string& own = model.nodes[static_cast<std::size_t>(joints.nodes[k])].name;
    const std::string wanted = own.empty() ? "joint_" + std::to_string(k) : own;
    std::string name = wanted;
    while (used.contains(name) || (name != own && taken.contains(name))) {
      name = wanted + "_" + std::to_string(2 + copies[wanted]++);
    }
    if (own.empty()) unnamed.push_back(name);
    if (!own.empty() && name != own) renamed.push_back(name);
    used.insert(name);
    joints.names.push_back(name);
  }
  note_names("Joints without a name are called ", unnamed, notes);
  note_names("Joints with the name of another got a suffix: ", renamed, notes);
  return joints;
}

JointFold::JointFold(const NodeTree& tree, std::span<const int> joint_nodes, const std::vector<bool>& animated)
    : joint_nodes_(joint_nodes.begin(), joint_nodes.end()),
      joint_of_node_(tree.parent.size(), -1),
      joint_above_(tree.parent.size(), -1),
      above_(tree.parent.size(), -1),
      folds_(tree.parent.size(), false),
      folded_(joint_nodes.size(), false),
      animated_(joint_nodes.size(), false) {
  for (std::size_t j = 0; j < joint_nodes.size(); ++j) {
    if (joint_nodes[j] >= 0) joint_of_node_[static_cast<std::size_t>(joint_nodes[j])] = static_cast<int>(j);
  }
  for (const std::size_t n : tree.order) {
    if (tree.parent[n] < 0) continue;
    const auto p = static_cast<std::size_t>(tree.parent[n]);
    if (joint_of_node_[p] >= 0) {
      joint_above_[n] = joint_of_node_[p];
    } else {
      joint_above_[n] = joint_above_[p];
      above_[n] = animated[p] || !is_identity(tree.local[p]) ? static_cast<int>(p) : above_[p];
    }
  }
  std::vector<bool> moves(tree.parent.size(), false);
  for (const std::size_t n : tree.order) {
    moves[n] = animated[n] || (above_[n] >= 0 && moves[static_cast<std::size_t>(above_[n])]);
  }
  for (std::size_t j = 0; j < joint_nodes.size(); ++j) {
    if (joint_nodes[j] < 0) continue;
    const auto n = static_cast<std::size_t>(joint_nodes[j]);
    folded_[j] = above_[n] >= 0;
    animated_[j] = moves[n];
    for (int up = above_[n]; up >= 0 && !folds_[static_cast<std::size_t>(up)];
         up = above_[static_cast<std::size_t>(up)]) {
      folds_[static_cast<std::size_t>(up)] = true;
    }
  }
  for (const std::size_t n : tree.order) {
    if (folds_[n]) folded_nodes_.push_back(n);
  }
}

std::vector<JointTransform> JointFold::locals(std::span<const JointTransform> node_local) const {
  std::vector<Affine> folded(node_local.size());
  const auto fold = [&](std::size_t n) {
    const Affine own = affine_from(node_local[n]);
    return above_[n] < 0 ? own : folded[static_cast<std::size_t>(above_[n])] * own;
  };
  for (const std::size_t n : folded_nodes_) folded[n] = fold(n);
  std::vector<JointTransform> locals(joint_nodes_.size());
  for (std::size_t j = 0; j < locals.size(); ++j) {
    if (joint_nodes_[j] < 0) continue;
    const auto n = static_cast<std::size_t>(joint_nodes_[j]);
    locals[j] = folded_[j] ? decompose(fold(n)) : node_local[n];
  }
  return locals;
}

}  // namespace bodyopt
