// A second reader of glTF, against which the product's is held: plain linear blend skinning after the text of the glTF
// 2.0 specification, in double precision, of sound files alone. It shares nothing with the reader under test.
#pragma once

#include <array>
#include <cmath>
#include <cstring>
#include <string>
#include <vector>

#include "tests/assets/gltf_blob.h"

namespace bodyopt {

class PlainGltf {
 public:
  using Matrix = std::array<std::array<double, 4>, 4>;
  using Point = std::array<double, 3>;

  explicit PlainGltf(const GltfBlob& blob) : root_(blob.root), binary_(blob.binary) {
    const std::size_t count = root_.at("nodes").size();
    parent_.assign(count, -1);
    for (std::size_t n = 0; n < count; ++n) {
      for (const Json& child : root_["nodes"][n].value("children", Json::array())) {
        parent_[child.get<std::size_t>()] = static_cast<int>(n);
      }
    }
  }

  // The vertices of a skinned node, world, file units, as the nodes stand.
  std::vector<Point> skinned(std::size_t node) const {
    const Json &own = root_["nodes"][node], &mesh = root_["meshes"][own["mesh"].get<std::size_t>()],
               &skin = root_["skins"][own["skin"].get<std::size_t>()];
    std::vector<Matrix> joints;
    const std::vector<double> binds = accessor(skin["inverseBindMatrices"]);
    for (std::size_t k = 0; k < skin["joints"].size(); ++k) {
      Matrix bind;
      for (std::size_t i = 0; i < 16; ++i) bind[i % 4][i / 4] = binds[16 * k + i];
      joints.push_back(times(world(skin["joints"][k]), bind));
    }
    const Json weights = own.value("weights", mesh.value("weights", Json::array()));
    std::vector<Point> all;
    for (const Json& primitive : mesh["primitives"]) {
      const std::vector<Point> points = skinned(primitive, weights, joints);
      all.insert(all.end(), points.begin(), points.end());
    }
    return all;
  }

  // Where a node's origin stands in the world, its local transforms being `locals` where they are given.
  Matrix world(std::size_t node) const {
    const Matrix own = local(root_["nodes"][node]);
    return parent_[node] < 0 ? own : times(world(static_cast<std::size_t>(parent_[node])), own);
  }

 private:
  static Matrix times(const Matrix& a, const Matrix& b) {
    Matrix c{};
    for (std::size_t i = 0; i < 4; ++i) {
      for (std::size_t j = 0; j < 4; ++j) {
        for (std::size_t k = 0; k < 4; ++k) c[i][j] += a[i][k] * b[k][j];
      }
    }
    return c;
  }

  static Matrix local(const Json& node) {
    Matrix m{};
    if (node.contains("matrix")) {
      for (std::size_t i = 0; i < 16; ++i) m[i % 4][i / 4] = node["matrix"][i];
      return m;
    }
    const std::vector<double> t = node.value("translation", std::vector<double>{0, 0, 0}),
                              q = node.value("rotation", std::vector<double>{0, 0, 0, 1}),
                              s = node.value("scale", std::vector<double>{1, 1, 1});
    const double x = q[0], y = q[1], z = q[2], w = q[3];
    const double turn[3][3] = {{1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)},
                               {2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)},
                               {2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)}};
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t j = 0; j < 3; ++j) m[i][j] = turn[i][j] * s[j];
      m[i][3] = t[i];
    }
    m[3][3] = 1;
    return m;
  }

  std::vector<Point> skinned(const Json& primitive, const Json& morph_weights,
                             const std::vector<Matrix>& joints) const {
    const Json& attributes = primitive["attributes"];
    std::vector<double> positions = accessor(attributes["POSITION"]);
    for (std::size_t k = 0; k < morph_weights.size(); ++k) {
      const std::vector<double> moved = accessor(primitive["targets"][k]["POSITION"]);
      for (std::size_t i = 0; i < moved.size(); ++i) positions[i] += morph_weights[k].get<double>() * moved[i];
    }
    const std::vector<double> which = accessor(attributes["JOINTS_0"]), weights = accessor(attributes["WEIGHTS_0"]);
    std::vector<Point> points(positions.size() / 3);
    for (std::size_t v = 0; v < points.size(); ++v) {
      points[v] = {0, 0, 0};
      double sum = 0;
      for (std::size_t c = 0; c < 4; ++c) sum += weights[4 * v + c];
      for (std::size_t c = 0; c < 4; ++c) {
        const Matrix& m = joints[static_cast<std::size_t>(which[4 * v + c])];
        for (std::size_t i = 0; i < 3; ++i) {
          double x = m[i][3];
          for (std::size_t j = 0; j < 3; ++j) x += m[i][j] * positions[3 * v + j];
          points[v][i] += weights[4 * v + c] / sum * x;
        }
      }
    }
    return points;
  }

  std::vector<double> read(std::size_t view, std::size_t offset, int type, std::size_t count) const {
    std::vector<double> values;
    const char* data = binary_.data() + root_["bufferViews"][view].value("byteOffset", std::size_t{0}) + offset;
    for (std::size_t k = 0; k < count; ++k) {
      float real = 0;
      std::uint16_t two = 0;
      if (type == 5126) std::memcpy(&real, data + 4 * k, 4);
      if (type == 5123) std::memcpy(&two, data + 2 * k, 2);
      values.push_back(type == 5126 ? static_cast<double>(real)
                                    : (type == 5123 ? two : static_cast<unsigned char>(data[k])));
    }
    return values;
  }

  std::vector<double> accessor(std::size_t index) const {
    const Json& source = root_["accessors"][index];
    const std::string type = source["type"];
    const std::size_t components = type == "SCALAR" ? 1 : (type == "VEC3" ? 3 : (type == "VEC4" ? 4 : 16)),
                      count = components * source["count"].get<std::size_t>();
    std::vector<double> values(count, 0.0);
    if (source.contains("bufferView")) values = read(source["bufferView"], 0, source["componentType"], count);
    if (!source.contains("sparse")) return values;
    const Json& sparse = source["sparse"];
    const std::size_t some = sparse["count"];
    const auto places = read(sparse["indices"]["bufferView"], 0, sparse["indices"]["componentType"], some);
    const auto others = read(sparse["values"]["bufferView"], 0, source["componentType"], components * some);
    for (std::size_t k = 0; k < some; ++k) {
      for (std::size_t c = 0; c < components; ++c) {
        values[components * static_cast<std::size_t>(places[k]) + c] = others[components * k + c];
      }
    }
    return values;
  }

  Json root_;
  std::string binary_;
  std::vector<int> parent_;
};

}  // namespace bodyopt
