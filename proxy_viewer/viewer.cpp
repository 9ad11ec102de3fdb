#include "proxy_viewer/viewer.h"

#include <imgui.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <deque>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iostream>
#include <memory>
#include <utility>

#include "base/progress.h"
#include "draw/viewport.h"
#include "proxy_viewer/commands/commands.h"
#include "proxy_viewer/compare/error_measuring.h"
#include "proxy_viewer/compare/heat_scale.h"
#include "proxy_viewer/describe_scene.h"
#include "proxy_viewer/mouse.h"
#include "proxy_viewer/panels/panels.h"
#include "proxy_viewer/panels/shown_texts.h"
#include "proxy_viewer/picture_files.h"
#include "proxy_viewer/platform/gui.h"
#include "proxy_viewer/platform/live_pose.h"
#include "proxy_viewer/platform/window.h"
#include "proxy_viewer/session.h"
#include "runtime/core/error.h"

namespace bodyopt {
namespace {

using Clock = std::chrono::steady_clock;

constexpr double kIdle = 0.25;     // seconds between looks at files while nothing happens
constexpr double kBusy = 0.004;    // and at the clock or a stream of poses
constexpr double kProgress = 0.5;  // between pictures of the window while others are written
const char* const kFlipKey = "X";  // while it is down, what is compared with is shown

double seconds_between(Clock::time_point from, Clock::time_point to) {
  return std::chrono::duration<double>(to - from).count();
}

double resident_mib() {
  std::ifstream file("/proc/self/statm");
  double pages = 0, resident = 0;
  file >> pages >> resident;
  return resident * static_cast<double>(sysconf(_SC_PAGESIZE)) / (1 << 20);
}

struct Finally {
  std::function<void()> action;
  ~Finally() { action(); }
};

class Viewer {
 public:
  explicit Viewer(const ViewerOptions& options)
      : options_(options),
        window_(options.headless ? nullptr : std::make_unique<Window>(window_options(options))),
        device_(std::make_shared<const vulkan::Device>(
            options.device, window_ ? window_->device_use() : vulkan::DeviceUse{.draws = true})),
        viewport_(*device_),
        session_(device_, options_),
        errors_(scene_, controls_, device_->info().type != "cpu") {
    if (window_) {
      window_->attach(device_);
      window_->on_drop = [this](const auto& files) { std::ranges::copy(files, std::back_inserter(dropped_)); };
      window_->on_key = [this](const std::string& key, KeyEvent event) { on_key(key, event); };
    }
    controls_.panels = controls_.settings.hud.on = !options.headless;
    gui_.attach(*device_, viewport_.panel_pass(), window_ ? window_->handle() : nullptr);
    show_loading(options.files.empty() ? "the built-in arm" : options.files.front());
    open_first();
    for (std::size_t k = 1; k < options.files.size(); ++k) {
      show_loading(options.files[k]);
      attempt([&] { open(options.files[k]); });
    }
    begin();
  }

  void run_window() {
    const Clock::time_point started = Clock::now();
    last_ = started;
    while (!window_->closed() && !controls_.requests.quit) {
      if (interrupted()) throw Error(ErrorKind::interrupted, "interrupted: the viewport ends, as a signal asked it to");
      const double wait = controls_.playback.playing() || live_ ? kBusy : kIdle;
      const bool woken =
          window_->poll(series_ || pending_pictures_ > 0 || !options_.vsync || errors_.has_work() ? 0 : wait);
      if (options_.seconds > 0 && seconds_between(started, Clock::now()) > options_.seconds) break;
      attempt([&] { turn(woken); });
    }
  }

  void run_headless() {
    do {
      run_script();
      draw(options_.width, options_.height, Edges::smooth);
      fulfil();
    } while (!script_.empty() && !controls_.requests.quit);
    if (options_.out.empty()) return;
    settle();
    take_sequence(options_.out);
  }

  std::shared_ptr<const vulkan::ValidationLog> validation_log() const { return device_->validation_log(); }

 private:
  static WindowOptions window_options(const ViewerOptions& options) {
    return {.width = options.width, .height = options.height, .vsync = options.vsync};
  }

