// Which frames of which clip: what verbs and sessions name.
#pragma once

#include <string>
#include <vector>

#include "assets/clip.h"
#include "runtime/basis/basis.h"

namespace bodyopt {

struct ClipChoice {
  std::string source;  // as read_clip() takes it
  std::string frames;  // "1-100", "1-100x2" or comma lists of them; empty: all
  ClipOptions options;

  // `unit`: that of the character, where the options name none. Throw as read_clip().
  Clip read(const Skeleton& skeleton, double unit) const;
  Clip read(const Basis& basis, double unit) const;
  // Of the clip. Throws Error(usage) when a frame lies outside it.
  std::vector<int> chosen_frames(const Clip& clip) const;

 private:
  ClipOptions in_unit(double unit) const;
};

// The poses of some frames of a clip.
std::vector<Pose> poses_of(const Clip& clip, const std::vector<int>& frames);

}  // namespace bodyopt
