// Reads MuJoCo models (.xml): bodies, joints, sites, spatial tendons and the muscles that pull them.
#pragma once

#include <filesystem>

#include "trainer/muscle_models/model.h"

namespace bodyopt::muscle_models {

// Includes are read from the folder of `path`, as MuJoCo does; one that is missing is left out with a note. Honoured:
// hinge and slide joints, default classes, the compiler's angle and eulerseq, joint couplings (in the default pose),
// sphere and cylinder wraps. Ball and free joints stay as they are. A tendon without a muscle is left out with a note.
// Throws Error(file).
Model read_mujoco(const std::filesystem::path& path);

}  // namespace bodyopt::muscle_models
