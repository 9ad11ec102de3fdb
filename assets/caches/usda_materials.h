// The materials of a surface as USD text: a UsdPreviewSurface each, below the mesh, with images beside the file.
#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "assets/gltf/skin_surface.h"

namespace bodyopt {

// Turns any text into a valid name of a prim.
std::string prim_name(const std::string& name);

// Returns text for the prim of the mesh of that name, whose path is `prim`; empty if the surface has no materials.
std::string usd_materials(const SkinSurface& surface, const std::string& mesh, const std::string& prim);

// Writes the images that the text names into the folder. Throws Error(file).
void write_usd_images(const SkinSurface& surface, const std::string& mesh, const std::filesystem::path& folder);
// Copies images that the text of a file in one folder names into another. Throws Error(file).
void copy_usd_images(const std::string& text, const std::filesystem::path& from, const std::filesystem::path& to);

}  // namespace bodyopt
