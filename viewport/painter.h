// A picture of what is open: the characters, and the panels over them.
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <memory>
#include <string>

#include "draw/canvas.h"
#include "viewport/compare/error_measuring.h"
#include "viewport/platform/gui.h"
#include "viewport/platform/screen.h"
#include "viewport/session.h"

namespace bodyopt::viewport {

using PictureSize = std::array<std::uint32_t, 2>;  // width, height, pixels

class Painter {
 public:
  // All must outlive it. Without a screen pictures are of `size`.
  Painter(const std::shared_ptr<const vulkan::Device>& device, Session& session, ErrorMeasuring& errors, Screen* screen,
          const PictureSize& size);

  // Takes an event for the panels of the next picture.
  void hear(const WindowEvent& event) { gui_.hear(event); }

  // The screen's size, in its proportions where it is larger than pictures can be; 0 while it is minimised.
  PictureSize size() const;
  // `passed`: seconds since the picture before, for panels. What cannot be drawn leaves the panels alone, and is said.
  void draw(const PictureSize& size, draw::Edges edges, double passed = 0);
  const draw::Rectangle& area() const { return area_; }  // of the characters in the last picture
  // The screen's edges: while something moves on a software device, with a sample a pixel.
  draw::Edges edges() const { return is_software_ && is_busy() ? draw::Edges::quick : draw::Edges::smooth; }
  void show() { screen_->show(canvas_); }
  // Drawn once more, at its best, and without messages. Throws Error(usage) for what cannot be drawn.
  draw::Image draw_still(const PictureSize& size);
  // The lead alone in a pose; the screen's picture is to be drawn anew.
  draw::Image draw_portrait(const shots::ViewSettings::PoseKey& pose);
  // Panels take their sizes from the picture before.
  void settle();

  // Shows a text over the picture until the next is drawn, while the window cannot answer.
  void show_message(const std::string& text);
  // A window that shows nothing yet looks dead.
  void show_loading(const std::string& file);

  void forget_heat() { heat_ = {}; }
  bool hides_window() const { return gui_.hides_window(); }
  bool is_busy() const;  // playing, or the mouse holds something

 private:
  using Clock = std::chrono::steady_clock;

  bool is_minimised() const;
  float scale() const { return screen_ ? screen_->scale() : 1; }  // pixels a point of panels
  void draw_panels_over(const PictureSize& size, double passed);
  void choose_heat();
  void choose_level();
  void describe_time(Clock::time_point start);

  const bool is_software_;
  Session& session_;
  Scene& scene_ = session_.scene;
  Controls& controls_ = session_.controls;
  Snapshot& snapshot_ = session_.snapshot;
  ErrorMeasuring& errors_;
  Screen* const screen_;
  const PictureSize size_;
  draw::Canvas canvas_;
  Gui gui_;
  HeatScale heat_;
  DetailChoice detail_;
  draw::Rectangle area_;           // of the characters in the last picture
  std::uint64_t shown_poses_ = 0;  // version of the library whose pictures panels have
  bool drawn_ = false;             // the characters, in the last picture
  Clock::time_point last_picture_ = Clock::now();
};

}  // namespace bodyopt::viewport
