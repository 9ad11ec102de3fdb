#include "proxy_viewer/truth_times.h"

#include <sstream>

namespace bodyopt {

std::string describe_truth_times(const std::string& file, const Pc2Reader& truth, const Clip& clip) {
  const float first = truth.start_frame(), step = truth.sample_rate();
  const std::uint32_t count = truth.sample_count();
  if (first == static_cast<float>(clip.first_frame) && step == 1 && count == clip.poses.size()) return {};
  std::ostringstream text;
  text << file << ": " << count << " samples, of frames " << first << "-"
       << first + step * static_cast<float>(count - 1);
  if (step != 1) text << ", one every " << step << " frames";
  text << "; the clip has frames " << clip.first_frame << "-" << clip.last_frame() << " at " << clip.fps
       << " a second. A frame is compared with the sample nearest to it, and with none beyond the first and the last. "
          "Was the cache written with another --fps, or of another part of the clip?";
  return text.str();
}

}  // namespace bodyopt
