// What an output may stand in place of, and where it may be: checked before long work.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace bodyopt {

// Throws Error(usage) where `output`, which `option` names, is one of `files`: inputs, or other outputs; what is empty
// is none. Finds files that are not there yet, too.
void refuse_over(const std::string& option, const std::filesystem::path& output,
                 const std::vector<std::filesystem::path>& files);

// The folder, or the one in which it would be made, must be writable. Throws Error(file).
void require_writable_folder(std::filesystem::path folder);

}  // namespace bodyopt
