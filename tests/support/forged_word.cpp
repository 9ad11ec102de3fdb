#include "tests/support/forged_word.h"

#include <cstring>
#include <iterator>

namespace bodyopt::testing {

std::string forge_word(Safetensors& file, std::mt19937& random) {
  const std::uint32_t worst[] = {0,           1,           0xffffffffu, 0x7fffffffu, 0x80000000u,
                                 0x7f800000u, 0xff800000u, 0x7fc00000u, 0x7f7fffffu, 0x4e6e6b28u,
                                 0x00000001u, 0x7c007c00u, 0x7bff7bffu};
  auto tensor = file.tensors.begin();
  do {
    tensor = std::next(file.tensors.begin(), static_cast<std::ptrdiff_t>(random() % file.tensors.size()));
  } while (tensor->second.bytes.empty());
  const std::size_t at = 4 * (random() % (tensor->second.bytes.size() / 4));
  std::uint32_t word = worst[random() % std::size(worst)];
  if (random() % 2 == 0) {
    std::memcpy(&word, tensor->second.bytes.data() + at, 4);
    word ^= 1u << random() % 32;
  }
  std::memcpy(tensor->second.bytes.data() + at, &word, 4);
  return tensor->second.dtype + " " + tensor->first + " byte " + std::to_string(at);
}

}  // namespace bodyopt::testing
