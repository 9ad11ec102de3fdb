// The demo's trained arm, carried to a stockier one of another topology.
#pragma once

#include <filesystem>
#include <string>

namespace bodyopt::cli {

// Writes stocky.glb, stocky.safetensors and, where something can be drawn, transfer.html, from the basis and the
// held-out clip in the folder. Returns a line on it.
std::string demo_transfer(const std::filesystem::path& folder, bool has_pictures);

}  // namespace bodyopt::cli
