// Pictures on disk: one, one of every frame, one from all around. What was written before an interruption is kept.
#pragma once

#include <cstddef>
#include <deque>
#include <filesystem>
#include <functional>
#include <future>
#include <memory>
#include <optional>
#include <set>
#include <string>

#include "draw/animation.h"
#include "draw/png.h"
#include "viewport/movie_file.h"
#include "viewport/painter.h"

namespace bodyopt::viewport {

// A file name with a place for the frame: `img.####.png` (as many digits at least as there are #) or `img.%04d.png`.
// Both write a minus before the digits and count it among them.
class FrameSequenceName {
 public:
  // Without a place the name is that of a single picture. Throws Error(usage) for more than one place, and for
  // more than one frame without a place.
  FrameSequenceName(const std::filesystem::path& pattern, std::size_t frame_count);

  std::filesystem::path operator()(int frame) const;

 private:
  std::filesystem::path folder_;
  std::string before_, after_;  // the place
  std::size_t digits_ = 0;      // 0: no place
};

using DrawPicture = std::function<draw::Image()>;  // of what the controls say

// These say in a message what was written, and throw Error(file), Error(usage) for a bad pattern, Error(interrupted).

// Throws Error(usage), which names what can be, for another kind than .png, and, where pictures `may_move`, .webp and
// .mp4.
void require_picture_name(const std::string& file, bool may_move);

// `file`, or, where it is empty, the first bodyopt.0001.png, ... that is free.
void write_screenshot(const std::string& file, const DrawPicture& draw, Controls& controls);

// Pictures are drawn one after the other, and written by other threads meanwhile. The destructor puts playhead and
// camera back, and waits for single files; one that moves is written with its last picture alone.
class PictureSeries {
 public:
  // `place(k)` before the k-th of `count` is drawn, whose file has the number `first` + k; `put_back` at the end.
  // `milliseconds`: of a picture in one file that moves; 0: each has its own.
  struct Plan {
    std::string pattern;
    std::size_t count;
    int first;
    std::function<void(std::size_t)> place;
    std::function<void()> put_back;
    double milliseconds;
  };
  PictureSeries(Plan plan, Controls& controls);
  ~PictureSeries();
  PictureSeries(const PictureSeries&) = delete;
  PictureSeries& operator=(const PictureSeries&) = delete;

  // False: that was the last, and it was said. Throws what went wrong with one that was drawn before, too.
  bool make_next(const DrawPicture& draw);
  // Waits until what was drawn is written; throws what went wrong with it.
  void finish();
  std::size_t made() const { return made_; }
  std::size_t count() const { return plan_.count; }
  bool is_one_file() const { return animation_ || movie_; }  // which is there when the last picture is

 private:
  void write(draw::Image picture, std::filesystem::path file);
  void take_writer();  // waits for the oldest

  const Plan plan_;
  const FrameSequenceName name_;
  Controls& controls_;
  std::optional<draw::AnimationEncoder> animation_;
  std::optional<MovieFile> movie_;
  std::size_t made_ = 0;
  std::deque<std::future<void>> writers_;  // of the last pictures; each is waited for where it goes
};

// Does the name ask for more than one frame: #### or %04d, .webp or .mp4?
bool shows_motion(const std::string& pattern);

// Makes the range in pictures (`pattern` with #### or %04d), or in one file that moves (`fps` of the clip). Otherwise
// makes the frame that is shown. Pauses.
std::unique_ptr<PictureSeries> frame_series(const std::string& pattern, double fps, Controls& controls);

// Goes once around the target. Pauses.
std::unique_ptr<PictureSeries> turntable_series(const std::string& pattern, Controls& controls);

// Makes all of a series, with a line of progress on the terminal.
void make_all(PictureSeries& series, const DrawPicture& draw);

// Takes all kinds of pictures, as they are asked for. In a window it takes one at a time, so that it answers.
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
  // Stops before the next picture; files that were written are kept.
  void stop() { stops_ = true; }
  // Makes the series' next picture, drawn without what is there to work with.
  void go_on();
  void show_progress();

 private:
  void make(std::unique_ptr<PictureSeries> series);
  draw::Image draw_and_tell(std::set<std::string>& told);
  draw::Image draw_playblast();

  Painter& painter_;
  Session& session_;
  std::unique_ptr<PictureSeries> series_;  // that is being made
  PictureSize series_size_{};
  bool stops_ = false;
};

}  // namespace bodyopt::viewport
