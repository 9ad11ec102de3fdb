#include "cli/results/evaluation_log.h"

#include <algorithm>
#include <cmath>
#include <ranges>

#include "base/frame_range.h"
#include "base/wording.h"
#include "runtime/core/transformed.h"
#include "runtime/deformer/deformer.h"
#include "runtime/deformer/evaluation.h"
#include "trainer/dynamics/jiggle.h"
#include "trainer/train/coverage/coverage.h"

namespace bodyopt::cli {
namespace {

constexpr double kSeenMm = 0.5;  // errors of Direct Delta Mush below are nobody's concern
constexpr double kAsBad = 0.9;   // of the error of Direct Delta Mush: what is left out would hardly be seen

// Frames worth a look, spread over the shot, are expected to be most wrong. Where that is not known, they leave the
// trained range furthest.
Json worth_a_look(const Json& per_frame) {
  constexpr std::size_t kMost = 3;
  std::vector<double> expected, outside;
  for (const Json& entry : per_frame) {
    expected.push_back(entry.value("expected_rms_mm", 0.0));
    outside.push_back(entry.value("outside", 0.0));
  }
  const bool is_known = std::ranges::any_of(expected, [](double mm) { return mm > 0; });
  Json list = Json::array();
  for (const std::size_t k :
       worth_simulating(is_known ? expected : outside, kMost, spreading_gap(per_frame.size(), kMost))) {
    list.push_back({{"frame", per_frame[k].at("frame")}, {"expected_rms_mm", expected[k]}, {"outside", outside[k]}});
  }
  return list;
}

std::vector<int> frame_numbers(const Json& list) {
  return transformed(list, [&](const Json& entry) { return entry.at("frame").get<int>(); });
}

// The joint that stands nearest to a vertex at rest.
std::string nearest_joint(const Basis& basis, std::uint32_t vertex) {
  const float* x = &basis.mesh.rest[std::size_t{3} * vertex];
  const auto squared_distance = [&](std::size_t joint) {
    const Vec3 place = bind_place(basis.skeleton, joint);
    double sum = 0;
    for (std::size_t i = 0; i < 3; ++i) sum += std::pow(static_cast<double>(x[i]) - place[i], 2);
    return sum;
  };
  const auto joints = std::views::iota(std::size_t{0}, basis.skeleton.size());
  return basis.skeleton.joints[*std::ranges::min_element(joints, {}, squared_distance)].name;
}

constexpr double kNoted = 0.95;  // of what was learned: more is hardly seen

}  // namespace

EvaluationLog::EvaluationLog(const Basis& basis) {
  if (!basis.coverage.empty()) expectation_.emplace(basis);
}

void EvaluationLog::add(const Deformer& deformer, const Evaluation& part, std::span<const int> frames,
                        const NodeMotion& motion) {
  for (std::size_t k = 0; k < frames.size(); ++k) {
    Json entry = entry_of(deformer, part, k, frames[k], motion);
    if (expectation_) {
      const ExpectedError expected = expectation_->of(part, k);
      entry["expected_rms_mm"] = expected.rms_mm;
      if (expected.ddm_rms_mm > 0) entry["expected_ddm_rms_mm"] = expected.ddm_rms_mm;
    }
    count(entry);
    per_frame_.push_back(std::move(entry));
  }
  timed_frames_ += frames.size();
  stage_seconds_.add(part.stage_seconds);
  for (const auto& [name, seconds] : kHostParts) host_seconds_.*seconds += part.host_seconds.*seconds;
}

Json EvaluationLog::entry_of(const Deformer& deformer, const Evaluation& part, std::size_t k, int frame,
                             const NodeMotion& motion) {
  Json entry{{"frame", frame}, {"outside", part.outside[k]}};
  fades_.add(deformer.basis().skeleton, part, k, frame, entry);
  if (part.outside[k] > 0) {
    entry["outside_feature"] = feature_name(deformer.basis(), part.outside_feature[k]);
    entry["outside_by"] = outside_text(deformer.basis(), part.outside_feature[k], part.outside_by[k]);
  }
  if (part.starts.empty()) return entry;
  starts_[part.starts[k]].push_back(frame);
  const JiggleMeasure measure = measure_jiggle(*deformer.dynamics(), motion);
  entry["jiggle_rms_mm"] = measure.rms_mm;
  entry["jiggle_max_mm"] = measure.max_mm;
  entry["inverted_tets"] = measure.inverted_tets;
  entry["jiggle_limited_vertices"] = measure.limited;
  if (measure.limited > 0) entry["jiggle_limited_near"] = nearest_joint(deformer.basis(), measure.most_limited);
  tets_ = deformer.dynamics()->tets.tet_count();
  return entry;
}

void EvaluationLog::count(const Json& entry) {
  const int frame = entry.at("frame");
  frames_.push_back(frame);
  if (const double outside = entry.at("outside"); outside > 0) {
    outside_frames_.push_back(frame);
    if (outside > worst_outside_) {
      worst_feature_ = entry.at("outside_feature");
      worst_by_ = entry.value("outside_by", std::string());  // not kept by earlier versions
    }
    worst_outside_ = std::max(worst_outside_, outside);
  }
  const auto inverted = entry.value("inverted_tets", std::uint32_t{0});
  if (inverted > 0) inverted_frames_.push_back(frame);
  most_inverted_ = std::max(most_inverted_, inverted);
  if (entry.value("jiggle_limited_vertices", std::size_t{0}) > 0) {
    limited_frames_.push_back(frame);
    ++limited_joints_[entry.at("jiggle_limited_near")];
  }
  const double jiggle = entry.value("jiggle_max_mm", 0.0);
  if (jiggle > most_jiggle_mm_) most_jiggle_frame_ = frame;
  most_jiggle_mm_ = std::max(most_jiggle_mm_, jiggle);
  if (!entry.contains("expected_rms_mm")) return;
  const double expected = expected_mm_.emplace_back(entry.at("expected_rms_mm"));
  const double of_ddm = entry.value("expected_ddm_rms_mm", 0.0);
  if (of_ddm > kSeenMm && expected > kAsBad * of_ddm) no_better_frames_.push_back(frame);
  if (expected > most_expected_mm_) most_expected_frame_ = frame;
  most_expected_mm_ = std::max(most_expected_mm_, expected);
}

double EvaluationLog::milliseconds_per_frame(double seconds) const {
  return 1e3 * seconds / static_cast<double>(std::max<std::size_t>(1, timed_frames_));
}

// A line for each way to start anew, however many frames do.
std::vector<std::string> EvaluationLog::notes() const {
  std::vector<std::string> notes;
  for (const auto& [start, frames] : starts_) {
    std::optional<std::string> note = describe(start, frames.front());
    if (!note) continue;
    if (frames.size() > 1) {
      *note += "; so in frames " + format_frame_range({frames.begin() + 1, frames.end()}) + ", too";
    }
    notes.push_back(*note);
  }
  return notes;
}

Json EvaluationLog::kept() const {
  Json starts = Json::array();
  for (const auto& [start, frames] : starts_) starts.push_back({static_cast<int>(start), frames});
  return {{"per_frame", per_frame_}, {"starts", starts}, {"tets", tets_}};
}

void EvaluationLog::take_up(const Json& kept) {
  per_frame_ = kept.at("per_frame");
  for (const Json& start : kept.at("starts")) {
    starts_[static_cast<JiggleStart>(start.at(0).get<int>())] = start.at(1).get<std::vector<int>>();
  }
  tets_ = kept.at("tets");
  for (const Json& entry : per_frame_) {
    fades_.add(entry.at("frame"), entry);
    count(entry);
  }
}

// By name; the rig's are among the stages'.
Json EvaluationLog::host_milliseconds() const {
  Json milliseconds = Json::object();
  for (const auto& [name, seconds] : kHostParts) milliseconds[name] = milliseconds_per_frame(host_seconds_.*seconds);
  milliseconds["write"] = milliseconds_per_frame(writing_seconds_);
  return milliseconds;
}

Json EvaluationLog::summary() const {
  Json milliseconds = Json::object();
  stage_seconds_.for_each([&](const StageDescription& stage, double seconds) {
    milliseconds[stage.name] = milliseconds_per_frame(seconds);
  });
  const Json worst = worth_a_look(per_frame_);
  Json result{{"frames", frames_.size()},
              {"milliseconds_per_frame", milliseconds},
              {"host_milliseconds_per_frame", host_milliseconds()},
              {"peak_memory_mib", peak_memory_mib()},
              {"outside_frames", format_frame_range(outside_frames_)},
              {"worst_outside", worst_outside_},
              {"worst_outside_feature", worst_feature_},
              {"worst_outside_by", worst_by_},
              {"worst_frames", frame_numbers(worst)},
              {"worth_a_look", worst}};
  if (most_expected_mm_ > 0) result["worst_expected_rms_mm"] = most_expected_mm_;
  result["no_better_than_ddm_frames"] = format_frame_range(no_better_frames_);
  return result;
}

Json EvaluationLog::result() const {
  Json result = summary();
  result["notes"] = notes();
  result["per_frame"] = per_frame_;
  return result;
}

std::string EvaluationLog::text() const {
  std::string text;
  stage_seconds_.for_each([&](const StageDescription& stage, double seconds) {
    text += format("  {:8} {:8.3f} ms a frame\n", stage.name, milliseconds_per_frame(seconds));
  });
  text += "  on the host:";
  const Json host = host_milliseconds();
  for (const auto& [name, milliseconds] : host.items()) {
    text += format(" {} {:.3f}", name, milliseconds.get<double>());
  }
  text += " ms a frame\n";
  if (worst_outside_ >= kOutsideWorthTelling) {
    text += count_of(outside_frames_.size(), "frame leaves", "frames leave") +
            format(" the trained range (most of all {}{}), clamped: ", worst_feature_,
                   worst_by_.empty() ? "" : ", by " + worst_by_) +
            format_frame_range(outside_frames_) + "\n";
  }
  text += fades_.text();
  if (most_expected_mm_ > 0) {
    text += format("expected error: {:.3f} mm RMS, most in frame {}: {:.3f} mm", root_mean_square(expected_mm_),
                   most_expected_frame_, most_expected_mm_);
    // Judged by cross-validation of the training frames: of other poses nothing tells how far off even DDM is.
    if (!fades_.empty()) {
      text += "; poses that training did not show can be further off: test compares with their shapes";
    }
    text += "\n";
  }
  if (!no_better_frames_.empty()) {
    text += "no better than Direct Delta Mush alone is to be expected in " +
            count_of(no_better_frames_.size(), "frame", "frames") + ": " + format_frame_range(no_better_frames_) + "\n";
  }
  if (most_jiggle_mm_ > 0) {
    text +=
        format("the jiggle moves the skin by {:.2f} mm at most, in frame {}\n", most_jiggle_mm_, most_jiggle_frame_);
  }
  if (!limited_frames_.empty()) {
    std::vector<std::string> joints;
    for (const auto& [joint, count] : limited_joints_) joints.push_back(joint);
    text += "skin near " + list_names(joints) + " would go further than its limit, a share of the body's thickness " +
            "there ('limit' of jiggle.json), and is held short of it: " + format_frame_range(limited_frames_) + "\n";
  }
  if (!inverted_frames_.empty()) {
    text += count_of(inverted_frames_.size(), "frame has", "frames have") +
            format(" tetrahedra that are inside out before they jiggle, {} of {} at most: ", most_inverted_, tets_) +
            format_frame_range(inverted_frames_) + "\n";
  }
  for (const std::string& note : notes()) text += note + "\n";
  return text;
}

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
  const auto most = std::ranges::max_element(joints_, {}, [](const auto& joint) { return joint.second; });
  return count_of(frames_.size(), "frame holds a pose", "frames hold poses") +
         format(
             " that training did not show (most of all of {}); there the correction fades, to {:.0f} % at the least: "
             "{}\n",
             most->first, 100 * least_, format_frame_range(frames_));
}

}  // namespace bodyopt::cli
