#include "viewport/compare/error_measuring.h"

#include <algorithm>
#include <bit>
#include <chrono>
#include <cmath>

#include "dataset/compare.h"
#include "runtime/basis/output_order.h"
#include "runtime/core/error.h"
#include "runtime/cpu/kernels.h"
#include "shots/session/view_settings.h"

namespace bodyopt::viewport {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::chrono::milliseconds kAtRest{20}, kWhilePlaying{4};  // between events, between pictures
constexpr double kNearVertex = 0.5;                                 // distance of the camera, of the character's size

SkinMethod without_past(SkinMethod method) { return method == SkinMethod::jiggle ? SkinMethod::full : method; }

}  // namespace

FrameError frame_error(std::span<const float> shown, std::span<const float> compared) {
  ErrorAccumulator accumulator(static_cast<std::uint32_t>(shown.size() / 3));
  accumulator.add(0, shown, compared);
  const ErrorStatistics error = accumulator.finish();
  const float* const at = shown.data() + 3 * std::size_t{error.worst_vertex};
  return {static_cast<float>(error.rms),
          static_cast<float>(error.max),
          static_cast<float>(error.p99),
          error.worst_vertex,
          {at[0], at[1], at[2]}};
}

bool ErrorCurve::look_at(const Actor& character, const shots::ViewSettings& settings) {
  const std::optional<SkinMethod> compared = compared_method(character, settings);
  std::optional<Subject> subject;
  if (compared) {
    subject = {without_past(shown_method(character, settings)), without_past(*compared), settings.pose};
    if (subject->shown == subject->compared) subject.reset();
  }
  if (subject == subject_) return false;
  subject_ = subject;
  begin(subject ? character.clip().poses.size() : 0);
  return true;
}

void ErrorCurve::forget() {
  subject_.reset();
  begin(0);
}

void ErrorCurve::begin(std::size_t count) {
  errors_.assign(count, {});
  is_measured_.assign(count, false);
  measured_ = cursor_ = 0;
  stride_ = std::bit_floor(count);
}

std::optional<std::size_t> ErrorCurve::next(std::optional<std::size_t> wanted) {
  if (wanted && !is_measured_[*wanted]) return wanted;
  for (; stride_ > 0; stride_ /= 2, cursor_ = 0) {
    for (; cursor_ < is_measured_.size(); cursor_ += stride_) {
      if (!is_measured_[cursor_]) return cursor_;
    }
  }
  return std::nullopt;
}

bool ErrorCurve::measure_next(Actor& character, int frame) {
  const std::int64_t offset = std::int64_t{frame} - character.clip().first_frame;
  const bool within = offset >= 0 && offset < static_cast<std::int64_t>(errors_.size());
  const std::optional<std::size_t> index =
      next(within ? std::optional(static_cast<std::size_t>(offset)) : std::nullopt);
  if (!index) return false;
  is_measured_[*index] = true;
  ++measured_;
  const int number = character.clip().first_frame + static_cast<int>(*index);
  if (subject_->compared == SkinMethod::truth && !character.has_sample_at(number)) return true;
  const Pose pose = character.pose(number, subject_->posing);
  const auto correction = static_cast<float>(subject_->posing.correction);
  try {
    const std::vector<float> shown = character.measure(subject_->shown, pose, number, correction);
    const std::vector<float> compared = character.measure(subject_->compared, pose, number, correction);
    errors_[*index] = frame_error(shown, compared);
  } catch (...) {
    is_measured_.assign(errors_.size(), true);
    measured_ = errors_.size();
    throw;
  }
  return true;
}

std::optional<float> ErrorCurve::largest_p99() const {
  std::optional<float> largest;
  for (const FrameError& error : errors_) {
    if (std::isfinite(error.p99)) largest = std::max(largest.value_or(0), error.p99);
  }
  return largest;
}

std::optional<std::size_t> ErrorCurve::worst() const {
  std::optional<std::size_t> worst;
  for (std::size_t k = 0; k < errors_.size(); ++k) {
    if (std::isfinite(errors_[k].rms) && (!worst || errors_[k].rms > errors_[*worst].rms)) worst = k;
  }
  return worst;
}

