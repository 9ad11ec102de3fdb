#include "tests/support/paths.h"

namespace bodyopt {

const std::string kSourceFolder = BODYOPT_SOURCE_DIR;
const std::string kProgram = BODYOPT_PROGRAM;

}  // namespace bodyopt
