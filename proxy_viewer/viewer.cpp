#include "proxy_viewer/viewer.h"

#include <imgui.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <deque>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <memory>
#include <optional>

#include "proxy_viewer/commands.h"
#include "proxy_viewer/describe_scene.h"
#include "proxy_viewer/frame_sequence_name.h"
#include "proxy_viewer/gui.h"
#include "proxy_viewer/joint_ranges.h"
#include "proxy_viewer/live_pose.h"
#include "proxy_viewer/panels.h"
#include "proxy_viewer/render/animation.h"
#include "proxy_viewer/render/camera.h"
#include "proxy_viewer/render/viewport.h"
#include "proxy_viewer/scene.h"
#include "proxy_viewer/watched_files.h"
#include "proxy_viewer/window.h"
#include "runtime/basis/atomic_file.h"
#include "runtime/basis/error.h"
#include "trainer/progress.h"

namespace bodyopt {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

constexpr double kIdle = 0.25;          // seconds between looks at files while nothing happens
constexpr double kMeasuring = 0.02;     // seconds of measuring errors between events
constexpr double kNearVertex = 0.5;     // distance of the camera from a vertex, of the character's size
constexpr float kClick = 4;             // pixels: less is no drag
constexpr double kPickRadius = 14;      // pixels
constexpr int kTurntablePictures = 72;  // of once around
const char* const kNewScreenshot = "bodyopt.####.png";
const char* const kKept = "the pictures that were written are kept";

double seconds_between(Clock::time_point from, Clock::time_point to) {
  return std::chrono::duration<double>(to - from).count();
}

double resident_mib() {
  std::ifstream file("/proc/self/statm");
  double pages = 0, resident = 0;
  file >> pages >> resident;
  return resident * static_cast<double>(sysconf(_SC_PAGESIZE)) / (1 << 20);
}

bool has_extension(const std::string& path, std::initializer_list<const char*> extensions) {
  const std::string own = fs::path(path.substr(0, path.find('#'))).extension().string();
  return std::any_of(extensions.begin(), extensions.end(), [&](const char* e) { return own == e; });
}

class Viewer {
 public:
  explicit Viewer(const ViewerOptions& options)
      : options_(options),
        window_(options.headless ? nullptr : std::make_unique<Window>(window_options(options))),
        device_(std::make_shared<const vulkan::Device>(
            options.device, window_ ? window_->device_use() : vulkan::DeviceUse{.draws = true})),
        viewport_(*device_),
        scene_(device_) {
    if (window_) {
      window_->attach(device_);
      window_->on_drop = [this](const auto& files) { std::ranges::copy(files, std::back_inserter(dropped_)); };
      window_->on_key = [this](const std::string& key, bool down) { on_key(key, down); };
    }
    controls_.panels = controls_.settings.hud.on = !options.headless;
    open(options.files.at(0));  // without it there is nothing to see
    for (std::size_t k = 1; k < options.files.size(); ++k) attempt([&] { open(options.files[k]); });
    gui_ = std::make_unique<Gui>(names());
    gui_->attach(*device_, viewport_.panel_pass(), window_ ? window_->handle() : nullptr);
    if (gui_->problem()) warn(*gui_->problem());
    begin();
  }

