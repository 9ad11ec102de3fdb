// Numbers and hashes as text, text as numbers, and text without regard to case.
#pragma once

#include <cctype>
#include <charconv>
#include <cstdint>
#include <cstdio>
#include <optional>
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

// The shortest text that reads back to the same number of that type.
template <typename Number>
std::string shortest(Number number) {
  char text[32];
  return {text, std::to_chars(text, text + sizeof(text), number).ptr};
}

// The number that all of the text is, as std::from_chars reads it; nothing of any other text.
template <typename Number>
std::optional<Number> number_in(std::string_view text) {
  Number number{};
  const auto [end, failure] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (failure != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return number;
}

[[nodiscard]] inline std::string lower_case(std::string_view text) {
  std::string lower(text);
  for (char& c : lower) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return lower;
}

// Without the byte order mark that some programs, Excel among them, put before UTF-8.
[[nodiscard]] inline std::string_view without_mark(std::string_view text) {
  constexpr std::string_view kMark = "\xef\xbb\xbf";
  return text.starts_with(kMark) ? text.substr(kMark.size()) : text;
}

}  // namespace bodyopt
