#include "tests/support/paths.h"

namespace bodyopt {

const std::string kSourceFolder = BODYOPT_SOURCE_DIR;
const std::string kBuildFolder = BODYOPT_BINARY_DIR;
const std::string kProgram = BODYOPT_PROGRAM;
const std::string kDeviceLossLayer = BODYOPT_DEVICE_LOSS_LAYER;

}  // namespace bodyopt
