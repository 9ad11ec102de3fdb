// Reference values that other programs computed.
#pragma once

#include <cstddef>
#include <cstring>
#include <filesystem>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace bodyopt {

// A safetensors file of our own making: no checks.
class Tensors {
 public:
  explicit Tensors(const std::filesystem::path& path);
  template <typename T>
  std::vector<T> get(const std::string& name) const {
    const auto [begin, end] = places_.at(name);
    std::vector<T> values((end - begin) / sizeof(T));
    std::memcpy(values.data(), bytes_.data() + begin, end - begin);
    return values;
  }

 private:
  std::map<std::string, std::pair<std::size_t, std::size_t>> places_;  // first byte and that after the last
  std::vector<char> bytes_;
};

}  // namespace bodyopt
