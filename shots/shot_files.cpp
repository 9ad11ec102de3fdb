#include "shots/shot_files.h"

#include <algorithm>
#include <utility>

#include "assets/frame_range.h"
#include "assets/gltf_guard.h"
#include "assets/shot_modifiers.h"
#include "runtime/basis/character_unit.h"
#include "runtime/basis/dynamics.h"
#include "runtime/core/error.h"
#include "runtime/host/jiggle.h"
#include "runtime/modifiers/drive_modifiers.h"
#include "shots/session/posed_clip.h"
#include "shots/session/session_file.h"

namespace bodyopt {
namespace {

namespace fs = std::filesystem;

void tell_all(const std::vector<std::string>& notes, const Tell& tell) {
  for (const std::string& note : notes) tell(note);
}

Level chosen_level(const ShotFiles& files) {
  std::vector<Level> levels = load_levels(files.basis);
  if (files.level >= levels.size()) {
    throw Error(ErrorKind::usage, "--level asks for level ", files.level, "; ", files.basis, " has levels 0 to ",
                levels.size() - 1);
  }
  return std::move(levels[files.level]);
}

void choose_shot_modifiers(const std::string& file, Basis& basis) {
  if (file.empty()) return;
  if (basis.modifiers.empty()) {
    throw Error(ErrorKind::mismatch, "the basis has no modifiers that ", file,
                " could choose of: give it some with 'bodyopt modifiers'");
  }
  choose_modifiers(file, basis.modifiers);
}

std::unique_ptr<Deformer> make_deformer(const ShotFiles& files, Basis basis) {
  const JiggleChoice& choice = files.jiggle;
  if (!choice.jiggle) return std::make_unique<Deformer>(std::move(basis), files.device);
  const std::string file = choice.file(files.basis);
  if (choice.dynamics.empty() && !fs::exists(file)) {
    throw Error(ErrorKind::file, file,
                ": not there; --jiggle needs the dynamics of the basis: make them with 'bodyopt "
                "dynamics', or name them with --dynamics");
  }
  JiggleOptions options;
  std::ranges::copy(choice.gravity_change, options.gravity_change.begin());
  if (!choice.cuts.empty()) options.cuts = parse_frame_range(choice.cuts);
  std::ranges::sort(options.cuts);
  Dynamics tables = load_dynamics(file, basis);
  auto deformer = std::make_unique<Deformer>(std::move(basis), std::move(tables), options, files.device);
  if (!choice.state_in.empty()) deformer->set_state(load_state(choice.state_in, *deformer->dynamics()));
  return deformer;
}

// Of a session whose lead plays no clip, that which the viewport poses in its place.
Clip read_own_clip(const ClipChoice& choice, const Basis& basis) {
  return choice.source.empty() ? still_clip(basis.skeleton, choice.options) : choice.read(basis, kept_unit(basis));
}

// Frames of a clip that its session does not play are left out.
void keep_range(const ShotFiles& files, Shot& shot) {
  const SessionPosing& session = files.session;
  std::erase_if(shot.frames,
                [&](int frame) { return frame < session.in.value_or(frame) || frame > session.out.value_or(frame); });
  if (!shot.frames.empty()) return;
  throw Error(ErrorKind::usage, session.file, ": '", files.clip.source.empty() ? shot.clip.name : files.clip.source,
              "' has no frame of the range that it plays: was the clip replaced? --frames chooses others");
}

void pose_by_session(const SessionPosing& session, Shot& shot) {
  if (session.file.empty()) return;
  const Skeleton& skeleton = shot.basis().skeleton;
  JointLimits limits;
  if (!session.limits.empty()) limits = read_joint_limits(session.limits, skeleton);
  shot.clip = posed_clip(std::move(shot.clip), skeleton, limits, session.pose);
  shot.deformer->set_weights({.correction = static_cast<float>(session.pose.correction), .jiggle = session.jiggle});
}

void drive_modifiers(const std::vector<std::string>& settings, Shot& shot, const Tell& tell) {
  const Basis& basis = shot.basis();
  std::vector<std::string> known = basis.residual.controls;
  for (const std::string& name : modifier_channels(basis.modifiers)) known.push_back(name);
  set_channels(settings, known, shot.clip);
  tell_all(apply_channels(basis, shot.clip), tell);
}

// The frames of a jiggle rise from its state on.
void require_frames_in_order(const Shot& shot, const std::string& state_in, const Tell& tell) {
  const std::vector<int>& frames = shot.frames;
  if (!std::ranges::is_sorted(frames)) throw Error(ErrorKind::usage, "--jiggle needs frames in rising order");
  if (frames.empty()) return;
  const JiggleState state = shot.deformer->state();
  if (state.known > 0 && frames.front() <= state.frame) {
    throw Error(ErrorKind::usage, state_in, " is the state after frame ", state.frame, "; the frames begin at ",
                frames.front(), ", expected ", state.frame + 1);
  }
  if (state.known > 0 && frames.front() > state.frame + 1) {
    tell(concat(state_in, " is the state after frame ", state.frame, ", the frames begin at ", frames.front(),
                ": those between are stepped over in a straight line"));
  }
  for (const int cut : shot.deformer->jiggle_options().cuts) {
    if (cut >= frames.front() && cut <= frames.back()) continue;
    tell(concat("the cut at frame ", cut, " is not among the frames ", frames.front(), " to ", frames.back()));
  }
}

Attachments read_attachments(const ShotFiles& files, const Basis& basis) {
  if (!files.attached.empty()) return load_attachments(files.attached, basis);
  const fs::path beside = attachments_beside(files.basis);
  // They ride on the finest level.
  if (files.level > 0 || !fs::exists(beside)) return {};
  return load_attachments(beside, basis, files.basis);
}

}  // namespace

std::string JiggleChoice::file(const std::string& basis) const {
  if (!jiggle) return "";
  return dynamics.empty() ? dynamics_beside(basis).string() : dynamics;
}

std::vector<fs::path> ShotFiles::paths() const {
  std::vector<fs::path> paths{basis};
  const std::string& source = clip.source;
  const fs::path of_clip = fs::exists(source) ? source : source.substr(0, source.rfind('#'));
  if (!of_clip.empty()) {
    for (const fs::path& file : gltf_files(of_clip)) paths.push_back(file);
  }
  for (const std::string& file : {clip.options.controls, clip.options.joint_map, jiggle.file(basis), jiggle.state_in,
                                  modifiers, session.file, session.limits}) {
    if (!file.empty()) paths.emplace_back(file);
  }
  const fs::path beside = attachments_beside(basis);
  if (!attached.empty()) {
    paths.emplace_back(attached);
  } else if (level == 0 && fs::exists(beside)) {
    paths.push_back(beside);
  }
  return paths;
}

void take_session(const std::string& session, ShotFiles& files) {
  const SessionFile read = read_session(session);
  const SessionCharacter& lead = trained_lead(read, session);
  files.basis = lead.files.basis;
  files.clip.source = lead.files.clip;
  files.clip.options.fps = read.clip.fps;
  files.clip.options.joint_map = lead.files.joint_map;
  files.clip.options.up = lead.files.up_of(lead.files.clip);
  files.session = {.file = session,
                   .limits = lead.files.limits,
                   .pose = lead.pose,
                   .jiggle = static_cast<float>(read.view.jiggle.amount)};
  if (!files.clip.frames.empty()) return;
  files.session.in = read.view.playback.in;
  files.session.out = read.view.playback.out;
}

Shot read_shot(const ShotFiles& files, const Tell& tell) {
  Shot shot;
  shot.name = fs::path(files.basis).stem().string();
  shot.jiggles = files.jiggle.jiggle;
  shot.checks = files.device.check;
  shot.preroll = files.jiggle.preroll;
  Level level = chosen_level(files);
  shot.carried = std::move(level.carried);
  choose_shot_modifiers(files.modifiers, level.basis);
  shot.deformer = make_deformer(files, std::move(level.basis));
  shot.clip = read_own_clip(files.clip, shot.basis());
  tell_all(shot.clip.notes, tell);
  shot.frames = files.clip.chosen_frames(shot.clip);
  keep_range(files, shot);
  pose_by_session(files.session, shot);
  drive_modifiers(files.controls, shot, tell);
  if (shot.jiggles) {
    const std::string problem = problem_of_rate(*shot.deformer->dynamics(), shot.clip);
    if (!problem.empty()) throw Error(ErrorKind::mismatch, problem);
    require_frames_in_order(shot, files.jiggle.state_in, tell);
  }
  shot.attached = read_attachments(files, shot.basis());
  return shot;
}

}  // namespace bodyopt