  // What fails is said, and the session goes on; without a window nobody would see it.
  template <typename Action>
  void attempt(const Action& action) {
    if (!window_) {
      action();
      return;
    }
    const std::size_t before = controls_.messages.size();
    controls_.attempt(action);
    if (controls_.messages.size() != before) pending_pictures_ = 2;
  }

  void warn(const std::string& text) {
    controls_.warn(text);
    pending_pictures_ = 2;
  }

  // A window that shows nothing yet looks dead.
  void show_loading(const std::string& file) {
    if (!window_) return;
    std::cerr << "loading " << file << "\n";
    window_->poll(0);
    const auto [width, height] = picture_size();
    if (width == 0 || height == 0) return;
    const std::string text = "loading " + std::filesystem::path(file).filename().string() + "\xe2\x80\xa6";
    gui_.fonts().show(text);
    gui_.begin(width, height, 1e-4);
    draw_loading(text);
    gui_.end();
    viewport_.draw({}, width, height, Edges::smooth, [this](VkCommandBuffer commands) { gui_.record(commands); });
    window_->show(viewport_);
  }

  // Without the first there is nothing to see.
  void open_first() {
    for (const std::string& note : session_.open_first()) warn(note);
    if (!options_.truth.empty()) attempt([&] { session_.open_truth(scene_.lead(), options_.truth); });
    set_title();
  }

  void open_meanwhile(const std::string& file) {
    show_message("loading " + std::filesystem::path(file).filename().string());
    open(file);
  }

  void open(const std::string& file) {
    errors_.forget();
    for (const std::string& note : session_.open(file)) warn(note);
    set_title();
  }

  void set_title() {
    if (window_) window_->set_title(scene_.lead().name() + " \xe2\x80\x93 Bodyopt");
  }

  void reload(const std::vector<std::filesystem::path>& files) {
    change_cast([&] { session_.reload(files); });
  }

  // What was known of the lead may be so no longer.
  template <typename Action>
  void change_cast(const Action& action) {
    action();
    errors_.forget();
    heat_ = {};
    set_title();
    if (live_) listen_for_lead();
  }

  // A pose of other joints than the lead's is none of it.
  void listen_for_lead() {
    const Basis& basis = scene_.lead().basis();
    try {
      if (live_->expect(basis.skeleton.size(), basis.residual.controls.size())) scene_.leave_live_pose();
    } catch (...) {  // nor are those that were listened for
      live_.reset();
      controls_.live.reset();
      snapshot_.live.reset();
      scene_.leave_live_pose();
      throw;
    }
  }

  void begin() {
    session_.play_clip();
    controls_.camera.orbit(0.45, 0.18);
    controls_.requests.frame_selection = true;
    session_.follow();
    if (!options_.state.empty()) session_.load_state(options_.state);
    Playback& playback = controls_.playback;
    for (const std::optional<int>& frame : {options_.first, options_.last, options_.current}) {
      if (frame) playback.require_frame(*frame);
    }
    if (options_.first || options_.last) {
      playback.set_range(options_.first.value_or(playback.first()), options_.last.value_or(playback.last()));
    }
    playback.scrub(options_.current.value_or(playback.in()));
    if (options_.live_port) {
      const Basis& basis = scene_.lead().basis();
      live_ = std::make_unique<LivePose>(*options_.live_port, basis.skeleton.size(), basis.residual.controls.size());
      controls_.live = true;
      const std::string listening = "listening for poses on 127.0.0.1:" + std::to_string(live_->port());
      std::cerr << listening << "\n";
      controls_.say(listening);
    }
    if (window_) controls_.say("H: all keys");
    session_.follow();
    if (controls_.requests.frame_selection) frame_what_comes();
    const std::vector<std::string> commands = script_commands(options_.commands);
    script_.assign(commands.begin(), commands.end());
  }

  // Of a sequence without a window all of it: nobody is there to move the camera.
  void frame_what_comes() {
    if (options_.headless && shows_motion(options_.out)) {
      session_.frame_range(options_.width, options_.height);
    } else {
      session_.frame_selection(options_.width, options_.height);
    }
  }

