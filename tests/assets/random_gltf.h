// Characters in glTF as they are found, at random: units, axes and scales of armatures and meshes, mirrored or sheared
// ones, joints between other nodes, poses, several skins and scenes, morph targets by default, sparse accessors, a
// clip. And what a reader must make of each, by PlainGltf.
#pragma once

#include <algorithm>
#include <random>
#include <string>
#include <vector>

#include "assets/characters/character.h"
#include "assets/clips/clip.h"
#include "runtime/core/transform.h"
#include "runtime/host/rig.h"
#include "tests/assets/plain_gltf.h"

namespace bodyopt {

class RandomGltf {
 public:
  explicit RandomGltf(std::uint64_t seed) : random_(seed) {
    file_unit_ = pick({1.0, 1.0, 0.01, 0.001});
    armature_unit_ = pick({1.0, file_unit_, 0.01});
    mesh_unit_ = pick({armature_unit_, armature_unit_, 1.0, 0.0001});
    blob.root["nodes"] = blob.root["meshes"] = blob.root["skins"] = Json::array();
    blob.root["scenes"] = Json::array({{{"nodes", Json::array()}}});
    add_skeleton("");
    body.push_back(add_mesh("body", 0, 12));
    if (chance(0.3)) add_further_skin();
    if (chance(0.3)) body.push_back(add_mesh("hat", 0, 3));
    if (chance(0.3)) add_mesh("coarse", 0, 14, false);
    if (chance(0.2)) blob.root["scenes"].push_back({{"nodes", {0}}});
    if (chance(0.2)) put_own_scene_second();
    add_motion();
  }

  GltfBlob blob;
  std::vector<std::size_t> body, loose_pieces;  // nodes of the character's skin, in order; nodes of other skins

  // Empty where it is as it must be.
  std::string what_is_wrong(const Character& character) const {
    std::vector<JointTransform> locals;
    for (const Joint& joint : character.skeleton.joints) locals.push_back(joint.default_local);
    return what_is_wrong(character, locals, blob);
  }

  // The same of the file's clip, as that character is read for it, a frame a second.
  std::string what_is_wrong(const Character& character, const Clip& clip) const {
    if (clip.poses.size() != kFrames) return std::to_string(clip.poses.size()) + " frames";
    for (std::size_t k = 0; k < kFrames; ++k) {
      GltfBlob posed = blob;
      for (const Moved& moved : moved_) posed.root["nodes"][moved.node][moved.path] = moved.values[k];
      const std::string wrong = what_is_wrong(character, clip.poses[k].joints, posed);
      if (!wrong.empty()) return "frame " + std::to_string(k + 1) + ": " + wrong;
    }
    return "";
  }

  // Do some joints turn the skin inside out, and others not?
  bool may_be_refused() const { return is_partly_mirrored_; }

 private:
  static constexpr std::size_t kFrames = 3;

  // What a channel makes of a node, per frame.
  struct Moved {
    std::size_t node;
    std::string path;
    std::vector<std::vector<double>> values;
  };

  std::string what_is_wrong(const Character& character, const std::vector<JointTransform>& locals,
                            const GltfBlob& posed) const {
    const PlainGltf plain(posed);
    std::vector<PlainGltf::Point> expected;
    for (const std::size_t node : body) {
      const std::vector<PlainGltf::Point> points = plain.skinned(node);
      expected.insert(expected.end(), points.begin(), points.end());
    }
    if (expected.size() != character.output_count()) {
      return std::to_string(character.output_count()) + " points of " + std::to_string(expected.size());
    }
    const std::vector<Affine> matrices = skinning_matrices(character.skeleton, locals);
    double most = 0;
    for (std::size_t o = 0; o < expected.size(); ++o) {
      const std::uint32_t v = character.output_vertex[o];
      const auto row = character.vertices.row(static_cast<Eigen::Index>(v));
      Vec3 shown{0, 0, 0};
      for (const JointWeight& w : character.weights[v]) {
        shown = shown + w.weight * (matrices[w.joint] * Vec3{row[0], row[1], row[2]});
      }
      most = std::max(most, length(shown - file_unit_ * expected[o]));
    }
    return most <= 2e-4 * height_ ? "" : std::to_string(most) + " m off";
  }

  // Turns joints and nodes between them, and shifts the first.
  void add_motion() {
    blob.root["animations"] =
        Json::array({{{"name", "move"}, {"channels", Json::array()}, {"samplers", Json::array()}}});
    for (std::size_t n = 0; n < blob.root["nodes"].size(); ++n) {
      const std::string name = blob.root["nodes"][n].value("name", "");
      const bool is_first = n == joint_nodes_.front();
      if (is_first || (name.starts_with("joint") && chance(0.7)) || (name.starts_with("between") && chance(0.3))) {
        move(n, "rotation", [&] { return turn(); });
      }
      if (is_first && chance(0.5)) {
        move(n, "translation", [&] { return Vec3{from(-1, 1) / armature_unit_, 0, from(-1, 1) / armature_unit_}; });
      }
    }
  }

