// The part of load_levels(), load_dynamics() and load_attachments() after the file is read, wherever its bytes are
// from.
#pragma once

#include <filesystem>
#include <vector>

#include "runtime/basis/attachments.h"
#include "runtime/basis/dynamics.h"
#include "runtime/basis/levels.h"
#include "runtime/basis/safetensors.h"

namespace bodyopt {

// `origin`: its file, or what errors name in place of one. Throw as the functions that load.
std::vector<Level> levels_in(const Safetensors& container, const std::filesystem::path& origin);
Dynamics dynamics_in(const Safetensors& container, const std::filesystem::path& origin, const Basis& basis);
Attachments attachments_in(const Safetensors& container, const std::filesystem::path& origin, const Basis& basis);

}  // namespace bodyopt
