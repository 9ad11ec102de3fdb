#include "viewport/commands/controls.h"

#include <algorithm>
#include <exception>
#include <filesystem>
#include <iostream>

#include "runtime/core/error.h"
#include "runtime/core/file_problem.h"
#include "shots/session/posed_clip.h"

namespace bodyopt::viewport {

shots::OrbitView Controls::kept_camera() const {
  shots::OrbitView view = camera.view();
  if (settings.look.follow) view.target = view.target - travelled;
  return view;
}

void Controls::go_to_camera(const shots::OrbitView& kept) {
  camera.look(kept);
  if (settings.look.follow) camera.move(travelled);
}

void Controls::follow_shot_camera() {
  const shots::ViewSettings::ShotCamera& shot = settings.shot_camera;
  if (!shot.look_through || shot_frame == playback.frame()) return;
  shot_frame = playback.frame();
  const auto of_file = std::ranges::find(file_cameras, shot.of_file, &ClipCamera::name);
  if (of_file != file_cameras.end()) {
    camera.look(view_of(*of_file, static_cast<std::size_t>(playback.frame() - playback.first())));
  } else if (!shot.keys.empty()) {
    go_to_camera(shots::between_keys(shot.keys, playback.frame()));
  }
}

void Controls::warn(const std::string& text) {
  if (!messages.empty() && messages.back().text == text) return;  // of every picture: once is enough
  std::cerr << "warning: " << text << "\n";
  messages.push_back({.error = true, .text = text});
}

void Controls::attempt(const std::function<void()>& action) {
  if (headless) return action();
  try {
    action();
  } catch (const Error& error) {
    if (error.kind() == ErrorKind::device) throw;
    warn(error.what());
  } catch (const std::filesystem::filesystem_error& error) {
    warn(describe_refusal(error));
  } catch (const std::exception& error) {  // of the libraries: memory
    warn(error.what());
  }
}

shots::ViewSettings::Posing Controls::posing_at(int frame) const {
  return frame == playback.frame() ? settings.pose : shots::keyed_posing(settings.pose, frame);
}

bool Controls::is_unkeyed() const {
  const shots::ViewSettings::PoseKey& in_hand = settings.pose;
  return keyed_frame && !settings.pose.keys.empty() && in_hand != shots::between_keys(settings.pose.keys, *keyed_frame);
}

std::size_t Controls::cast_place(int number) const {
  const auto own = std::ranges::find(cast_numbers, number);
  if (own != cast_numbers.end()) return static_cast<std::size_t>(own - cast_numbers.begin());
  std::vector<int> known = cast_numbers;
  std::ranges::sort(known);
  std::string list;
  for (const int one : known) list += (list.empty() ? "" : ", ") + std::to_string(one);
  throw Error(ErrorKind::usage, "'", number, "' is no number of the cast, expected one of ", list,
              ", as the cast panel counts them");
}

void Controls::browse(const std::string& command) {
  std::error_code gone;
  if (!std::filesystem::is_directory(folder, gone)) folder = ".";
  dialog = browse_folder(command, folder, proposed_name(command, folder));
}

void Controls::quit_or_ask() {
  quits_when_saved = false;
  asks_to_save = !headless && !scripted && has_unsaved_work && has_unsaved_work();
  requests.quit = !asks_to_save;
}

void Controls::select(const std::string& name) {
  joint = name;
  also.clear();
}

std::vector<std::string> Controls::selected() const {
  std::vector<std::string> all{joint};
  all.insert(all.end(), also.begin(), also.end());
  return also.empty() ? std::vector<std::string>() : all;
}

void Controls::key_by_itself() {
  const shots::ViewSettings::PoseKey& in_hand = settings.pose;
  const bool changed = settings.pose.keys.empty() ? in_hand != shots::ViewSettings::PoseKey() : is_unkeyed();
  if (auto_key && changed && keyed_frame) settings.pose.keys[*keyed_frame] = in_hand;
}

bool Controls::is_posed(const std::string& name) const {
  const shots::ViewSettings::PoseKey& pose = settings.pose;
  if (shots::set_or(pose.joints, name, {}) != Vec3{} || shots::set_or(pose.moves, name, {}) != Vec3{}) return true;
  return std::ranges::any_of(pose.axes, [&](const auto& axis) {
    const auto at = std::ranges::find(axis_names, axis.first) - axis_names.begin();
    return axis.second != 0 && at < std::ssize(axis_joints) && axis_joints[static_cast<std::size_t>(at)] == name;
  });
}

void Controls::follow_keys() {
  if (keyed_frame == playback.frame()) return;
  key_by_itself();
  if (is_unkeyed())
    say("the pose of frame " + std::to_string(*keyed_frame) + " had no key, and is gone: set one first");
  keyed_frame = playback.frame();
  if (settings.pose.keys.empty()) return;
  settings.pose = shots::keyed_posing(settings.pose, playback.frame());
  poses.follow(settings, playback.frame());
}

}  // namespace bodyopt::viewport
