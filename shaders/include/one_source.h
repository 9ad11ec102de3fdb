// What lets GLSL and C++ read the same function. Real is a float; in C++ it is a template parameter, which may also be
// the lanes of a block, side by side (runtime/cpu/lanes.h): such functions choose by select() and have no branches.
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
#define BODYOPT_IN_ARRAY(name, count) const Real(&name)[count]
#define BODYOPT_OUT_ARRAY(name, count) Real(&name)[count]
#define BODYOPT_INOUT_ARRAY(name, count) Real(&name)[count]
#define BODYOPT_INOUT(name) Real& name
#define BODYOPT_FUNCTION inline
#define BODYOPT_REAL_FUNCTION \
  template <typename Real>    \
  inline
#define BODYOPT_PRECISE  // C++ is built without contraction
#else
#define Real float
#define BODYOPT_IN_ARRAY(name, count) in Real name[count]
#define BODYOPT_OUT_ARRAY(name, count) out Real name[count]
#define BODYOPT_INOUT_ARRAY(name, count) inout Real name[count]
#define BODYOPT_INOUT(name) inout Real name
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