  // Up to the next command that asks for something: the picture is drawn, and it is done, before the others run.
  void run_script() {
    while (!script_.empty() && controls_.requests == Requests{}) {
      controls_.follow_keys();
      const std::string command = std::move(script_.front());
      script_.pop_front();
      attempt([&] { run_command(controls_, command); });
      script_waits_ = !(controls_.requests == Requests{});
      pending_pictures_ = 2;
    }
  }

  void on_key(const std::string& key, KeyEvent event) {
    pending_pictures_ = 2;
    if (event == KeyEvent::released) {
      // Shift and the like may have gone down meanwhile.
      if (key.substr(key.rfind('+') + 1) == kFlipKey) controls_.flipped = false;
      return;
    }
    if (series_ && !series_stops_) return on_key_in_series(key);
    if (ImGui::GetIO().WantTextInput) return;
    if (controls_.prompt) {  // which may not be drawn yet
      if (key == "Enter" && event == KeyEvent::pressed) controls_.typed.entered = true;
      return;
    }
    if (key == kFlipKey) controls_.flipped = true;
    const Command* command = find_command_by_key(key);
    if (!command || (event == KeyEvent::repeated && !command->repeats)) return;
    attempt([&] { run_command(controls_, command->name); });
  }

  // Nothing else shall change pictures that are being written.
  void on_key_in_series(const std::string& key) {
    if (key == "Escape") series_stops_ = true;
    if (find_command_by_key(key) == find_command("quit")) controls_.requests.quit = true;
  }

  // One turn of the loop: time passes, and what changed is drawn.
  void turn(bool woken) {
    const Clock::time_point now = Clock::now();
    const double passed = seconds_between(last_, now);
    last_ = now;
    if (series_) return make_next_of_series(now);
    for (const std::string& file : std::exchange(dropped_, {})) attempt([&] { open_meanwhile(file); });
    const int shown = controls_.playback.frame();
    controls_.playback.advance(passed);
    poll_live();
    look_at_files(now);
    run_script();
    measure_errors();
    if (woken) pending_pictures_ = 2;  // panels answer events a picture late
    const bool moves = controls_.playback.frame() != shown || !options_.vsync;
    if (!moves && pending_pictures_ == 0) return;
    pending_pictures_ = std::max(0, pending_pictures_ - 1);
    const auto [width, height] = picture_size();
    if (width == 0 || height == 0) return;  // minimised
    const bool busy =
        controls_.playback.playing() || ImGui::IsMouseDown(0) || ImGui::IsMouseDown(1) || ImGui::IsMouseDown(2);
    const bool software = device_->info().type == "cpu";
    const Edges edges = software && busy ? Edges::quick : Edges::smooth;
    draw(width, height, edges);
    window_->show(viewport_);
    if (edges == Edges::quick) pending_pictures_ = std::max(pending_pictures_, busy ? 0 : 1);
    was_busy_ = busy;
    fulfil();
  }

  // The newest of the poses that are sent, for as long as they are wanted.
  void poll_live() {
    if (!live_) return;
    if (!*controls_.live) {
      scene_.leave_live_pose();
      snapshot_.live.reset();
      return;
    }
    const std::size_t rejected = live_->rejected();
    std::optional<Pose> pose = live_->poll();
    if (pose || live_->rejected() > rejected) pending_pictures_ = std::max(pending_pictures_, 1);
    if (pose) scene_.set_live_pose(std::move(*pose));
    snapshot_.live = LiveRow{live_->frame(), live_->rejected(), live_->last_rejection()};
  }

  void look_at_files(Clock::time_point now) {
    const double at = seconds_between(Clock::time_point{}, now);
    if (at < next_look_) return;
    next_look_ = at + kIdle;
    const bool passes = std::ranges::any_of(controls_.messages, [](const Message& m) { return !m.error; });
    if (passes || (was_busy_ && !controls_.playback.playing())) pending_pictures_ = std::max(pending_pictures_, 1);
    const std::vector<std::filesystem::path> changed = session_.changed_files(at);
    if (changed.empty()) return;
    pending_pictures_ = 2;
    attempt([&] { reload(changed); });
  }

