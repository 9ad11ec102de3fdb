#include "shots/shot.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "base/progress.h"
#include "runtime/basis/dynamics.h"
#include "runtime/core/error.h"
#include "runtime/deformer/evaluation.h"
#include "shots/clip_choice.h"

namespace bodyopt {
namespace {

Evaluation evaluate_part(Shot& shot, std::span<const Pose> poses, std::span<const int> frames) {
  try {
    return shot.jiggles ? shot.deformer->jiggle(poses, frames) : shot.deformer->evaluate(poses);
  } catch (const Error& error) {
    if (!shot.checks) throw;
    throw Error(error.kind(), "frame ", frames.front(), ": ", error.what());
  }
}

}  // namespace

std::vector<Pose> Shot::poses(std::size_t begin, std::size_t count) const {
  const auto first = frames.begin() + static_cast<std::ptrdiff_t>(begin);
  return poses_of(clip, {first, first + static_cast<std::ptrdiff_t>(count)});
}

std::string problem_of_rate(const Dynamics& dynamics, const Clip& clip) {
  const double rate = static_cast<double>(dynamics.jiggle.step.frames_per_second);
  if (std::abs(clip.fps - rate) <= 1e-3 * rate) return "";
  std::ostringstream text;
  text << "the dynamics step " << rate << " frames a second, the clip has " << clip.fps << ": sample it with --fps "
       << rate << ", or make the dynamics anew with 'bodyopt dynamics --fps " << clip.fps << "'";
  return text.str();
}

void preroll(Shot& shot, const Tell& tell) {
  if (shot.preroll == 0 || shot.frames.empty()) return;
  const int first = shot.frames.front(), begin = std::max(shot.clip.first_frame, first - shot.preroll);
  if (first - begin < shot.preroll) {
    tell(concat("the clip has ", first - begin, " frames before frame ", first, ": the pre-roll is that short"));
  }
  Progress progress("pre-roll", static_cast<std::size_t>(first - begin));
  for (int frame = begin; frame < first; ++frame) {
    shot.deformer->jiggle(poses_of(shot.clip, {frame}), {&frame, 1});
    progress.advance();
  }
}

void evaluate(Shot& shot, SkinSink& sink, Progress& progress, std::size_t begin) {
  // Frames held in memory at once. Of the jiggle each is measured, and it may be slow; a check names the one it stops
  // at.
  const std::size_t step = shot.jiggles || shot.checks ? 1 : 64;
  while (begin < shot.frames.size()) {
    const std::size_t count = std::min(step, shot.frames.size() - begin);
    const std::vector<Pose> poses = shot.poses(begin, count);
    sink.append(evaluate_part(shot, poses, std::span(shot.frames).subspan(begin, count)), poses, begin);
    progress.advance(count);
    begin += count;
  }
}

}  // namespace bodyopt
