#include "assets/gltf/gltf_write.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fstream>
#include <map>
#include <tuple>

#include "runtime/core/atomic_file.h"
#include "runtime/core/error.h"

namespace bodyopt {
namespace {

constexpr const char* kGenerator = "bodyopt";

static_assert(std::endian::native == std::endian::little, "glTF is little-endian, and values are copied as they are");

void put_word(std::string& bytes, std::size_t word) {
  for (int shift = 0; shift < 32; shift += 8) bytes += static_cast<char>(word >> shift & 255);
}

void put_chunk(std::string& bytes, const char* type, const std::string& data) {
  put_word(bytes, data.size());
  bytes.append(type, 4);
  bytes += data;
}

Json node_of(const Joint& joint) {
  const JointTransform& t = joint.default_local;
  return {
      {"name", joint.name}, {"translation", t.translation}, {"rotation", normalized(t.rotation)}, {"scale", t.scale}};
}

}  // namespace

GlbWriter::GlbWriter() {
  root["asset"] = {{"version", "2.0"}, {"generator", kGenerator}};
  root["scene"] = 0;
  root["scenes"] = Json::array({{{"nodes", Json::array()}}});
  root["nodes"] = Json::array();
}

template <class T>
std::size_t GlbWriter::add_values(std::span<const T> values, int component_type, const std::string& type,
                                  GlbTarget target) {
  const std::size_t components =
      std::map<std::string, std::size_t>{{"SCALAR", 1}, {"VEC2", 2}, {"VEC3", 3}, {"VEC4", 4}, {"MAT4", 16}}.at(type);
  std::vector<double> low(components, INFINITY), high(components, -INFINITY);
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto value = static_cast<double>(values[i]);
    finite_ = finite_ && std::isfinite(value);
    low[i % components] = std::min(low[i % components], value);
    high[i % components] = std::max(high[i % components], value);
  }
  const std::size_t view = add_view(std::as_bytes(values), target);  // before a list that it may move
  root["accessors"].push_back({{"bufferView", view},
                               {"componentType", component_type},
                               {"count", values.size() / components},
                               {"type", type},
                               {"min", low},
                               {"max", high}});
  return root["accessors"].size() - 1;
}

std::size_t GlbWriter::add_view(std::span<const std::byte> bytes, GlbTarget target) {
  const std::size_t offset = binary_.size();
  Json view = {{"buffer", 0}, {"byteOffset", offset}, {"byteLength", bytes.size()}};
  if (target != GlbTarget::none) view["target"] = static_cast<int>(target);
  root["bufferViews"].push_back(view);
  binary_.resize((offset + bytes.size() + 3) / 4 * 4, 0);
  if (!bytes.empty()) std::memcpy(binary_.data() + offset, bytes.data(), bytes.size());
  return root["bufferViews"].size() - 1;
}

std::size_t GlbWriter::add_bytes(std::string_view bytes) {
  return add_view(std::as_bytes(std::span(bytes)), GlbTarget::none);
}

void GlbWriter::use(const char* extension, bool is_required) {
  for (const char* list : {"extensionsUsed", "extensionsRequired"}) {
    if (std::string_view(list) == "extensionsRequired" && !is_required) continue;
    if (std::ranges::find(root[list], Json(extension)) == root[list].end()) root[list].push_back(extension);
  }
}

std::size_t GlbWriter::add(std::span<const float> values, const std::string& type, GlbTarget target) {
  return add_values(values, 5126, type, target);
}
std::size_t GlbWriter::add(std::span<const std::uint16_t> values, const std::string& type, GlbTarget target) {
  return add_values(values, 5123, type, target);
}
std::size_t GlbWriter::add(std::span<const std::uint32_t> values, const std::string& type, GlbTarget target) {
  return add_values(values, 5125, type, target);
}

