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
  void add(int frame, double fade, const std::string& joint);

  bool empty() const { return frames_.empty(); }

  // A line for people; none where hardly anything fades.
  std::string text() const;

 private:
  std::vector<int> frames_;
  std::map<std::string, std::size_t> joints_;  // and of how many of these frames they are
  double least_ = 1;
};

// What is told of a frame.
struct FrameEntry {
  struct Jiggle {
    double rms_mm = 0, max_mm = 0;
    std::uint32_t inverted_tets = 0, limited_vertices = 0;
    std::string limited_near{};  // a joint; empty: none is limited
  };

  int frame = 0;
  double outside = 0;                           // see Evaluation
  std::string outside_feature{}, outside_by{};  // empty: it is not outside; earlier versions kept the first alone
  double fade = 1;
  std::string fading_joint{};
  std::optional<Jiggle> jiggle{};           // where it jiggles
  std::optional<double> expected_rms_mm{};  // where the basis knows its error
  double expected_ddm_rms_mm = 0;           // 0: not known
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
  FrameEntry entry_of(const Deformer& deformer, const Evaluation& part, std::size_t k, int frame,
                      const NodeMotion& motion) const;
  std::vector<std::string> notes() const;

  std::vector<FrameEntry> frames_;
  std::map<JiggleStart, std::vector<int>> starts_;  // in which frames
  std::uint32_t tets_ = 0;
  std::size_t timed_frames_ = 0;
  StageSeconds stage_seconds_;
  HostSeconds host_seconds_;
  double writing_seconds_ = 0;
  std::optional<ErrorExpectation> expectation_;  // where the basis knows its error
};

}  // namespace bodyopt::cli
