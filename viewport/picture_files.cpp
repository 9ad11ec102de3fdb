#include "viewport/picture_files.h"

#include <algorithm>
#include <array>
#include <iomanip>
#include <numbers>
#include <set>
#include <span>
#include <sstream>
#include <utility>
#include <vector>

#include "assets/clips/clip_source.h"
#include "base/progress.h"
#include "runtime/core/atomic_file.h"
#include "runtime/core/error.h"
#include "runtime/threads/tbb_executor.h"

namespace bodyopt::viewport {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kTurntablePictures = 72;
constexpr double kTurntableStep = 2 * std::numbers::pi / static_cast<double>(kTurntablePictures);  // radians
constexpr const char* kNewScreenshot = "bodyopt.####.png";
constexpr const char *kMoving = ".webp", *kMovie = ".mp4";
constexpr const char* kKept = "the pictures that were written are kept";

struct Place {
  std::size_t begin, end;  // in the name
  std::size_t digits;
};

// %d, or %04d and the like with one or two digits of width.
std::optional<Place> percent_place(const std::string& name, std::size_t begin) {
  const std::size_t letter = std::min(name.find_first_not_of("0123456789", begin + 1), name.size());
  if (name[letter] != 'd') return {};
  const std::string width = name.substr(begin + 1, letter - begin - 1);
  if (width.empty()) return Place{begin, letter + 1, 1};
  if (width.front() != '0' || width.size() < 2 || width.size() > 3) return {};
  return Place{begin, letter + 1, std::stoul(width)};
}

// The first place for the frame.
std::optional<Place> find_place(const std::string& name) {
  for (std::size_t begin = 0; begin < name.size(); ++begin) {
    if (name[begin] == '#') {
      const std::size_t end = std::min(name.find_first_not_of('#', begin), name.size());
      return Place{begin, end, end - begin};
    }
    if (name[begin] != '%') continue;
    if (const auto place = percent_place(name, begin)) return place;
  }
  return {};
}

bool is_one_file(const std::string& file) {
  const std::string extension = lower_case_extension(file);
  return extension == kMoving || extension == kMovie;
}

struct Finally {
  std::function<void()> action;
  ~Finally() { action(); }
};

std::string free_name() {
  const FrameSequenceName name(kNewScreenshot, 2);
  int k = 1;
  while (fs::exists(name(k))) ++k;
  return name(k).string();
}

}  // namespace

FrameSequenceName::FrameSequenceName(const std::filesystem::path& pattern, std::size_t frame_count)
    : folder_(pattern.parent_path()), after_(pattern.filename().string()) {
  const auto refuse = [&](const std::string& problem) {
    throw Error(ErrorKind::usage, pattern.string() + ": " + problem +
                                      "; expected one place for the frame, for instance img.####.png or img.%04d.png");
  };
  const auto place = find_place(after_);
  if (!place && frame_count > 1) {
    refuse("is the name of one picture, and there are " + std::to_string(frame_count) + " frames");
  }
  if (!place) return;
  digits_ = std::max<std::size_t>(place->digits, 1);
  before_ = after_.substr(0, place->begin);
  after_.erase(0, place->end);
  if (find_place(after_)) refuse("has more than one place for the frame");
}

std::filesystem::path FrameSequenceName::operator()(int frame) const {
  if (digits_ == 0) return folder_ / after_;
  std::ostringstream name;
  name << before_ << std::setw(static_cast<int>(digits_)) << std::setfill('0') << std::internal << frame << after_;
  return folder_ / name.str();
}

void require_picture_name(const std::string& file, bool may_move) {
  if (lower_case_extension(file) == ".png" || (may_move && is_one_file(file))) return;
  throw Error(ErrorKind::usage,
              file + ": pictures are written as .png: one, or a sequence where the name has #### or %04d" +
                  (may_move ? "; or all frames as one that moves, .webp or .mp4" : ""));
}

void write_screenshot(const std::string& file, const DrawPicture& draw, Controls& controls) {
  const std::string name = file.empty() ? free_name() : file;
  require_picture_name(name, false);
  draw::write_png(draw(), name);
  controls.say("wrote " + name);
}

PictureSeries::PictureSeries(Plan plan, Controls& controls)
    : plan_(std::move(plan)), name_(plan_.pattern, plan_.milliseconds > 0 ? 1 : plan_.count), controls_(controls) {
  if (!(plan_.milliseconds > 0)) return;
  if (lower_case_extension(plan_.pattern) == kMovie) {
    const double fps = 1e3 / plan_.milliseconds;
    const shots::SoundFile& sound = controls.sound;
    const bool fits = controls.playback.speed() == 1;
    if (!fits && !sound.file.empty()) controls.warn(plan_.pattern + ": is without its sound, at another speed");
    movie_.emplace(plan_.pattern,
                   MovieFile::Plan{fps, plan_.count, fits ? sound.file : "", (sound.first - plan_.first) / fps});
  } else {
    animation_.emplace(plan_.milliseconds);
  }
}

PictureSeries::~PictureSeries() { plan_.put_back(); }

bool PictureSeries::make_next(const DrawPicture& draw) {
  plan_.place(made_);
  draw::Image picture = draw();
  if (animation_) {
    animation_->add(picture);
  } else if (movie_) {
    movie_->add(picture);
  } else {
    write(std::move(picture), name_(plan_.first + static_cast<int>(made_)));
  }
  if (++made_ < plan_.count) return true;
  finish();
  if (movie_) movie_->finish();
  if (animation_) {
    const std::vector<std::uint8_t> bytes = animation_->finish();
    write_file_atomically(plan_.pattern, std::as_bytes(std::span(bytes)));
  }
  controls_.say("wrote " + std::to_string(made_) + " pictures, " + name_(plan_.first).string());
  return false;
}

