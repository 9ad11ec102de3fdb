// Writes and reads the session's files for others: exports, sessions, poses, settings, markers.
#include <algorithm>
#include <utility>

#include "assets/controls.h"
#include "proxy_viewer/commands/flipped_pose.h"
#include "proxy_viewer/session.h"
#include "runtime/basis/character_unit.h"
#include "runtime/core/error.h"
#include "runtime/deformer/evaluation.h"
#include "shots/session/posed_clip.h"
#include "shots/shot.h"
#include "shots/shot_files.h"
#include "trainer/transfer/markers_file.h"

namespace bodyopt {

namespace fs = std::filesystem;

void Session::refuse_input(const std::string& file) const {
  for (const fs::path& input : files()) {
    std::error_code absent;
    if (fs::equivalent(file, input, absent)) {
      throw Error(ErrorKind::usage, file + ": is open here, and would be overwritten: give another name");
    }
  }
}

// Returns the frames of the range; warns where the pose in hand is not in them.
std::vector<int> Session::frames_to_export(const std::string& file) {
  if (controls.is_unkeyed())
    controls.warn("the pose that is shown has no key, and is not in " + file + ": set one first");
  std::vector<int> frames;
  for (int frame = controls.playback.in(); frame <= controls.playback.out(); ++frame) frames.push_back(frame);
  return frames;
}

void Session::export_clip(const std::string& file) {
  refuse_input(file);
  const Actor& lead = scene.lead();
  Clip clip = lead.posed_source(controls.settings.pose);
  clip.name = fs::path(file).stem().string();
  clip.poses = poses_of(clip, frames_to_export(file));
  clip.first_frame = controls.playback.in();
  write_motion(clip, lead.basis().skeleton, kept_unit(lead.basis()), file);
  controls.say("wrote " + file);
  if (clip.controls.empty()) return;
  const fs::path beside = fs::path(file).replace_extension(".controls.json");
  write_controls(clip, beside);
  controls.say("wrote " + beside.string());
}

void Session::export_skin(const std::string& file) {
  refuse_input(file);
  const Actor& lead = scene.lead();
  const Tell tell = [&](const std::string& note) { controls.warn(note); };
  Shot shot = lead.shot(controls.settings, frames_to_export(file), tell);
  if (holds_triangles(file)) take_surfaces(lead.files().own_file(), lead.like(), shot, tell);
  ShotCaches caches({.out = file}, shot);
  evaluate(shot, caches, "export");
  caches.close();
  controls.say("wrote " + file);
  for (const std::string& attached : caches.attached_paths()) controls.say("wrote " + attached);
}

// All characters of the new session are read before the first of the old one goes.
void Session::open_session(const std::string& file) {
  SessionFile session = read_session(file);
  std::vector<std::unique_ptr<Actor>> cast;
  std::vector<SessionCharacter> opened;
  for (const SessionCharacter& character : session.cast) {
    try {
      cast.push_back(scene.make(character.files, session.clip));
    } catch (const Error& error) {
      const bool is_last = opened.empty() && &character == &session.cast.back();
      if (error.kind() == ErrorKind::device || controls.headless || is_last) throw;
      controls.warn(file + ": opened without a character: " + error.what());
      continue;
    }
    cast.back()->set_posing(character.pose);
    opened.push_back(character);
  }
  session.cast = std::move(opened);
  clip_options_ = session.clip;
  receiver_ = 0;
  scene.leave_live_pose();
  scene.cast() = std::move(cast);
  forget_pair();
  controls.placements.clear();
  controls.cast_numbers.clear();
  for (const SessionCharacter& character : session.cast) {
    controls.placements.push_back(character.placement);
    controls.cast_numbers.push_back(character.number);
  }
  opened_ = std::move(session);
  controls.session_file = file;
  controls.select(opened_->joint);
  controls.marker.reset();
  followed_.reset();
  take_note_of_cast();
}

void Session::save(const std::string& file) {
  refuse_input(file);
  if (fs::exists(file) && !is_session(file)) {
    throw Error(ErrorKind::usage, file + ": is there already, and is no session: choose another name");
  }
  write(file);
  controls.session_file = file;
  controls.say("wrote " + file);
}

Session::Work Session::work() const {
  Work work{{},
            controls.settings.cameras,
            controls.settings.shot_camera,
            controls.image_plane,
            controls.sound,
            controls.marking.pairs};
  for (const auto& character : scene.cast()) {
    const bool leads = &*character == &scene.lead();
    ViewSettings::Posing posing = leads ? controls.settings.pose : character->posing();
    posing.correction = 1;
    if (!posing.keys.empty() && !(leads && controls.is_unkeyed())) {  // what is in hand follows from them
      static_cast<ViewSettings::PoseKey&>(posing) = {};
    }
    if (posing != ViewSettings::Posing()) work.posings.push_back(std::move(posing));
  }
  return work;
}

void Session::write(const std::string& file, const std::string& saved_as) const {
  SessionFile session;
  session.clip = clip_options_;
  for (std::size_t c = 0; c < scene.cast().size(); ++c) {
    const Actor& character = *scene.cast()[c];
    session.cast.push_back({character.files(), character.posing(), controls.placements[c], controls.cast_numbers[c]});
  }
  session.frame = controls.playback.frame();
  session.joint = controls.joint;
  session.saved_as = saved_as;
  session.view = controls.settings;
  session.view.playback = controls.playback.settings();
  session.view.camera = controls.kept_camera();
  session.image_plane = controls.image_plane;
  session.sound = controls.sound;
  write_session(session, file);
}

void Session::save_pose(const std::string& file) {
  refuse_input(file);
  ViewSettings settings;
  static_cast<ViewSettings::PoseKey&>(settings.pose) = controls.settings.pose;
  write_view_settings(settings, file);
  controls.pose_folder = fs::absolute(file).parent_path().string();
  controls.say("wrote " + file);
}

void Session::load_pose(const PoseRequest& request) {
  const std::string& file = request.file;
  const ViewSettings::PoseKey loaded = is_session(file) ? read_session(file).view.pose : read_view_settings(file).pose;
  require_own_pose(controls, loaded, file);
  blend_in(controls, loaded, request.amount, ViewSettings::PoseKey(controls.settings.pose));
  controls.pose_folder = fs::absolute(file).parent_path().string();
}

void Session::save_state(const std::string& file) {
  controls.settings.playback = controls.playback.settings();
  controls.settings.camera = controls.kept_camera();
  write_view_settings(controls.settings, file);
  controls.say("wrote " + file);
}

void Session::save_markers(const std::string& file) {
  refuse_input(file);
  if (controls.marking.pairs.empty()) throw Error(ErrorKind::usage, "there is no marker to save: 'mark on', and click");
  std::vector<SkinMarker> markers;
  for (const auto& [of_lead, of_second] : controls.marking.pairs) markers.push_back({of_lead, of_second});
  write_markers(markers, file);
  controls.say("wrote " + file);
}

// Reads markers of the two that are first now.
void Session::open_markers(const std::string& file) {
  std::vector<MarkedPair> pairs;
  for (const auto& [source, target] : read_markers(file)) {
    const std::vector<std::uint32_t>& counts = controls.output_counts;
    if (counts.size() < 2 || source >= counts[0] || target >= counts[1]) {
      throw Error(ErrorKind::mismatch, file + ": marks vertex " + std::to_string(source) + " of the lead and " +
                                           std::to_string(target) +
                                           " of the second of the cast, which are not both there: other bodies?");
    }
    pairs.push_back({source, target});
  }
  controls.marking.pairs = std::move(pairs);
}

void Session::load_state(const std::string& file) { use_settings(read_view_settings(file)); }

}  // namespace bodyopt
