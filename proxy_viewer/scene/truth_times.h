// How the samples of a truth lie on the frames of a clip.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "assets/clip.h"
#include "assets/pc2.h"

namespace bodyopt {

// A place among the samples of a cache: on `sample`, or `share` of the way to the next.
struct SampleTime {
  std::uint32_t sample = 0;
  float share = 0;
  bool on_sample() const { return share == 0; }
  bool operator==(const SampleTime&) const = default;
};

// Nothing for frames before the first sample or after the last.
std::optional<SampleTime> sample_time(const Pc2Reader& truth, int frame);

// point_count x 3; between two samples, what lies between them by a straight line. Of the file as it is now: it may
// have been written anew since `truth` was opened. Throws as Pc2Reader, and Error(mismatch) where it has other points
// now.
std::vector<float> read_sample(const Pc2Reader& truth, const SampleTime& time);

// One sentence or two for the user, where they are not one for one; otherwise empty. `file`: the cache's name.
std::string describe_truth_times(const std::string& file, const Pc2Reader& truth, const Clip& clip);

}  // namespace bodyopt
