#include "assets/mirrored_name.h"

#include <algorithm>
#include <cctype>

namespace bodyopt {
namespace {

struct Sides {
  const char *left, *right;
};
constexpr Sides kSides[] = {{"Left", "Right"}, {"left", "right"}, {"LEFT", "RIGHT"}, {"L", "R"}, {"l", "r"}};

bool is_letter(char c) { return std::isalpha(static_cast<unsigned char>(c)) != 0; }
bool is_upper(char c) { return std::isupper(static_cast<unsigned char>(c)) != 0; }

// Whether the letter is a word, or a capital where a word of capitals and small letters begins or ends.
bool is_side(const std::string& name, std::size_t at) {
  const char before = at == 0 ? ' ' : name[at - 1], after = at + 1 < name.size() ? name[at + 1] : ' ';
  if (!is_letter(before) && !is_letter(after)) return true;
  if (!is_upper(name[at])) return false;
  return is_letter(before) ? !is_letter(after) && !is_upper(before) : is_upper(after);
}

// With one `from` replaced that makes it a name that is known; empty: none does.
std::string replaced(const std::string& name, const std::string& from, const std::string& to,
                     std::span<const std::string> names) {
  for (std::size_t at = name.find(from); at != std::string::npos; at = name.find(from, at + 1)) {
    if (from.size() == 1 && !is_side(name, at)) continue;
    const std::string other = std::string(name).replace(at, from.size(), to);
    if (std::find(names.begin(), names.end(), other) != names.end()) return other;
  }
  return {};
}

}  // namespace

std::string mirrored_name(const std::string& name, std::span<const std::string> names) {
  for (const auto& [left, right] : kSides) {
    for (const auto& [from, to] : {Sides{left, right}, Sides{right, left}}) {
      if (std::string other = replaced(name, from, to, names); !other.empty()) return other;
    }
  }
  return {};
}

}  // namespace bodyopt
