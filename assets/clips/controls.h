// controls.json, or a .csv: values over time beside the joints, by name: how hard a muscle is flexed.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "assets/clips/clip.h"

namespace bodyopt {

// Reads curves and samples them at every frame of the clip: linear between keys, constant before the first and after
// the last. Replaces clip.controls; keys that all lie beyond the clip are noted. Throws Error(file), and
// Error(mismatch) for a rate that is another than the clip's.
void read_controls(const std::filesystem::path& path, Clip& clip);

// Writes the clip's controls, which read_controls() reads: one value, or a key a frame. Throws Error(file).
void write_controls(const Clip& clip, const std::filesystem::path& path);

// Gives every pose of the clip a value for each of `names`, in that order: 0 where the clip has no such control.
// Returns the controls of the clip that are not among the names.
std::vector<std::string> arrange_controls(const std::vector<std::string>& names, Clip& clip);

}  // namespace bodyopt
