#include "proxy_viewer/mirrored_joint.h"

#include <algorithm>
#include <cctype>
#include <utility>

namespace bodyopt {
namespace {

constexpr std::pair<const char*, const char*> kSides[] = {{"Left", "Right"}, {"left", "right"}, {"LEFT", "RIGHT"}};

bool is_known(const std::string& name, std::span<const std::string> names) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

bool is_upper(char c) { return std::isupper(static_cast<unsigned char>(c)) != 0; }

char other_letter(char side) {
  constexpr char kFrom[] = {'L', 'R', 'l', 'r'}, kTo[] = {'R', 'L', 'r', 'l'};
  const auto found = std::find(std::begin(kFrom), std::end(kFrom), side);
  return found == std::end(kFrom) ? '\0' : kTo[found - std::begin(kFrom)];
}

}  // namespace

std::string mirrored_joint(const std::string& name, std::span<const std::string> names) {
  const auto replaced = [&](const std::string& from, const std::string& to) {
    std::string other = name;
    const std::size_t at = name.find(from);
    return at == std::string::npos ? std::string() : other.replace(at, from.size(), to);
  };
  for (const auto& [left, right] : kSides) {
    for (const std::string& other : {replaced(left, right), replaced(right, left)}) {
      if (!other.empty() && is_known(other, names)) return other;
    }
  }
  const std::size_t n = name.size();
  const bool begins = n > 1 && is_upper(name[0]) && is_upper(name[1]);
  const bool ends = n > 2 && (name[n - 2] == '_' || name[n - 2] == '.');
  for (const std::size_t at : {std::size_t{0}, n - 1}) {
    if (!(at == 0 ? begins : ends)) continue;
    std::string other = name;
    other[at] = other_letter(name[at]);
    if (other[at] != '\0' && is_known(other, names)) return other;
  }
  return {};
}

}  // namespace bodyopt