  void draw(std::uint32_t width, std::uint32_t height, Edges edges) {
    const Clock::time_point start = Clock::now();
    controls_.follow_keys();
    session_.warn_of_truth_times();
    session_.curation.look(scene_, controls_);
    scene_.lead().show_raw(controls_.curating.raw);
    visit_texts(snapshot_, controls_, [this](const std::string& text) { gui_.fonts().show(text); });
    if (!window_) errors_.measure_shown_frame();
    attempt([&] { choose_heat(); });
    gui_.begin(width, height, std::max(1e-4, seconds_between(last_picture_, start)));
    if (!series_) steer_by_mouse(scene_, area_, height, controls_);
    describe_turns(scene_, controls_.playback.frame(), snapshot_);
    describe_comparison(scene_, controls_, errors_.curve(), snapshot_);
    session_.curation.describe(controls_, snapshot_);
    const Rectangle area = draw_panels(snapshot_, controls_, width, height);
    if (!ImGui::IsAnyItemActive()) controls_.poses.note(controls_.settings.pose);  // a drag is one step
    gui_.end();
    session_.follow();
    if (controls_.requests.frame_selection) {
      attempt([&] { session_.frame_selection(area.width, area.height); });
    }
    choose_level();
    // What cannot be drawn leaves the panels, which can undo what was set.
    std::vector<View> views;
    drawn_ = false;
    attempt([&] {
      views = scene_.look(controls_, area);
      drawn_ = true;
    });
    area_ = area;
    viewport_.draw(views, width, height, edges, [this](VkCommandBuffer commands) { gui_.record(commands); });
    session_.describe_picture();
    describe_time(start);
    if (const auto problem = gui_.fonts().take_problem()) warn(*problem);
  }

  // Of what colours the lead, as far as it is measured; the pictures of a series are one after the other, too.
  void choose_heat() {
    const bool covers = controls_.settings.compare.coverage && scene_.lead().shown().knows_coverage();
    std::optional<double> p99;
    if (covers) {
      p99 = scene_.lead().shown().expected_skin(scene_.lead_pose(controls_)).p99_mm;
    } else if (const std::optional<float> error = errors_.curve().largest_p99()) {
      p99 = static_cast<double>(*error);
    }
    controls_.automatic_heat_mm = heat_.choose(p99, controls_.playback.playing() || makes_series_);
  }

  // While it plays, a level of detail that keeps up; but the finest, where what is looked at is of that alone.
  void choose_level() {
    const ViewSettings& s = controls_.settings;
    const bool wants_finest = s.compare.with != CompareWith::none || s.look.tets ||
                              (s.jiggle.on && scene_.lead().has_at_finest(SkinMethod::jiggle));
    const std::size_t automatic =
        detail_.choose(1e-3 * snapshot_.frame_ms, controls_.playback.playing() && !wants_finest, most_levels());
    const std::optional<int>& wanted = controls_.settings.look.level;
    for (const auto& character : scene_.cast()) {
      character->set_level(wanted ? static_cast<std::size_t>(*wanted) : automatic);
    }
    snapshot_.level = scene_.lead().level();
    snapshot_.level_count = scene_.lead().level_count();
  }

  // Of any; who has fewer shows the coarsest there is.
  std::size_t most_levels() const {
    std::size_t most = 1;
    for (const auto& character : scene_.cast()) most = std::max(most, character->level_count());
    return most;
  }

  // How long it took.
  void describe_time(Clock::time_point start) {
    const Clock::time_point now = Clock::now();
    const double interval = seconds_between(last_picture_, now);
    last_picture_ = now;
    snapshot_.shown_fps += 0.1 * ((interval > 0 && interval < 1 ? 1 / interval : 0) - snapshot_.shown_fps);
    snapshot_.frame_ms = 1e3 * seconds_between(start, now);
    snapshot_.draw_ms = 1e3 * viewport_.seconds();
    snapshot_.memory_mib = resident_mib();
  }

