// The characters, and what of them is to be seen at a frame.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "draw/view.h"
#include "runtime/host/stages.h"
#include "viewport/commands/controls.h"
#include "viewport/scene/actor.h"

namespace bodyopt::viewport {

// The match of the lead's points with those of the second of the cast: of their finest levels, runtime vertices.
struct MatchedSkins {
  std::array<vulkan::Buffer, 2> colours;  // V x 3, linear RGB: the same on the same points
  std::array<vulkan::Buffer, 2> unsure;   // V: one less the confidence
};

// The part of the lead's skin that a plane leaves, and the section that closes it.
struct CutOpenSkin {
  struct Part {
    vulkan::Buffer positions, normals, colours, triangles;
    std::uint32_t triangle_count = 0;  // 0: there is none, and no buffers
  };
  Part skin, face;
};

class Scene {
 public:
  explicit Scene(std::shared_ptr<const vulkan::Device> device) : device_(std::move(device)) {}

  void add(const shots::ActorFiles& files, const ClipOptions& options);
  // One that is not in the cast.
  std::unique_ptr<Actor> make(const shots::ActorFiles& files, const ClipOptions& options) const;
  void swap(std::size_t index, std::unique_ptr<Actor>& other);
  void make_lead(std::size_t index);  // the others keep their order
  void remove(std::size_t index);
  // Returns the coarsest level whose skin is less than a fifth of a pixel from the full one (RMS, at rest). The pixel
  // is where the character is, in a picture of that height.
  std::size_t level_by_size(std::size_t index, const Controls& controls, std::uint32_t height) const;
  // Replaces the lead's clip.
  void set_live_pose(Pose pose) { live_pose_ = std::move(pose); }
  void leave_live_pose() { live_pose_.reset(); }  // back to the clip
  void reset_jiggle();
  // Sets what the settings may colour the two by, until it is taken back; they must be the two that were matched.
  void show_match(std::optional<MatchedSkins> match) { match_ = std::move(match); }
  // Replaces the lead's skin, where it is given; world.
  void show_cut_open(std::optional<CutOpenSkin> skin) { cut_open_ = std::move(skin); }
  bool empty() const { return cast_.empty(); }
  std::vector<std::filesystem::path> paths() const;  // of all that is read for the cast
  std::vector<std::unique_ptr<Actor>>& cast() { return cast_; }
  const std::vector<std::unique_ptr<Actor>>& cast() const { return cast_; }
  Actor& lead() { return *cast_.front(); }  // whom panels speak of
  const Actor& lead() const { return *cast_.front(); }

  // The views of a frame in a picture whose part `area` is free of panels: evaluates what is not yet. Buffers stay
  // until the next call. Throws Error(device), Error(file) of a truth that went away.
  std::vector<draw::View> look(const Controls& controls, const draw::Rectangle& area);

  // The lead alone in a pose at the frame, in a square picture, framed.
  std::vector<draw::View> portrait(const shots::ViewSettings::PoseKey& pose, const Controls& controls,
                                   std::uint32_t pixels);

  // Places those views in the area: two side by side, otherwise all of it.
  std::vector<draw::Rectangle> view_areas(const shots::ViewSettings& settings, const draw::Rectangle& area) const;

  // Returns the lead's place over the ground, however it leaps: its root's mean over half a second either way. The mean
  // ends where the root is half its size away, as a dataset goes on with another take elsewhere.
  Vec3 whereabouts(int frame) const;
  Vec3 root_place(int frame) const;  // of the lead, metres, world; of the nearest frame that its clip has
  // Returns the skin and attached meshes of all at the frame, or what is around the selected joint: V x 3, for framing.
  std::vector<float> points_to_frame(const Controls& controls);
  // Returns the pose of one of the cast.
  Pose pose_at(const Actor& character, int frame, const Controls& controls) const;
  Pose lead_pose(const Controls& controls) const;
  // The lead's full skin in that pose, finest level, output vertex order: quasi-static.
  std::vector<float> lead_skin(const Controls& controls);  // at the frame
  // The full skin of one of the cast at the frame, where it stands on the stage, finest level, O x 3: quasi-static.
  std::vector<float> skin_on_stage(std::size_t index, const Controls& controls);
  // Returns the lead's joint centres at the frame, J, metres, world.
  std::vector<Vec3> joint_centres(const Controls& controls) const;

