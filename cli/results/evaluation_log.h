// The report of `eval` on the frames that it evaluated.
#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "cli/arguments/common.h"
#include "runtime/coverage/expected_error.h"
#include "runtime/deformer/evaluation.h"
#include "runtime/host/jiggle.h"
#include "runtime/host/stages.h"

namespace bodyopt {
class Deformer;
}  // namespace bodyopt

namespace bodyopt::cli {

// Frames in which what was learned fades to Direct Delta Mush.
class FadeLog {
 public:
  // Adds sample k of an evaluation, which is this frame; `entry` gets "fade" and "fading_joint".
  void add(const Skeleton& skeleton, const Evaluation& evaluation, std::size_t k, int frame, Json& entry);

  // Adds an entry that was made before.
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

class EvaluationLog {
 public:
  // Expects errors where the basis knows its own. It must outlive this.
  explicit EvaluationLog(const Basis& basis);

  // Adds what the deformer gave of poses, which are these frames. `motion`: after the last; jiggling frames come alone.
  void add(const Deformer& deformer, const Evaluation& part, std::span<const int> frames, const NodeMotion& motion);

  // What writing these frames took beside.
  void add_writing(double seconds) { writing_seconds_ += seconds; }

  // All that take_up() needs to go on from here.
  Json kept() const;
  void take_up(const Json& kept);

  // Keys of the result: frames, what was flagged, times.
  Json result() const;
  // A few lines for records, without the list of frames.
  Json summary() const;
  std::string text() const;

 private:
  double milliseconds_per_frame(double seconds) const;
  Json host_milliseconds() const;
  Json entry_of(const Deformer& deformer, const Evaluation& part, std::size_t k, int frame, const NodeMotion& motion);
  void count(const Json& entry);
  std::vector<std::string> notes() const;

  Json per_frame_ = Json::array();
  std::map<JiggleStart, std::vector<int>> starts_;  // in which frames
  std::map<std::string, std::size_t> limited_joints_;
  std::vector<int> frames_, outside_frames_, inverted_frames_, limited_frames_, no_better_frames_;
  std::string worst_feature_, worst_by_;
  double worst_outside_ = 0, most_jiggle_mm_ = 0, most_expected_mm_ = 0;
  int most_jiggle_frame_ = 0, most_expected_frame_ = 0;
  std::uint32_t most_inverted_ = 0, tets_ = 0;
  std::size_t timed_frames_ = 0;
  StageSeconds stage_seconds_;
  HostSeconds host_seconds_;
  double writing_seconds_ = 0;
  FadeLog fades_;
  std::optional<ErrorExpectation> expectation_;  // where the basis knows its error
  std::vector<double> expected_mm_;              // of the frames
};

}  // namespace bodyopt::cli
