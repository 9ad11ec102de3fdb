#include "proxy_viewer/compare/error_measuring.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "runtime/basis/output_order.h"
#include "runtime/core/error.h"
#include "runtime/cpu/kernels.h"

namespace bodyopt {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::chrono::milliseconds kAtRest{20}, kWhilePlaying{4};  // between events, between pictures
constexpr double kNearVertex = 0.5;                                 // distance of the camera, of the character's size

}  // namespace

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

// Quasi-static, as the error is.
Vec3 ErrorMeasuring::worst_normal(const FrameError& error) {
  return normal_at(scene_.lead().finest_basis().mesh, scene_.lead_skin(controls_), error.worst_vertex);
}

void ErrorMeasuring::go_to_worst_vertex() {
  require_comparison();
  controls_.playback.pause();
  measure_shown_frame();
  const FrameError* const error = shown_error();
  if (!error) throw Error(ErrorKind::usage, "there is nothing to compare with in this frame");
  controls_.marker = Marker{controls_.playback.frame(), error->worst};
  OrbitView view = controls_.camera.view();
  view.target = error->worst;
  view.distance = kNearVertex * scene_.lead().size();
  if (const Vec3 normal = worst_normal(*error); length(normal) > 0) {
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

}  // namespace bodyopt