  void measure_errors() {
    errors_.look();
    if (!errors_.has_work() || ImGui::IsAnyMouseDown()) return;
    errors_.measure_some();
    const bool is_late = seconds_between(last_picture_, Clock::now()) > kIdle;
    if (is_late || !errors_.has_work()) pending_pictures_ = std::max(pending_pictures_, 1);
  }

  // A script waits until all are measured, by and by where there is a window.
  void go_to_worst_frame() {
    controls_.playback.pause();
    if (!window_) errors_.measure_all();
    if (window_ && script_waits_ && errors_.has_work()) {
      controls_.requests.worst_frame = true;
    } else {
      errors_.go_to_worst_frame();
    }
  }

  // What was asked for meanwhile, now that there is a picture.
  void fulfil() {
    Requests requests = std::exchange(controls_.requests, {});
    controls_.requests.quit = requests.quit;
    for (const std::string& file : requests.open) attempt([&] { open_meanwhile(file); });
    if (requests.lead) attempt([&] { change_cast([&] { session_.make_lead(*requests.lead); }); });
    if (requests.remove) attempt([&] { change_cast([&] { session_.remove(*requests.remove); }); });
    for (const ModifierEdit& edit : requests.edits) {
      attempt([&] { change_cast([&] { session_.edit_stack(edit); }); });
    }
    if (requests.step_back) attempt([&] { change_cast([&] { session_.step_stack(*requests.step_back); }); });
    if (requests.contradictions) attempt([&] { session_.find_contradictions(); });
    if (requests.screenshot) attempt([&] { take_screenshot(*requests.screenshot); });
    if (requests.sequence) attempt([&] { take_sequence(*requests.sequence); });
    if (requests.turntable) attempt([&] { make(turntable_series(*requests.turntable, controls_)); });
    if (requests.save_state) attempt([&] { session_.save_state(*requests.save_state); });
    if (requests.export_clip) attempt([&] { session_.export_clip(*requests.export_clip); });
    if (requests.export_skin) attempt([&] { session_.export_skin(*requests.export_skin); });
    if (requests.load_state) attempt([&] { session_.load_state(*requests.load_state); });
    if (requests.reload) attempt([&] { reload(session_.files()); });
    if (requests.reset_jiggle) scene_.reset_jiggle();
    if (requests.worst_frame) attempt([&] { go_to_worst_frame(); });
    if (requests.worst_vertex) attempt([&] { errors_.go_to_worst_vertex(); });
    if (controls_.requests == Requests{}) script_waits_ = false;
  }

  // Of the window, in its proportions where it is larger than pictures can be.
  std::array<std::uint32_t, 2> picture_size() const {
    if (!window_) return {options_.width, options_.height};
    const auto [width, height] = window_->size();
    const std::uint32_t larger = std::max(width, height), most = viewport_.most_pixels();
    if (larger <= most) return {width, height};
    const auto scaled = [&](std::uint32_t side) {
      return static_cast<std::uint32_t>((std::uint64_t{side} * most + larger - 1) / larger);
    };
    return {scaled(width), scaled(height)};
  }

  // Panels take their sizes from the picture before.
  void settle() {
    for (int k = 0; k < 3; ++k) draw_still();
  }

  // Drawn once more, at its best, and without messages.
  Image draw_still() { return draw_still(picture_size()); }

  Image draw_still(const std::array<std::uint32_t, 2>& size) {
    const auto [width, height] = size;
    std::vector<Message> messages = std::exchange(controls_.messages, {});
    attempt([&] { errors_.measure_shown_frame(); });
    draw(width, height, Edges::smooth);
    std::swap(controls_.messages, messages);
    std::ranges::move(messages, std::back_inserter(controls_.messages));
    if (!drawn_) throw Error(ErrorKind::usage, "no picture was taken of what cannot be drawn");
    return viewport_.picture();
  }

  void take_screenshot(const std::string& file) {
    settle();
    write_screenshot(file, draw_picture_, controls_);
  }

  void take_sequence(const std::string& pattern) { make(frame_series(pattern, scene_.lead().clip().fps, controls_)); }

