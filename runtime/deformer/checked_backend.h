// Doubt while it runs: every stage on a device beside the same on the CPU.
#pragma once

#include <memory>

#include "runtime/host/backend.h"
#include "runtime/host/character_model.h"

namespace bodyopt {

// A backend that gives what `device` gives, and runs every batch on `cpu`, too; both are of `model`. At the first
// difference, stage by stage and frame by frame, run() throws Error(device). The message names stage, frame of the call
// (Batch::first_frame), element (a vertex, say), both values and the tolerance. Nodes of a jiggle are compared, and
// named, after the last frame of the batch. Each batch of a jiggle begins on both with the motion of the device, so
// that differences do not add up.
std::unique_ptr<Backend> make_checked_backend(std::shared_ptr<const CharacterModel> model,
                                              std::unique_ptr<Backend> device, std::unique_ptr<Backend> cpu);

}  // namespace bodyopt
