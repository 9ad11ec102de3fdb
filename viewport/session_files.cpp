// The session's own files: all of it, and its settings.
#include <utility>

#include "runtime/core/error.h"
#include "viewport/session.h"
#include "viewport/work_files.h"

namespace bodyopt::viewport {

namespace fs = std::filesystem;

// All characters of the new session are read before the first of the old one goes.
void Session::open_session(const std::string& file) {
  shots::SessionFile session = shots::read_session(file);
  std::vector<std::unique_ptr<Actor>> cast;
  std::vector<shots::SessionCharacter> opened;
  for (const shots::SessionCharacter& character : session.cast) {
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
  for (const shots::SessionCharacter& character : session.cast) {
    controls.placements.push_back(character.placement);
    controls.cast_numbers.push_back(character.number);
  }
  opened_ = std::move(session);
  controls.session_file = file;
  controls.select(opened_->joint);
  controls.marker.reset();
  framing.forget_lead();
  take_note_of_cast();
}

void Session::save(const std::string& file) {
  refuse_input(scene, file);
  if (fs::exists(file) && !shots::is_session(file)) {
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
    shots::ViewSettings::Posing posing = leads ? controls.settings.pose : character->posing();
    posing.correction = 1;
    if (!posing.keys.empty() && !(leads && controls.is_unkeyed())) {  // what is in hand follows from them
      static_cast<shots::ViewSettings::PoseKey&>(posing) = {};
    }
    if (posing != shots::ViewSettings::Posing()) work.posings.push_back(std::move(posing));
  }
  return work;
}

void Session::write(const std::string& file, const std::string& saved_as) const {
  shots::SessionFile session;
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
  shots::write_session(session, file);
}

void Session::save_state(const std::string& file) {
  refuse_input(scene, file);
  controls.settings.playback = controls.playback.settings();
  controls.settings.camera = controls.kept_camera();
  shots::write_view_settings(controls.settings, file);
  controls.say("wrote " + file);
}

void Session::load_state(const std::string& file) { use_settings(shots::read_view_settings(file)); }

}  // namespace bodyopt::viewport
