// Doubts about shapes that do belong to their character: found before they are learned as the truth.
#pragma once

#include <string>
#include <vector>

#include "dataset/dataset.h"
#include "geometry/mesh.h"
#include "trainer/train/data/samples.h"

namespace bodyopt {
struct Character;
struct Clip;
}  // namespace bodyopt

namespace bodyopt::trainer {

// One sentence for each doubt, take by take. The skin of a part follows its joint by less than 70 %, as if glued to
// what it touches at rest. Only parts count that the joint moves by a hundredth of the body's size or more, in 48
// frames. Vertices fly away from their neighbours in single frames; all frames are searched, but not in sparse sets.
std::vector<std::string> shape_doubts(const SampleSet& set);

// Takes of which hold_out_blocks() can hold out nothing, without frames held out: one sentence each.
std::vector<std::string> short_takes(const Dataset& dataset);

// One sentence for every take whose simulation is further from that in ever finer tets than training comes to it, as
// its side-car estimates. Throws Error(file) as read_frame_status().
std::vector<std::string> coarse_takes(const Dataset& dataset);

// Errors of a take's shapes as a whole, so that they do not lie where its frames are.

struct Misplacement {
  std::string
      cause;        // "the frames are numbered 1 too high", with its number; empty: none explains most of the distance
  double left = 1;  // share of the distance from the skinned character that is left without it
};

// The simplest explanation of over half of the squared distance between shapes and the skinned character. Frames are
// early or late, or the shapes have another size, are turned, mirrored, moved, or several of these at once. Or each
// frame is moved (and turned) for itself, as without the root's travel. What bulges, folds and swings is none of them.
//
// `shapes`: V x 3 welded, metres, world, of some frames of the clip, `frames`; one or more.
Misplacement find_misplacement(const Character& character, const Clip& clip, const std::vector<int>& frames,
                               const std::vector<Positions>& shapes);

}  // namespace bodyopt::trainer
