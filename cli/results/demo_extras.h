// The demo's extras: the arm that stops suddenly, static and jiggling, and a stockier one.
#pragma once

#include <filesystem>
#include <string>

#include "report/report.h"
#include "runtime/deformer/deformer.h"
#include "trainer/train/data/samples.h"

namespace bodyopt::cli {

// Makes the dynamics of the built-in arm, from which `set` is, and evaluates the clip `stop.glb` in `folder` with and
// without them. Writes basis.dynamics.safetensors and, where `pictures_on` names a Vulkan device (empty: none),
// stop_strip.png, stop.webp and, at half the speed, stop_slow.webp. Throws Error(file), Error(device).
report::JiggleReport demo_jiggle(const trainer::SampleSet& set, const Basis& basis, const DeviceChoice& device,
                                 const std::string& pictures_on, const std::filesystem::path& folder);

// Carries the trained arm to one of another topology. Writes stocky.glb, stocky.safetensors and, where something can be
// drawn, transfer.html, from the basis and the held-out clip in the folder. Returns a line on it.
std::string demo_transfer(const std::filesystem::path& folder, bool has_pictures);

}  // namespace bodyopt::cli
