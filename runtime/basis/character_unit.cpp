#include "runtime/basis/character_unit.h"

#include <cmath>

#include "runtime/core/error.h"
#include "runtime/core/text.h"

namespace bodyopt {

void keep_unit(Basis& basis, double unit) {
  if (unit > 0) basis.metadata["character_unit_m"] = shortest(unit);
}

double kept_unit(const Basis& basis) {
  const auto entry = basis.metadata.find("character_unit_m");
  if (entry == basis.metadata.end()) return 0;
  const std::optional<double> unit = number_in<double>(entry->second);
  if (!unit || !(*unit > 0 && std::isfinite(*unit))) {
    throw Error(ErrorKind::file, "the basis says that its character's unit is '", entry->second,
                "', expected metres above 0: the file is damaged");
  }
  return *unit;
}

}  // namespace bodyopt
