// Reads OpenSim models (.osim, versions 2 to 4).
#pragma once

#include <filesystem>

#include "trainer/muscle_models/model.h"

namespace bodyopt::muscle_models {

// Joints: CustomJoint, WeldJoint, PinJoint, SliderJoint, UniversalJoint, BallJoint, GimbalJoint, PlanarJoint,
// FreeJoint. Functions: Constant, LinearFunction, PiecewiseLinearFunction, PolynomialFunction, SimmSpline,
// MultiplierFunction. Path points: fixed, conditional, moving. Wraps are named, not honoured. Throws Error(file).
Model read_opensim(const std::filesystem::path& path);

}  // namespace bodyopt::muscle_models
