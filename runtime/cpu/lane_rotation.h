// rot() of shaders/include/rotation.h in lanes.
#if defined(BODYOPT_LANE_ROTATION_H) == defined(HWY_TARGET_TOGGLE)
#ifdef BODYOPT_LANE_ROTATION_H
#undef BODYOPT_LANE_ROTATION_H
#else
#define BODYOPT_LANE_ROTATION_H
#endif

#include "runtime/cpu/lanes.h"
#include "shaders/include/one_source.h"

HWY_BEFORE_NAMESPACE();
namespace bodyopt::cpu::HWY_NAMESPACE {
#define BODYOPT_OF_LANES
#include "shaders/include/rotation.h"
#undef BODYOPT_OF_LANES
}  // namespace bodyopt::cpu::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
