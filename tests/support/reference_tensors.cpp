#include "tests/support/reference_tensors.h"

#include <cstdint>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>

#include "runtime/core/json.h"

namespace bodyopt {

Tensors::Tensors(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::uint64_t size = 0;
  file.read(reinterpret_cast<char*>(&size), 8);
  std::string text(size, ' ');
  file.read(text.data(), static_cast<std::streamsize>(size));
  const Json header = Json::parse(text);
  for (const auto& [name, tensor] : header.items()) {
    if (name != "__metadata__") places_[name] = {tensor.at("data_offsets")[0], tensor.at("data_offsets")[1]};
  }
  bytes_.assign(std::istreambuf_iterator<char>(file), {});
}

}  // namespace bodyopt
