#include "shots/clip_choice.h"

#include <sstream>

#include "assets/clips/matched_joints.h"
#include "base/frame_range.h"
#include "runtime/core/error.h"
#include "runtime/core/transformed.h"

namespace bodyopt::shots {

Clip ClipChoice::read(const Skeleton& skeleton, double unit) const {
  return read_clip(source, skeleton, in_unit(unit));
}

Clip ClipChoice::read(const Basis& basis, double unit) const { return read_clip(source, basis, in_unit(unit)); }

ClipOptions ClipChoice::in_unit(double unit) const {
  ClipOptions result = options;
  if (result.unit == 0) result.unit = clip_unit(source, unit);
  return result;
}

std::vector<int> ClipChoice::chosen_frames(const ClipSpan& clip) const {
  std::vector<int> numbers;
  if (frames.empty()) {
    for (int frame = clip.first; frame <= clip.last; ++frame) numbers.push_back(frame);
  } else {
    numbers = parse_frame_range(frames);
  }
  for (const int frame : numbers) {
    if (frame >= clip.first && frame <= clip.last) continue;
    std::ostringstream text;
    text << "--frames asks for frame " << frame << "; '" << (source.empty() ? clip.name : source) << "' has frames "
         << clip.first << " to " << clip.last << " at " << clip.fps << " frames a second";
    throw Error(ErrorKind::usage, text.str());
  }
  return numbers;
}

std::vector<Pose> poses_of(const Clip& clip, const std::vector<int>& frames) {
  return transformed(frames, [&](int frame) { return clip.poses[static_cast<std::size_t>(frame - clip.first_frame)]; });
}

}  // namespace bodyopt::shots
