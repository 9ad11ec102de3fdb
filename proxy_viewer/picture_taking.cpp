#include "proxy_viewer/picture_taking.h"

#include <functional>
#include <utility>

namespace bodyopt {
namespace {

struct Finally {
  std::function<void()> action;
  ~Finally() { action(); }
};

}  // namespace

void PictureTaking::take_screenshot(const std::string& file) {
  painter_.settle();
  write_screenshot(
      file, [this] { return painter_.draw_still(painter_.size()); }, session_.controls);
}

void PictureTaking::take_sequence(const std::string& pattern) {
  make(frame_series(pattern, session_.scene.lead().clip().fps, session_.controls));
}

void PictureTaking::take_turntable(const std::string& pattern) { make(turntable_series(pattern, session_.controls)); }

void PictureTaking::make(std::unique_ptr<PictureSeries> series) {
  painter_.set_series(true);
  if (session_.controls.headless) {
    const Finally ends{[this] { painter_.set_series(false); }};
    return make_all(*series, [this] { return painter_.draw_still(painter_.size()); });
  }
  series_ = std::move(series);
  series_size_ = painter_.size();
  stops_ = false;
}

void PictureTaking::go_on() {
  bool goes_on = false;
  if (std::exchange(stops_, false)) {
    session_.controls.say("stopped after " + std::to_string(series_->made()) + " of " +
                          std::to_string(series_->count()) + " pictures");
  } else {
    session_.controls.attempt([&] { goes_on = series_->make_next([this] { return draw_playblast(); }); });
  }
  if (goes_on) return;
  series_.reset();
  painter_.set_series(false);
}

void PictureTaking::show_progress() {
  painter_.show_message(std::to_string(series_->made()) + " of " + std::to_string(series_->count()) +
                        " pictures: Escape stops");
}

Image PictureTaking::draw_playblast() {
  Controls& controls = session_.controls;
  bool* const shown[] = {&controls.panels, &controls.settings.hud.on, &controls.cheat_sheet, &controls.prompt};
  std::array<bool, std::size(shown)> before;
  for (std::size_t k = 0; k < before.size(); ++k) before[k] = std::exchange(*shown[k], false);
  const Finally put_back{[&] {
    for (std::size_t k = 0; k < before.size(); ++k) *shown[k] = before[k];
  }};
  return painter_.draw_still(series_size_);
}

}  // namespace bodyopt
