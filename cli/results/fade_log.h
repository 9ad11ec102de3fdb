// Frames in which what was learned fades to Direct Delta Mush.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "cli/arguments/common.h"

namespace bodyopt {
struct Evaluation;
}  // namespace bodyopt

namespace bodyopt::cli {

class FadeLog {
 public:
  // Of sample k of an evaluation, which is this frame; `entry` gets "fade" and "fading_joint".
  void add(const Skeleton& skeleton, const Evaluation& evaluation, std::size_t k, int frame, Json& entry);

  // The same of an entry that was made before.
  void add(int frame, const Json& entry);
  void add(int frame, double fade, const std::string& joint);

  bool empty() const { return frames_.empty(); }

  // A line for people; none where hardly anything fades.
  std::string text() const;

 private:
  std::vector<int> frames_;
  std::map<std::string, std::size_t> joints_;  // and of how many of these frames they are
  double least_ = 1;
};

}  // namespace bodyopt::cli
