// The geometry of a skin: every primitive of every node that uses it, one after the other.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "trainer/dataset/character.h"
#include "trainer/dataset/gltf_file.h"

namespace bodyopt {

struct SkinGeometry {
  std::vector<Vec3> positions;                    // file units
  std::vector<std::vector<JointWeight>> weights;  // by joint of the skin, ascending; sum 1, or empty
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::string name;  // of the skinned node or its mesh; empty when unnamed
};

// Throws Error(file): attributes missing, of different counts, indices or joints out of range, points or lines.
SkinGeometry read_skin_geometry(const GltfFile& file, int skin, std::vector<std::string>& notes);

}  // namespace bodyopt
