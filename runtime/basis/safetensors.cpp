#include "runtime/basis/safetensors.h"

#include <xxhash.h>

#include <algorithm>
#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>

#include "runtime/basis/atomic_file.h"
#include "runtime/basis/error.h"

namespace bodyopt {
namespace {

using Json = nlohmann::json;

constexpr std::uint64_t kLargestHeader = 100'000'000;  // the format's own limit

[[noreturn]] void refuse(const std::filesystem::path& path, const std::string& what) {
  throw Error(ErrorKind::file, path.string() + ": " + what + " (not a safetensors file, or a damaged or cut-off one)");
}

std::string hex(std::uint64_t value) {
  char text[17];
  std::snprintf(text, sizeof(text), "%016llx", static_cast<unsigned long long>(value));
  return text;
}

// Elements x size, or refusal when the product does not fit what is there.
std::uint64_t checked_bytes(const std::filesystem::path& path, const std::string& name, const Tensor& tensor,
                            std::uint64_t available) {
  std::uint64_t bytes = dtype_size(tensor.dtype);
  if (std::find(tensor.shape.begin(), tensor.shape.end(), 0u) != tensor.shape.end()) return 0;
  for (const std::uint64_t n : tensor.shape) {
    if (n > available / bytes) refuse(path, "tensor '" + name + "' is larger than the file");
    bytes *= n;
  }
  return bytes;
}

Tensor parse_tensor(const std::filesystem::path& path, const std::string& name, const Json& entry, std::uint64_t size,
                    std::uint64_t& begin) {
  Tensor tensor;
  const auto dtype = entry.find("dtype"), shape = entry.find("shape"), offsets = entry.find("data_offsets");
  if (dtype == entry.end() || !dtype->is_string() || shape == entry.end() || !shape->is_array() ||
      offsets == entry.end() || !offsets->is_array() || offsets->size() != 2 || !(*offsets)[0].is_number_unsigned() ||
      !(*offsets)[1].is_number_unsigned()) {
    refuse(path, "tensor '" + name + "' lacks dtype, shape or data_offsets");
  }
  tensor.dtype = dtype->get<std::string>();
  if (dtype_size(tensor.dtype) == 0) {
    refuse(path, "tensor '" + name + "' has type " + tensor.dtype + ", expected F32, F64 or U32");
  }
  for (const Json& n : *shape) {
    if (!n.is_number_unsigned()) refuse(path, "tensor '" + name + "' has a shape that is not of counts");
    tensor.shape.push_back(n.get<std::uint64_t>());
  }
  begin = (*offsets)[0].get<std::uint64_t>();
  const std::uint64_t end = (*offsets)[1].get<std::uint64_t>();
  if (begin > end || end > size) {
    refuse(path, "tensor '" + name + "' lies at bytes " + std::to_string(begin) + " to " + std::to_string(end) +
                     " of " + std::to_string(size));
  }
  if (checked_bytes(path, name, tensor, size) != end - begin) {
    refuse(path,
           "tensor '" + name + "' has " + std::to_string(end - begin) + " bytes, which is not what its shape says");
  }
  return tensor;
}

}  // namespace

std::size_t dtype_size(const std::string& dtype) {
  if (dtype == "F32" || dtype == "U32") return 4;
  return dtype == "F64" ? 8 : 0;
}

std::string tensor_checksum(const Safetensors& file) {
  XXH3_state_t* state = XXH3_createState();
  XXH3_64bits_reset(state);
  for (const auto& [name, tensor] : file.tensors) {
    std::string label = name + ' ' + tensor.dtype;
    for (const std::uint64_t n : tensor.shape) label += ' ' + std::to_string(n);
    XXH3_64bits_update(state, label.data(), label.size());
    XXH3_64bits_update(state, tensor.bytes.data(), tensor.bytes.size());
  }
  const std::uint64_t digest = XXH3_64bits_digest(state);
  XXH3_freeState(state);
  return hex(digest);
}

void write_safetensors(const Safetensors& file, const std::filesystem::path& path) {
  nlohmann::ordered_json header;
  header["__metadata__"] = file.metadata;
  std::uint64_t offset = 0;
  for (const auto& [name, tensor] : file.tensors) {
    header[name] = {
        {"dtype", tensor.dtype}, {"shape", tensor.shape}, {"data_offsets", {offset, offset + tensor.bytes.size()}}};
    offset += tensor.bytes.size();
  }
  std::string text = header.dump();
  text.resize((text.size() + 7) / 8 * 8, ' ');  // tensors start at a multiple of 8
  const std::uint64_t length = text.size();
  AtomicFile out(path);
  out.write(std::as_bytes(std::span(&length, 1)));
  out.write(std::as_bytes(std::span(text)));
  for (const auto& [name, tensor] : file.tensors) out.write(tensor.bytes);
  out.commit();
}

Safetensors read_safetensors(const std::filesystem::path& path) {
  std::error_code failure;
  const std::uint64_t size = std::filesystem::file_size(path, failure);
  std::ifstream stream(path, std::ios::binary);
  if (failure || !stream) throw Error(ErrorKind::file, path.string() + ": cannot be read: no such file?");

  std::uint64_t length = 0;
  if (size < 8 || !stream.read(reinterpret_cast<char*>(&length), 8)) refuse(path, "shorter than a header");
  if (length > std::min(kLargestHeader, size - 8)) {
    refuse(path, "its header claims " + std::to_string(length) + " of " + std::to_string(size) + " bytes");
  }
  std::string text(length, '\0');
  if (!stream.read(text.data(), static_cast<std::streamsize>(length))) refuse(path, "the header cannot be read");
  const Json header = Json::parse(text, nullptr, false);
  if (!header.is_object()) refuse(path, "the header is not a JSON object");

  Safetensors file;
  const std::uint64_t data_size = size - 8 - length;
  std::vector<std::pair<std::uint64_t, std::string>> order;
  for (const auto& [name, entry] : header.items()) {
    if (!entry.is_object()) refuse(path, "entry '" + name + "' is not an object");
    if (name == "__metadata__") {
      for (const auto& [key, value] : entry.items()) {
        if (!value.is_string()) refuse(path, "metadata '" + key + "' is not a string");
        file.metadata[key] = value.get<std::string>();
      }
      continue;
    }
    std::uint64_t begin = 0;
    file.tensors[name] = parse_tensor(path, name, entry, data_size, begin);
    order.emplace_back(begin, name);
  }
  std::sort(order.begin(), order.end());
  std::uint64_t expected = 0;
  for (const auto& [begin, name] : order) {
    Tensor& tensor = file.tensors[name];
    const std::uint64_t bytes = checked_bytes(path, name, tensor, data_size);
    if (begin != expected) refuse(path, "tensor '" + name + "' leaves a gap or overlaps another");
    tensor.bytes.resize(bytes);
    stream.seekg(static_cast<std::streamoff>(8 + length + begin));
    if (!stream.read(reinterpret_cast<char*>(tensor.bytes.data()), static_cast<std::streamsize>(bytes))) {
      refuse(path, "tensor '" + name + "' cannot be read");
    }
    expected += bytes;
  }
  if (expected != data_size) refuse(path, std::to_string(data_size - expected) + " bytes follow the last tensor");
  const auto checksum = file.metadata.find("checksum");
  if (checksum != file.metadata.end() && checksum->second != tensor_checksum(file)) {
    refuse(path, "its checksum is " + tensor_checksum(file) + ", expected " + checksum->second);
  }
  return file;
}

}  // namespace bodyopt
