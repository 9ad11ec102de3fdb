#include "runtime/basis/character_unit.h"

#include <charconv>
#include <cmath>

#include "runtime/core/error.h"

namespace bodyopt {
namespace {

std::string shortest(double value) {
  char text[32];
  return {text, std::to_chars(text, text + sizeof(text), value).ptr};
}

}  // namespace

void keep_unit(Basis& basis, double unit) {
  if (unit > 0) basis.metadata["character_unit_m"] = shortest(unit);
}

double kept_unit(const Basis& basis) {
  const auto entry = basis.metadata.find("character_unit_m");
  if (entry == basis.metadata.end()) return 0;
  double unit = 0;
  const char* end = entry->second.data() + entry->second.size();
  const auto [stop, failure] = std::from_chars(entry->second.data(), end, unit);
  if (failure != std::errc() || stop != end || !(unit > 0 && std::isfinite(unit))) {
    throw Error(ErrorKind::file, "the basis says that its character's unit is '", entry->second,
                "', expected metres above 0: the file is damaged");
  }
  return unit;
}

}  // namespace bodyopt
