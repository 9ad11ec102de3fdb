// What is odd about shapes that do belong to their character: found before they are learned as the truth.
#pragma once

#include <string>
#include <vector>

#include "dataset/dataset.h"
#include "trainer/train/data/samples.h"

namespace bodyopt {

// One sentence each, take by take: parts whose skin follows its joint by less than 70 % (of those that the joint moves
// by a hundredth of the body's size or more), as when they were glued to what they touch at rest, found in 48 frames of
// each take at most; and vertices that fly away from their neighbours in single frames, looked for in all frames.
std::vector<std::string> shape_doubts(const SampleSet& set);

// Takes of which hold_out_blocks() can hold out nothing, without frames held out: one sentence each.
std::vector<std::string> short_takes(const Dataset& dataset);

// One sentence for every take whose simulation is further from that in ever finer tets than training comes to it, as
// its side-car estimates. Throws Error(file) as read_frame_status().
std::vector<std::string> coarse_takes(const Dataset& dataset);

}  // namespace bodyopt
