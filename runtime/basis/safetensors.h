// The safetensors container: a length, a JSON header naming tensors and strings, then the tensors' little-endian bytes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <vector>

namespace bodyopt {

struct Tensor {
  std::string dtype;  // "F32", "F64", "U16", "U32"
  std::vector<std::uint64_t> shape;
  std::vector<std::byte> bytes;
};

struct Safetensors {
  std::map<std::string, Tensor> tensors;
  std::map<std::string, std::string> metadata;
};

std::size_t dtype_size(const std::string& dtype);  // 0 for a type that is not ours

// xxh3 of every string of the metadata but "checksum", and of every tensor's name, type, shape and bytes, in name
// order, as 16 hexadecimal digits.
std::string content_checksum(const Safetensors& file);

// Throws Error(file). Reading checks the header's length, and every type, shape and range (no gap, no overlap), before
// it takes memory for tensors. It compares the checksum where the metadata names one.
void write_safetensors(const Safetensors& file, const std::filesystem::path& path);
Safetensors read_safetensors(const std::filesystem::path& path);
// Reads a file that is in memory. Errors name the `origin`.
Safetensors read_safetensors(std::span<const std::byte> bytes, const std::string& origin);

}  // namespace bodyopt
