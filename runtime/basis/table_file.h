// Tensors from arrays of numbers or of records of 4-byte words, and back, for all files of tables.
#pragma once

#include <cstring>
#include <filesystem>
#include <set>
#include <string>
#include <type_traits>
#include <vector>

#include "runtime/basis/safetensors.h"
#include "runtime/core/error.h"
#include "shaders/include/layout.h"

namespace bodyopt {

// A record of 4-byte scalars is stored as rows of U32 or F32 words; mixed records as U32.
template <typename T>
constexpr const char* dtype_of() {
  if constexpr (std::is_same_v<T, float> || std::is_same_v<T, FeatureRange> || std::is_same_v<T, TetShape>)
    return "F32";
  if constexpr (std::is_same_v<T, double>) return "F64";
  return "U32";
}

template <typename T>
constexpr std::uint64_t words_of() {
  return sizeof(T) / (std::is_same_v<T, double> ? 8 : 4);
}

// The shape of `count` values, `width` of them to a row: count, or rows x words.
template <typename T>
std::vector<std::uint64_t> shape_of(std::size_t count, std::uint64_t width) {
  const std::uint64_t words = width * words_of<T>();
  if (words == 1) return {count};
  return {count / width, words};
}

template <typename T>
Tensor tensor_from(const std::vector<T>& values, std::uint64_t width) {
  static_assert(std::is_trivially_copyable_v<T>);
  Tensor tensor{dtype_of<T>(), shape_of<T>(values.size(), width), {}};
  tensor.bytes.resize(values.size() * sizeof(T));
  if (!values.empty()) std::memcpy(tensor.bytes.data(), values.data(), tensor.bytes.size());
  return tensor;
}

// Reads the tensors of a file and refuses what is not one of them. Every refusal is Error(file), names the file and
// says that it is perhaps not `kind` ("a basis").
class TableReader {
 public:
  TableReader(const Safetensors& file, const std::filesystem::path& path, std::string kind)
      : file_(file), path_(path), kind_(std::move(kind)) {}

  // Throws where the metadata do not name this schema, or no checksum (which read_safetensors compares).
  void require_schema(const std::string& schema) const {
    const std::string found = metadata("schema");
    if (found != schema) refuse("its schema is '", found, "', expected '", schema, "'");
    metadata("checksum");
  }

  template <typename T>
  void read(const std::string& name, std::vector<T>& values, std::uint64_t width) {
    const auto found = file_.tensors.find(name);
    if (found == file_.tensors.end()) refuse("tensor '", name, "' is missing");
    const Tensor& tensor = found->second;
    if (tensor.dtype != dtype_of<T>()) {
      refuse("tensor '", name, "' has type ", tensor.dtype, ", expected ", dtype_of<T>());
    }
    const std::size_t count = tensor.bytes.size() / sizeof(T);
    if (tensor.shape != shape_of<T>(count, width)) {
      refuse("tensor '", name, "' has a shape of ", tensor.shape.size(), " dimensions whose rows are not of ",
             width * words_of<T>(), " values");
    }
    known_.insert(name);
    values.resize(count);
    if (!values.empty()) std::memcpy(static_cast<void*>(values.data()), tensor.bytes.data(), tensor.bytes.size());
  }

  // A tensor of earlier versions that nothing is made of any more.
  void pass_over(const std::string& name) { known_.insert(name); }

  std::string metadata(const std::string& key) const {
    const auto found = file_.metadata.find(key);
    if (found == file_.metadata.end()) refuse("its metadata lacks '", key, "'");
    return found->second;
  }

  void refuse_unknown_tensors() const {
    for (const auto& [name, tensor] : file_.tensors) {
      if (!known_.contains(name)) refuse("tensor '", name, "' is not one of ", kind_);
    }
  }

  [[noreturn]] void refuse(const auto&... what) const {
    throw Error(ErrorKind::file, path_, ": ", what..., " (not ", kind_, ", or one of another version)");
  }

 private:
  const Safetensors& file_;
  const std::filesystem::path& path_;
  std::string kind_;
  std::set<std::string> known_;  // tensors read so far
};

}  // namespace bodyopt
