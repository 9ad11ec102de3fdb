// The viewport without its window: what is open, and what a turn of the loop makes of events and of time.
#pragma once

#include <deque>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "viewport/picture_files.h"
#include "viewport/session.h"
#include "viewport/state/autosave.h"
#include "viewport/state/recent_files.h"
#include "viewport/viewer.h"

namespace bodyopt::viewport {

class Application {
 public:
  // Opens the files and settings of the options, which must outlive it. Without a screen, which must outlive it too,
  // only pictures are made. Throws as run_viewer().
  Application(const ViewerOptions& options, std::shared_ptr<const vulkan::Device> device, Screen* screen);

  // Takes events, and the seconds since the turn before; draws and shows what changed.
  void turn(std::span<const WindowEvent> events, double passed);
  // Returns how long the next turn can wait for events, seconds.
  double patience() const;
  bool is_done() const { return session_.controls.requests.quit; }
  // Keeps unsaved work, which the next viewport brings back where this one does not end as it should.
  void autosave();
  void forget_autosave() { autosave_.forget(); }
  // Without a screen: the script, then the pictures that the options ask for.
  void make_pictures();

  const Session& session() const { return session_; }

 private:
  static constexpr double kAutosaveEvery = 60;  // seconds

  void open_files();
  void begin();
  void begin_frames(bool restored);
  void frame_what_comes();
  void open(const std::string& file);
  void open_meanwhile(const std::string& file);
  void set_title();
  template <typename Action>
  void change_cast(const Action& action);
  template <typename Action>
  void change_shapes(const Action& action);
  void reload(const std::vector<std::filesystem::path>& files);

  void act(std::span<const WindowEvent> events, double passed);
  void hear_some();
  bool is_typing() const;
  void hear(const WindowEvent& event);
  void hear_key(const KeyEvent& event);
  void hear_key_in_series(const std::string& key);
  void run_script();
  void look_at_files();
  void measure_errors();
  bool shows_poses() const;
  void look_at_poses();
  void draw_if_needed(bool moves, double passed);
  void go_on_with_pictures(double passed);
  void go_to_worst_frame();
  void offer_unsaved();
  void note_saved();
  void remember(const std::string& file);
  void keep_unsaved();
  void quit();
  void save(const std::string& file);
  void recover(bool wanted);
  void fulfil();
  void fulfil_of_files(const Requests& requests);
  void fulfil_of_dataset(const Requests& requests);

  const ViewerOptions& options_;
  Screen* const screen_;
  Session session_;
  Controls& controls_ = session_.controls;
  ErrorMeasuring errors_;
  Painter painter_;
  PictureTaking pictures_;
  Autosave autosave_;
  RecentFiles recent_;
  Session::Work saved_, autosaved_;  // what the session's file has, and the autosave
  std::deque<WindowEvent> unheard_;
  std::deque<std::string> script_;  // commands that have not run
  bool script_waits_ = false;       // for what its last command asked for
  int pending_pictures_ = 2;        // to be drawn although nothing moves
  std::size_t said_ = 0;            // messages in the last turn
  bool was_busy_ = false;
  double now_ = 0;                                          // seconds, of the turns
  double last_picture_ = 0, next_look_ = 0, progress_ = 0;  // when drawn, at files, and shown
  double next_autosave_ = kAutosaveEvery;
  double next_poses_ = 0;  // looked at
};

}  // namespace bodyopt::viewport
