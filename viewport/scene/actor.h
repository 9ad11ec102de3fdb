// A character of the scene: its basis, the clip it plays, and its skin by several methods, each on the device.
#pragma once

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "assets/caches/pc2.h"
#include "assets/clips/clip.h"
#include "runtime/deformer/deformer.h"
#include "runtime/deformer/following_meshes.h"
#include "runtime/vulkan/buffer.h"
#include "shots/session/pinned_joints.h"
#include "shots/session/posed_clip.h"
#include "shots/session/session_file.h"
#include "shots/session/view_settings.h"
#include "shots/shot.h"
#include "shots/shot_files.h"
#include "viewport/scene/character_materials.h"
#include "viewport/scene/detail.h"
#include "viewport/scene/truth_times.h"

namespace bodyopt::viewport {

// A mesh attached to F skins: it follows them on the host, and is uploaded when it moves.
struct WornMesh {
  const vulkan::Buffer* triangles = nullptr;
  std::uint32_t triangle_count = 0, vertex_count = 0;
  vulkan::Buffer positions, normals;  // F x N x 3
  const draw::SurfaceDraw* materials = nullptr;
};

class WornMeshes {
 public:
  WornMeshes(const vulkan::Device& device, FollowingMeshes following);

  // Attaches the meshes to each of the skins, F x O x 3, at its pose. They are on the device, as long as this lives.
  // Throws Error(usage) for more than the device shows at once.
  std::vector<WornMesh> carry(std::span<const float> skins, std::span<const Pose> poses) const;
  // Returns the points on the host, all meshes one after the other, N x 3.
  std::vector<float> points(std::span<const float> skin, const Pose& pose) const;

  const FollowingMeshes& following() const { return following_; }

 private:
  const vulkan::Device& device_;
  FollowingMeshes following_;
  std::vector<vulkan::Buffer> triangles_;
};

class Actor {
 public:
  // Throws Error(file), Error(mismatch), Error(device).
  Actor(std::shared_ptr<const vulkan::Device> device, const shots::ActorFiles& files, const ClipOptions& options,
        LevelPool& pool);

  const shots::ActorFiles& files() const { return files_; }
  std::vector<std::filesystem::path> paths() const;  // of all that it shows, its materials' images among them
  std::string name() const;
  const std::vector<std::string>& notes() const { return notes_; }  // of opening it, for the user
  const std::string& shown_by() const { return shown_by_; }         // see OpenedCharacter
  // The level that is shown. Joints and controls are the same for all.
  const Detail& shown() const { return *details_[level_]; }
  Detail& shown() { return *details_[level_]; }
  const Basis& basis() const { return shown().basis(); }
  const Basis& finest_basis() const { return finest().basis(); }
  std::size_t level_count() const { return details_.size(); }
  std::size_t level() const { return level_; }
  // Returns the coarsest level whose skin at rest is no further than that from the full one, RMS, metres.
  std::size_t level_within(double metres) const;
  void set_level(std::size_t level) { level_ = std::min(level, details_.size() - 1); }
  const Clip& clip() const { return clip_; }              // still_clip() where there is no file
  const std::vector<int>& keys() const { return keys_; }  // frames; see clip_keys()
  std::vector<ClipCamera> cameras() const;                // of its clip, then others of its own file
  bool has(SkinMethod method) const;
  bool has_at_finest(SkinMethod method) const;  // whatever level is shown
  bool has_dynamics() const { return finest().jiggles(); }
  // Why it does not jiggle although it has dynamics: they step at another rate than the clip. Empty: it does.
  std::string why_still() const;

  // The character with its weights; null: they are not at hand.
  const Character* character() const { return character_ ? &*character_ : nullptr; }

  // These throw as the constructor, and leave what was there.
  void open_clip(const std::string& source);  // of a dataset: its frames, one after the other, takes as keys
  void open_clip_of(const Actor& lead);       // with the joint map by which the lead plays it
  void open_truth(const std::string& name);   // as NamedShapes

