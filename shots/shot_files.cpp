#include "shots/shot_files.h"

#include <algorithm>
#include <filesystem>
#include <set>
#include <utility>

#include "assets/clips/clip_source.h"
#include "assets/clips/shot_modifiers.h"
#include "assets/gltf/gltf_file.h"
#include "assets/gltf/gltf_guard.h"
#include "base/frame_range.h"
#include "runtime/basis/character_unit.h"
#include "runtime/basis/dynamics.h"
#include "runtime/core/error.h"
#include "runtime/host/jiggle.h"
#include "runtime/modifiers/drive_modifiers.h"
#include "shots/session/posed_clip.h"
#include "shots/session/session_file.h"
#include "trainer/attach/bind_mesh.h"
#include "trainer/builtin/arm.h"
#include "trainer/train/features/features.h"
#include "trainer/train/skinning/ddm.h"

namespace bodyopt::shots {
namespace {

OpenedCharacter with_ddm(Character character) {
  OpenedCharacter opened;
  opened.notes = std::move(character.notes);
  Level& level = opened.levels.emplace_back();
  level.basis = trainer::build_ddm_basis(character, {});
  keep_unit(level.basis, character.unit);
  opened.character = std::move(character);
  return opened;
}

// Attaches its eyes, teeth and clothes as `train` does.
void attach_own_meshes(const std::string& path, OpenedCharacter& opened) {
  const Basis& basis = opened.levels.front().basis;
  try {
    const double unit = opened.character->unit > 0 ? opened.character->unit : 1;
    const std::vector<trainer::LooseMesh> meshes =
        trainer::read_loose_meshes(GltfFile(path), basis.skeleton, basis.mesh.output_count(), unit, opened.notes);
    opened.attached.meshes = trainer::bind_own_meshes(meshes, basis, opened.notes);
  } catch (const Error& error) {
    opened.notes.push_back(std::string("the character's other meshes are not shown: ") + error.what());
  }
}

void play_own_clip(const std::string& path, const ClipOptions& options, OpenedCharacter& opened) {
  if (clip_names(path).empty()) return;
  try {
    opened.clip = read_clip(path, opened.levels.front().basis.skeleton, options);
    std::ranges::copy(opened.clip->notes, std::back_inserter(opened.notes));
  } catch (const Error& error) {
    opened.notes.push_back(std::string("its own clip is not played: ") + error.what());
  }
}

OpenedCharacter open_untrained(const std::string& path, const ClipOptions& options) {
  OpenedCharacter opened = with_ddm(read_character(path, options.unit));
  attach_own_meshes(path, opened);
  play_own_clip(path, options, opened);
  opened.shown_by = path + " is shown by Direct Delta Mush, made just now: it is not trained";
  return opened;
}

OpenedCharacter open_arm(const ClipOptions& options) {
  trainer::BuiltinArm arm = trainer::build_arm();
  OpenedCharacter opened = with_ddm(std::move(arm.character));
  Basis& basis = opened.levels.front().basis;
  basis.strain = trainer::make_strain_table(basis, arm.muscles);
  opened.clip = trainer::arm_heldout(basis.skeleton, trainer::kArmHeldoutFrames);
  opened.clip->first_frame = options.first_frame;
  opened.shown_by =
      "the built-in arm is shown by Direct Delta Mush: `bodyopt demo --out demo` trains it, and `bodyopt view "
      "demo/basis.safetensors demo/heldout.glb` shows that";
  return opened;
}

// Half of the joints of the smaller skeleton must be in the other, by name: rigs of others share a few, as "Hips".
bool is_of(const tinygltf::Model& model, const Skeleton& skeleton) {
  std::set<std::string> joints;
  for (const tinygltf::Skin& skin : model.skins) {
    for (const int joint : skin.joints) {
      if (joint < 0 || joint >= std::ssize(model.nodes)) continue;  // which who reads the character says
      joints.insert(model.nodes[static_cast<std::size_t>(joint)].name);
    }
  }
  const auto shared = std::ranges::count_if(joints, [&](const std::string& name) { return skeleton.find(name) >= 0; });
  const std::size_t fewer = std::min(joints.size(), skeleton.joints.size());
  return shared > 0 && 2 * static_cast<std::size_t>(shared) >= fewer;
}

namespace fs = std::filesystem;

void tell_all(const std::vector<std::string>& notes, const Tell& tell) {
  for (const std::string& note : notes) tell(note);
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
  if (files.is_untrained()) refuse_jiggle(files.session.file);
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

ShotPosing posing_of(const ShotFiles& files, const Skeleton& skeleton) {
  const SessionPosing& session = files.session;
  ShotPosing posing{{}, session.pose, session.jiggle, files.controls};
  if (!session.limits.empty()) {
    posing.turning = turning_within(trainer::read_joint_limits(session.limits, skeleton), skeleton);
  }
  return posing;
}

// It is as long as is asked for. Where nothing is said of it, that of a session is as long as the viewport's.
int preroll_of(const ShotFiles& files, const Clip& clip, int first, const Tell& tell) {
  const JiggleChoice& choice = files.jiggle;
  const bool says_nothing = choice.preroll == 0 && choice.state_in.empty();
  if (choice.jiggle && says_nothing && !files.session.file.empty()) return usual_preroll(clip, first);
  const int before = first - clip.first_frame;
  if (before < choice.preroll) {
    tell(concat("the clip has ", before, " frames before frame ", first, ": the pre-roll is that short"));
  }
  return std::min(before, choice.preroll);
}

// The frames of a jiggle rise from its state on.
void require_frames_in_order(const Shot& shot, const std::string& state_in, const Tell& tell) {
  const std::vector<int>& frames = shot.frames;
  if (!std::ranges::is_sorted(frames)) throw Error(ErrorKind::usage, "--jiggle needs frames in rising order");
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

// `own`: the character where nobody trained it.
BoundSkin bind_skin(const ShotFiles& files, const Shot& shot, std::optional<Character> own) {
  if (!own && files.character.empty()) {
    throw Error(ErrorKind::usage, "--rigged needs the character's own file, which has its weights: --character FILE");
  }
  BoundSkin bound{own ? std::move(*own) : read_character(files.character, kept_unit(shot.basis())), shot.played_clip()};
  const std::vector<Joint>&found = bound.character.skeleton.joints, &expected = shot.basis().skeleton.joints;
  const auto same = [](const Joint& a, const Joint& b) { return a.name == b.name && a.parent == b.parent; };
  const auto [other, meant] = std::ranges::mismatch(found, expected, same);
  if (other == found.end() && meant == expected.end()) return bound;
  throw Error(ErrorKind::mismatch, files.character, ": its joint ",
              other == found.end() ? "after the last" : other->name, " is no joint of ", shot.name,
              " in that place: expected the file that the character was trained of");
}

}  // namespace

OpenedCharacter open_character(const std::string& path, const ClipOptions& options) {
  if (path.empty()) return open_arm(options);
  if (!is_basis(path)) return open_untrained(path, options);
  OpenedCharacter opened;
  opened.levels = load_levels(path);
  return opened;
}

bool is_another_character(const std::string& path, const Skeleton& skeleton) {
  if (!std::filesystem::exists(path)) return false;  // FILE.glb#name
  const GltfFile file(path);
  const tinygltf::Model& model = file.model();
  const bool has_skin =
      std::ranges::any_of(model.nodes, [](const auto& node) { return node.mesh >= 0 && node.skin >= 0; });
  if (!has_skin) return false;
  return model.animations.empty() || !is_of(model, skeleton);
}

std::string JiggleChoice::file(const std::string& basis) const {
  if (!jiggle) return "";
  return dynamics.empty() ? dynamics_beside(basis).string() : dynamics;
}

bool ShotFiles::is_untrained() const { return !session.file.empty() && !is_basis(basis); }

std::vector<fs::path> ShotFiles::paths() const {
  std::vector<fs::path> paths;
  const std::string& source = clip.source;
  const fs::path of_clip = fs::exists(source) ? source : source.substr(0, source.rfind('#'));
  if (!of_clip.empty()) {
    for (const fs::path& file : gltf_files(of_clip)) paths.push_back(file);
  }
  const std::string untrained = is_basis(basis) ? "" : basis;
  for (const std::string& own : {character, untrained, fs::exists(session.character) ? session.character : ""}) {
    if (!own.empty()) std::ranges::copy(gltf_files(own), std::back_inserter(paths));
  }
  for (const std::string& file : {is_basis(basis) ? basis : "", clip.options.controls, clip.options.joint_map,
                                  jiggle.file(basis), jiggle.state_in, modifiers, session.file, session.limits}) {
    if (!file.empty()) paths.emplace_back(file);
  }
  const fs::path beside = is_basis(basis) ? attachments_beside(basis) : fs::path();
  if (!attached.empty()) {
    paths.emplace_back(attached);
  } else if (level == 0 && fs::exists(beside)) {
    paths.push_back(beside);
  }
  return paths;
}

void take_session(const std::string& session, ShotFiles& files) {
  if (!files.basis.empty() || !files.clip.source.empty()) {
    throw Error(ErrorKind::usage, "--session names the basis and the clip itself: leave out BASIS and --clip");
  }
  const SessionFile read = read_session(session);
  const SessionCharacter& lead = read.cast.front();
  files.basis = lead.files.basis;
  files.clip.source = lead.files.clip;
  files.clip.options.fps = read.clip.fps;
  files.clip.options.joint_map = lead.files.joint_map;
  files.clip.options.up = lead.files.up_of(lead.files.clip);
  const std::string character = files.level == 0 ? lead.files.own_file() : "";
  const std::string clip = split_source(lead.files.clip).path.string();
  files.session = {.file = session,
                   .character = character,
                   .like = files.level == 0 && character.empty() && is_called_scene(clip) ? clip : "",
                   .limits = lead.files.limits,
                   .pose = lead.pose,
                   .jiggles = read.view.jiggle.on,
                   .jiggle = static_cast<float>(read.view.jiggle.amount),
                   .unit = read.clip.unit};
  if (!files.clip.frames.empty()) return;
  files.session.in = read.view.playback.in;
  files.session.out = read.view.playback.out;
}

OpenedCharacter open_level(const ShotFiles& files) {
  OpenedCharacter opened;
  if (files.is_untrained()) {
    ClipOptions options = files.clip.options;
    options.unit = files.session.unit;
    opened = open_character(files.basis, options);
  } else {
    opened.levels = load_levels(files.basis);
  }
  if (files.level >= opened.levels.size()) {
    throw Error(ErrorKind::usage, "--level asks for level ", files.level, "; ", files.basis, " has levels 0 to ",
                opened.levels.size() - 1);
  }
  if (files.level > 0) opened.levels.front() = std::move(opened.levels[files.level]);
  opened.levels.resize(1);
  return opened;
}

Clip read_own_clip(const ClipChoice& choice, const Basis& basis, std::optional<Clip> own) {
  if (!choice.source.empty()) return choice.read(basis, kept_unit(basis));
  return own ? std::move(*own) : still_clip(basis.skeleton, choice.options);
}

std::vector<int> shot_frames(const ShotFiles& files, const ClipSpan& clip) {
  const SessionPosing& session = files.session;
  std::vector<int> frames = files.clip.chosen_frames(clip);
  std::erase_if(frames,
                [&](int frame) { return frame < session.in.value_or(frame) || frame > session.out.value_or(frame); });
  if (!frames.empty()) return frames;
  throw Error(ErrorKind::usage, session.file, ": '", files.clip.source.empty() ? clip.name : files.clip.source,
              "' has no frame of the range that it plays: was the clip replaced? --frames chooses others");
}

Attachments read_attachments(const ShotFiles& files, const Basis& basis, Attachments own) {
  if (!files.attached.empty()) return load_attachments(files.attached, basis);
  if (files.is_untrained()) return own;
  const fs::path beside = attachments_beside(files.basis);
  // Attached meshes follow the finest level.
  if (files.level > 0 || !fs::exists(beside)) return {};
  return load_attachments(beside, basis, files.basis);
}

std::string missing_jiggle(const ShotFiles& files) {
  const bool is_missing = files.session.jiggles && files.session.jiggle > 0 && !files.jiggle.jiggle &&
                          files.level == 0 && !files.is_untrained() && fs::exists(dynamics_beside(files.basis));
  if (!is_missing) return "";
  return files.session.file +
         ": its lead jiggles in the viewport, and is evaluated without: give --jiggle, or in a list \"jiggle\": true";
}

void refuse_jiggle(const std::string& session) {
  throw Error(ErrorKind::usage, session,
              ": its lead is not trained, and has no dynamics that --jiggle could step: 'bodyopt train' and 'bodyopt "
              "dynamics' make them");
}

SkinSurface surface_if_any(const std::string& character, const MeshTable& mesh, const Tell& tell) {
  try {
    SkinSurface surface = read_skin_surface(character, mesh);
    tell_all(surface.notes, tell);
    return surface;
  } catch (const Error& error) {
    tell(std::string("no texture coordinates and materials are taken: ") + error.what());
    return {};
  }
}

std::vector<SkinSurface> attached_surfaces(const std::string& character, const Basis& basis,
                                           const Attachments& attached, const Tell& tell) {
  std::vector<SkinSurface> surfaces(attached.meshes.size());
  if (attached.meshes.empty() || character.empty()) return surfaces;
  std::vector<std::string> unused;  // what attaching the meshes notes already
  try {
    const GltfFile file(character);
    MaterialReader reader(file);
    for (const trainer::LooseMesh& mesh :
         trainer::read_loose_meshes(file, basis.skeleton, basis.mesh.output_count(), 1, unused)) {
      std::vector<std::uint32_t> corners;
      for (const auto& triangle : mesh.triangles) corners.insert(corners.end(), triangle.begin(), triangle.end());
      const auto own = std::ranges::find_if(attached.meshes, [&](const AttachedMesh& worn) {
        return worn.name == mesh.name && worn.vertex_count() == mesh.vertices.size() && worn.triangles == corners;
      });
      if (own == attached.meshes.end()) continue;
      try {
        SkinSurface& surface = surfaces[static_cast<std::size_t>(own - attached.meshes.begin())];
        surface = read_node_surface(reader, mesh.node, corners);
        tell_all(surface.notes, tell);
      } catch (const Error& error) {
        tell("mesh '" + mesh.name + "' has no materials: " + error.what());
      }
    }
  } catch (const Error& error) {
    tell(std::string("attached meshes have no materials: ") + error.what());
  }
  return surfaces;
}

void take_surfaces(const std::string& own, const std::string& like, Shot& shot, const Tell& tell) {
  const std::string& file = own.empty() ? like : own;
  if (file.empty()) return;
  const Tell say = own.empty() ? [](const std::string&) {} : tell;
  shot.surface = surface_if_any(file, shot.basis().mesh, say);
  if (own.empty() && shot.surface.empty()) return;
  shot.surfaces = attached_surfaces(file, shot.basis(), shot.following.attached(), say);
}

Shot read_shot(const ShotFiles& files, const Tell& tell) {
  OpenedCharacter opened = open_level(files);
  tell_all(opened.notes, tell);
  if (!opened.shown_by.empty()) tell(opened.shown_by);
  Level& level = opened.levels.front();
  choose_shot_modifiers(files.modifiers, level.basis);
  std::unique_ptr<Deformer> deformer = make_deformer(files, std::move(level.basis));
  const Basis& basis = deformer->basis();
  if (const std::string missing = missing_jiggle(files); !missing.empty()) tell(missing);
  Clip clip = read_own_clip(files.clip, basis, std::move(opened.clip));
  tell_all(clip.notes, tell);
  std::vector<int> frames = shot_frames(files, clip);
  const int preroll = preroll_of(files, clip, frames.front(), tell);
  Shot shot{.name = files.basis.empty() ? "arm" : fs::path(files.basis).stem().string(),
            .deformer = std::move(deformer),
            .jiggles = files.jiggle.jiggle,
            .checks = files.device.check,
            .following = {basis, read_attachments(files, basis, std::move(opened.attached)), std::move(level.carried)},
            .clip = std::move(clip),
            .frames = std::move(frames),
            .preroll = preroll,
            .surface = {},
            .surfaces = {},
            .bound = {}};
  pose_shot(posing_of(files, basis.skeleton), shot, tell);
  if (shot.jiggles) require_frames_in_order(shot, files.jiggle.state_in, tell);
  if (files.character.empty()) {
    take_surfaces(files.session.character, files.session.like, shot, tell);
  } else {
    shot.surface = read_skin_surface(files.character, shot.basis().mesh);
    tell_all(shot.surface.notes, tell);
    shot.surfaces = attached_surfaces(files.character, shot.basis(), shot.following.attached(), tell);
  }
  if (files.is_rigged) shot.bound = bind_skin(files, shot, std::move(opened.character));
  return shot;
}

}  // namespace bodyopt::shots
