#include "viewport/session.h"

#include <algorithm>
#include <initializer_list>
#include <iostream>
#include <iterator>
#include <utility>

#include "assets/clips/clip_source.h"
#include "dataset/modifier.h"
#include "runtime/core/error.h"
#include "runtime/core/file_kind.h"
#include "shots/shot_files.h"
#include "trainer/transfer/markers_file.h"
#include "viewport/describe_scene.h"
#include "viewport/scene/truth_times.h"
#include "viewport/work_files.h"

namespace bodyopt::viewport {
namespace {

namespace fs = std::filesystem;

bool has_extension(const std::string& file, std::initializer_list<const char*> extensions) {
  const std::string own = lower_case_extension(split_source(file).path);
  return std::any_of(extensions.begin(), extensions.end(), [&](const char* e) { return own == e; });
}

}  // namespace

Session::Session(std::shared_ptr<const vulkan::Device> device, const ViewerOptions& options)
    : scene(device),
      matching(device, scene, controls),
      sectioning(device, scene, controls),
      image_plane(device),
      options_(options),
      clip_options_(options.clip),
      device_name_(device->info().name),
      watched_({}) {
  controls.root_x = [this](int frame) { return scene.root_place(frame)[0]; };
}

std::vector<std::string> Session::open_first() {
  const std::string file = options_.files.empty() ? "" : options_.files.front();
  const bool dataset = trainer::is_dataset(file);
  if (!dataset && has_extension(file, {".json"})) {
    if (!options_.proxy.empty() || !options_.character.empty() || !options_.limits.empty() ||
        !options_.joint_map.empty() || !options_.up.empty()) {
      throw Error(ErrorKind::usage, file + ": a session names the files of its characters itself: leave out --proxy, " +
                                        "--character, --limits, --joint-map and --up");
    }
    open_session(file);
    return {};
  }
  const bool is_clip = !split_source(file).name.empty();
  if (is_clip || (fs::exists(file) && !dataset && !is_character(file))) {
    throw Error(
        ErrorKind::usage,
        file + ": a basis (.safetensors) or a character (.glb, .gltf, .fbx) must come before its clips and caches" +
            looks_like(file));
  }
  shots::ActorFiles files = dataset ? files_of_dataset(file) : shots::ActorFiles{.basis = file};
  files.proxy = options_.proxy;
  files.character = options_.character;
  files.limits = options_.limits;
  if (!options_.muscles.empty()) files.muscles = options_.muscles;
  files.joint_map = options_.joint_map;
  files.up = options_.up;
  std::vector<std::string> notes = add(files);
  if (dataset) controls.settings.compare.with = shots::CompareWith::truth;
  take_note_of_cast();
  return notes;
}

std::vector<std::string> Session::open(const std::string& file) {
  std::vector<std::string> notes;
  Actor& receiver = *scene.cast()[receiver_];
  if (trainer::is_dataset(file)) {
    const std::string path = files_of_dataset(file).truth, before = receiver.files().clip;
    open_truth(receiver, path);
    receiver.open_clip(path);
    if (!before.empty() && before != path) {
      notes.push_back(fs::path(before).filename().string() + ": in its place play the frames of " + file +
                      ", which have shapes to compare with");
    }
    if (receiver_ == 0) play_clip();
  } else if (is_character(file)) {
    return open_character(file);
  } else if (is_called_scene(split_source(file).path) || has_extension(file, {".bvh"})) {
    receiver.open_clip(file);
    notes = receiver.clip().notes;
    const std::string path = split_source(file).path.string();
    if (is_called_scene(path) && split_source(file).name.empty() && shots::is_another_character(path, Skeleton())) {
      notes.push_back(file + ": its clip is played; 'character' shows its skin as one more of the cast");
    }
    if (receiver_ == 0) play_clip();
  } else if (has_extension(file, {".pc2", ".mdd"})) {
    open_truth(receiver, file);
    return notes;
  } else if (has_extension(file, {".json"}) && shots::is_session(file)) {
    open_session(file);
    restore_view();
    return notes;
  } else if (has_extension(file, {".json"}) && trainer::is_markers(file)) {
    load_markers(file, controls);
  } else if (has_extension(file, {".json"})) {
    load_state(file);
  } else {
    throw Error(ErrorKind::usage,
                file +
                    ": expected a basis (.safetensors), a character (.glb, .gltf, .fbx), a clip "
                    "(.glb, .gltf, .fbx, .bvh), a point cache (.pc2, .mdd), a session, markers or a state (.json)" +
                    looks_like(file));
  }
  take_note_of_cast();
  return notes;
}

std::vector<std::string> Session::open_character(const std::string& file) {
  std::vector<std::string> notes = add({.basis = file});
  receiver_ = scene.cast().size() - 1;
  controls.requests.frame_selection = true;  // to see it, too
  take_note_of_cast();
  return notes;
}

void Session::use_unit(double metres) {
  const double before = std::exchange(clip_options_.unit, metres);
  try {
    replace_lead(scene.lead().files());
  } catch (...) {
    clip_options_.unit = before;
    throw;
  }
  controls.requests.frame_selection = true;
}

// A dataset opens its character by Direct Delta Mush, its frames, and their shapes.
shots::ActorFiles Session::files_of_dataset(const std::string& file) {
  const fs::path path = fs::is_directory(file) ? fs::path(file) / "dataset.json" : fs::path(file);
  const Dataset dataset = read_dataset(path);
  if (scene.empty()) clip_options_.unit = dataset.unit;
  return {.basis = (dataset.folder / dataset.character).string(),
          .clip = path.string(),
          .truth = path.string(),
          .muscles = dataset.muscles.empty() ? "" : (dataset.folder / dataset.muscles).string()};
}

// Modifiers of a stack may change its frames: mirrored poses come, and dropped ones go.
void Session::read_dataset_again() {
  brushing.forget();
  const std::string dataset = scene.lead().files().truth;
  const bool has_its_frames = std::ranges::all_of(scene.cast(), [&](const std::unique_ptr<Actor>& character) {
    return character->files().truth != dataset || character->reread_truth();
  });
  if (!has_its_frames) reload({dataset});
  watch();
}

void Session::edit_stack(const ModifierEdit& edit) {
  curation.edit(edit);
  read_dataset_again();
}

void Session::keep_strokes() {
  curation.require_open();
  if (!brushing.has_change()) return;
  for (const std::string& note : brushing.keep()) controls.warn(note);
  read_dataset_again();
}

void Session::step_stack(bool back) {
  if (back && brushing.has_change()) return read_dataset_again();  // which could not be kept
  curation.step(back);
  read_dataset_again();
}

void Session::open_truth(Actor& character, const std::string& file) {
  character.open_truth(file);
  controls.settings.compare.with = shots::CompareWith::truth;
  take_note_of_cast();
}

bool Session::is_character(const std::string& file) const {
  if (has_extension(file, {".safetensors"})) return true;
  if (!is_called_scene(split_source(file).path)) return false;
  return shots::is_another_character(file, scene.empty() ? Skeleton{} : scene.cast()[receiver_]->basis().skeleton);
}

// Adds it with the joint limits in its folder, where they are its own.
std::vector<std::string> Session::add(shots::ActorFiles files) {
  const fs::path beside = fs::path(files.basis).parent_path() / "limits.json";
  std::vector<std::string> notes;
  if (files.limits.empty() && !files.basis.empty() && fs::exists(beside)) {
    try {
      shots::ActorFiles limited = files;
      limited.limits = beside.string();
      scene.add(limited, clip_options_);
    } catch (const Error& error) {
      if (error.kind() == ErrorKind::device) throw;
      notes.push_back(std::string("left out, as it stands beside the character: ") + error.what());
    }
  }
  if (scene.cast().size() == controls.placements.size()) scene.add(files, clip_options_);
  controls.placements.resize(scene.cast().size());
  number_cast();
  std::ranges::copy(scene.cast().back()->notes(), std::back_inserter(notes));
  if (const std::string& shown_by = scene.cast().back()->shown_by(); !shown_by.empty()) {
    std::cerr << shown_by << "\n";
    controls.say(shown_by);
  }
  return notes;
}

void Session::use_sound(const shots::SoundFile& sound) {
  snapshot.waveform = sound.file.empty() ? nullptr : std::make_shared<const Waveform>(read_waveform(sound.file));
  controls.sound = sound;
}

void Session::use_limits(const std::string& file) {
  shots::ActorFiles files = scene.lead().files();
  files.limits = file == "none" ? "" : file;
  replace_lead(files);
}

// The new lead is posed as the one before.
void Session::replace_lead(const shots::ActorFiles& files) {
  std::unique_ptr<Actor> actor = scene.make(files, clip_options_);
  actor->set_posing(scene.lead().posing());
  scene.swap(0, actor);
  take_note_of_cast();
  play_on();
}

// Each of the cast keeps its posing.
void Session::give_same_clip() {
  if (scene.lead().files().clip.empty()) {
    throw Error(ErrorKind::usage, "the lead plays no clip of a file that others could play: open one");
  }
  for (std::size_t c = 1; c < scene.cast().size(); ++c) {
    scene.cast()[c]->open_clip_of(scene.lead());
    for (const std::string& note : scene.cast()[c]->clip().notes) controls.warn(note);
  }
  take_note_of_cast();
}

void Session::reload(const std::vector<fs::path>& files) {
  std::vector<std::pair<std::size_t, std::unique_ptr<Actor>>> replacements;  // by place in the cast
  for (std::size_t c = 0; c < scene.cast().size(); ++c) {
    const shots::ActorFiles& own = scene.cast()[c]->files();
    const std::vector<fs::path> paths = scene.cast()[c]->paths();
    if (std::ranges::find_first_of(paths, files) == paths.end()) continue;
    replacements.emplace_back(c, scene.make(own, clip_options_));
  }
  for (auto& [index, actor] : replacements) {
    const std::uint32_t before = scene.cast()[index]->finest_basis().mesh.vertex_count();
    if (index < 2) matching.forget();
    sectioning.forget();
    if (index < 2 && actor->finest_basis().mesh.vertex_count() != before) forget_pair();  // markers number vertices
    actor->set_posing(scene.cast()[index]->posing());
    scene.swap(index, actor);
  }
  describe_cast();
  controls.say("the files were read again");
  play_on();
}

// Plays the lead's clip as it is now; the playhead stays, and goes on as it went.
void Session::play_on() {
  const Playback before = controls.playback;
  play_clip();
  controls.playback.scrub(before.frame());
  if (before.playing()) controls.playback.play();
}

void Session::make_lead(int number) {
  const std::size_t index = controls.cast_place(number);
  receiver_ = 0;
  if (index == 0) return;
  scene.lead().set_posing(controls.settings.pose);
  scene.make_lead(index);
  const auto put_first = [&](auto& list) {
    const auto lead = list.begin() + static_cast<std::ptrdiff_t>(index);
    std::rotate(list.begin(), lead, lead + 1);
  };
  put_first(controls.placements);
  put_first(controls.cast_numbers);
  show_lead();
}

void Session::remove(int number) {
  const std::size_t index = controls.cast_place(number);
  if (scene.cast().size() == 1) throw Error(ErrorKind::usage, "the only character stays: 'quit' closes the viewport");
  scene.remove(index);
  controls.placements.erase(controls.placements.begin() + static_cast<std::ptrdiff_t>(index));
  controls.cast_numbers.erase(controls.cast_numbers.begin() + static_cast<std::ptrdiff_t>(index));
  receiver_ = receiver_ == index ? 0 : receiver_ - (receiver_ > index ? 1 : 0);
  if (index == 0) return show_lead();
  if (index == 1) forget_pair();
  take_note_of_cast();
}

// Those who have come get numbers above all others.
void Session::number_cast() {
  std::vector<int>& numbers = controls.cast_numbers;
  while (numbers.size() < scene.cast().size()) {
    numbers.push_back(numbers.empty() ? 1 : *std::ranges::max_element(numbers) + 1);
  }
}

void Session::forget_pair() {
  controls.marking = {};
  matching.forget();
}

// Another is the lead now.
void Session::show_lead() {
  forget_pair();
  scene.leave_live_pose();
  controls.select("");
  controls.marker.reset();
  framing.forget_lead();
  controls.requests.frame_selection = true;  // the stage is around another
  pose_lead();
  take_note_of_cast();
  play_on();
}

// Restores the pose that it had as the lead, if it ever was. The correction is of all.
void Session::pose_lead() {
  const double correction = controls.settings.pose.correction;
  controls.settings.pose = scene.lead().posing();
  controls.settings.pose.correction = correction;
  controls.poses.begin(controls.settings);
  controls.keyed_frame.reset();
}

void Session::listen(std::uint16_t port) {
  const Basis& basis = scene.lead().basis();
  live_ = std::make_unique<LivePose>(port, basis.skeleton.size(), basis.residual.controls.size());
  controls.live = true;
  const std::string listening = "listening for poses on 127.0.0.1:" + std::to_string(live_->port());
  std::cerr << listening << "\n";
  controls.say(listening);
}

void Session::expect_poses_of_lead() {
  if (!live_) return;
  const Basis& basis = scene.lead().basis();
  try {
    if (live_->expect(basis.skeleton.size(), basis.residual.controls.size())) scene.leave_live_pose();
  } catch (...) {  // nor are those that were listened for
    live_.reset();
    controls.live.reset();
    snapshot.live.reset();
    scene.leave_live_pose();
    throw;
  }
}

bool Session::poll_live() {
  if (!live_) return false;
  if (!*controls.live) {
    scene.leave_live_pose();
    snapshot.live.reset();
    return false;
  }
  const std::size_t rejected = live_->rejected();
  std::optional<Pose> pose = live_->poll();
  const bool is_new = pose || live_->rejected() > rejected;
  if (pose) scene.set_live_pose(std::move(*pose));
  snapshot.live = LiveRow{live_->frame(), live_->rejected(), live_->last_rejection()};
  return is_new;
}

bool Session::restore_view() {
  if (!opened_) return false;
  const shots::SessionFile session = *std::exchange(opened_, std::nullopt);
  play_clip();
  controls.playback.scrub(session.frame);
  framing.follow();
  use_settings(session.view);
  controls.image_plane = session.image_plane;
  controls.sound = session.sound;
  snapshot.waveform.reset();
  try {
    use_sound(session.sound);
  } catch (const Error& error) {
    controls.warn(error.what());
  }
  controls.poses.begin(controls.settings);
  controls.keyed_frame = controls.playback.frame();
  return true;
}

void Session::use_settings(const shots::ViewSettings& settings) {
  controls.settings = settings;
  controls.go_to_camera(controls.settings.camera);
  require_shot_camera();
  play_as(controls.settings.playback);
  controls.requests.frame_selection = false;
  warn_of_rates();
}

void Session::play_clip() {
  const Clip& clip = scene.lead().clip();
  const shots::PlaySettings before = controls.playback.settings();
  controls.playback = Playback({clip.first_frame, clip.last_frame()}, clip.fps);
  const std::vector<int>& keys = scene.lead().keys();
  if (2 * keys.size() <= clip.poses.size()) controls.playback.set_keys(keys);  // otherwise it was baked
  play_as(before);
}

void Session::play_as(const shots::PlaySettings& settings) {
  const std::string lacks = controls.playback.apply(settings);
  if (!lacks.empty()) controls.warn(lacks);
}

void Session::warn_of_truth_times() {
  std::set<std::string> times;
  for (const auto& character : scene.cast()) {
    const trainer::NamedShapes* truth = character->truth();
    if (truth) times.insert(describe_truth_times(character->files().truth, *truth, character->clip()));
  }
  times.erase("");
  for (const std::string& text : times) {
    if (!truth_times_.contains(text)) controls.warn(text);
  }
  truth_times_ = std::move(times);
}

void Session::take_note_of_cast() {
  describe_cast();
  watch();
}

void Session::describe_cast() {
  const Basis& basis = scene.lead().basis();
  viewport::describe_cast(scene, snapshot);
  for (std::size_t c = 0; c < scene.cast().size(); ++c) snapshot.cast[c].number = controls.cast_numbers[c];
  name_for_commands(scene, controls);
  require_shot_camera();
  if (basis.skeleton.find(controls.joint) < 0) controls.select("");
  std::erase_if(controls.also, [&](const std::string& joint) { return basis.skeleton.find(joint) < 0; });
  curation.look(scene, controls);
  snapshot.device = device_name_;
  warn_of_rates();
}

// The camera of a file that the shot is seen by may be gone with the file. A session's is not looked for yet.
void Session::require_shot_camera() {
  std::string& name = controls.settings.shot_camera.of_file;
  controls.shot_frame.reset();
  const bool is_there =
      std::ranges::find(controls.file_cameras, name, &ClipCamera::name) != controls.file_cameras.end();
  if (opened_ || name.empty() || is_there) return;
  controls.warn("the lead's files have no camera '" + name + "': the shot is seen by what is keyed");
  name = "";
}

// Warns where jiggle is wanted, and left out.
void Session::warn_of_rates() {
  if (!controls.settings.jiggle.on && controls.settings.compare.with != shots::CompareWith::jiggle) return;
  for (const auto& character : scene.cast()) {
    if (const std::string why = character->why_still(); !why.empty()) controls.warn("it does not jiggle: " + why);
  }
}

}  // namespace bodyopt::viewport
