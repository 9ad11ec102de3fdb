// How the samples of a truth lie on the frames of a clip.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "assets/clips/clip.h"
#include "trainer/curate/named_shapes.h"

namespace bodyopt::viewport {

// A place among the samples of a cache: on `sample`, or `share` of the way to the next.
struct SampleTime {
  std::uint32_t sample = 0;
  float share = 0;
  bool on_sample() const { return share == 0; }
  bool operator==(const SampleTime&) const = default;
};

// Returns nothing for frames before the first sample or after the last, and where frames of a dataset have none.
std::optional<SampleTime> sample_time(const trainer::NamedShapes& truth, int frame);

// point_count x 3; between two samples, what lies between them by a straight line. Throws as NamedShapes.
std::vector<float> read_sample(const trainer::NamedShapes& truth, const SampleTime& time);

// One sentence or two for the user, where they are not one for one; otherwise empty. `file`: the cache's name.
std::string describe_truth_times(const std::string& file, const trainer::NamedShapes& truth, const Clip& clip);

}  // namespace bodyopt::viewport