  // In a window one by one, so that it answers.
  void make(std::unique_ptr<PictureSeries> series) {
    makes_series_ = true;
    if (!window_) {
      const Finally ends{[this] { makes_series_ = false; }};
      return make_all(*series, draw_picture_);
    }
    series_ = std::move(series);
    series_size_ = picture_size();
    series_stops_ = false;
  }

  void make_next_of_series(Clock::time_point now) {
    bool goes_on = false;
    if (std::exchange(series_stops_, false)) {
      controls_.say("stopped after " + std::to_string(series_->made()) + " of " + std::to_string(series_->count()) +
                    " pictures");
    } else {
      attempt([&] { goes_on = series_->make_next([this] { return draw_playblast(); }); });
    }
    if (!goes_on) series_.reset();
    makes_series_ = goes_on;
    pending_pictures_ = 2;
    if (goes_on && seconds_between(last_progress_, now) > kProgress) show_progress();
  }

  void show_progress() {
    show_message(std::to_string(series_->made()) + " of " + std::to_string(series_->count()) +
                 " pictures: Escape stops");
    last_progress_ = Clock::now();
  }

  // While the window cannot answer: over the picture as it is, until the next is drawn.
  void show_message(const std::string& text) {
    const auto [width, height] = picture_size();
    if (!window_ || width == 0 || height == 0) return;
    const std::vector<Message> messages = controls_.messages;
    controls_.say(text);
    for (int k = 0; k < 2; ++k) draw(width, height, Edges::quick);  // panels take their sizes from the first
    controls_.messages = messages;
    window_->show(viewport_);
  }

  // Without what is there to work with.
  Image draw_playblast() {
    bool* const shown[] = {&controls_.panels, &controls_.settings.hud.on, &controls_.cheat_sheet, &controls_.prompt};
    std::array<bool, std::size(shown)> before;
    for (std::size_t k = 0; k < before.size(); ++k) before[k] = std::exchange(*shown[k], false);
    const Finally put_back{[&] {
      for (std::size_t k = 0; k < before.size(); ++k) *shown[k] = before[k];
    }};
    return draw_still(series_size_);
  }

  const ViewerOptions options_;
  std::unique_ptr<Window> window_;  // none when headless; outlives all that draws
  std::shared_ptr<const vulkan::Device> device_;
  Viewport viewport_;
  Gui gui_;
  Session session_;
  Scene& scene_ = session_.scene;
  Controls& controls_ = session_.controls;
  Snapshot& snapshot_ = session_.snapshot;
  ErrorMeasuring errors_;
  std::unique_ptr<LivePose> live_;
  std::deque<std::string> script_;    // commands that have not run
  bool script_waits_ = false;         // for what its last command asked for
  std::vector<std::string> dropped_;  // files, onto the window
  const DrawPicture draw_picture_ = [this] { return draw_still(); };
  std::unique_ptr<PictureSeries> series_;  // that is being made
  std::array<std::uint32_t, 2> series_size_{};
  bool series_stops_ = false;  // before the next
  bool makes_series_ = false;  // with a window and without
  HeatScale heat_;
  Clock::time_point last_progress_;  // shown
  DetailChoice detail_;
  Rectangle area_;            // of the characters in the last picture
  int pending_pictures_ = 2;  // to be drawn although nothing moves
  bool was_busy_ = false;
  bool drawn_ = false;    // the characters, in the last picture
  double next_look_ = 0;  // at files
  Clock::time_point last_ = Clock::now(), last_picture_ = last_;
};

}  // namespace

void run_viewer(const ViewerOptions& options) {
  std::shared_ptr<const vulkan::ValidationLog> log;
  {
    Viewer viewer(options);
    log = viewer.validation_log();
    if (options.headless) {
      viewer.run_headless();
    } else {
      viewer.run_window();
    }
  }
  const std::vector<std::string> messages = log->messages();  // those of its end, too
  if (messages.empty()) return;
  throw Error(ErrorKind::device, "Vulkan validation reported " + std::to_string(messages.size()) +
                                     " messages, first: " + messages.front());
}

}  // namespace bodyopt
