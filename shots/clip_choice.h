// The choice of a clip and of frames of it, as verbs and sessions name them.
#pragma once

#include <string>
#include <vector>

#include "assets/clips/clip.h"
#include "runtime/basis/basis.h"

namespace bodyopt::shots {

// What a clip tells of its frames.
struct ClipSpan {
  std::string name;
  int first = 1, last = 0;
  double fps = 24;

  ClipSpan(const Clip& clip) : name(clip.name), first(clip.first_frame), last(clip.last_frame()), fps(clip.fps) {}
};

struct ClipChoice {
  std::string source;  // as read_clip() takes it
  std::string frames;  // "1-100", "1-100x2" or comma lists of them; empty: all
  ClipOptions options;

  // `unit`: that of the character, where the options name none. Throw as read_clip().
  Clip read(const Skeleton& skeleton, double unit) const;
  Clip read(const Basis& basis, double unit) const;
  // Throws Error(usage) when a frame lies outside the clip.
  std::vector<int> chosen_frames(const ClipSpan& clip) const;

 private:
  ClipOptions in_unit(double unit) const;
};

// The poses of some frames of a clip.
std::vector<Pose> poses_of(const Clip& clip, const std::vector<int>& frames);

}  // namespace bodyopt::shots
