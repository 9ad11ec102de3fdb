#include "tests/support/stand_in_human.h"

#include "tests/support/paths.h"
#include "tests/support/shared_data.h"

namespace bodyopt {

Character stand_in_human() { return read_character(kSourceFolder + "/tests/data/stand_in_human.glb"); }

std::vector<Character> humans(const std::string& file) {
  std::vector<Character> characters{stand_in_human()};
  if (const auto path = shared_data(file)) characters.push_back(read_character(*path));
  return characters;
}

}  // namespace bodyopt
