// What lets GLSL and C++ read the same function.
#ifndef BODYOPT_ONE_SOURCE_H
#define BODYOPT_ONE_SOURCE_H

#ifdef __cplusplus
#define BODYOPT_IN_ARRAY(name, count) const float(&name)[count]
#define BODYOPT_OUT_ARRAY(name, count) float(&name)[count]
#define BODYOPT_INOUT_ARRAY(name, count) float(&name)[count]
#define BODYOPT_FUNCTION inline
#define BODYOPT_PRECISE  // C++ is built without contraction
#else
#define BODYOPT_IN_ARRAY(name, count) in float name[count]
#define BODYOPT_OUT_ARRAY(name, count) out float name[count]
#define BODYOPT_INOUT_ARRAY(name, count) inout float name[count]
#define BODYOPT_FUNCTION
#define BODYOPT_PRECISE precise
#endif

#endif
