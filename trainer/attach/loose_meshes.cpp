#include "trainer/attach/loose_meshes.h"

#include <algorithm>
#include <set>

#include "assets/gltf/gltf_skeleton.h"
#include "assets/gltf/gltf_skin.h"
#include "base/wording.h"
#include "runtime/basis/attachments.h"
#include "runtime/core/error.h"

namespace bodyopt::trainer {
namespace {

class LooseMeshReader {
 public:
  LooseMeshReader(const GltfFile& file, const Skeleton& skeleton, std::size_t skin_vertices, double unit,
                  std::vector<std::string>& notes)
      : file_(file),
        skeleton_(skeleton),
        unit_(unit),
        notes_(notes),
        tree_(read_nodes(file_, unit_, notes)),
        world_(world_of_nodes(tree_)) {
    const int first_skin = choose_skin(file_);
    find_character(first_skin, skin_vertices);
    for (int skin = 0; skin < std::ssize(file_.model().skins); ++skin) find_character(skin, skin_vertices);
    set_joints(is_character() ? character_skin_ : first_skin);
  }

  std::vector<LooseMesh> read() {
    const auto& nodes = file_.model().nodes;
    for (std::size_t n = 0; n < nodes.size(); ++n) {
      if (nodes[n].mesh < 0 || character_skins_.contains(nodes[n].skin)) continue;
      if (!is_character()) {
        add(n);
        continue;
      }
      if (nodes[n].skin < 0 && joint_above(n) < 0) {
        notes_.push_back("Mesh '" + nodes[n].name + "' hangs on no joint: it is not attached.");
        continue;
      }
      try {
        add(n);
      } catch (const Error& error) {
        notes_.push_back("Mesh '" + nodes[n].name + "' is not attached: " + error.what());
      }
    }
    return std::move(meshes_);
  }

 private:
  bool is_character() const { return character_skin_ >= 0; }

  // Is it this skin, with those that are one with it?
  void find_character(int skin, std::size_t skin_vertices) {
    if (skin < 0 || is_character() || read_skin_positions(file_, skin).size() != skin_vertices) return;
    character_skin_ = skin;
    const std::vector<std::vector<std::uint32_t>> joints = joints_of_skins(file_, skin);
    for (int other = 0; other < std::ssize(joints); ++other) {
      if (!joints[static_cast<std::size_t>(other)].empty()) character_skins_.insert(other);
    }
  }

  // The character's joints are the joints of the file's skins (another node may have a joint's name). In a file without
  // skins they are bones that came along with a mesh.
  void set_joints(int first_skin) {
    const tinygltf::Model& model = file_.model();
    joint_of_node_.assign(model.nodes.size(), -1);
    std::vector<std::string> unused;
    const auto add_skin = [&](int skin) {
      const SkinJoints joints = read_skin_joints(file_, skin, tree_, unused);
      for (std::size_t k = 0; k < joints.nodes.size(); ++k) {
        int& joint = joint_of_node_[static_cast<std::size_t>(joints.nodes[k])];
        if (joint < 0) joint = skeleton_.find(joints.names[k]);
      }
    };
    if (first_skin >= 0) add_skin(first_skin);
    for (int skin = 0; skin < std::ssize(model.skins); ++skin) add_skin(skin);
    if (!model.skins.empty()) return;
    for (std::size_t n = 0; n < model.nodes.size(); ++n) {
      if (model.nodes[n].mesh < 0) joint_of_node_[n] = skeleton_.find(model.nodes[n].name);
    }
  }

  // The node, or the nearest above it, that is a joint; -1 for none.
  int joint_node(std::size_t node) const {
    int n = static_cast<int>(node);
    while (n >= 0 && joint_of_node_[static_cast<std::size_t>(n)] < 0) n = tree_.parent[static_cast<std::size_t>(n)];
    return n;
  }
  int joint_above(std::size_t node) const {
    const int n = joint_node(node);
    return n < 0 ? -1 : joint_of_node_[static_cast<std::size_t>(n)];
  }

  int node_of_first_joint() const {
    const auto found = std::ranges::find(joint_of_node_, 0);
    return found == joint_of_node_.end() ? -1 : static_cast<int>(found - joint_of_node_.begin());
  }

  // A node's space to the character's rest space. In the character's own file what is below no joint is seen from its
  // first.
  Affine rest_of(std::size_t node) const {
    int above = joint_node(node);
    if (above < 0 && is_character()) above = node_of_first_joint();
    if (above < 0) return world_[node];
    const auto n = static_cast<std::size_t>(above);
    const Joint& joint = skeleton_.joints[static_cast<std::size_t>(joint_of_node_[n])];
    try {
      return inverse(joint.inverse_bind) * inverse(world_[n]) * world_[node];
    } catch (const Error&) {
      file_.fail("the transform of joint '" + joint.name + "' is singular (a scale of 0?)");
    }
  }

