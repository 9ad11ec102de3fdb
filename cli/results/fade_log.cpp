#include "cli/results/fade_log.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "assets/frame_range.h"
#include "assets/wording.h"
#include "runtime/deformer/deformer.h"

namespace bodyopt::cli {
namespace {

constexpr double kNoted = 0.95;  // of what was learned: more is hardly seen

}  // namespace

void FadeLog::add(const Skeleton& skeleton, const Evaluation& evaluation, std::size_t k, int frame, Json& entry) {
  const double fade = mean_fade(evaluation, k);
  const int joint = evaluation.fading_joint[k];
  const std::string name = joint < 0 ? "" : skeleton.joints[static_cast<std::size_t>(joint)].name;
  entry["fade"] = fade;
  entry["fading_joint"] = name;
  add(frame, fade, name);
}

void FadeLog::add(int frame, const Json& entry) { add(frame, entry.at("fade"), entry.at("fading_joint")); }

void FadeLog::add(int frame, double fade, const std::string& joint) {
  if (fade >= kNoted) return;
  frames_.push_back(frame);
  ++joints_[joint];
  least_ = std::min(least_, fade);
}

std::string FadeLog::text() const {
  if (frames_.empty()) return "";
  const auto most = std::max_element(joints_.begin(), joints_.end(),
                                     [](const auto& a, const auto& b) { return a.second < b.second; });
  return count_of(frames_.size(), "frame holds a pose", "frames hold poses") +
         format(
             " that training did not show (most of all of {}); there the correction fades, to {:.0f} % at the least: "
             "{}\n",
             most->first, 100 * least_, format_frame_range(frames_));
}

}  // namespace bodyopt::cli