  // Whether the truth is shown as its dataset has it before any modifier.
  void show_raw(bool raw);
  // Shows points in place of the truth in a frame, until it is read again: O x 3, output vertex order, metres.
  void show_sculpted(int frame, std::vector<float> points);
  // The truth as the stack of its dataset makes it now; false: its frames are others by now, and all is to be read
  // again. Throws as the constructor.
  bool reread_truth();

  // The clip's pose, turned joint by joint as the settings say and the ranges let it. Frames beyond the clip: its first
  // or last.
  Pose pose(int frame, const shots::ViewSettings::Posing& posing) const;
  // Returns all of the clip before modifiers, posed and keyed so, for export.
  Clip posed_source(const shots::ViewSettings::Posing& posing) const;
  // The finest level with the clip that is posed and keyed so, as `eval` reads it of a session. `frames`: of the clip,
  // one at least. Throws Error(device).
  shots::Shot shot(const shots::ViewSettings& settings, std::vector<int> frames, const shots::Tell& tell) const;
  // Pins that the pose of a frame does not reach.
  std::vector<shots::MissedPin> missed_pins(int frame, const shots::ViewSettings::PoseKey& posing) const;
  // See facing_of().
  Vec3 facing(std::size_t joint, int frame, const shots::ViewSettings::PoseKey& posing) const;
  // Returns joints that may be moved: roots, what hangs alone under them and has no range, hips, and those that the
  // clip moves. So may those that hang elsewhere in the rig than their skin does.
  std::vector<std::string> movable_joints() const;
  // Degrees of freedom of the limits, where it has any.
  const std::vector<trainer::DegreeOfFreedom>& axes() const { return turning_.limits.dofs; }
  // How it is posed while it is not the lead, whom the settings pose.
  const shots::ViewSettings::Posing& posing() const { return posing_; }
  void set_posing(shots::ViewSettings::Posing posing) { posing_ = std::move(posing); }
  // Returns what a joint's range lets be added to the clip; none: it has no range.
  std::optional<shots::JointRange> free_turns(std::size_t joint, int frame) const;
  std::pair<double, double> free_axis(const trainer::DegreeOfFreedom& dof, int frame) const;  // see free_angles()

  // Evaluates poses of one frame, then of ghosts and instances; `frame`: of the first. The jiggle steps only with that.
  // `dressed`: worn() is to follow.
  const Evaluation& evaluate(SkinMethod method, std::span<const Pose> poses, int frame, const Weights& weights,
                             bool dressed = true);
  // Returns the request by which the device makes what evaluate() would; nothing where the skin comes from the host.
  std::optional<SkinRequest> request(SkinMethod method, std::span<const Pose> poses, int frame, const Weights& weights,
                                     bool dressed = true);
  void reset_jiggle();  // which starts anew with the next frame
  // Returns attached meshes on the skins that the method has evaluated last, one a pose; empty: nothing.
  std::span<const WornMesh> worn(SkinMethod method);
  bool wears() const { return worn_ != nullptr; }
  // The materials of the skin that is shown; null: no file with them is known.
  const draw::SurfaceDraw* materials() const { return materials_ ? &materials_->skin[level_] : nullptr; }
  // The clip's file, where its own is not known: it may have the same skin, with materials. Empty: there is none.
  const std::string& like() const { return like_; }
  // Returns the points of attached meshes, on a skin as measure() gives it, metres, world.
  std::vector<float> worn_points(std::span<const float> skin, const Pose& pose) const;
  // Returns the skin of the last evaluation by the method.
  DeviceSkin skin(SkinMethod method) const;

  // The result of a method on the host, output vertex order: of one pose, for figures; of the truth, where
  // has_sample_at() only. Quasi-static, of the finest level. `correction`: see Weights.
  std::vector<float> measure(SkinMethod method, const Pose& pose, int frame, float correction = 1);

  double size() const { return size_; }      // diagonal of the rest skin, metres
  double reach() const { return reach_; }    // as size(), with attached meshes
  double ground() const { return ground_; }  // height of its lowest point as the clip begins, metres
  Vec3 start() const { return clip_.poses.front().joints.front().translation; }  // of its root, as the clip begins
  const trainer::NamedShapes* truth() const { return truth_ ? &truth_->shapes : nullptr; }
  // Returns a frame's place among the samples of the truth; nothing: there is no truth, or none at the frame. Only
  // where it has a place is it evaluated.
  std::optional<SampleTime> truth_time(int frame) const {
    return truth_ ? sample_time(truth_->shapes, frame) : std::nullopt;
  }
  // The truth between samples is shown, and not measured.
  bool has_sample_at(int frame) const {
    const std::optional<SampleTime> time = truth_time(frame);
    return time && time->on_sample();
  }

