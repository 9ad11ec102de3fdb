#include "assets/caches/nodes_cache.h"

#include <algorithm>
#include <cinttypes>
#include <cmath>
#include <cstring>
#include <limits>

#include "assets/caches/pc2.h"
#include "runtime/core/error.h"
#include "runtime/core/text.h"

namespace bodyopt {
namespace {

constexpr const char* kNodesSchema = "bodyopt-nodes-1";
constexpr double kSteps = 65535;

[[noreturn]] void refuse_cache(const std::filesystem::path& path, const auto&... what) {
  throw Error(ErrorKind::file, path, ": ", what..., " (not a cache of nodes, or a damaged one)");
}

template <typename T>
Tensor tensor(const std::string& dtype, std::vector<std::uint64_t> shape, const std::vector<T>& values) {
  const auto bytes = std::as_bytes(std::span(values));
  return {dtype, std::move(shape), {bytes.begin(), bytes.end()}};
}

// The values of a tensor of this type and of these sizes, 0 for any but none.
template <typename T>
std::vector<T> values_of(const std::filesystem::path& path, const Safetensors& file, const std::string& name,
                         const std::string& dtype, const std::vector<std::uint64_t>& shape) {
  const auto found = file.tensors.find(name);
  if (found == file.tensors.end()) refuse_cache(path, "it has no tensor '", name, "'");
  const Tensor& tensor = found->second;
  bool fits = tensor.dtype == dtype && tensor.shape.size() == shape.size();
  for (std::size_t i = 0; fits && i < shape.size(); ++i) {
    const std::uint64_t n = tensor.shape[i];
    fits = shape[i] == 0 ? n > 0 && n <= std::numeric_limits<std::int32_t>::max() : n == shape[i];
  }
  if (!fits) refuse_cache(path, "tensor '", name, "' has another type or shape than its neighbours need");
  std::vector<T> values(tensor.bytes.size() / sizeof(T));
  std::memcpy(values.data(), tensor.bytes.data(), tensor.bytes.size());
  return values;
}

std::string metadata_of(const std::filesystem::path& path, const Safetensors& file, const std::string& key) {
  const auto found = file.metadata.find(key);
  if (found == file.metadata.end()) refuse_cache(path, "its metadata has no '", key, "'");
  return found->second;
}

}  // namespace

NodesWriter::NodesWriter(std::filesystem::path path, const Tets& tets, const std::vector<EmbeddedPoint>& skin,
                         std::uint64_t inputs, const std::vector<int>& frames)
    : path_(std::move(path)) {
  const std::vector<std::uint32_t> corners(tets.data(), tets.data() + tets.size());
  std::vector<std::uint32_t> tet;
  std::vector<double> weights;
  for (const EmbeddedPoint& point : skin) {
    tet.push_back(static_cast<std::uint32_t>(point.tet));
    weights.insert(weights.end(), point.weights.data(), point.weights.data() + 4);
  }
  file_.tensors["tets"] = tensor("U32", {corners.size() / 4, 4}, corners);
  file_.tensors["skin.tet"] = tensor("U32", {tet.size()}, tet);
  file_.tensors["skin.weights"] = tensor("F64", {tet.size(), 4}, weights);
  file_.metadata = {{"schema", kNodesSchema},
                    {"inputs", formatted("%" PRIx64, inputs)},
                    {"start_frame", std::to_string(frames.empty() ? 1 : frames.front())},
                    {"frame_spacing", std::to_string(static_cast<int>(frame_spacing(frames)))}};
}

void NodesWriter::append(const Positions& nodes) {
  if (!nodes.allFinite()) throw Error(ErrorKind::file, path_, ": a node that is not finite was given");
  node_count_ = static_cast<std::uint64_t>(nodes.rows());
  const Eigen::RowVector3d low = nodes.colwise().minCoeff(), high = nodes.colwise().maxCoeff();
  bounds_.insert(bounds_.end(), low.data(), low.data() + 3);
  bounds_.insert(bounds_.end(), high.data(), high.data() + 3);
  for (Eigen::Index n = 0; n < nodes.rows(); ++n) {
    for (int i = 0; i < 3; ++i) {
      const double extent = high[i] - low[i], share = extent > 0 ? (nodes(n, i) - low[i]) / extent : 0;
      nodes_.push_back(static_cast<std::uint16_t>(std::lround(kSteps * share)));
    }
  }
}

void NodesWriter::close() {
  const std::uint64_t samples = bounds_.size() / 6;
  file_.tensors["bounds"] = tensor("F64", {samples, 6}, bounds_);
  file_.tensors["nodes"] = tensor("U16", {samples, node_count_, 3}, nodes_);
  file_.metadata["checksum"] = content_checksum(file_);
  write_safetensors(file_, path_);
}

NodesReader::NodesReader(const std::filesystem::path& path) : path_(path) {
  const Safetensors file = read_safetensors(path);
  if (metadata_of(path, file, "schema") != kNodesSchema) {
    refuse_cache(path, "its schema is '", metadata_of(path, file, "schema"), "', expected '", kNodesSchema, "'");
  }
  metadata_of(path, file, "checksum");  // read_safetensors has held it against the content
  const auto whole_number = [&](const char* key) {
    const std::string text = metadata_of(path, file, key);
    const std::optional<int> value = number_in<int>(text);
    if (!value) refuse_cache(path, key, " is '", text, "'");
    return static_cast<float>(*value);
  };
  start_frame_ = whole_number("start_frame");
  sample_rate_ = whole_number("frame_spacing");
  if (!(sample_rate_ >= 1)) refuse_cache(path, "frame_spacing is below 1");

  const auto tet = values_of<std::uint32_t>(path, file, "skin.tet", "U32", {0});
  const auto weights = values_of<double>(path, file, "skin.weights", "F64", {tet.size(), 4});
  const auto corners = values_of<std::uint32_t>(path, file, "tets", "U32", {0, 4});
  bounds_ = values_of<double>(path, file, "bounds", "F64", {0, 6});
  nodes_ = values_of<std::uint16_t>(path, file, "nodes", "U16", {bounds_.size() / 6, 0, 3});
  samples_ = static_cast<std::uint32_t>(bounds_.size() / 6);
  node_count_ = static_cast<Eigen::Index>(nodes_.size() / 3 / samples_);
  if (*std::ranges::max_element(corners) >= node_count_) refuse_cache(path, "a tet names a missing node");
  if (*std::ranges::max_element(tet) >= corners.size() / 4) refuse_cache(path, "a point lies in a missing tet");
  tets_.resize(static_cast<Eigen::Index>(corners.size() / 4), 4);
  std::copy(corners.begin(), corners.end(), tets_.data());
  for (std::size_t p = 0; p < tet.size(); ++p) {
    skin_.push_back({static_cast<int>(tet[p]), Eigen::Map<const Eigen::Vector4d>(weights.data() + 4 * p)});
  }
}

Positions NodesReader::nodes(std::uint32_t k) const {
  if (k >= samples_) throw Error(ErrorKind::mismatch, path_, ": sample ", k, " was asked for, it has ", samples_);
  const double* bounds = bounds_.data() + 6 * std::size_t{k};
  const auto count = static_cast<std::size_t>(node_count_);
  const std::uint16_t* steps = nodes_.data() + 3 * count * k;
  Positions result(node_count_, 3);
  for (std::size_t i = 0; i < 3 * count; ++i) {
    const double low = bounds[i % 3], high = bounds[3 + i % 3];
    result.data()[i] = low + (high - low) * (steps[i] / kSteps);
  }
  return result;
}

std::vector<float> NodesReader::sample(std::uint32_t k) const {
  const Positions points = embed(skin_, tets_, nodes(k));
  std::vector<float> result(points.data(), points.data() + points.size());
  for (std::size_t i = 0; i < result.size(); ++i) {
    if (std::isfinite(result[i])) continue;
    throw Error(ErrorKind::file, path_, ": sample ", k, ", point ", i / 3, " is not a finite number (a damaged file)");
  }
  return result;
}

}  // namespace bodyopt