  template <typename Value>
  void move(std::size_t node, const std::string& path, Value value) {
    Moved& moved = moved_.emplace_back(Moved{node, path, {}});
    std::vector<float> times, numbers;
    for (std::size_t k = 0; k < kFrames; ++k) {
      const auto one = value();
      moved.values.emplace_back(one.begin(), one.end());
      times.push_back(static_cast<float>(k));
      for (const double x : one) numbers.push_back(static_cast<float>(x));
    }
    animate(blob, node, path, times, numbers, chance(0.5) ? "LINEAR" : "STEP");
  }

  double from(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }
  bool chance(double part) { return from(0, 1) < part; }
  double pick(const std::vector<double>& of) { return of[random_() % of.size()]; }
  Quat turn() { return normalized({from(-1, 1), from(-1, 1), from(-1, 1), from(-1, 1)}); }

  std::size_t add_node(Json node) {
    blob.root["nodes"].push_back(std::move(node));
    return blob.root["nodes"].size() - 1;
  }
  void show(std::size_t node) { blob.root["scenes"][0]["nodes"].push_back(node); }

  static Json node_of(const std::string& name, const JointTransform& t) {
    return {{"name", name}, {"translation", t.translation}, {"rotation", t.rotation}, {"scale", t.scale}};
  }

  // A chain of joints up a body, each in axes of its own, below an armature; a skin of them.
  void add_skeleton(const std::string& side) {
    JointTransform armature;
    armature.translation = {from(-1, 1) / file_unit_, 0, from(-1, 1) / file_unit_};
    if (chance(0.5)) armature.rotation = chance(0.5) ? turn() : axis_angle({1, 0, 0}, -1.5707963267948966);
    const double scale = armature_unit_ / file_unit_;
    armature.scale = {scale, scale, scale};
    if (chance(0.1)) armature.scale[random_() % 3] *= -1;
    if (chance(0.1)) {
      armature.scale = {scale, 1.4 * scale, 0.7 * scale};
    }
    const std::size_t top = add_node(node_of(side + "armature", armature));
    show(top);
    const std::size_t joints = 2 + random_() % 5;
    height_ = from(1, 2.5);
    joint_nodes_.clear();
    binds_.clear();
    std::size_t above = top;
    Affine world_above;
    for (std::size_t k = 0; k < joints; ++k) {
      JointTransform bind;
      bind.rotation = chance(0.5) ? turn() : Quat{0, 0, 0, 1};
      bind.translation = {0, height_ / armature_unit_ * static_cast<double>(k) / static_cast<double>(joints), 0};
      JointTransform local = decompose(inverse(world_above) * affine_from(bind));
      world_above = affine_from(bind);
      if (chance(0.2)) {  // a node between
        JointTransform between;
        between.rotation = turn();
        const JointTransform rest = decompose(inverse(affine_from(between)) * affine_from(local));
        above = add_child(above, node_of(side + "between" + std::to_string(k), between));
        local = rest;
      }
      if (chance(0.3)) local.rotation = normalized(local.rotation * axis_angle({0, 0, 1}, from(-1, 1)));
      if (k + 1 == joints && chance(0.2)) local.scale = {1.1, 1.1, 1.1};
      if (k + 1 == joints && chance(0.05)) {
        local.scale = {-1, 1, 1};
        is_partly_mirrored_ = true;
      }
      above = add_child(above, node_of(side + "joint" + std::to_string(k), local));
      joint_nodes_.push_back(above);
      const double size = armature_unit_ / mesh_unit_;
      bind.translation = size * bind.translation;
      bind.scale = {size, size, size};
      binds_.push_back(inverse(affine_from(bind)));
    }
    std::vector<std::size_t> order(joints);
    for (std::size_t k = 0; k < joints; ++k) order[k] = k;
    add_skin(order);
  }

  std::size_t add_child(std::size_t above, Json node) {
    const std::size_t child = add_node(std::move(node));
    blob.root["nodes"][above]["children"].push_back(child);
    return child;
  }

  void add_skin(const std::vector<std::size_t>& order) {
    std::vector<float> columns;
    Json nodes = Json::array();
    for (const std::size_t k : order) {
      for (std::size_t i = 0; i < 16; ++i) {
        columns.push_back(i % 4 == 3 ? (i == 15 ? 1.0f : 0.0f) : static_cast<float>(binds_[k].m[i % 4][i / 4]));
      }
      nodes.push_back(joint_nodes_[k]);
    }
    const std::size_t accessor = blob.matrices(columns);
    blob.root["skins"].push_back({{"joints", nodes}, {"inverseBindMatrices", accessor}});
  }

  // Of the same joints in another order, which is the same character, or of another skeleton.
  void add_further_skin() {
    const std::size_t skin = blob.root["skins"].size();
    if (chance(0.5)) {
      std::vector<std::size_t> order(joint_nodes_.size());
      for (std::size_t k = 0; k < order.size(); ++k) order[k] = order.size() - 1 - k;
      add_skin(order);
      body.push_back(add_mesh("hair", skin, 4));
    } else {
      const double height = height_;
      const bool was_mirrored = is_partly_mirrored_;
      const std::vector<std::size_t> nodes = joint_nodes_;
      const std::vector<Affine> binds = binds_;
      add_skeleton("other");
      loose_pieces.push_back(add_mesh("rider", skin, 4));
      height_ = height;
      is_partly_mirrored_ = was_mirrored;
      joint_nodes_ = nodes;
      binds_ = binds;
    }
  }