void GlbWriter::add_weights(std::span<const VertexWeights> vertices, std::size_t most, Json& attributes) {
  for (std::size_t set = 0; 4 * set < most; ++set) {
    std::vector<std::uint16_t> joints(4 * vertices.size());
    std::vector<float> weights(4 * vertices.size());
    for (std::size_t v = 0; v < vertices.size(); ++v) {
      for (std::size_t k = 4 * set; k < std::min(vertices[v].size(), 4 * set + 4); ++k) {
        std::tie(joints[4 * v + k % 4], weights[4 * v + k % 4]) = vertices[v][k];
      }
    }
    attributes["JOINTS_" + std::to_string(set)] = add(joints, "VEC4", GlbTarget::vertices);
    attributes["WEIGHTS_" + std::to_string(set)] = add(weights, "VEC4", GlbTarget::vertices);
  }
}

std::size_t GlbWriter::add_skeleton(const Skeleton& skeleton) {
  Json& nodes = root["nodes"];
  const std::size_t first = nodes.size(), top = first + skeleton.size();
  for (const Joint& joint : skeleton.joints) {
    finite_ = finite_ && is_finite(joint.default_local);
    nodes.push_back(node_of(joint));
  }
  nodes.push_back({{"name", "skeleton"}});
  for (std::size_t j = 0; j < skeleton.size(); ++j) {
    const int parent = skeleton.joints[j].parent;
    nodes[parent < 0 ? top : first + static_cast<std::size_t>(parent)]["children"].push_back(first + j);
  }
  root["scenes"][0]["nodes"].push_back(top);
  return top;
}

void GlbWriter::add_skin(const Skeleton& skeleton, std::size_t top) {
  std::vector<float> columns;
  std::vector<std::size_t> joints;
  for (const Joint& joint : skeleton.joints) {
    joints.push_back(top - skeleton.size() + joints.size());
    for (int c = 0; c < 4; ++c) {
      for (int r = 0; r < 3; ++r) columns.push_back(static_cast<float>(joint.inverse_bind.m[r][c]));
      columns.push_back(c == 3 ? 1.0f : 0.0f);
    }
  }
  const std::size_t binds = add(columns, "MAT4", GlbTarget::none);
  root["skins"].push_back({{"inverseBindMatrices", binds}, {"skeleton", top}, {"joints", joints}});
}

std::string GlbWriter::bytes(const std::filesystem::path& path) {
  const auto fail = [&](const auto&... problem) { throw Error(ErrorKind::file, path, ": ", problem...); };
  if (!finite_) fail("not written, because a number is not finite");
  root["buffers"] = Json::array({{{"byteLength", binary_.size()}}});
  std::string json;
  try {
    json = root.dump();
  } catch (const Json::exception& error) {
    fail("not written, because a name is not UTF-8 text (", error.what(), ")");
  }
  json.resize((json.size() + 3) / 4 * 4, ' ');
  const std::size_t total = 12 + 8 + json.size() + 8 + binary_.size();
  if (total > 0xFFFFFFFFu) fail("not written, because a .glb file holds at most 4 GiB");
  std::string bytes = "glTF";
  put_word(bytes, 2);
  put_word(bytes, total);
  put_chunk(bytes, "JSON", json);
  put_chunk(bytes, "BIN\0", std::string(binary_.begin(), binary_.end()));
  return bytes;
}

void GlbWriter::write(const std::filesystem::path& path) {
  if (!may_be_replaced(path, kGenerator)) {
    throw Error(
        ErrorKind::usage, path,
        " is there already, and bodyopt did not write it: is it a character? Choose another name, or remove it");
  }
  write_file_atomically(path, bytes(path));
}

bool may_be_replaced(const std::filesystem::path& path, const std::string& generator) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(path, ignored)) return true;  // a pipe would make its reader wait
  std::ifstream file(path, std::ios::binary);
  std::string head(256, '\0');
  file.read(head.data(), static_cast<std::streamsize>(head.size()));
  return file.gcount() == 0 || head.find("\"generator\":\"" + generator) != std::string::npos;
}

void add_channel(std::size_t times, std::size_t values, std::size_t node, const char* path, Json& animation) {
  animation["channels"].push_back(
      {{"sampler", animation["samplers"].size()}, {"target", {{"node", node}, {"path", path}}}});
  animation["samplers"].push_back({{"input", times}, {"output", values}, {"interpolation", "LINEAR"}});
}

}  // namespace bodyopt
