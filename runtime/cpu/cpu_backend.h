// The stages on the CPU: what every kernel is checked against, and what runs where there is no device.
#pragma once

#include <memory>

#include "runtime/core/executor.h"
#include "runtime/host/backend.h"
#include "runtime/host/character_model.h"

namespace bodyopt {

// Frames, and the blocks of each, are spread over the executor's threads; without one all is done by the calling one.
// The bits are the same however many there are.
std::unique_ptr<Backend> make_cpu_backend(std::shared_ptr<const CharacterModel> model, const JiggleModel& jiggle = {},
                                          std::shared_ptr<Executor> executor = nullptr);

}  // namespace bodyopt
