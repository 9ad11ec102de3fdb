#include "cli/results/evaluation_log.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "base/frame_range.h"
#include "base/wording.h"
#include "runtime/basis/dynamics.h"
#include "runtime/core/transformed.h"
#include "runtime/deformer/deformer.h"
#include "runtime/deformer/evaluation.h"
#include "trainer/dynamics/jiggle.h"
#include "trainer/train/coverage/coverage.h"

namespace bodyopt::cli {
namespace {

constexpr double kSeenMm = 0.5;  // errors of Direct Delta Mush below are nobody's concern
constexpr double kAsBad = 0.9;   // of the error of Direct Delta Mush: what is left out would hardly be seen

Json json_of(const FrameEntry& entry) {
  Json json{
      {"frame", entry.frame}, {"outside", entry.outside}, {"fade", entry.fade}, {"fading_joint", entry.fading_joint}};
  if (!entry.outside_feature.empty()) json["outside_feature"] = entry.outside_feature;
  if (!entry.outside_by.empty()) json["outside_by"] = entry.outside_by;
  if (entry.jiggle) {
    json["jiggle_rms_mm"] = entry.jiggle->rms_mm;
    json["jiggle_max_mm"] = entry.jiggle->max_mm;
    json["inverted_tets"] = entry.jiggle->inverted_tets;
    json["jiggle_limited_vertices"] = entry.jiggle->limited_vertices;
    if (entry.jiggle->limited_vertices > 0) json["jiggle_limited_near"] = entry.jiggle->limited_near;
  }
  if (entry.expected_rms_mm) json["expected_rms_mm"] = *entry.expected_rms_mm;
  if (entry.expected_ddm_rms_mm > 0) json["expected_ddm_rms_mm"] = entry.expected_ddm_rms_mm;
  return json;
}

FrameEntry read_entry(const Json& json) {
  FrameEntry entry{.frame = json.at("frame"),
                   .outside = json.at("outside"),
                   .outside_feature = json.value("outside_feature", ""),
                   .outside_by = json.value("outside_by", ""),
                   .fade = json.at("fade"),
                   .fading_joint = json.at("fading_joint"),
                   .expected_ddm_rms_mm = json.value("expected_ddm_rms_mm", 0.0)};
  if (json.contains("jiggle_max_mm")) {
    entry.jiggle = {.rms_mm = json.value("jiggle_rms_mm", 0.0),
                    .max_mm = json.at("jiggle_max_mm"),
                    .inverted_tets = json.value("inverted_tets", 0u),
                    .limited_vertices = json.value("jiggle_limited_vertices", 0u),
                    .limited_near = json.value("jiggle_limited_near", "")};
  }
  if (json.contains("expected_rms_mm")) entry.expected_rms_mm = json.at("expected_rms_mm");
  return entry;
}

using Frames = std::vector<FrameEntry>;

double expected_of(const FrameEntry& entry) { return entry.expected_rms_mm.value_or(0); }
double most_jiggle_of(const FrameEntry& entry) { return entry.jiggle ? entry.jiggle->max_mm : 0; }
bool is_inverted(const FrameEntry& entry) { return entry.jiggle && entry.jiggle->inverted_tets > 0; }
bool is_limited(const FrameEntry& entry) { return entry.jiggle && entry.jiggle->limited_vertices > 0; }
bool is_outside(const FrameEntry& entry) { return entry.outside > 0; }
bool is_no_better(const FrameEntry& entry) {
  return entry.expected_rms_mm && entry.expected_ddm_rms_mm > kSeenMm &&
         *entry.expected_rms_mm > kAsBad * entry.expected_ddm_rms_mm;
}

std::vector<int> numbers_of(const Frames& frames, bool (*is_wanted)(const FrameEntry&)) {
  std::vector<int> numbers;
  for (const FrameEntry& entry : frames) {
    if (is_wanted(entry)) numbers.push_back(entry.frame);
  }
  return numbers;
}

// The first of those with the most; one that tells nothing where there is no frame.
template <typename Measure>
FrameEntry worst_of(const Frames& frames, Measure measure) {
  return frames.empty() ? FrameEntry() : *std::ranges::max_element(frames, {}, measure);
}

// Frames worth a look, spread over the shot, are expected to be most wrong. Where that is not known, they leave the
// trained range furthest.
std::vector<FrameEntry> worth_a_look(const Frames& frames) {
  constexpr std::size_t kMost = 3;
  const bool is_known = expected_of(worst_of(frames, expected_of)) > 0;
  const std::vector<double> wrong =
      is_known ? transformed(frames, expected_of) : transformed(frames, &FrameEntry::outside);
  return transformed(trainer::worth_simulating(wrong, kMost, trainer::spreading_gap(frames.size(), kMost)),
                     [&](std::size_t k) { return frames[k]; });
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
  std::size_t nearest = 0;
  for (std::size_t joint = 1; joint < basis.skeleton.size(); ++joint) {
    if (squared_distance(joint) < squared_distance(nearest)) nearest = joint;
  }
  return basis.skeleton.joints[nearest].name;
}

constexpr double kNoted = 0.95;  // of what was learned: more is hardly seen

}  // namespace

EvaluationLog::EvaluationLog(const Basis& basis) {
  if (!basis.coverage.empty()) expectation_.emplace(basis);
}

void EvaluationLog::add(const Deformer& deformer, const Evaluation& part, std::span<const int> frames,
                        const NodeMotion& motion) {
  for (std::size_t k = 0; k < frames.size(); ++k) {
    frames_.push_back(entry_of(deformer, part, k, frames[k], motion));
    if (part.starts.empty()) continue;
    starts_[part.starts[k]].push_back(frames[k]);
    tets_ = deformer.dynamics()->tets.tet_count();
  }
  timed_frames_ += frames.size();
  stage_seconds_.add(part.stage_seconds);
  for (const auto& [name, seconds] : kHostParts) host_seconds_.*seconds += part.host_seconds.*seconds;
}

FrameEntry EvaluationLog::entry_of(const Deformer& deformer, const Evaluation& part, std::size_t k, int frame,
                                   const NodeMotion& motion) const {
  const Basis& basis = deformer.basis();
  const int joint = part.fading_joint[k];
  FrameEntry entry{.frame = frame, .outside = static_cast<double>(part.outside[k]), .fade = mean_fade(part, k)};
  if (joint >= 0) entry.fading_joint = basis.skeleton.joints[static_cast<std::size_t>(joint)].name;
  if (entry.outside > 0) {
    entry.outside_feature = feature_name(basis, part.outside_feature[k]);
    entry.outside_by = outside_text(basis, part.outside_feature[k], part.outside_by[k]);
  }
  if (!part.starts.empty()) {
    const trainer::JiggleMeasure measure = trainer::measure_jiggle(*deformer.dynamics(), motion);
    entry.jiggle = {.rms_mm = measure.rms_mm,
                    .max_mm = measure.max_mm,
                    .inverted_tets = measure.inverted_tets,
                    .limited_vertices = measure.limited};
    if (measure.limited > 0) entry.jiggle->limited_near = nearest_joint(basis, measure.most_limited);
  }
  if (!expectation_) return entry;
  const ExpectedError expected = expectation_->of(part, k);
  entry.expected_rms_mm = expected.rms_mm;
  entry.expected_ddm_rms_mm = expected.ddm_rms_mm;
  return entry;
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
  return {{"per_frame", transformed(frames_, json_of)}, {"starts", starts}, {"tets", tets_}};
}

void EvaluationLog::take_up(const Json& kept) {
  frames_ = transformed(kept.at("per_frame"), read_entry);
  for (const Json& start : kept.at("starts")) {
    starts_[static_cast<JiggleStart>(start.at(0).get<int>())] = start.at(1).get<std::vector<int>>();
  }
  tets_ = kept.at("tets");
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
  const FrameEntry worst = worst_of(frames_, &FrameEntry::outside);
  const std::vector<FrameEntry> worth = worth_a_look(frames_);
  Json result{
      {"frames", frames_.size()},
      {"milliseconds_per_frame", milliseconds},
      {"host_milliseconds_per_frame", host_milliseconds()},
      {"peak_memory_mib", peak_memory_mib()},
      {"outside_frames", format_frame_range(numbers_of(frames_, is_outside))},
      {"worst_outside", worst.outside},
      {"worst_outside_feature", worst.outside_feature},
      {"worst_outside_by", worst.outside_by},
      {"worst_frames", transformed(worth, &FrameEntry::frame)},
      {"worth_a_look", transformed(worth, [](const FrameEntry& entry) {
         return Json{{"frame", entry.frame}, {"expected_rms_mm", expected_of(entry)}, {"outside", entry.outside}};
       })}};
  if (const double most = expected_of(worst_of(frames_, expected_of)); most > 0) result["worst_expected_rms_mm"] = most;
  result["no_better_than_ddm_frames"] = format_frame_range(numbers_of(frames_, is_no_better));
  return result;
}

Json EvaluationLog::result() const {
  Json result = summary();
  result["notes"] = notes();
  result["per_frame"] = transformed(frames_, json_of);
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
  if (const FrameEntry worst = worst_of(frames_, &FrameEntry::outside); worst.outside >= double{kOutsideWorthTelling}) {
    const std::vector<int> outside = numbers_of(frames_, is_outside);
    text += count_of(outside.size(), "frame leaves", "frames leave") +
            format(" the trained range (most of all {}{}), clamped: ", worst.outside_feature,
                   worst.outside_by.empty() ? "" : ", by " + worst.outside_by) +
            format_frame_range(outside) + "\n";
  }
  FadeLog fades;
  for (const FrameEntry& entry : frames_) fades.add(entry.frame, entry.fade, entry.fading_joint);
  text += fades.text();
  if (const FrameEntry worst = worst_of(frames_, expected_of); expected_of(worst) > 0) {
    text += format("expected error: {:.3f} mm RMS, most in frame {}: {:.3f} mm",
                   trainer::root_mean_square(transformed(frames_, expected_of)), worst.frame, expected_of(worst));
    // Judged by cross-validation of the training frames: of other poses nothing tells how far off even DDM is.
    if (!fades.empty()) {
      text += "; poses that training did not show can be further off: test compares with their shapes";
    }
    text += "\n";
  }
  if (const std::vector<int> no_better = numbers_of(frames_, is_no_better); !no_better.empty()) {
    text += "no better than Direct Delta Mush alone is to be expected in " +
            count_of(no_better.size(), "frame", "frames") + ": " + format_frame_range(no_better) + "\n";
  }
  if (const FrameEntry most = worst_of(frames_, most_jiggle_of); most_jiggle_of(most) > 0) {
    text += format("the jiggle moves the skin by {:.2f} mm at most, in frame {}\n", most_jiggle_of(most), most.frame);
  }
  if (const std::vector<int> limited = numbers_of(frames_, is_limited); !limited.empty()) {
    std::set<std::string> joints;
    for (const FrameEntry& entry : frames_) {
      if (is_limited(entry)) joints.insert(entry.jiggle->limited_near);
    }
    text += "skin near " + list_names(std::vector<std::string>(joints.begin(), joints.end())) +
            " would go further than its limit, a share of the body's thickness there ('limit' of jiggle.json), and is "
            "held short of it: " +
            format_frame_range(limited) + "\n";
  }
  if (const std::vector<int> inverted = numbers_of(frames_, is_inverted); !inverted.empty()) {
    const FrameEntry most =
        worst_of(frames_, [](const FrameEntry& e) { return e.jiggle ? e.jiggle->inverted_tets : 0; });
    text += count_of(inverted.size(), "frame has", "frames have") +
            format(" tetrahedra that are inside out before they jiggle, {} of {} at most: ", most.jiggle->inverted_tets,
                   tets_) +
            format_frame_range(inverted) + "\n";
  }
  for (const std::string& note : notes()) text += note + "\n";
  return text;
}

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