double round_heat(double mm) {
  constexpr double kFinestAutomatic = 0.1;  // of what is equal, noise shall not glow
  constexpr double kRounding = 1.001;       // 5 mm in single precision are 5 mm
  const double wanted = std::clamp(mm, kFinestAutomatic, shots::kCoarsestHeat);
  const double power = std::pow(10, std::floor(std::log10(wanted * kRounding)));
  for (const double step : {1.0, 2.0, 5.0}) {
    if (step * power * kRounding >= wanted) return step * power;
  }
  return 10 * power;
}

double HeatScale::choose(std::optional<double> p99_mm, bool playing) {
  if (!p99_mm) return mm_;
  const double mm = round_heat(*p99_mm);
  mm_ = playing && is_chosen_ ? std::max(mm_, mm) : mm;
  is_chosen_ = true;
  return mm_;
}

// Coarser levels of detail are there to keep up.
// Live poses are of no frame.
bool ErrorMeasuring::is_possible() const { return !controls_.live.value_or(false) && scene_.lead().level() == 0; }

std::size_t ErrorMeasuring::shown_index() const {
  return static_cast<std::size_t>(controls_.playback.frame() - scene_.lead().clip().first_frame);
}

void ErrorMeasuring::look() {
  if (is_possible() && curve_.look_at(scene_.lead(), controls_.settings)) controls_.marker.reset();
}

bool ErrorMeasuring::has_work() const {
  return is_possible() && !curve_.is_complete() && (while_playing_ || !controls_.playback.playing());
}

void ErrorMeasuring::measure_some() {
  look();
  if (!has_work()) return;
  const Clock::time_point end = Clock::now() + (controls_.playback.playing() ? kWhilePlaying : kAtRest);
  while (measure_next() && Clock::now() < end) {
  }
}

void ErrorMeasuring::measure_shown_frame() {
  look();
  const std::size_t index = shown_index();
  if (is_possible() && index < curve_.errors().size() && !curve_.is_measured(index)) measure_next();
}

const FrameError* ErrorMeasuring::shown_error() const {
  const std::size_t index = shown_index();
  const bool is_known = index < curve_.errors().size() && std::isfinite(curve_.errors()[index].rms);
  return is_known ? &curve_.errors()[index] : nullptr;
}

void ErrorMeasuring::measure_all() {
  look();
  while (is_possible() && measure_next()) {
  }
}

void ErrorMeasuring::require_comparison() {
  look();
  if (!is_possible() || curve_.errors().empty()) {
    throw Error(ErrorKind::usage,
                "nothing is compared: begin with 'compare ddm', or 'compare truth' where there is one");
  }
}

void ErrorMeasuring::go_to_worst_frame() {
  require_comparison();
  controls_.playback.pause();
  while (!curve_.worst() && measure_next()) {
  }
  const std::optional<std::size_t> worst = curve_.worst();
  if (!worst) throw Error(ErrorKind::usage, "no frame could be measured: has the cache samples of the clip's frames?");
  controls_.playback.scrub(scene_.lead().clip().first_frame + static_cast<int>(*worst));
  if (curve_.is_complete()) return;
  controls_.say("worst of " + std::to_string(curve_.measured_count()) + " of " +
                std::to_string(curve_.errors().size()) + " frames measured");
}

void ErrorMeasuring::go_to_worst_vertex() {
  require_comparison();
  controls_.playback.pause();
  measure_shown_frame();
  const FrameError* const error = shown_error();
  if (!error) throw Error(ErrorKind::usage, "there is nothing to compare with in this frame");
  controls_.marker = Marker{controls_.playback.frame(), error->worst};
  shots::OrbitView view = controls_.camera.view();
  view.target = error->worst;
  view.distance = kNearVertex * scene_.lead().size();
  // Quasi-static, as the error is.
  const MeshTable& mesh = scene_.lead().finest_basis().mesh;
  const Vec3 normal = normal_at(mesh, scene_.lead_skin(controls_), error->worst_vertex);
  if (length(normal) > 0) {
    view.azimuth = std::atan2(normal[0], normal[2]);
    view.elevation = std::asin(std::clamp(normal[1], -1.0, 1.0));
  }
  controls_.camera = OrbitCamera(view);
}

Vec3 normal_at(const MeshTable& mesh, std::span<const float> output, std::uint32_t vertex) {
  const std::vector<float> vertices = vertices_of(mesh, output);
  std::vector<float> normals(vertices.size());
  cpu::output_normals(mesh, vertices, normals);
  const float* const at = normals.data() + std::size_t{3} * mesh.output_vertex[vertex];
  return {at[0], at[1], at[2]};
}

}  // namespace bodyopt::viewport
