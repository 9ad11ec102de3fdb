// Buffer views of a glTF file that are compressed by EXT_meshopt_compression.
#pragma once

#include <filesystem>
#include <vector>

#include "runtime/core/json.h"

namespace bodyopt {

// Appends to `buffers` what each compressed view of the file's JSON holds, and lets the view show that. Throws
// Error(file), messages calling the file `path`, where a view is damaged or wants far more memory than its bytes can
// tell of.
void decompress_views(const std::filesystem::path& path, Json& root, std::vector<std::vector<unsigned char>>& buffers);

}  // namespace bodyopt
