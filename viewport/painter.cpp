#include "viewport/painter.h"

#include <imgui.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <iterator>
#include <ranges>
#include <utility>
#include <vector>

#include "runtime/core/error.h"
#include "viewport/describe_scene.h"
#include "viewport/mouse.h"
#include "viewport/panels/panels.h"

namespace bodyopt::viewport {
namespace {

double resident_mib() {
  std::ifstream file("/proc/self/statm");
  double pages = 0, resident = 0;
  file >> pages >> resident;
  return resident * static_cast<double>(sysconf(_SC_PAGESIZE)) / (1 << 20);
}

std::uint32_t in_points(std::uint32_t pixels, float scale) {
  return static_cast<std::uint32_t>(std::lround(static_cast<float>(pixels) / scale));
}

draw::Rectangle in_pixels(const draw::Rectangle& points, float scale) {
  const auto pixels = [&](auto length) { return std::lround(static_cast<float>(length) * scale); };
  return {static_cast<std::int32_t>(pixels(points.x)), static_cast<std::int32_t>(pixels(points.y)),
          static_cast<std::uint32_t>(pixels(points.width)), static_cast<std::uint32_t>(pixels(points.height))};
}

}  // namespace

Painter::Painter(const std::shared_ptr<const vulkan::Device>& device, Session& session, ErrorMeasuring& errors,
                 Screen* screen, const PictureSize& size)
    : is_software_(device->info().type == "cpu"),
      session_(session),
      errors_(errors),
      screen_(screen),
      size_(size),
      canvas_(*device) {
  gui_.attach(*device, canvas_.panel_pass(), screen ? screen->handle() : nullptr);
}

PictureSize Painter::size() const {
  if (!screen_) return size_;
  const auto [width, height] = screen_->size();
  const std::uint32_t larger = std::max(width, height), most = canvas_.most_pixels();
  if (larger <= most) return {width, height};
  const auto scaled = [&](std::uint32_t side) {
    return static_cast<std::uint32_t>((std::uint64_t{side} * most + larger - 1) / larger);
  };
  return {scaled(width), scaled(height)};
}

bool Painter::is_minimised() const {
  const auto [width, height] = size();
  return width == 0 || height == 0;
}

bool Painter::is_busy() const {
  return controls_.playback.playing() || ImGui::IsMouseDown(0) || ImGui::IsMouseDown(1) || ImGui::IsMouseDown(2);
}

void Painter::draw(const PictureSize& size, draw::Edges edges, double passed) {
  const Clock::time_point start = Clock::now();
  controls_.follow_keys();
  session_.warn_of_truth_times();
  session_.curation.look(scene_, controls_);
  controls_.attempt([&] { session_.matching.look(); });
  controls_.attempt([&] { session_.sectioning.look(is_busy()); });
  scene_.lead().show_raw(controls_.curating.raw);
  if (controls_.headless) errors_.measure_shown_frame();
  controls_.attempt([&] { choose_heat(); });
  draw_panels_over(size, passed);
  // A panel may have gone to another frame: the jiggle would start from the pose of the frame before.
  controls_.follow_keys();
  choose_level();
  // Panels stay where drawing fails: they can undo what was set.
  std::vector<draw::View> views;
  drawn_ = false;
  controls_.attempt([&] {
    views = scene_.look(controls_, area_);
    session_.image_plane.look(controls_, views);
    drawn_ = true;
  });
  const auto [width, height] = size;
  canvas_.draw(views, width, height, edges, [this](VkCommandBuffer commands) { gui_.record(commands); });
  describe_picture(scene_, snapshot_);
  describe_time(start);
  if (const auto problem = gui_.fonts().take_problem()) controls_.warn(*problem);
}

void Painter::draw_panels_over(const PictureSize& size, double passed) {
  const auto [width, height] = size;
  visit_texts(snapshot_, controls_, [this](const std::string& text) { gui_.fonts().show(text); });
  const PoseLibrary& poses = controls_.pose_library;
  if (std::exchange(shown_poses_, poses.version()) != poses.version()) gui_.fonts().show_pictures(poses.pictures());
  gui_.begin(width, height, passed, scale());
  if (!controls_.takes_series && !brush_by_mouse(session_.brushing, area_, controls_)) {
    steer_by_mouse(scene_, area_, height, controls_);
  }
  describe_turns(scene_, controls_, snapshot_);
  snapshot_.missed_pins = scene_.lead().missed_pins(controls_.playback.frame(), controls_.settings.pose);
  describe_comparison(scene_, controls_, errors_.curve(), snapshot_);
  session_.matching.describe(snapshot_);
  session_.sectioning.describe(area_, mouse_over_picture(), snapshot_);
  const Brushing& brushing = session_.brushing;
  const bool shows_stroke = brushing.is_pressed() || controls_.curating.colour == MapColour::sculpt;
  session_.curation.describe(controls_, snapshot_,
                             shows_stroke ? std::span(brushing.weights()) : std::span<const double>());
  const auto [area, over] = draw_panels(snapshot_, controls_, in_points(width, scale()), in_points(height, scale()));
  area_ = in_pixels(area, scale());
  draw_brush(session_.brushing, scene_, area_, controls_);
  if (!ImGui::IsAnyItemActive() && !controls_.grip) {
    controls_.key_by_itself();
    controls_.poses.note(controls_.settings, controls_.playback.frame());  // a drag is one step
  }
  const auto pixels = [&](float points) { return static_cast<std::uint32_t>(std::lround(points * scale())); };
  const Covered covered = {pixels(over.top), pixels(over.right), pixels(over.bottom), pixels(over.left)};
  gui_.end();
  session_.framing.follow();
  controls_.attempt([&] {
    if (controls_.requests.frame_selection) session_.framing.frame_selection(area_.width, area_.height, covered);
    session_.framing.keep_framed(area_.width, area_.height, covered);
  });
}

// Scales the lead's colours to what is measured so far; a series' pictures follow each other as in playing.
void Painter::choose_heat() {
  const bool covers = controls_.settings.compare.coverage && scene_.lead().shown().knows_coverage();
  std::optional<double> p99;
  if (covers) {
    p99 = scene_.expect(controls_).p99_mm;
  } else if (const std::optional<float> error = errors_.curve().largest_p99()) {
    p99 = static_cast<double>(*error);
  }
  controls_.automatic_heat_mm = heat_.choose(p99, controls_.playback.playing() || controls_.takes_series);
}

// While it plays, a level of detail that keeps up; but the finest, where what is looked at is of that alone. Of all but
// the lead one as coarse as their size in the picture allows.
void Painter::choose_level() {
  const shots::ViewSettings& s = controls_.settings;
  const bool all_finest = s.compare.with != shots::CompareWith::none || s.look.tets,
             matched = snapshot_.match.has_value();
  const bool lead_finest = all_finest || matched || (s.jiggle.on && scene_.lead().has_at_finest(SkinMethod::jiggle));
  // The most levels of any; characters with fewer show their coarsest.
  const std::size_t most_levels =
      std::ranges::max(scene_.cast() | std::views::transform([](const auto& one) { return one->level_count(); }));
  const std::size_t automatic =
      detail_.choose(1e-3 * snapshot_.frame_ms, controls_.playback.playing() && !lead_finest, most_levels);
  for (std::size_t c = 0; c < scene_.cast().size(); ++c) {
    const std::optional<int>& own = c == 0 ? s.look.level : controls_.placements[c].level;
    const std::optional<int>& asked = own ? own : s.look.level;
    const bool finest = c == 0 || all_finest || (matched && c == 1);
    const std::size_t by_size = finest ? 0 : scene_.level_by_size(c, controls_, area_.height);
    scene_.cast()[c]->set_level(asked ? static_cast<std::size_t>(*asked) : std::max(automatic, by_size));
  }
  snapshot_.level = scene_.lead().level();
  snapshot_.level_count = scene_.lead().level_count();
}

void Painter::describe_time(Clock::time_point start) {
  const auto seconds_from = [now = Clock::now()](Clock::time_point from) {
    return std::chrono::duration<double>(now - from).count();
  };
  const double interval = seconds_from(last_picture_);
  last_picture_ = Clock::now();
  snapshot_.shown_fps += 0.1 * ((interval > 0 && interval < 1 ? 1 / interval : 0) - snapshot_.shown_fps);
  snapshot_.frame_ms = 1e3 * seconds_from(start);
  snapshot_.draw_ms = 1e3 * canvas_.seconds();
  snapshot_.memory_mib = resident_mib();
}

draw::Image Painter::draw_still(const PictureSize& size) {
  std::vector<Message> messages = std::exchange(controls_.messages, {});
  controls_.attempt([&] { errors_.measure_shown_frame(); });
  draw(size, draw::Edges::smooth);
  std::swap(controls_.messages, messages);
  std::ranges::move(messages, std::back_inserter(controls_.messages));
  if (!drawn_) throw Error(ErrorKind::usage, "no picture was taken of what cannot be drawn");
  return canvas_.picture();
}

draw::Image Painter::draw_portrait(const shots::ViewSettings::PoseKey& pose) {
  canvas_.draw(scene_.portrait(pose, controls_, kPosePicture), kPosePicture, kPosePicture, draw::Edges::smooth);
  return canvas_.picture();
}

void Painter::settle() {
  for (int k = 0; k < 3; ++k) draw_still(size());
}

void Painter::show_message(const std::string& text) {
  if (!screen_ || is_minimised()) return;
  const std::vector<Message> messages = controls_.messages;
  controls_.say(text);
  for (int k = 0; k < 2; ++k) draw(size(), draw::Edges::quick);  // panels take their sizes from the first
  controls_.messages = messages;
  show();
}

void Painter::show_loading(const std::string& file) {
  if (!screen_) return;
  std::cerr << "loading " << file << "\n";
  if (is_minimised()) return;
  const auto [width, height] = size();
  const std::string text = "loading " + std::filesystem::path(file).filename().string() + "\xe2\x80\xa6";
  gui_.fonts().show(text);
  gui_.begin(width, height, 0, scale());
  draw_loading(text);
  gui_.end();
  canvas_.draw({}, width, height, draw::Edges::smooth, [this](VkCommandBuffer commands) { gui_.record(commands); });
  show();
}

}  // namespace bodyopt::viewport
