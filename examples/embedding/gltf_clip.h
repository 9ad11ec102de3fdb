// A clip of a .glb as skinning matrices, which every engine has after its own import: LINEAR and STEP keys of the first
// animation, the joints of the first skin. Of the file of the character itself, or of a motion that Bodyopt wrote.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <fstream>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <vector>

class GltfClip {
 public:
  using Matrix = std::array<float, 12>;  // three rows of four

  explicit GltfClip(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    const std::string bytes{std::istreambuf_iterator<char>(file), {}};
    if (bytes.size() < 20 || !bytes.starts_with("glTF")) throw std::runtime_error(path + " is no .glb");
    std::uint32_t length = 0;
    std::memcpy(&length, bytes.data() + 12, 4);
    root_ = nlohmann::json::parse(bytes.substr(20, length));
    binary_ = bytes.substr(std::min(bytes.size(), std::size_t{28} + length));
    const auto& skin = root_.at("skins").at(0);
    const std::vector<float> binds = numbers(skin.at("inverseBindMatrices"), 16);
    for (std::size_t k = 0; k < skin.at("joints").size(); ++k) {
      const std::size_t node = skin["joints"][k];
      joints_[root_["nodes"].at(node).value("name", "")] = {node, rows_of(&binds.at(16 * k))};
    }
    for (std::size_t n = 0; n < root_["nodes"].size(); ++n) {
      for (const std::size_t child : root_["nodes"][n].value("children", std::vector<std::size_t>())) above_[child] = n;
    }
  }

  // Of the joint of this name; what the clip does not move stands as its node does.
  Matrix skinning(const std::string& joint, float seconds) const {
    const auto found = joints_.find(joint);
    if (found == joints_.end()) throw std::runtime_error("the clip has no joint '" + joint + "': of another rig?");
    const auto& [node, inverse_bind] = found->second;
    return times(world(node, seconds), inverse_bind);
  }

 private:
  // Of an accessor of floats.
  std::vector<float> numbers(std::size_t accessor, std::size_t components) const {
    const auto &is = root_.at("accessors").at(accessor), &view = root_.at("bufferViews").at(is.value("bufferView", 0));
    const std::size_t begin = view.value("byteOffset", 0u) + is.value("byteOffset", 0u), count = is.at("count");
    if (is.at("componentType") != 5126 || begin + 4 * components * count > binary_.size()) {
      throw std::runtime_error("an accessor of the clip is not of floats, or beyond the file");
    }
    std::vector<float> values(components * count);
    std::memcpy(values.data(), binary_.data() + begin, sizeof(float) * values.size());
    return values;
  }

  // Translation, rotation x y z w or scale of a node at a time.
  std::vector<float> property(std::size_t node, const std::string& path, std::vector<float> rest, float seconds) const {
    rest = root_["nodes"][node].value(path, rest);
    const std::size_t size = rest.size();
    for (const auto& channel : root_.at("animations").at(0).at("channels")) {
      const auto& target = channel.at("target");
      if (!target.contains("node") || target["node"] != node || target.at("path") != path) continue;
      const auto& sampler = root_["animations"][0].at("samplers").at(channel.at("sampler").get<std::size_t>());
      const std::string interpolation = sampler.value("interpolation", "LINEAR");
      if (interpolation != "LINEAR" && interpolation != "STEP") {
        throw std::runtime_error("the clip has keys of " + interpolation + ": export it with LINEAR or STEP keys");
      }
      const std::vector<float> keys = numbers(sampler.at("input"), 1), values = numbers(sampler.at("output"), size);
      const auto after = std::ranges::upper_bound(keys, seconds);
      const auto next = static_cast<std::size_t>(std::min(after, keys.end() - 1) - keys.begin()),
                 last = static_cast<std::size_t>(std::max(after, keys.begin() + 1) - 1 - keys.begin());
      float share = next > last ? std::min(1.0f, (seconds - keys[last]) / (keys[next] - keys[last])) : 0.0f;
      if (interpolation == "STEP") share = 0;
      float along = 0;
      for (std::size_t i = 0; i < size; ++i) along += values[size * last + i] * values[size * next + i];
      const float sign = size == 4 && along < 0 ? -1.0f : 1.0f;  // q and -q turn alike
      for (std::size_t i = 0; i < size; ++i) {
        rest[i] = (1 - share) * values[size * last + i] + share * sign * values[size * next + i];
      }
    }
    return rest;
  }

  Matrix world(std::size_t node, float seconds) const {
    if (root_["nodes"][node].contains("matrix")) {
      throw std::runtime_error("node " + std::to_string(node) +
                               " of the clip has a matrix: export translation, rotation and scale");
    }
    const std::vector<float> t = property(node, "translation", {0, 0, 0}, seconds),
                             q = property(node, "rotation", {0, 0, 0, 1}, seconds),
                             s = property(node, "scale", {1, 1, 1}, seconds);
    const float n = 2 / (q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]), x = q[0], y = q[1], z = q[2], w = q[3];
    const Matrix own = {
        s[0] * (1 - n * (y * y + z * z)), s[1] * n * (x * y - z * w),       s[2] * n * (x * z + y * w),       t[0],
        s[0] * n * (x * y + z * w),       s[1] * (1 - n * (x * x + z * z)), s[2] * n * (y * z - x * w),       t[1],
        s[0] * n * (x * z - y * w),       s[1] * n * (y * z + x * w),       s[2] * (1 - n * (x * x + y * y)), t[2]};
    const auto parent = above_.find(node);
    return parent == above_.end() ? own : times(world(parent->second, seconds), own);
  }

  static Matrix rows_of(const float* columns) {
    Matrix rows{};
    for (std::size_t k = 0; k < 12; ++k) rows[k] = columns[4 * (k % 4) + k / 4];
    return rows;
  }

  static Matrix times(const Matrix& a, const Matrix& b) {
    Matrix c{};
    for (std::size_t k = 0; k < 12; ++k) {
      const std::size_t row = 4 * (k / 4), column = k % 4;
      c[k] = column == 3 ? a[row + 3] : 0;
      for (std::size_t i = 0; i < 3; ++i) c[k] += a[row + i] * b[4 * i + column];
    }
    return c;
  }

  nlohmann::json root_;
  std::string binary_;
  std::map<std::string, std::pair<std::size_t, Matrix>> joints_;
  std::map<std::size_t, std::size_t> above_;
};