void PictureSeries::finish() {
  while (!writers_.empty()) take_writer();
}

void PictureSeries::take_writer() {
  std::future<void> writer = std::move(writers_.front());
  writers_.pop_front();
  writer.get();
}

void PictureSeries::write(draw::Image picture, fs::path file) {
  writers_.push_back(std::async(
      std::launch::async, [picture = std::move(picture), file = std::move(file)] { draw::write_png(picture, file); }));
  if (writers_.size() > thread_count()) take_writer();
}

bool shows_motion(const std::string& pattern) {
  const std::string name = fs::path(pattern).filename().string();  // folders may have any
  return is_one_file(pattern) || name.find_first_of("#%") != std::string::npos;
}

std::unique_ptr<PictureSeries> frame_series(const std::string& pattern, double fps, Controls& controls) {
  require_picture_name(pattern, true);
  Playback& playback = controls.playback;
  const bool flip_book = is_one_file(pattern), moves = shows_motion(pattern);
  playback.pause();
  const int shown = playback.frame(), first = moves ? playback.in() : shown, last = moves ? playback.out() : shown;
  return std::make_unique<PictureSeries>(
      PictureSeries::Plan{pattern, static_cast<std::size_t>(last - first + 1), first,
                          [&controls, first, moves](std::size_t k) {
                            controls.playback.scrub(first + static_cast<int>(k));
                            if (moves) controls.shot_frame.reset();  // a view that was moved by hand is not the shot's
                          },
                          [&playback, shown] { playback.scrub(shown); },  // the camera goes along again
                          flip_book ? 1e3 / fps / playback.speed() : 0},
      controls);
}

std::unique_ptr<PictureSeries> turntable_series(const std::string& pattern, Controls& controls) {
  require_picture_name(pattern, false);
  controls.playback.pause();
  const OrbitCamera before = controls.camera;
  return std::make_unique<PictureSeries>(PictureSeries::Plan{pattern, kTurntablePictures, 1,
                                                             [&controls, before](std::size_t k) {
                                                               controls.camera = before;
                                                               controls.camera.orbit(
                                                                   static_cast<double>(k) * kTurntableStep, 0);
                                                             },
                                                             [&controls, before] { controls.camera = before; }, 0},
                                         controls);
}

void make_all(PictureSeries& series, const DrawPicture& draw) {
  Progress progress("pictures", series.count(), series.is_one_file() ? "nothing is written" : kKept);
  while (series.make_next(draw)) progress.advance();
  progress.advance();
}

void PictureTaking::take_screenshot(const std::string& file) {
  painter_.settle();
  std::set<std::string> told;
  write_screenshot(
      file, [&] { return session_.controls.headless ? draw_and_tell(told) : painter_.draw_still(painter_.size()); },
      session_.controls);
}

void PictureTaking::take_sequence(const std::string& pattern) {
  make(frame_series(pattern, session_.scene.lead().clip().fps, session_.controls));
}

void PictureTaking::take_turntable(const std::string& pattern) { make(turntable_series(pattern, session_.controls)); }

// Draws a picture without a window. Tells each joint once, where it first misses its pin.
draw::Image PictureTaking::draw_and_tell(std::set<std::string>& told) {
  draw::Image picture = painter_.draw_still(painter_.size());
  for (const shots::MissedPin& pin : session_.snapshot.missed_pins) {
    if (!told.insert(pin.joint).second) continue;
    session_.controls.warn("frame " + std::to_string(session_.controls.playback.frame()) + ": " + shots::describe(pin));
  }
  return picture;
}

void PictureTaking::make(std::unique_ptr<PictureSeries> series) {
  session_.controls.takes_series = series->count() > 1;
  if (session_.controls.headless) {
    const Finally ends{[this] { session_.controls.takes_series = false; }};
    std::set<std::string> told;
    return make_all(*series, [&] { return draw_and_tell(told); });
  }
  series_ = std::move(series);
  series_size_ = painter_.size();
  stops_ = false;
}

void PictureTaking::go_on() {
  bool goes_on = false;
  if (std::exchange(stops_, false)) {
    session_.controls.attempt([&] {
      series_->finish();
      session_.controls.say("stopped after " + std::to_string(series_->made()) + " of " +
                            std::to_string(series_->count()) + " pictures" +
                            (series_->is_one_file() ? ": nothing is written" : ""));
    });
  } else {
    session_.controls.attempt([&] { goes_on = series_->make_next([this] { return draw_playblast(); }); });
  }
  if (goes_on) return;
  series_.reset();
  session_.controls.takes_series = false;
}

void PictureTaking::show_progress() {
  painter_.show_message(std::to_string(series_->made()) + " of " + std::to_string(series_->count()) +
                        " pictures: Escape stops");
}

draw::Image PictureTaking::draw_playblast() {
  Controls& controls = session_.controls;
  bool* const shown[] = {&controls.panels, &controls.settings.hud.on, &controls.cheat_sheet, &controls.prompt,
                         &controls.asks_to_save};
  std::array<bool, std::size(shown)> before;
  for (std::size_t k = 0; k < before.size(); ++k) before[k] = std::exchange(*shown[k], false);
  std::string recoverable = std::exchange(controls.recoverable, "");
  const Finally put_back{[&] {
    for (std::size_t k = 0; k < before.size(); ++k) *shown[k] = before[k];
    controls.recoverable = std::move(recoverable);
  }};
  return painter_.draw_still(series_size_);
}

}  // namespace bodyopt::viewport
