// What a unit of a glTF file is.
#pragma once

#include <string>
#include <vector>

#include "assets/gltf_file.h"
#include "runtime/core/transform.h"

namespace bodyopt {

// Metres per unit of the file. What is `given`, where it is not 0. Else metres, if the bounding box of the file's skin,
// as its joints scale it, then measures 0.05 to 50 m from corner to corner, or there is none; centimetres, millimetres,
// hundreds or thousands of metres if one of them brings it there, that which brings it nearest to a person's 2 m. A
// note says so. Throws Error(file) where none does, Error(usage) for what is no unit.
double file_unit(const GltfFile& file, double given, std::vector<std::string>& notes);

// Of the box around points; 0 of none.
double bounding_box_diagonal(const std::vector<Vec3>& points);

}  // namespace bodyopt
