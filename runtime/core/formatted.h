// Numbers in texts.
#pragma once

#include <cstdio>
#include <string>

namespace bodyopt {

// As std::printf writes it; of no more than 199 characters.
std::string formatted(const char* pattern, auto... values) {
  char text[200];
  std::snprintf(text, sizeof(text), pattern, values...);
  return text;
}

}  // namespace bodyopt
