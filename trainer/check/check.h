// Does a dataset belong together? Counts, units, up axis, frame numbering, controls, and how well shapes fit the
// skinned rest.
#pragma once

#include <string>
#include <vector>

#include "dataset/dataset.h"

namespace bodyopt {
struct Character;
}

namespace bodyopt::trainer {

struct TakeCheck {
  std::string name;
  std::uint32_t points = 0, samples = 0;
  std::uint32_t unconverged = 0;  // frames that training leaves out, or that are not simulated yet
  std::uint32_t compared = 0;     // samples that the distances are of: without those, and without replaced ones
  double fit_mm = 0;       // RMS distance of shapes from linear blend skinning, over some frames spread over the take
  double rest_fit_mm = 0;  // the same for the frame whose pose is nearest to the bind pose
  int rest_frame = 0;
  std::vector<std::string> problems;  // each names what was expected, what was found and the likely cause; where shapes
                                      // lie is none of a take that is `as_given`
};

// One entry per take, of its raw shapes. Throws Error(file) where something cannot be read at all, and Error(mismatch)
// where a modifier does not fit what is sound.
std::vector<TakeCheck> check_dataset(const Dataset& dataset);

// Says what keeps a dataset, read from `path`, from training: its file, the take and the first problem, or that no
// frame is solved. Empty: nothing.
std::string first_problem(const std::vector<TakeCheck>& takes, const std::filesystem::path& path);

// "closed, 1 piece" or what is open, non-manifold, in several pieces: one sentence.
std::string describe_surface(const Character& character);

}  // namespace bodyopt::trainer
