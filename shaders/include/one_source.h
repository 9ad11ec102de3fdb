// Lets GLSL and C++ read the same function. Real is a float; in C++ it is a template parameter, which may also be the
// lanes of a block (runtime/cpu/lanes.h). Such functions choose by select() and have no branches.
#ifndef BODYOPT_ONE_SOURCE_H
#define BODYOPT_ONE_SOURCE_H

#ifdef __cplusplus
#include <algorithm>
#include <cmath>
namespace bodyopt {
using std::abs;
using std::max;
using std::min;
using std::sqrt;
#define BODYOPT_IN_ARRAY(name, count) const float(&name)[count]
#define BODYOPT_OUT_ARRAY(name, count) float(&name)[count]
#define BODYOPT_INOUT_ARRAY(name, count) float(&name)[count]
#define BODYOPT_IN_REALS(name, count) const Real(&name)[count]
#define BODYOPT_OUT_REALS(name, count) Real(&name)[count]
#define BODYOPT_INOUT_REALS(name, count) Real(&name)[count]
#define BODYOPT_INOUT_REAL(name) Real& name
#define BODYOPT_FUNCTION inline
// clang-format off
#define BODYOPT_REAL_FUNCTION template <typename Real> inline
// clang-format on
#define BODYOPT_PRECISE  // C++ is built without contraction
#else
#define Real float
#define BODYOPT_IN_ARRAY(name, count) in float name[count]
#define BODYOPT_OUT_ARRAY(name, count) out float name[count]
#define BODYOPT_INOUT_ARRAY(name, count) inout float name[count]
#define BODYOPT_IN_REALS(name, count) in Real name[count]
#define BODYOPT_OUT_REALS(name, count) out Real name[count]
#define BODYOPT_INOUT_REALS(name, count) inout Real name[count]
#define BODYOPT_INOUT_REAL(name) inout Real name
#define BODYOPT_FUNCTION
#define BODYOPT_REAL_FUNCTION
#define BODYOPT_PRECISE precise
#endif

BODYOPT_FUNCTION float select(bool condition, float yes, float no) { return condition ? yes : no; }
BODYOPT_FUNCTION bool any_of(bool condition) { return condition; }

#ifdef __cplusplus
}  // namespace bodyopt
#endif
#endif
