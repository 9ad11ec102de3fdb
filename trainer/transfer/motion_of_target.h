// What is known of a motion on a body that something was carried to: for the report and the viewport.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "assets/clip.h"
#include "runtime/basis/basis.h"

namespace bodyopt {

// What a skin encloses, over what the mesh does at rest. `output`: O x 3, output vertex order, metres. Of an open skin
// a measure that changes as it is carried about, too: compare with care.
double relative_volume(const MeshTable& mesh, std::span<const float> output);

// The frames that would teach a body most, as `simulate --frames` takes them, by what each is expected to be wrong by,
// mm RMS (0: not known); at most twenty, spread over the motion. Empty: nothing is known.
std::string frames_to_simulate(std::span<const int> frames, const std::vector<double>& expected_mm);

// The same of a clip of the body's own, by what the basis knows of its error. Throws as ErrorExpectation, but for a
// basis that knows nothing: it says so by an empty text.
std::string frames_to_simulate(const Basis& basis, const Clip& clip);

}  // namespace bodyopt
