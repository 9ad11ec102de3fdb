// markers.json: points of two skins that are the same, where registration cannot tell.
#pragma once

#include <filesystem>
#include <vector>

#include "trainer/transfer/correspondence.h"

namespace bodyopt::trainer {

// Is it a file of markers? False where it cannot be read.
bool is_markers(const std::filesystem::path& path);
// Each vertex of either side once. Throws Error(file).
std::vector<SkinMarker> read_markers(const std::filesystem::path& path);
void write_markers(const std::vector<SkinMarker>& markers, const std::filesystem::path& path);

}  // namespace bodyopt::trainer