  // Figures of the last look: seconds by stage, summed over the cast; strains and outside of the lead.
  const StageSeconds& stage_seconds() const { return stage_seconds_; }
  const Evaluation* lead_evaluation() const { return lead_evaluation_; }
  // Returns the lead's error at the frame; its coverage must be known. Evaluates what is not yet. Throws as look().
  const ExpectedSkin& expect(const Controls& controls);
  // The lead's expected error in the last look; null: the settings do not ask for it, or it is not known.
  const ExpectedSkin* lead_expected() const { return lead_expected_; }

 private:
  struct Shown {
    SkinMethod method;
    const Evaluation* evaluation;
    DeviceSkin skin;
  };

  static std::vector<Vec3> joint_centres(const Skeleton& skeleton, const Pose& pose);
  void forget_look();  // whose results may be gone
  // Steps the jiggle through the second before a frame to which it has not come by itself, unless something plays.
  void preroll(Actor& character, const Controls& controls, const Weights& weights) const;
  void evaluate_cast(const std::vector<std::vector<Pose>>& all_poses, const Controls& controls);
  Shown evaluate(Actor& character, SkinMethod method, std::span<const Pose> poses, const Controls& controls);
  std::vector<Pose> poses_of(const Actor& character, const Controls& controls) const;
  std::vector<std::vector<Pose>> poses_of_cast(const Controls& controls) const;
  // Gives the view the sphere of all that is seen, and the radius of the smallest character's.
  void surround(const std::vector<std::vector<Pose>>& all_poses, const Controls& controls, draw::View& view) const;
  // `poses`: the frame's, those of the ghosts, those of the copies; `shown`, `skin`: of the frame.
  void add_character(std::size_t index, std::span<const Pose> poses, const Controls& controls,
                     std::vector<draw::View>& views);
  void add_copies_and_ghosts(Actor& character, std::span<const Pose> poses, const Shown& shown,
                             const draw::SkinDraw& skin, const Controls& controls, std::vector<draw::View>& views);
  void add_skeleton(const Actor& character, const Pose& pose, const std::array<float, 3>& offset,
                    const Controls& controls, draw::View& view);
  void add_trails(const Controls& controls, const std::array<float, 3>& offset, draw::View& view);
  void add_rings(const Controls& controls, const std::array<float, 3>& offset, draw::View& view);
  void add_fibres(const Actor& character, const Shown& shown, const std::array<float, 3>& offset, draw::View& view);
  void colour_by_match(std::size_t index, const shots::ViewSettings& settings, draw::SkinDraw& skin) const;
  void add_tets(Actor& character, const Pose& pose, const draw::SkinDraw& skin, const Controls& controls,
                std::vector<draw::View>& views);
  void add_cut_open(const draw::SkinDraw& skin, draw::View& view) const;
  void add_lines(std::vector<draw::LinePoint> points, const std::array<float, 3>& offset, float width,
                 draw::View& view);
  void add_marker(const Vec3& at, std::uint32_t colour, draw::View& view);
  void add_markings(const Controls& controls, std::vector<draw::View>& views);
  const shots::Placement& placement(const Actor& character, const Controls& controls) const;
  // Returns the frame of its own clip that a character plays at a frame of the lead's.
  int played_frame(const Actor& character, int frame, const Controls& controls) const;
  std::array<float, 3> place(std::size_t index, const Controls& controls) const;
  std::array<float, 3> free_place(std::size_t index) const;
  std::array<float, 3> place_copy(std::size_t copy, const Controls& controls) const;

  std::shared_ptr<const vulkan::Device> device_;
  mutable LevelPool levels_;  // of the cast
  std::vector<std::unique_ptr<Actor>> cast_;
  std::optional<Pose> live_pose_;
  std::optional<MatchedSkins> match_;
  std::optional<CutOpenSkin> cut_open_;
  StageSeconds stage_seconds_;
  const Evaluation* lead_evaluation_ = nullptr;
  const ExpectedSkin* lead_expected_ = nullptr;
  // Views point to these.
  std::vector<std::vector<draw::LinePoint>> lines_;
  std::vector<std::vector<std::uint32_t>> colours_;
};

// Returns the weights by which the settings show a skin.
Weights weights_of(const Controls& controls);

// The method that settings choose, and what it is compared with: none where the character has no such skin.
SkinMethod shown_method(const Actor& character, const shots::ViewSettings& settings);
std::optional<SkinMethod> compared_method(const Actor& character, const shots::ViewSettings& settings);

}  // namespace bodyopt::viewport
