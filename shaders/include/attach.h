// How attached meshes follow the skin. One source for GLSL and C++.
//
// x = c + R (u - c_rest) for every vertex at u. c is the mean of its anchor's points on the posed skin. R is the
// rotation nearest to how the skin around them moved. It is fitted to edges and normals of the skin around the points'
// corners, from rest to posed.
#ifndef BODYOPT_ATTACH_H
#define BODYOPT_ATTACH_H

#include "layout.h"
#include "vectors.h"

#ifdef __cplusplus
namespace bodyopt {
#endif

// A vertex of the skin that is a corner of points. It has a fan of triangles, the unit normal at rest times half the
// number of edges, and one over that number.
struct AttachCorner {
  uint vertex, fan_begin, fan_end;
  float normal_x, normal_y, normal_z, share;
};

// A triangle of a fan: its other corners, and the edges to them at rest over their squared lengths.
struct AttachFan {
  uint b, c;
  float bx, by, bz, cx, cy, cz;
};

// Turns and moves vertices together: by points, whose a, b and c are numbers of corners, or, without any, by a joint.
struct AttachAnchor {
  uint joint, point_begin, point_end;
  float x, y, z;  // at rest
};

struct AttachVertex {
  uint anchor;
  float x, y, z;  // at rest, away from its anchor
};

// How much of R is the joint's: nothing that could be seen, all of it where the skin says nothing.
const float kJointInAnchor = 1e-6f;

const uint kStretchNumbers = 9u, kAnchorNumbers = 12u;  // R and then c

struct OutputStretchPush {
  uint corner_count, vertex_count;
};
struct OutputAnchorPush {
  uint anchor_count, corner_count, vertex_count, joint_count;
};
struct OutputAttachPush {
  uint first_vertex, vertex_count, anchor_count;
  uint first_word, element_words, frame_words;  // of what is written
};

// Adds a triangle, its posed edges to b and c, to how the skin moved around the corner, and to its normal.
BODYOPT_FUNCTION void add_fan(AttachFan fan, BODYOPT_IN_ARRAY(to_b, 3), BODYOPT_IN_ARRAY(to_c, 3),
                              BODYOPT_INOUT_ARRAY(stretch, 9), BODYOPT_INOUT_ARRAY(normal, 3)) {
  float rest_b[3], rest_c[3], area[3];
  rest_b[0] = fan.bx, rest_b[1] = fan.by, rest_b[2] = fan.bz;
  rest_c[0] = fan.cx, rest_c[1] = fan.cy, rest_c[2] = fan.cz;
  cross_product(to_b, to_c, area);
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      BODYOPT_PRECISE float more = to_b[i] * rest_b[j] + to_c[i] * rest_c[j];
      stretch[3 * i + j] += more;
    }
    normal[i] += area[i];
  }
}

// Finishes a stretch from the sums over the corner's fan.
BODYOPT_FUNCTION void finish_stretch(AttachCorner corner, BODYOPT_IN_ARRAY(normal, 3),
                                     BODYOPT_INOUT_ARRAY(stretch, 9)) {
  float rest_normal[3], unit[3];
  rest_normal[0] = corner.normal_x, rest_normal[1] = corner.normal_y, rest_normal[2] = corner.normal_z;
  for (int i = 0; i < 3; ++i) unit[i] = normal[i];
  make_unit(unit);
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      BODYOPT_PRECISE float whole = stretch[3 * i + j] + unit[i] * rest_normal[j];
      stretch[3 * i + j] = whole * corner.share;
    }
  }
}

#ifdef __cplusplus
static_assert(sizeof(AttachCorner) == 28 && sizeof(AttachFan) == 32 && sizeof(AttachAnchor) == 24 &&
                  sizeof(AttachVertex) == 16,
              "they differ between C++ and GLSL");
}  // namespace bodyopt
#endif
#endif
