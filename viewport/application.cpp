#include "viewport/application.h"

#include <imgui.h>

#include <algorithm>
#include <chrono>
#include <ctime>
#include <filesystem>
#include <iomanip>
#include <limits>
#include <sstream>
#include <utility>

#include "assets/clips/clip_source.h"
#include "shots/session/session_file.h"
#include "viewport/commands/commands.h"
#include "viewport/commands/keymap_file.h"
#include "viewport/pin_joint.h"
#include "viewport/platform/window.h"
#include "viewport/work_files.h"

namespace bodyopt::viewport {
namespace {

constexpr double kIdle = 0.25;     // seconds between looks at files while nothing happens
constexpr double kBusy = 0.004;    // and at the clock or a stream of poses
constexpr double kProgress = 0.5;  // between pictures of the window while others are written
const char* const kFlipKey = "X";  // while it is down, what is compared with is shown

}  // namespace

Application::Application(const ViewerOptions& options, std::shared_ptr<const vulkan::Device> device, Screen* screen)
    : options_(options),
      screen_(screen),
      session_(device, options_),
      errors_(session_.scene, controls_, device->info().type != "cpu"),
      painter_(device, session_, errors_, screen, {options.width, options.height}),
      pictures_(painter_, session_),
      autosave_(options.user_folder),
      recent_(options.user_folder) {
  controls_.headless = !screen;
  controls_.panels = controls_.settings.hud.on = screen != nullptr;
  open_files();
  begin();
}

// Without the first there is nothing to see.
void Application::open_files() {
  painter_.show_loading(options_.files.empty() ? "the built-in arm" : options_.files.front());
  for (const std::string& note : session_.open_first()) controls_.warn(note);
  if (!options_.truth.empty()) {
    controls_.attempt([&] { session_.open_truth(session_.scene.lead(), options_.truth); });
  }
  set_title();
  for (std::size_t k = 1; k < options_.files.size(); ++k) {
    painter_.show_loading(options_.files[k]);
    controls_.attempt([&] { open(options_.files[k]); });
  }
}

void Application::begin() {
  controls_.has_unsaved_work = [this] { return session_.work() != saved_; };
  session_.play_clip();
  controls_.camera.orbit(0.45, 0.18);
  controls_.requests.frame_selection = true;
  session_.framing.follow();
  const bool restored = session_.restore_view();
  if (!options_.state.empty()) session_.load_state(options_.state);
  begin_frames(restored);
  if (options_.live_port) session_.listen(*options_.live_port);
  if (screen_) controls_.say("H: all keys");
  session_.framing.follow();
  if (controls_.requests.frame_selection) frame_what_comes();
  note_saved();
  if (!options_.files.empty()) remember(options_.files.front());
  controls_.recent = recent_.list();
  controls_.attempt([&] { controls_.keymap = read_keymap(options_.user_folder); });
  if (options_.commands.empty()) offer_unsaved();
  const std::vector<std::string> commands = script_commands(options_.commands);
  script_.assign(commands.begin(), commands.end());
}

void Application::begin_frames(bool restored) {
  Playback& playback = controls_.playback;
  for (const std::optional<int>& frame : {options_.first, options_.last, options_.current}) {
    if (frame) playback.require_frame(*frame);
  }
  if (options_.first || options_.last) {
    playback.set_range(options_.first.value_or(playback.first()), options_.last.value_or(playback.last()));
  }
  playback.scrub(options_.current.value_or(restored ? playback.frame() : playback.in()));
}

// A sequence without a window is framed as a whole: nobody is there to move the camera.
void Application::frame_what_comes() {
  if (!screen_ && shows_motion(options_.out)) {
    session_.framing.frame_range(options_.width, options_.height);
  } else {
    session_.framing.frame_selection(options_.width, options_.height);
  }
}

void Application::open_meanwhile(const std::string& file) {
  painter_.show_message("loading " + std::filesystem::path(file).filename().string());
  open(file);
}

void Application::open(const std::string& file) {
  errors_.forget();
  const std::size_t cast = session_.scene.cast().size();
  const bool is_whole = shots::is_session(file);
  if (is_whole) keep_unsaved();
  for (const std::string& note : session_.open(file)) controls_.warn(note);
  if (is_whole) note_saved();
  if (is_whole || session_.scene.cast().size() > cast) remember(file);
  set_title();
}

void Application::offer_unsaved() {
  controls_.recoverable = autosave_.left_behind().string();
  if (controls_.recoverable.empty()) return;
  std::error_code gone;  // another viewport may have taken it since
  const auto written = std::filesystem::last_write_time(controls_.recoverable, gone);
  if (gone) return controls_.recoverable.clear();
  const auto system = std::chrono::file_clock::to_sys(written);
  const std::time_t time = std::chrono::system_clock::to_time_t(std::chrono::floor<std::chrono::seconds>(system));
  std::tm local{};
  localtime_r(&time, &local);
  std::ostringstream text;
  controls_.attempt([&] {
    const shots::SessionFile session = shots::read_session(controls_.recoverable);
    const shots::ActorFiles& lead = session.cast.front().files;
    const std::string& of = !session.saved_as.empty() ? session.saved_as : lead.basis;
    text << (of.empty() ? "the built-in arm" : std::filesystem::path(of).filename().string()) << ", ";
  });
  text << std::put_time(&local, "%Y-%m-%d %H:%M");
  controls_.recoverable_what = text.str();
}

void Application::note_saved() { saved_ = session_.work(); }

void Application::remember(const std::string& file) {
  if (!screen_) return;
  controls_.folder = std::filesystem::absolute(split_source(file).path).parent_path().string();
  controls_.attempt([&] { recent_.remember(file); });
  controls_.recent = recent_.list();
}

// The next viewport offers what the next session replaces.
void Application::keep_unsaved() {
  if (session_.work() == saved_) return;
  autosave();
  autosaved_ = {};
  if (autosave_.leave()) controls_.say("what was not saved is kept: the next viewport offers it");
}

void Application::save(const std::string& file) {
  session_.save(file);
  note_saved();
  autosave_.forget();
  autosaved_ = {};
  remember(file);
  if (std::exchange(controls_.quits_when_saved, false)) controls_.requests.quit = true;
}

void Application::autosave() {
  next_autosave_ = now_ + kAutosaveEvery;
  Session::Work work = session_.work();
  if (work == saved_ || work == autosaved_) return;
  controls_.attempt([&] {
    const std::string file = autosave_.file().string();
    if (file.empty()) return;
    const std::string& own = controls_.session_file;
    session_.write(file, own.empty() ? own : std::filesystem::absolute(own).string());
    autosaved_ = std::move(work);
  });
}

// The recovered session is unsaved still, and this viewport's to lose.
void Application::recover(bool wanted) {
  const std::string left = std::exchange(controls_.recoverable, "");
  if (!wanted) {
    std::filesystem::remove(left);
    return;
  }
  keep_unsaved();
  const Session::Work saved = saved_;
  change_cast([&] { session_.open(left); });
  saved_ = saved;
  controls_.session_file = shots::read_session(left).saved_as;
  autosave_.take_over(left);
  autosaved_ = session_.work();
  controls_.say("here is what was not saved: 'save' keeps it");
}

void Application::set_title() {
  if (screen_) screen_->set_title(session_.scene.lead().name() + " \xe2\x80\x93 Bodyopt");
}

// Forgets what was measured of the lead. The cast stays as it is.
template <typename Action>
void Application::change_shapes(const Action& action) {
  action();
  errors_.forget();
  painter_.forget_heat();
}

template <typename Action>
void Application::change_cast(const Action& action) {
  change_shapes(action);
  set_title();
  session_.expect_poses_of_lead();
}

void Application::reload(const std::vector<std::filesystem::path>& files) {
  change_cast([&] { session_.reload(files); });
}

void Application::make_pictures() {
  do {
    run_script();
    do {
      pending_pictures_ = 0;
      look_at_poses();
    } while (shows_poses() && controls_.pose_library.has_work() && !painter_.is_busy());
    painter_.draw(painter_.size(), draw::Edges::smooth);
    fulfil();
  } while (!script_.empty() && !is_done());
  if (options_.out.empty()) return;
  painter_.settle();
  pictures_.take_sequence(options_.out);
}

double Application::patience() const {
  const bool draws_poses = shows_poses() && controls_.pose_library.has_work() && !painter_.is_busy();
  if (pictures_.goes_on() || pending_pictures_ > 0 || !unheard_.empty() || !options_.vsync || errors_.has_work() ||
      draws_poses)
    return 0;
  return controls_.playback.playing() || session_.listens() ? kBusy : kIdle;
}

void Application::turn(std::span<const WindowEvent> events, double passed) {
  now_ += passed;
  controls_.attempt([&] { act(events, passed); });
  if (controls_.messages.size() != std::exchange(said_, controls_.messages.size())) pending_pictures_ = 2;
}

void Application::act(std::span<const WindowEvent> events, double passed) {
  unheard_.insert(unheard_.end(), events.begin(), events.end());
  if (!unheard_.empty()) pending_pictures_ = 2;  // panels answer events a picture late
  hear_some();
  if (pictures_.goes_on()) return go_on_with_pictures(passed);
  const int shown = controls_.playback.frame();
  // The jiggle steps every frame: a late picture must not make the next one later.
  constexpr std::int64_t kMostJiggled = 2, kAll = std::numeric_limits<std::int64_t>::max();
  controls_.playback.advance(passed, controls_.settings.jiggle.on ? kMostJiggled : kAll);
  if (session_.poll_live()) pending_pictures_ = std::max(pending_pictures_, 1);
  look_at_files();
  if (session_.sectioning.has_news()) pending_pictures_ = 2;
  run_script();
  look_at_poses();
  measure_errors();
  draw_if_needed(controls_.playback.frame() != shown || !options_.vsync, passed);
}

void Application::draw_if_needed(bool moves, double passed) {
  if (!moves && pending_pictures_ == 0) return;
  pending_pictures_ = std::max(0, pending_pictures_ - 1);
  const auto [width, height] = painter_.size();
  if (width == 0 || height == 0) return;  // minimised
  const draw::Edges edges = painter_.edges();
  was_busy_ = painter_.is_busy();
  painter_.draw({width, height}, edges, std::max(passed, now_ - last_picture_));
  last_picture_ = now_;
  painter_.show();
  if (painter_.hides_window()) pending_pictures_ = std::max(pending_pictures_, 1);
  if (edges == draw::Edges::quick) pending_pictures_ = std::max(pending_pictures_, was_busy_ ? 0 : 1);
  fulfil();
}

void Application::go_on_with_pictures(double passed) {
  pictures_.go_on();
  pending_pictures_ = 2;
  progress_ += passed;
  if (!pictures_.goes_on() || progress_ < kProgress) return;
  progress_ = 0;
  pictures_.show_progress();
}

// Hears events up to Enter: the prompt that it opens or ends is drawn first, however fast somebody types. It stops at a
// button that goes down, too: a picture has it where the mouse was, however far it goes meanwhile. A field hears
// letters and Ctrl in different pictures, as it takes no letter with Ctrl, and one of Ctrl+A and Ctrl+C.
void Application::hear_some() {
  for (bool is_first = true; !unheard_.empty(); is_first = false) {
    const auto* held = std::get_if<ModifierKeysEvent>(&unheard_.front());
    if (held && !is_first && held->control != ImGui::GetIO().KeyCtrl && is_typing()) return;
    const WindowEvent event = std::move(unheard_.front());
    unheard_.pop_front();
    const bool typed = is_typing();
    hear(event);
    const auto* key = std::get_if<KeyEvent>(&event);
    const auto* button = std::get_if<ButtonEvent>(&event);
    if (button && button->down) return;
    if (!key || key->action != KeyAction::pressed) continue;
    if (key->name == "Enter" || (typed && key->name.starts_with("Ctrl+"))) return;
  }
}

bool Application::is_typing() const { return takes_text() || controls_.prompt || controls_.dialog; }

void Application::hear(const WindowEvent& event) {
  painter_.hear(event);
  if (const auto* key = std::get_if<KeyEvent>(&event)) hear_key(*key);
  if (std::holds_alternative<CloseEvent>(event)) quit();
  if (const auto* drop = std::get_if<DropEvent>(&event)) {
    for (const std::string& file : drop->files) controls_.requests.open.push_back(file);
  }
}

void Application::hear_key(const KeyEvent& event) {
  const std::string& key = event.name;
  if (event.action == KeyAction::released) {
    if (bare_key(key) == kFlipKey) controls_.flipped = false;  // shift and the like may have gone down meanwhile
    return;
  }
  if (pictures_.goes_on() && !pictures_.stops()) return hear_key_in_series(key);
  if (controls_.prompt || controls_.dialog) {  // whose field may not be drawn yet
    if (key == "Enter" && event.action == KeyAction::pressed) controls_.typed.entered = true;
    return;
  }
  if (takes_text() || controls_.asks_to_save) return;
  if (key == kFlipKey) controls_.flipped = true;
  const Command* command = find_command_by_key(key, controls_.keymap);
  if (!command || (event.action == KeyAction::repeated && !command->repeats)) return;
  controls_.attempt([&] { run_command(controls_, command->name); });
  // Letters typed before the command were keys, however late they are heard.
  if (is_typing()) ImGui::GetIO().InputQueueCharacters.clear();
}

// Nothing else shall change pictures that are being written.
void Application::hear_key_in_series(const std::string& key) {
  if (key == "Escape") pictures_.stop();
  if (find_command_by_key(key, controls_.keymap) == find_command("quit")) quit();
}

void Application::quit() {
  controls_.quit_or_ask();
  if (controls_.asks_to_save && pictures_.goes_on()) pictures_.stop();
}

// Runs commands until one asks for something: that is done, and a picture drawn, before the others run.
void Application::run_script() {
  while (!script_.empty() && controls_.requests == Requests{}) {
    controls_.follow_keys();
    session_.framing.follow();
    const std::string command = std::move(script_.front());
    script_.pop_front();
    controls_.scripted = true;
    controls_.attempt([&] { run_command(controls_, command); });
    controls_.scripted = false;
    script_waits_ = !(controls_.requests == Requests{});
    pending_pictures_ = 2;
  }
}

void Application::look_at_files() {
  if (now_ < next_look_) return;
  next_look_ = now_ + kIdle;
  if (now_ >= next_autosave_) autosave();
  if (!controls_.messages.empty() || (was_busy_ && !controls_.playback.playing()))
    pending_pictures_ = std::max(pending_pictures_, 1);
  const std::vector<std::filesystem::path> changed = session_.changed_files(now_);
  if (changed.empty()) return;
  pending_pictures_ = 2;
  controls_.attempt([&] { reload(changed); });
}

bool Application::shows_poses() const {
  const shots::Section& section = *std::ranges::find(shots::kSections, std::string("poses"), &shots::Section::name);
  return controls_.panels && shots::shows_side_panel(controls_.settings) && shots::is_open(controls_.settings, section);
}

// One picture a turn, while nothing else is to be done.
void Application::look_at_poses() {
  PoseLibrary& poses = controls_.pose_library;
  if (!shows_poses()) return;
  if (!screen_ || now_ >= next_poses_ || poses.has_more()) {
    next_poses_ = now_ + kIdle;
    if (poses.look(controls_.shown_pose_folder())) pending_pictures_ = 2;
  }
  const PoseFile* const next = poses.without_picture();
  if (!next || painter_.is_busy() || pending_pictures_ > 0) return;
  draw::Image picture{kPosePicture, kPosePicture,
                      std::vector<std::uint8_t>(4 * kPosePicture * kPosePicture)};  // where it fails
  controls_.attempt([&] { picture = painter_.draw_portrait(next->pose); });
  poses.set_picture(std::filesystem::path(next->path), std::move(picture));
  pending_pictures_ = 2;
}

void Application::measure_errors() {
  errors_.look();
  if (!errors_.has_work() || ImGui::IsAnyMouseDown()) return;
  errors_.measure_some();
  if (now_ - last_picture_ > kIdle || !errors_.has_work()) pending_pictures_ = std::max(pending_pictures_, 1);
}

// A script waits until all frames are measured, one by one where there is a window.
void Application::go_to_worst_frame() {
  controls_.playback.pause();
  if (!screen_) errors_.measure_all();
  if (screen_ && script_waits_ && errors_.has_work()) {
    controls_.requests.worst_frame = true;
  } else {
    errors_.go_to_worst_frame();
  }
}

// Fulfils requests once there is a picture.
void Application::fulfil() {
  const Requests requests = std::exchange(controls_.requests, {});
  controls_.requests.quit = requests.quit;
  fulfil_of_files(requests);
  fulfil_of_dataset(requests);
  const auto attempt = [&](const auto& asked, const auto& action) {
    if (asked) controls_.attempt(action);
  };
  attempt(requests.frame_range, [&] { session_.framing.frame_range(painter_.area().width, painter_.area().height); });
  attempt(requests.keep_keymap, [&] { write_keymap(controls_.keymap, options_.user_folder); });
  attempt(requests.pin, [&] { pin_joint(*requests.pin, session_.scene, controls_); });
  attempt(requests.screenshot, [&] { pictures_.take_screenshot(*requests.screenshot); });
  attempt(requests.sequence, [&] { pictures_.take_sequence(*requests.sequence); });
  attempt(requests.turntable, [&] { pictures_.take_turntable(*requests.turntable); });
  attempt(requests.save, [&] { save(*requests.save); });
  if (requests.save) controls_.quits_when_saved = false;
  attempt(requests.save_pose, [&] {
    save_pose(session_.scene, controls_, *requests.save_pose);
    if (!screen_) return;
    draw::write_png(painter_.draw_portrait(controls_.settings.pose), picture_of_pose(*requests.save_pose));
    pending_pictures_ = 2;
  });
  attempt(requests.load_pose, [&] { load_pose(*requests.load_pose, controls_); });
  attempt(requests.recover, [&] { recover(*requests.recover); });
  if (requests.export_clip || requests.export_skin || requests.sequence) autosave();
  attempt(requests.save_markers, [&] { save_markers(session_.scene, controls_, *requests.save_markers); });
  attempt(requests.save_state, [&] { session_.save_state(*requests.save_state); });
  attempt(requests.export_clip, [&] { export_clip(session_.scene, controls_, *requests.export_clip); });
  attempt(requests.export_skin, [&] { export_skin(session_.scene, controls_, *requests.export_skin); });
  attempt(requests.load_state, [&] { session_.load_state(*requests.load_state); });
  attempt(requests.reload, [&] { reload(session_.scene.paths()); });
  if (requests.reset_jiggle) session_.scene.reset_jiggle();
  attempt(requests.worst_frame, [&] { go_to_worst_frame(); });
  attempt(requests.worst_vertex, [&] { errors_.go_to_worst_vertex(); });
  if (controls_.requests == Requests{}) script_waits_ = false;
}

void Application::fulfil_of_files(const Requests& requests) {
  for (const std::string& file : requests.open) controls_.attempt([&] { open_meanwhile(file); });
  for (const std::string& file : requests.add) {
    controls_.attempt([&] {
      painter_.show_message("loading " + std::filesystem::path(file).filename().string());
      change_cast([&] {
        for (const std::string& note : session_.open_character(file)) controls_.warn(note);
      });
      remember(file);
    });
  }
  if (requests.unit) controls_.attempt([&] { change_cast([&] { session_.use_unit(*requests.unit); }); });
  if (requests.sound) controls_.attempt([&] { session_.use_sound(*requests.sound); });
  if (requests.same_clip) controls_.attempt([&] { change_cast([&] { session_.give_same_clip(); }); });
  if (requests.limits) controls_.attempt([&] { change_cast([&] { session_.use_limits(*requests.limits); }); });
  if (requests.lead) controls_.attempt([&] { change_cast([&] { session_.make_lead(*requests.lead); }); });
  if (requests.remove) controls_.attempt([&] { change_cast([&] { session_.remove(*requests.remove); }); });
}

void Application::fulfil_of_dataset(const Requests& requests) {
  for (const ModifierEdit& edit : requests.edits) {
    controls_.attempt([&] { change_cast([&] { session_.edit_stack(edit); }); });
  }
  if (requests.step_back) controls_.attempt([&] { change_cast([&] { session_.step_stack(*requests.step_back); }); });
  if (requests.stroke) {
    controls_.attempt([&] { session_.brushing.stroke(painter_.area(), *requests.stroke); });
  }
  if (requests.stroke || requests.keep_strokes) {
    controls_.attempt([&] { change_shapes([&] { session_.keep_strokes(); }); });
  }
  if (requests.contradictions) controls_.attempt([&] { session_.curation.find_contradictions(controls_); });
}

}  // namespace bodyopt::viewport
