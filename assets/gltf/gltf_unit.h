// The length of a glTF file's unit.
#pragma once

#include <string>
#include <vector>

#include "assets/gltf/gltf_file.h"
#include "runtime/core/transform.h"

namespace bodyopt {

// Metres per unit of the file: `given`, where it is not 0. Otherwise 1, if there is no skin, or its bounding box, as
// its joints scale it, then has a diagonal of 0.05 to 50 m. Else it is the centimetre, millimetre, hundred or thousand
// metres that brings it there and nearest to a person's 2 m. A note says so. Throws Error(file) where none does,
// Error(usage) for what is no unit.
double file_unit(const GltfFile& file, double given, std::vector<std::string>& notes);

// The diagonal of the box around points; 0 without points.
double bounding_box_diagonal(const std::vector<Vec3>& points);

}  // namespace bodyopt
