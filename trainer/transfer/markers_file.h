// markers.json: points of two skins that are the same, where registration cannot tell.
#pragma once

#include <filesystem>
#include <vector>

#include "trainer/transfer/correspondence.h"

namespace bodyopt {

// Each vertex of either side once. Throws Error(file).
std::vector<SkinMarker> read_markers(const std::filesystem::path& path);

}  // namespace bodyopt
