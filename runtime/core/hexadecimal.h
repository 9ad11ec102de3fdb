// Hashes as text.
#pragma once

#include <cstdint>
#include <string>

namespace bodyopt {

inline std::string hexadecimal(std::uint64_t value) {  // 16 digits, lower case
  std::string text(16, '0');
  for (std::size_t k = 16; k-- > 0; value >>= 4) text[k] = "0123456789abcdef"[value & 15];
  return text;
}

}  // namespace bodyopt
