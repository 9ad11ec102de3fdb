// Numbers and hashes as text, and text without regard to case.
#pragma once

#include <cctype>
#include <cstdint>
#include <cstdio>
#include <string>
#include <string_view>

namespace bodyopt {

// Formats as std::printf does, up to 199 characters.
std::string formatted(const char* pattern, auto... values) {
  char text[200];
  std::snprintf(text, sizeof(text), pattern, values...);
  return text;
}

inline std::string hexadecimal(std::uint64_t value) {  // 16 digits, lower case
  std::string text(16, '0');
  for (std::size_t k = 16; k-- > 0; value >>= 4) text[k] = "0123456789abcdef"[value & 15];
  return text;
}

[[nodiscard]] inline std::string lower_case(std::string_view text) {
  std::string lower(text);
  for (char& c : lower) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return lower;
}

}  // namespace bodyopt