  void run_window() {
    const Clock::time_point started = Clock::now();
    last_ = started;
    while (!window_->closed() && !controls_.requests.quit) {
      if (interrupted()) throw Error(ErrorKind::interrupted, "interrupted: the window was closed");
      const Clock::time_point before = Clock::now();
      const double wait = std::min(kIdle, controls_.playback.playing() ? 0.004 : kIdle);
      window_->poll(pending_pictures_ > 0 || !options_.vsync || can_measure() ? 0 : wait);
      if (options_.seconds > 0 && seconds_between(started, Clock::now()) > options_.seconds) break;
      const bool woken = seconds_between(before, Clock::now()) < 0.9 * wait;
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
    write_sequence(options_.out);
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
    try {
      action();
    } catch (const Error& error) {
      if (error.kind() == ErrorKind::device) throw;
      warn(error.what());
    }
  }

  void warn(const std::string& text) {
    const std::vector<Message>& messages = controls_.messages;
    if (!messages.empty() && messages.back().text == text) return;  // of every picture: once is enough
    std::cerr << "warning: " << text << "\n";
    controls_.warn(text);
    pending_pictures_ = 2;
  }

  void open(const std::string& file) {
    if (has_extension(file, {".safetensors"})) {
      const bool first = scene_.empty();
      scene_.add({.basis = file, .proxy = first ? options_.proxy : "", .character = first ? options_.character : ""},
                 options_.clip);
    } else if (scene_.empty()) {
      throw Error(ErrorKind::usage, file + ": a basis (.safetensors) must come before its clips and caches");
    } else if (has_extension(file, {".glb", ".gltf", ".bvh"})) {
      scene_.cast().back()->open_clip(file);
      for (const std::string& note : scene_.cast().back()->clip().notes) warn(note);
      if (scene_.cast().size() == 1) play_clip();
    } else if (has_extension(file, {".pc2"})) {
      scene_.cast().back()->open_truth(file);
      controls_.settings.compare.with = CompareWith::truth;
    } else if (has_extension(file, {".json"})) {
      load_state(file);
    } else {
      throw Error(ErrorKind::usage, file +
                                        ": expected a basis (.safetensors), a clip (.glb, .gltf, .bvh), a point "
                                        "cache (.pc2) or a state (.json)");
    }
    describe_cast();
    watch();
  }

  // The playhead over the lead's clip.
  void play_clip() {
    const Clip& clip = scene_.lead().clip();
    controls_.playback = Playback({clip.first_frame, clip.last_frame(), 1}, clip.fps);
    apply_settings();
  }

  void apply_settings() {
    Playback& playback = controls_.playback;
    const ViewSettings::Playing& s = controls_.settings.playback;
    playback.set_mode(s.mode);
    playback.set_speed(s.speed);
    playback.set_backwards(s.backwards);
    playback.set_real_time(s.real_time);
    if (s.in || s.out) playback.set_range(s.in.value_or(playback.first()), s.out.value_or(playback.last()));
  }

  void begin() {
    play_clip();
    controls_.camera.orbit(0.45, 0.18);
    controls_.requests.frame_selection = true;
    if (!options_.state.empty()) load_state(options_.state);
    Playback& playback = controls_.playback;
    if (options_.first || options_.last) {
      playback.set_range(options_.first.value_or(playback.first()), options_.last.value_or(playback.last()));
    }
    playback.scrub(options_.current.value_or(playback.in()));
    if (options_.live_port) {
      const Basis& basis = scene_.lead().basis();
      live_ = std::make_unique<LivePose>(*options_.live_port, basis.skeleton.size(), basis.residual.controls.size());
      controls_.say("listening for poses on 127.0.0.1:" + std::to_string(live_->port()));
    }
    if (controls_.requests.frame_selection) frame_selection(options_.width, options_.height);
    followed_ = scene_.whereabouts(playback.frame());
    const std::vector<std::string> commands = script_commands(options_.commands);
    script_.assign(commands.begin(), commands.end());
  }

  // Up to the next command that asks for something: the picture is drawn, and it is done, before the others run.
  void run_script() {
    while (!script_.empty() && controls_.requests == Requests{}) {
      const std::string command = std::move(script_.front());
      script_.pop_front();
      attempt([&] { run_command(controls_, command); });
      pending_pictures_ = 2;
    }
  }

  void watch() {
    std::vector<fs::path> files;
    for (const auto& character : scene_.cast()) {
      std::ranges::copy(character->files().paths(), std::back_inserter(files));
    }
    watched_ = std::make_unique<WatchedFiles>(files);
  }

  void reload() {
    for (std::size_t c = 0; c < scene_.cast().size(); ++c) {
      scene_.replace(c, ActorFiles(scene_.cast()[c]->files()), options_.clip);
    }
    describe_cast();
    controls_.say("the files were read again");
    const int frame = controls_.playback.frame();
    play_clip();
    controls_.playback.scrub(frame);
  }

  void load_state(const std::string& file) {
    controls_.settings = read_view_settings(file);
    controls_.camera = OrbitCamera(controls_.settings.camera);
    followed_.reset();
    apply_settings();
    controls_.requests.frame_selection = false;
  }

  void on_key(const std::string& key, bool down) {
    pending_pictures_ = 2;
    if (ImGui::GetIO().WantTextInput) return;
    if (key == "X") {
      controls_.flipped = down;
      return;
    }
    const Command* command = down ? find_command_by_key(key) : nullptr;
    if (command) attempt([&] { run_command(controls_, command->name); });
  }

  // One turn of the loop: time passes, and what changed is drawn.
  void turn(bool woken) {
    const Clock::time_point now = Clock::now();
    const double passed = seconds_between(last_, now);
    last_ = now;
    for (const std::string& file : std::exchange(dropped_, {})) attempt([&] { open(file); });
    const int shown = controls_.playback.frame();
    controls_.playback.advance(passed);
    if (live_) {
      if (auto pose = live_->poll()) {
        scene_.set_live_pose(std::move(*pose));
        pending_pictures_ = std::max(pending_pictures_, 1);
      }
    }
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

  void look_at_files(Clock::time_point now) {
    const double at = seconds_between(Clock::time_point{}, now);
    if (at < next_look_) return;
    next_look_ = at + kIdle;
    if (was_busy_ && !controls_.playback.playing()) pending_pictures_ = std::max(pending_pictures_, 1);
    const std::vector<fs::path> changed = watched_->changed(at);
    if (changed.empty()) return;
    controls_.requests.reload = true;
    pending_pictures_ = 2;
  }

  void draw(std::uint32_t width, std::uint32_t height, Edges edges) {
    const Clock::time_point start = Clock::now();
    gui_->begin(width, height, std::max(1e-4, seconds_between(last_picture_, start)));
    steer(height);
    if (!window_ && look_at_errors()) curve_.measure_next(scene_.lead(), controls_.playback.frame());
    describe_comparison(scene_, controls_, curve_, snapshot_);
    const Rectangle area = draw_panels(snapshot_, controls_, width, height);
    gui_->end();
    follow();
    if (controls_.requests.frame_selection) frame_selection(area.width, area.height);
    choose_level();
    const std::vector<View> views = scene_.look(controls_, area);
    area_ = area;
    viewport_.draw(views, width, height, edges, [this](VkCommandBuffer commands) { gui_->record(commands); });
    measure(start);
  }

  // While it plays, a level of detail that keeps up.
  void choose_level() {
    const std::size_t automatic =
        detail_.choose(1e-3 * snapshot_.frame_ms, controls_.playback.playing(), scene_.lead().level_count());
    const std::optional<int>& wanted = controls_.settings.look.level;
    for (const auto& character : scene_.cast()) {
      character->set_level(wanted ? static_cast<std::size_t>(*wanted) : automatic);
    }
    snapshot_.level = scene_.lead().level();
    snapshot_.level_count = scene_.lead().level_count();
  }

  void follow() {
    const Vec3 at = scene_.whereabouts(controls_.playback.frame());
    if (followed_ && controls_.settings.look.follow) controls_.camera.move(at - *followed_);
    followed_ = at;
  }

  void frame_selection(std::uint32_t width, std::uint32_t height) {
    controls_.requests.frame_selection = false;
    const std::vector<float> points = scene_.points_to_frame(controls_);
    if (!points.empty()) {
      controls_.camera.frame(points, static_cast<float>(width) / static_cast<float>(std::max(1u, height)));
    }
  }

  // The mouse over the picture: left turns, middle or shift pans, right and the wheel go nearer; a click picks a joint.
  void steer(std::uint32_t height) {
    const ImGuiIO& io = ImGui::GetIO();
    if (io.WantCaptureMouse) return;
    const double per_pixel = 3.2 / std::max(1u, height);  // half a turn across the window's height
    const double x = static_cast<double>(io.MouseDelta.x), y = static_cast<double>(io.MouseDelta.y);
    // Not with what moved before the button went down.
    const auto drags = [&](int button) { return io.MouseDown[button] && io.MouseDownDuration[button] > 0; };
    if (drags(2) || (drags(0) && io.KeyShift)) {
      controls_.camera.pan(x, y, static_cast<double>(area_.height));
    } else if (drags(0)) {
      controls_.camera.orbit(-x * per_pixel, y * per_pixel);
    } else if (drags(1)) {
      controls_.camera.dolly(0.03 * (x - y));
    }
    if (io.MouseWheel != 0) controls_.camera.dolly(static_cast<double>(io.MouseWheel));
    const ImVec2 drag = ImGui::GetMouseDragDelta(0, 0);
    if (ImGui::IsMouseReleased(0) && std::abs(drag.x) + std::abs(drag.y) < kClick) pick(io.MousePos.x, io.MousePos.y);
  }

  void pick(float x, float y) {
    if (!controls_.settings.look.skeleton) return;
    const Camera camera = controls_.camera.camera();
    const auto rows = view_matrix(camera);
    const auto scale = projection(camera, {0, 1}, static_cast<double>(area_.width) / std::max(1u, area_.height));
    const std::vector<Vec3> centres = scene_.joint_centres(controls_);
    double nearest = kPickRadius;
    controls_.joint.clear();
    for (std::size_t j = 0; j < centres.size(); ++j) {
      double at[3];
      for (std::size_t r = 0; r < 3; ++r) {
        at[r] = static_cast<double>(rows[r][3]);
        for (std::size_t i = 0; i < 3; ++i) at[r] += static_cast<double>(rows[r][i]) * centres[j][i];
      }
      const double w = camera.orthographic_height > 0 ? 1 : -at[2];
      if (w <= 0) continue;
      const double px = area_.x + 0.5 * area_.width * (1 + static_cast<double>(scale[0]) * at[0] / w);
      const double py = area_.y + 0.5 * area_.height * (1 - static_cast<double>(scale[1]) * at[1] / w);
      const double distance = std::hypot(px - static_cast<double>(x), py - static_cast<double>(y));
      if (distance >= nearest) continue;
      nearest = distance;
      controls_.joint = scene_.lead().basis().skeleton.joints[j].name;
    }
  }

  void measure(Clock::time_point start) {
    const Clock::time_point now = Clock::now();
    const double interval = seconds_between(last_picture_, now);
    last_picture_ = now;
    snapshot_.shown_fps += 0.1 * ((interval > 0 && interval < 1 ? 1 / interval : 0) - snapshot_.shown_fps);
    snapshot_.frame_ms = 1e3 * seconds_between(start, now);
    snapshot_.draw_ms = 1e3 * viewport_.seconds();
    snapshot_.stage_ms.clear();
    for (const auto& [stage, seconds] : scene_.stage_seconds()) snapshot_.stage_ms[stage] = 1e3 * seconds;
    snapshot_.memory_mib = resident_mib();
    const Evaluation* evaluation = scene_.lead_evaluation();
    if (!evaluation || evaluation->outside.empty()) return;
    snapshot_.strains = evaluation->strains;
    snapshot_.outside = evaluation->outside[0];
    snapshot_.outside_feature =
        snapshot_.outside > 0 ? feature_name(scene_.lead().basis(), evaluation->outside_feature[0]) : "";
  }

  void describe_cast() {
    bodyopt::describe_cast(scene_, snapshot_);
    const Basis& basis = scene_.lead().basis();
    if (!options_.limits.empty()) {
      limit_joints(read_joint_limits(options_.limits, basis.skeleton), basis.skeleton, snapshot_.joints);
    }
    controls_.joint_names.clear();
    for (const JointRow& row : snapshot_.joints) controls_.joint_names.push_back(row.name);
    controls_.control_names = basis.residual.controls;
    snapshot_.device = device_->info().name;
    curve_.forget();
    if (window_) window_->set_title(scene_.lead().name() + " \xe2\x80\x93 Bodyopt");
  }

  // Names that panels show in their own script.
  std::vector<std::string> names() const {
    std::vector<std::string> all = options_.files;
    std::ranges::copy(controls_.joint_names, std::back_inserter(all));
    std::ranges::copy(controls_.control_names, std::back_inserter(all));
    std::ranges::copy(snapshot_.fibres, std::back_inserter(all));
    for (const CharacterRow& row : snapshot_.cast) all.push_back(row.clip);
    return all;
  }

  // False where there is nothing to measure: live poses are of no frame, and coarser levels are there to keep up.
  bool measures_errors() const { return !live_ && scene_.lead().level() == 0; }

  bool look_at_errors() {
    if (!measures_errors()) return false;
    if (curve_.look_at(scene_.lead(), controls_.settings)) controls_.marker.reset();
    return true;
  }

  bool can_measure() const { return measures_errors() && !curve_.is_complete() && !controls_.playback.playing(); }

  // For as long as nobody notices.
  void measure_errors() {
    if (!look_at_errors() || !can_measure() || ImGui::IsAnyMouseDown()) return;
    const Clock::time_point start = Clock::now();
    while (curve_.measure_next(scene_.lead(), controls_.playback.frame())) {
      if (seconds_between(start, Clock::now()) > kMeasuring) break;
    }
    const bool is_late = seconds_between(last_picture_, Clock::now()) > kIdle;
    if (is_late || curve_.is_complete()) pending_pictures_ = std::max(pending_pictures_, 1);
  }

  void require_comparison() {
    if (!look_at_errors() || curve_.errors().empty())
      throw Error(ErrorKind::usage, "nothing is compared: begin with 'compare truth'");
  }

  // In a window the measuring goes on between pictures, and the request stays until it is done.
  void go_to_worst_frame() {
    require_comparison();
    controls_.playback.pause();
    if (window_ && !curve_.is_complete()) {
      controls_.requests.worst_frame = true;
      return;
    }
    while (curve_.measure_next(scene_.lead(), controls_.playback.frame())) {
    }
    const std::optional<std::size_t> worst = curve_.worst();
    if (worst) controls_.playback.scrub(snapshot_.first_frame + static_cast<int>(*worst));
  }

  void go_to_worst_vertex() {
    require_comparison();
    controls_.playback.pause();
    const int frame = controls_.playback.frame();
    curve_.measure_next(scene_.lead(), frame);
    const FrameError& error = curve_.errors().at(static_cast<std::size_t>(frame - snapshot_.first_frame));
    if (!std::isfinite(error.rms)) throw Error(ErrorKind::usage, "there is nothing to compare with in this frame");
    controls_.marker = Marker{frame, error.worst};
    OrbitView view = controls_.camera.view();
    view.target = error.worst;
    view.distance = kNearVertex * scene_.lead().size();
    controls_.camera = OrbitCamera(view);
  }

  // What was asked for meanwhile, now that there is a picture.
  void fulfil() {
    Requests requests = std::exchange(controls_.requests, {});
    controls_.requests.quit = requests.quit;
    for (const std::string& file : requests.open) attempt([&] { open(file); });
    if (requests.screenshot) attempt([&] { write_screenshot(*requests.screenshot); });
    if (requests.sequence) attempt([&] { write_sequence(*requests.sequence); });
    if (requests.turntable) attempt([&] { write_turntable(*requests.turntable); });
    if (requests.save_state) attempt([&] { save_state(*requests.save_state); });
    if (requests.load_state) attempt([&] { load_state(*requests.load_state); });
    if (requests.reload) attempt([&] { reload(); });
    if (requests.reset_jiggle) scene_.reset_jiggle();
    if (requests.worst_frame) attempt([&] { go_to_worst_frame(); });
    if (requests.worst_vertex) attempt([&] { go_to_worst_vertex(); });
  }

  void save_state(const std::string& file) {
    controls_.settings.camera = controls_.camera.view();
    write_view_settings(controls_.settings, file);
    controls_.say("wrote " + file);
  }

  void write_screenshot(std::string file) {
    for (int k = 1; file.empty(); ++k) {
      const fs::path next = FrameSequenceName(kNewScreenshot, 2)(k);
      if (!fs::exists(next)) file = next.string();
    }
    settle();
    write_png(draw_still(), file);
    controls_.say("wrote " + file);
  }

  std::array<std::uint32_t, 2> picture_size() const {
    const auto [width, height] =
        window_ ? window_->size() : std::array<std::uint32_t, 2>{options_.width, options_.height};
    return {std::min(width, kMaxPictureSize), std::min(height, kMaxPictureSize)};
  }

  // Drawn once more, at its best, and without messages.
  // Panels take their sizes from the picture before.
  void settle() {
    for (int k = 0; k < 3; ++k) draw_still();
  }

  Image draw_still() {
    const auto [width, height] = picture_size();
    std::vector<Message> messages = std::exchange(controls_.messages, {});
    draw(width, height, Edges::smooth);
    controls_.messages = std::move(messages);
    return viewport_.picture();
  }

  // The range in pictures, or in one that moves.
  void write_sequence(const std::string& pattern) {
    Playback& playback = controls_.playback;
    const bool flip_book = fs::path(pattern).extension() == ".webp";
    const bool moves = flip_book || pattern.find_first_of("#%") != std::string::npos;
    playback.pause();
    const int shown = playback.frame(), first = moves ? playback.in() : shown, last = moves ? playback.out() : shown;
    const std::size_t count = static_cast<std::size_t>(last - first + 1);
    const FrameSequenceName name(pattern, flip_book ? 1 : count);
    std::vector<Image> pictures;
    Progress progress("pictures", count, kKept);
    for (int frame = first; frame <= last; ++frame) {
      playback.scrub(frame);
      if (flip_book) {
        pictures.push_back(draw_still());
      } else {
        write_png(draw_still(), name(frame));
      }
      progress.advance();
    }
    if (flip_book) {
      const auto bytes = encode_animation(pictures, 1e3 / scene_.lead().clip().fps / playback.speed());
      write_file_atomically(pattern, std::as_bytes(std::span(bytes)));
    }
    playback.scrub(shown);
    controls_.say("wrote " + std::to_string(count) + " pictures, " + name(shown).string());
  }

  void write_turntable(const std::string& pattern) {
    const FrameSequenceName name(pattern, kTurntablePictures);
    const OrbitCamera camera = controls_.camera;
    Progress progress("pictures", kTurntablePictures, kKept);
    for (int k = 0; k < kTurntablePictures; ++k) {
      write_png(draw_still(), name(k + 1));
      progress.advance();
      controls_.camera.orbit(2 * std::numbers::pi / kTurntablePictures, 0);
    }
    controls_.camera = camera;
    controls_.say("wrote " + std::to_string(kTurntablePictures) + " pictures, " + name(1).string());
  }

  const ViewerOptions options_;
  std::unique_ptr<Window> window_;  // none when headless; outlives all that draws
  std::shared_ptr<const vulkan::Device> device_;
  Viewport viewport_;
  std::unique_ptr<Gui> gui_;
  Scene scene_;
  Controls controls_;
  Snapshot snapshot_;
  std::unique_ptr<WatchedFiles> watched_;
  std::unique_ptr<LivePose> live_;
  std::deque<std::string> script_;    // commands that have not run
  std::vector<std::string> dropped_;  // files, onto the window
  std::optional<Vec3> followed_;      // where the lead was in the last picture
  DetailChoice detail_;
  ErrorCurve curve_;
  Rectangle area_;            // of the characters in the last picture
  int pending_pictures_ = 2;  // to be drawn although nothing moves
  bool was_busy_ = false;
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