 private:
  // The source of what the host made last: the evaluation of a level, or an upload.
  struct Source {
    std::size_t level = 0;
    std::uint64_t number = 0;
    bool operator==(const Source&) const = default;
  };
  // A skin of the finest level that comes from the host.
  struct HostedSkin {
    std::uint64_t number = 0;   // another with every upload
    std::vector<float> points;  // O x 3
    vulkan::Buffer positions, normals;
  };
  // The meshes attached to the skins of a method.
  struct Worn {
    Source on;
    std::vector<Pose> poses;
    std::vector<WornMesh> meshes;
  };
  struct Truth {
    trainer::NamedShapes shapes;
    std::optional<SampleTime> shown;
    HostedSkin skin;
    bool raw = false;
    std::optional<std::pair<int, std::vector<float>>> sculpted{};  // frame, points
  };

  Detail& finest() { return *details_.front(); }
  const Detail& finest() const { return *details_.front(); }
  LevelPool::Levels make_levels(shots::OpenedCharacter& opened) const;
  void read_materials(LevelPool& pool);
  std::shared_ptr<const CharacterMaterials> materials_of(const std::string& own) const;
  std::vector<Level> proxy_of(const Basis& full) const;
  void take_clip(Clip clip);
  std::size_t clip_index(int frame) const;
  const Pose& clip_pose(int frame) const { return clip_.poses[clip_index(frame)]; }
  const FollowingMeshes& following() const;  // the skin of the finest level
  bool has_worn_skin() const;
  std::vector<float> full_skin(const Detail& detail, const Evaluation& evaluation) const;
  const HostedSkin* hosted_skin(SkinMethod method) const;
  std::vector<float> skins_on_host(SkinMethod method) const;
  const Evaluation& carry_proxy();
  void show_linear_blend(const Pose& pose);
  std::vector<float> linear_skin(const Pose& pose) const;
  HostedSkin upload_output(std::span<const float> points);
  void show_truth(int frame);
  std::vector<float> shown_truth(int frame, const SampleTime& time) const;
  void open_frames(const std::string& dataset);
  std::shared_ptr<const trainer::UnposedSpace> unposed_space(const trainer::PoseDatabase& database) const;
  void measure_size();
  void measure_ground();

  std::shared_ptr<const vulkan::Device> device_;
  shots::ActorFiles files_;
  ClipOptions clip_options_;
  std::vector<std::string> notes_;
  std::string shown_by_;
  std::vector<std::unique_ptr<Detail>> details_;  // finest first; all but the first are proxies
  std::size_t level_ = 0;
  Clip source_;                             // as it was read
  Clip clip_;                               // as it is shown before it is posed: modified, with the basis' controls
  mutable shots::ModifierTrack modifiers_;  // over source_
  std::vector<int> keys_;
  std::vector<ClipCamera> own_cameras_;
  shots::Turning turning_;
  shots::ViewSettings::Posing posing_;
  double size_ = 1, reach_ = 1, ground_ = 0;
  Evaluation hosted_;  // of skins that come from the host: nothing
  std::uint64_t uploads_ = 0;
  HostedSkin blended_, carried_;  // by linear blending; by the proxy
  std::vector<Pose> blended_of_;  // none, or one
  Source carried_from_;
  std::optional<Truth> truth_;
  std::unique_ptr<WornMeshes> worn_;
  std::map<SkinMethod, Worn> worn_on_;
  std::shared_ptr<const CharacterMaterials> materials_;  // null: its own file is not known
  std::string like_;
  Pose hosted_pose_;                    // of the skins from the host that were evaluated last
  std::optional<Character> character_;  // with its weights, where they are at hand
};

}  // namespace bodyopt::viewport