  std::size_t vectors(const std::vector<float>& values) {
    if (chance(0.7)) return blob.vectors(values);
    // Every other vector stands beside a base, which may be none.
    const bool has_base = chance(0.5);
    std::vector<float> base = values, some;
    std::vector<std::uint16_t> places;
    for (std::size_t k = 0; k < values.size() / 3; ++k) {
      if (has_base && k % 2 == 0) continue;
      places.push_back(static_cast<std::uint16_t>(k));
      for (std::size_t i = 0; i < 3; ++i) {
        some.push_back(values[3 * k + i]);
        base[3 * k + i] = 77;
      }
    }
    const std::size_t at = blob.root["accessors"][blob.add(places, 5123, "SCALAR", 1)]["bufferView"],
                      by = blob.root["accessors"][blob.vectors(some)]["bufferView"], whole = blob.vectors(base);
    Json& accessor = blob.root["accessors"][whole];
    if (!has_base) accessor.erase("bufferView");
    accessor["sparse"] = {{"count", places.size()},
                          {"indices", {{"bufferView", at}, {"componentType", 5123}}},
                          {"values", {{"bufferView", by}}}};
    return whole;
  }

  // A tube up the body, each ring on two joints. The node's own transform is to be ignored.
  std::size_t add_mesh(const std::string& name, std::size_t skin, std::size_t rings, bool is_shown = true) {
    const std::size_t joints = joint_nodes_.size();
    std::vector<float> positions, weights;
    std::vector<std::uint8_t> which;
    std::vector<std::uint16_t> corners;
    constexpr std::size_t kAround = 6;
    const double radius = from(0.1, 0.2);
    for (std::size_t r = 0; r < rings; ++r) {
      for (std::size_t k = 0; k < kAround; ++k) {
        const double angle = 6.283185307179586 * static_cast<double>(k) / kAround;
        const double up = height_ * static_cast<double>(r) / static_cast<double>(rings - 1);
        for (const double x : {radius * std::cos(angle), up, radius * std::sin(angle)}) {
          positions.push_back(static_cast<float>(x / mesh_unit_));
        }
        const auto joint = static_cast<std::uint8_t>(r * (joints - 1) / rings);
        which.insert(which.end(), {joint, static_cast<std::uint8_t>(joint + 1), 0, 0});
        const auto share = static_cast<float>(from(0, 1));
        weights.insert(weights.end(), {1 - share, share, 0, 0});
        if (r + 1 == rings) continue;
        const std::size_t a = r * kAround + k, b = r * kAround + (k + 1) % kAround;
        for (const std::size_t corner : {a, a + kAround, b, b, a + kAround, b + kAround}) {
          corners.push_back(static_cast<std::uint16_t>(corner));
        }
      }
    }
    Json mesh = {{"primitives", Json::array()}};
    Json node = {{"name", name}, {"skin", skin}, {"scale", {from(0.5, 2), 1, 1}}};
    Json primitive = {{"attributes", Json::object()}};
    primitive["attributes"]["POSITION"] = vectors(positions);
    primitive["attributes"]["JOINTS_0"] = blob.joints(which);
    primitive["attributes"]["WEIGHTS_0"] = blob.quads(weights);
    primitive["indices"] = blob.add(corners, 5123, "SCALAR", 1);
    if (chance(0.3)) {
      std::vector<float> moved;
      for (std::size_t k = 0; k < positions.size(); ++k)
        moved.push_back(static_cast<float>(from(0, 0.05) / mesh_unit_));
      primitive["targets"].push_back({{"POSITION", vectors(moved)}});
      if (chance(0.7)) mesh["weights"] = {from(0, 1)};
      if (chance(0.3)) node["weights"] = {from(0, 1)};
    }
    mesh["primitives"].push_back(primitive);
    blob.root["meshes"].push_back(mesh);
    node["mesh"] = blob.root["meshes"].size() - 1;
    const std::size_t index = add_node(node);
    if (is_shown) show(index);
    return index;
  }

  void put_own_scene_second() {
    Json& scenes = blob.root["scenes"];
    const Json own = scenes[0];
    scenes[0] = {{"nodes", Json::array()}};
    scenes.push_back(own);
    if (chance(0.5)) blob.root["scene"] = scenes.size() - 1;
  }

  std::mt19937_64 random_;
  double file_unit_ = 1, armature_unit_ = 1, mesh_unit_ = 1;  // metres
  double height_ = 1;                                         // metres
  bool is_partly_mirrored_ = false;
  std::vector<std::size_t> joint_nodes_;
  std::vector<Affine> binds_;  // inverse
  std::vector<Moved> moved_;
};

}  // namespace bodyopt
