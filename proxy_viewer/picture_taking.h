// Pictures that are written: screenshots, sequences, turntables. In a window one by one, so that it answers.
#pragma once

#include <memory>
#include <string>

#include "proxy_viewer/painter.h"
#include "proxy_viewer/picture_files.h"

namespace bodyopt {

class PictureTaking {
 public:
  // Both must outlive it.
  PictureTaking(Painter& painter, Session& session) : painter_(painter), session_(session) {}

  // These throw Error(usage) for a name of another kind, Error(file), and for what cannot be drawn.
  void take_screenshot(const std::string& file);
  void take_sequence(const std::string& pattern);
  void take_turntable(const std::string& pattern);

  bool goes_on() const { return series_ != nullptr; }
  bool stops() const { return stops_; }
  // Before the next picture; what was written is kept.
  void stop() { stops_ = true; }
  // The next picture of those that go on, drawn without what is there to work with.
  void go_on();
  void show_progress();

 private:
  void make(std::unique_ptr<PictureSeries> series);
  Image draw_playblast();

  Painter& painter_;
  Session& session_;
  std::unique_ptr<PictureSeries> series_;  // that is being made
  PictureSize series_size_{};
  bool stops_ = false;
};

}  // namespace bodyopt
