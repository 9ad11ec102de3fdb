// Where the tests find the project and its program.
#pragma once

#include <string>

namespace bodyopt {

extern const std::string kSourceFolder;
extern const std::string kBuildFolder;
extern const std::string kProgram;          // bodyopt, of the build that the tests belong to
extern const std::string kDeviceLossLayer;  // the folder of device_loss_layer.cpp's manifest

}  // namespace bodyopt
