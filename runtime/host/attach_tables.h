// Attached meshes as kernels read them: all of a character's, one after the other.
#pragma once

#include <cstdint>
#include <vector>

#include "runtime/basis/attachments.h"
#include "shaders/include/attach.h"

namespace bodyopt {

struct AttachTables {
  std::vector<AttachCorner> corners;  // C, by rising vertex
  std::vector<AttachFan> fans;
  std::vector<AttachAnchor> anchors;        // K
  std::vector<SurfacePoint> points;         // a, b and c are corners; weights add up to 1 over an anchor's points
  std::vector<AttachVertex> vertices;       // N
  std::vector<std::uint32_t> vertex_begin;  // of each mesh its first vertex, and the end
};

// They must belong together (load_attachments sees to it).
AttachTables attach_tables(const MeshTable& mesh, const Attachments& attachments);

}  // namespace bodyopt
