#include "viewport/work_files.h"

#include <filesystem>
#include <utility>
#include <vector>

#include "assets/caches/motion_write.h"
#include "assets/clips/controls.h"
#include "runtime/basis/character_unit.h"
#include "runtime/core/error.h"
#include "shots/clip_choice.h"
#include "shots/session/session_file.h"
#include "shots/shot.h"
#include "shots/shot_files.h"
#include "trainer/transfer/markers_file.h"
#include "viewport/commands/flipped_pose.h"

namespace bodyopt::viewport {
namespace {

namespace fs = std::filesystem;

// Returns the frames of the range; warns where the pose in hand is not in them.
std::vector<int> frames_to_export(Controls& controls, const std::string& file) {
  if (controls.is_unkeyed())
    controls.warn("the pose that is shown has no key, and is not in " + file + ": set one first");
  std::vector<int> frames;
  for (int frame = controls.playback.in(); frame <= controls.playback.out(); ++frame) frames.push_back(frame);
  return frames;
}

}  // namespace

void refuse_input(const Scene& scene, const std::string& file) {
  for (const fs::path& input : scene.paths()) {
    std::error_code absent;
    if (fs::equivalent(file, input, absent)) {
      throw Error(ErrorKind::usage, file + ": is open here, and would be overwritten: give another name");
    }
  }
}

void export_clip(const Scene& scene, Controls& controls, const std::string& file) {
  refuse_input(scene, file);
  const Actor& lead = scene.lead();
  Clip clip = lead.posed_source(controls.settings.pose);
  clip.name = fs::path(file).stem().string();
  clip.poses = shots::poses_of(clip, frames_to_export(controls, file));
  clip.first_frame = controls.playback.in();
  write_motion(clip, lead.basis().skeleton, kept_unit(lead.basis()), file);
  controls.say("wrote " + file);
  if (clip.controls.empty()) return;
  const fs::path beside = fs::path(file).replace_extension(".controls.json");
  write_controls(clip, beside);
  controls.say("wrote " + beside.string());
}

void export_skin(const Scene& scene, Controls& controls, const std::string& file) {
  refuse_input(scene, file);
  const Actor& lead = scene.lead();
  const shots::Tell tell = [&](const std::string& note) { controls.warn(note); };
  shots::Shot shot = lead.shot(controls.settings, frames_to_export(controls, file), tell);
  if (holds_triangles(file)) shots::take_surfaces(lead.files().own_file(), lead.like(), shot, tell);
  shots::ShotCaches caches({.out = file}, shot);
  shots::evaluate(shot, caches, "export");
  caches.close();
  controls.say("wrote " + file);
  for (const std::string& attached : caches.attached_paths()) controls.say("wrote " + attached);
}

void save_pose(const Scene& scene, Controls& controls, const std::string& file) {
  refuse_input(scene, file);
  shots::ViewSettings settings;
  static_cast<shots::ViewSettings::PoseKey&>(settings.pose) = controls.settings.pose;
  shots::write_view_settings(settings, file);
  controls.pose_folder = fs::absolute(file).parent_path().string();
  controls.say("wrote " + file);
}

void load_pose(const PoseRequest& request, Controls& controls) {
  const std::string& file = request.file;
  const shots::ViewSettings::PoseKey loaded =
      shots::is_session(file) ? shots::read_session(file).view.pose : shots::read_view_settings(file).pose;
  require_own_pose(controls, loaded, file);
  blend_in(controls, loaded, request.amount, shots::ViewSettings::PoseKey(controls.settings.pose));
  controls.pose_folder = fs::absolute(file).parent_path().string();
}

void save_markers(const Scene& scene, Controls& controls, const std::string& file) {
  refuse_input(scene, file);
  if (controls.marking.pairs.empty()) throw Error(ErrorKind::usage, "there is no marker to save: 'mark on', and click");
  std::vector<trainer::SkinMarker> markers;
  for (const auto& [of_lead, of_second] : controls.marking.pairs) markers.push_back({of_lead, of_second});
  trainer::write_markers(markers, file);
  controls.say("wrote " + file);
}

void load_markers(const std::string& file, Controls& controls) {
  std::vector<MarkedPair> pairs;
  for (const auto& [source, target] : trainer::read_markers(file)) {
    const std::vector<std::uint32_t>& counts = controls.output_counts;
    if (counts.size() < 2 || source >= counts[0] || target >= counts[1]) {
      throw Error(ErrorKind::mismatch, file, ": marks vertex ", source, " of the lead and ", target,
                  " of the second of the cast, which are not both there: other bodies?");
    }
    pairs.push_back({source, target});
  }
  controls.marking.pairs = std::move(pairs);
}

}  // namespace bodyopt::viewport
