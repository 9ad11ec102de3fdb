#include "assets/gltf/gltf_meshopt.h"

#include <meshoptimizer.h>

#include <nlohmann/json.hpp>
#include <string>

#include "runtime/core/error.h"

namespace bodyopt {
namespace {

using Bytes = std::vector<unsigned char>;

constexpr const char* kExtension = "EXT_meshopt_compression";
constexpr std::uint64_t kMostPerByte = 64;  // that a byte is decoded to: vertices that are all alike
constexpr std::uint64_t kMostCount = 1u << 30;

class CompressedView {
 public:
  CompressedView(std::string what, const Json& properties) : what_(std::move(what)), properties_(properties) {
    if (!properties.is_object()) refuse("is no object");
    buffer_ = number("buffer", kMostCount);
    offset_ = number("byteOffset", ~std::uint64_t{0}, 0);
    length_ = number("byteLength", ~std::uint64_t{0});
    stride_ = number("byteStride", 256);
    count_ = number("count", kMostCount);
    mode_ = text("mode", "");
    filter_ = text("filter", "NONE");
    const bool fits = mode_ == "ATTRIBUTES"
                          ? stride_ > 0 && stride_ % 4 == 0
                          : (stride_ == 2 || stride_ == 4) && (mode_ != "TRIANGLES" || count_ % 3 == 0);
    if (!fits || count_ == 0)
      refuse("has " + std::to_string(count_) + " elements of " + std::to_string(stride_) + " bytes");
  }

  std::uint64_t decoded_size() const { return count_ * stride_; }

  Bytes decode(const std::vector<Bytes>& buffers) const {
    if (buffer_ >= buffers.size()) refuse("is of buffer " + std::to_string(buffer_) + ", which does not exist");
    const Bytes& buffer = buffers[buffer_];
    if (offset_ > buffer.size() || length_ > buffer.size() - offset_) refuse("reaches beyond its buffer");
    if (decoded_size() > kMostPerByte * length_) refuse("tells of far more than its bytes can hold; it is damaged");
    Bytes decoded(decoded_size());
    const unsigned char* source = buffer.data() + offset_;
    int failure = -1;
    if (mode_ == "ATTRIBUTES") {
      failure = meshopt_decodeVertexBuffer(decoded.data(), count_, stride_, source, length_);
    } else if (mode_ == "TRIANGLES") {
      failure = meshopt_decodeIndexBuffer(decoded.data(), count_, stride_, source, length_);
    } else if (mode_ == "INDICES") {
      failure = meshopt_decodeIndexSequence(decoded.data(), count_, stride_, source, length_);
    } else {
      refuse("has the unknown mode '" + mode_ + "'");
    }
    if (failure != 0) refuse("cannot be decompressed; the file is damaged");
    filter(decoded);
    return decoded;
  }

 private:
  void filter(Bytes& decoded) const {
    if (filter_ == "NONE") return;
    if (filter_ == "OCTAHEDRAL" && (stride_ == 4 || stride_ == 8)) {
      meshopt_decodeFilterOct(decoded.data(), count_, stride_);
    } else if (filter_ == "QUATERNION" && stride_ == 8) {
      meshopt_decodeFilterQuat(decoded.data(), count_, stride_);
    } else if (filter_ == "EXPONENTIAL" && stride_ % 4 == 0) {
      meshopt_decodeFilterExp(decoded.data(), count_, stride_);
    } else {
      refuse("has the filter '" + filter_ + "', unknown for elements of " + std::to_string(stride_) + " bytes");
    }
  }

  std::uint64_t number(const char* key, std::uint64_t most, std::int64_t otherwise = -1) const {
    const auto found = properties_.find(key);
    if (found == properties_.end() && otherwise >= 0) return static_cast<std::uint64_t>(otherwise);
    if (found == properties_.end() || !found->is_number_unsigned() || found->get<std::uint64_t>() > most) {
      refuse(std::string("lacks a ") + key + " that can be");
    }
    return *found;
  }

  std::string text(const char* key, const char* otherwise) const {
    const auto found = properties_.find(key);
    return found != properties_.end() && found->is_string() ? found->get<std::string>() : otherwise;
  }

  [[noreturn]] void refuse(const std::string& why) const { throw Error(ErrorKind::file, what_, " ", why); }

  std::string what_;
  const Json& properties_;
  std::uint64_t buffer_ = 0, offset_ = 0, length_ = 0, stride_ = 0, count_ = 0;
  std::string mode_, filter_;
};

}  // namespace

void decompress_views(const std::filesystem::path& path, Json& root, std::vector<Bytes>& buffers) {
  if (!root.contains("bufferViews") || !root["bufferViews"].is_array()) return;
  std::uint64_t bytes_left = 0;
  for (const Bytes& buffer : buffers) bytes_left += kMostPerByte * buffer.size();
  for (std::size_t k = 0; k < root["bufferViews"].size(); ++k) {
    Json& view = root["bufferViews"][k];
    if (!view.is_object() || !view.contains("extensions") || !view["extensions"].is_object() ||
        !view["extensions"].contains(kExtension)) {
      continue;
    }
    const std::string what = path.string() + ": compressed buffer view " + std::to_string(k);
    const CompressedView compressed(what, view["extensions"][kExtension]);
    if (compressed.decoded_size() > bytes_left) {
      throw Error(ErrorKind::file, what, " tells of the same bytes over and over; the file is damaged or hostile");
    }
    bytes_left -= compressed.decoded_size();
    Bytes decoded = compressed.decode(buffers);
    view["buffer"] = buffers.size();
    view["byteOffset"] = 0u;
    view["byteLength"] = decoded.size();
    buffers.push_back(std::move(decoded));
  }
}

}  // namespace bodyopt