  void add(std::size_t node) {
    SkinGeometry geometry = read_node_geometry(file_, node, notes_);
    if (geometry.triangles.empty()) file_.fail("mesh '" + geometry.name + "' has no triangles");
    LooseMesh mesh;
    mesh.node = node;
    mesh.name = unique_name(geometry.name.empty() ? "mesh_" + std::to_string(node) : geometry.name);
    mesh.triangles = std::move(geometry.triangles);
    for (Vec3& p : geometry.positions) p = unit_ * p;
    if (const int skin = file_.model().nodes[node].skin; skin >= 0) {
      place_skinned(skin, geometry, mesh);
    } else {
      place(node, geometry, mesh);
    }
    meshes_.push_back(std::move(mesh));
  }

  void place(std::size_t node, const SkinGeometry& geometry, LooseMesh& mesh) const {
    const Affine to_rest = rest_of(node);
    for (const Vec3& p : geometry.positions) mesh.vertices.push_back(to_rest * p);
    mesh.joint = joint_above(node);
    if (determinant(to_rest) < 0) turn_inside_out(mesh);
  }

  void place_skinned(int skin, const SkinGeometry& geometry, LooseMesh& mesh) {
    std::vector<std::string> unused;
    const SkinJoints joints = read_skin_joints(file_, skin, tree_, unused);
    const std::vector<Affine> binds = read_inverse_binds(file_, skin, joints.listed, unit_);
    std::vector<Affine> to_rest;
    for (std::size_t k = 0; k < joints.listed; ++k) {
      to_rest.push_back(rest_of(static_cast<std::size_t>(joints.nodes[k])) * binds[k]);
    }
    bool is_foreign = true;
    for (std::size_t v = 0; v < geometry.positions.size(); ++v) {
      Vec3 rest{0, 0, 0};
      std::vector<JointWeight> weights = geometry.weights[v];
      if (weights.empty()) weights.push_back({0, 1});
      for (JointWeight& w : weights) {
        rest = rest + w.weight * (to_rest[w.joint] * geometry.positions[v]);
        const int joint = joint_above(static_cast<std::size_t>(joints.nodes[w.joint]));
        if (joint < 0 && !is_character()) refuse_joint(joints.names[w.joint]);
        is_foreign = is_foreign && joint < 0;
        w.joint = static_cast<std::uint32_t>(std::max(0, joint));
      }
      mesh.vertices.push_back(rest);
      mesh.weights.push_back(std::move(weights));
    }
    if (determinant(to_rest.front()) < 0) turn_inside_out(mesh);
    if (!is_foreign) return;
    mesh.joint = 0;
    notes_.push_back("Mesh '" + mesh.name + "' is skinned to joints of another character: it is fixed to '" +
                     skeleton_.joints.front().name + "' as it stands.");
  }

  // Mirrored: the outside stays outside.
  static void turn_inside_out(LooseMesh& mesh) {
    for (auto& [a, b, c] : mesh.triangles) std::swap(b, c);
  }

  [[noreturn]] void refuse_joint(const std::string& name) const {
    const std::vector<std::string> known = names_of(skeleton_.joints);
    throw Error(ErrorKind::mismatch, file_.path(), ": a mesh is skinned to joint '", name,
                "', which the character does not have, nor one above it; the nearest names are ",
                list_names(nearest_names(known, name)), ": a mesh of another character?");
  }

  std::string unique_name(const std::string& wanted) {
    std::string name = attachment_name(wanted);
    for (int copy = 2; !names_.insert(name).second; ++copy) {
      const std::string suffix = "_" + std::to_string(copy);
      name = attachment_name(wanted.substr(0, kLongestAttachedName - suffix.size())) + suffix;
    }
    return name;
  }

  const GltfFile& file_;
  const Skeleton& skeleton_;
  double unit_;
  std::vector<std::string>& notes_;
  NodeTree tree_;
  std::vector<Affine> world_;
  int character_skin_ = -1;         // where the file is the character's own
  std::set<int> character_skins_;   // and those that are one with it
  std::vector<int> joint_of_node_;  // the character's, -1 for none
  std::set<std::string> names_;
  std::vector<LooseMesh> meshes_;
};

}  // namespace

std::vector<LooseMesh> read_loose_meshes(const GltfFile& file, const Skeleton& skeleton, std::size_t skin_vertices,
                                         double unit, std::vector<std::string>& notes) {
  return LooseMeshReader(file, skeleton, skin_vertices, unit, notes).read();
}

}  // namespace bodyopt::trainer
