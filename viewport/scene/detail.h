// A level of detail. Its constant part is on the device once for all of the cast who show it. Each of the cast has its
// skin by several methods.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "runtime/coverage/expected_error.h"
#include "runtime/deformer/deformer.h"
#include "runtime/deformer/evaluate_together.h"
#include "runtime/deformer/following_meshes.h"
#include "runtime/host/character_model.h"
#include "runtime/vulkan/backend/device_model.h"
#include "runtime/vulkan/buffer.h"
#include "viewport/scene/character_materials.h"
#include "viewport/scene/cut_tets.h"

namespace bodyopt::viewport {

struct LevelOnDevice {
  // `dynamics`: of the same basis, where there are any. Throws Error(device).
  LevelOnDevice(const std::shared_ptr<const vulkan::Device>& device, Level level, std::optional<Dynamics> dynamics);

  const Basis& basis() const { return model->basis; }
  // An instance whose skin is drawn. `jiggle`: none for the quasi-static skin, or the model must have dynamics.
  std::unique_ptr<Deformer> make_deformer(const std::optional<JiggleOptions>& jiggle = std::nullopt) const;

  std::shared_ptr<const vulkan::Device> device;
  std::shared_ptr<const CharacterModel> model;
  std::shared_ptr<const vulkan::DeviceModel> tables;  // none on a device that only draws
  FollowingMeshes following;                          // of a proxy: the full skin
  double distance = 0;  // of the full skin's vertices from the level's at rest, RMS, metres
  vulkan::Buffer triangles, fibre_segments, fibre_points;
  std::uint32_t fibre_segment_count = 0;
  std::optional<ErrorExpectation> expectation;  // where there is coverage
  RegionShares shares;                          // of the regions, where there is coverage
};

// The levels of bases that are shown, and their materials. Those of the same files, unchanged, are made once.
class LevelPool {
 public:
  using Levels = std::vector<std::shared_ptr<const LevelOnDevice>>;

  // Returns what `make` gives of the files, or gave before, while somebody shows it.
  Levels get(const std::vector<std::filesystem::path>& files, const std::function<Levels()>& make);
  using Materials = std::shared_ptr<const CharacterMaterials>;
  Materials materials(const std::vector<std::filesystem::path>& files, const std::function<Materials()>& make);

 private:
  // Keys are names, sizes and times; those of the images then are beside the materials.
  std::map<std::string, std::pair<std::weak_ptr<const CharacterMaterials>, std::string>> materials_;
  std::map<std::string, std::vector<std::weak_ptr<const LevelOnDevice>>> made_;  // by names, sizes and times
};

// The methods that make the skin: linear blending (lbs); Direct Delta Mush without what is learned (ddm). Of what is
// learned, `linear` has the part that is linear in joints and strains. In `proxy` the full skin follows the next
// coarser level; `truth` is a point cache.
enum class SkinMethod { lbs, ddm, linear, full, jiggle, proxy, truth };

// The error that coverage expects at a pose.
struct ExpectedSkin {
  double rms_mm = 0, largest_mm = 0, p99_mm = 0;  // over the skin; of a vertex; of 99 of 100
  vulkan::Buffer vertices;                        // V, metres
};

class Detail;

// Poses of one frame, then of ghosts, by ddm, linear, full or jiggle, on one level. `frame`: of the first; the jiggle
// steps only with that. On the host, too, when `host` asks for it.
struct SkinRequest {
  Detail* detail;
  SkinMethod method;
  std::vector<Pose> poses;  // of the jiggle one
  int frame = 0;
  Weights weights;
  bool host = false;
};

// Evaluates on the device, in one submission, the requests that differ from the last time. Each has to be of another
// level or method. Throws the first error, when all others are done.
void evaluate_together(std::span<const SkinRequest> requests);

class Detail {
 public:
  // The last evaluation by a method, and its input.
  struct Evaluated {
    std::vector<Pose> poses;
    int frame = 0;
    Weights weights;
    bool host = false;
    std::uint64_t number = 0;  // that no other evaluation of the level has
    Evaluation result;
  };

  Detail(std::shared_ptr<const vulkan::Device> device, std::shared_ptr<const LevelOnDevice> level);

  const LevelOnDevice& level() const { return *level_; }
  const Basis& basis() const { return level_->basis(); }
  bool jiggles() const { return level_->model->dynamics.has_value(); }
  // Frames a second that the jiggle steps; the level must have dynamics.
  double jiggle_rate() const { return static_cast<double>(level_->model->dynamics->jiggle.step.frames_per_second); }
  std::uint32_t tet_count() const { return jiggles() ? level_->model->dynamics->tets.tet_count() : 0; }
  // Cuts the tets at a pose, or at the jiggle that is shown, where `jiggle` says how much of it is. The level must have
  // dynamics.
  const CutTets& cut_tets(const Pose& pose, std::optional<float> jiggle, const Vec3& towards, double share);

  bool knows_coverage() const { return !basis().coverage.empty(); }
  // Returns the expected error at the first pose that the method evaluated last; the level must know its coverage.
  const ExpectedSkin& expected_skin(SkinMethod method);

  // Returns the skin of the last evaluation by the method.
  DeviceSkin skin(SkinMethod method) const;
  const Evaluated& last(SkinMethod method) const { return evaluated_.at(method); }
  void reset_jiggle();  // which starts anew with the next frame
  // The frame that the jiggle stands at, or was reset at; none before its first.
  std::optional<int> jiggle_frame() const;

  // The quasi-static result on the host, of one pose: does not touch what is shown. `correction`: see Weights.
  Evaluation measure(SkinMethod method, const Pose& pose, float correction = 1);

 private:
  friend void evaluate_together(std::span<const SkinRequest> requests);
  enum class Use { show, measure };

  std::optional<DeformerCall> call_of(const SkinRequest& request);
  void keep(const SkinRequest& request, Evaluation result);
  Deformer& deformer(SkinMethod method, Use use);
  std::vector<float> tet_nodes(const Pose& pose, std::optional<float> jiggle);

  std::shared_ptr<const vulkan::Device> device_;
  std::shared_ptr<const LevelOnDevice> level_;
  std::map<std::pair<SkinMethod, Use>, std::unique_ptr<Deformer>> deformers_;  // of one model, made when first wanted
  std::map<SkinMethod, Evaluated> evaluated_;
  std::uint64_t evaluations_ = 0;      // so far
  std::unique_ptr<CutTets> cut_tets_;  // made when they are first wanted
  std::vector<Pose> tet_poses_;        // of which the tets were measured last; none, or one
  std::optional<std::pair<std::uint64_t, ExpectedSkin>> expected_;  // of the evaluation of this number
};

// Compares joints and controls to the last bit.
bool same(std::span<const Pose> a, std::span<const Pose> b);

// Chooses the level that holds a rate: coarser when pictures are late, finer when there is twice the time. A level that
// was too slow is tried again after a while, each time a longer one, or the skin would change twice a second. The
// finest while nothing plays.
class DetailChoice {
 public:
  static constexpr double kRate = 24;                            // pictures a second
  static constexpr double kPatience = 0.5;                       // seconds of pictures before it changes its mind
  static constexpr double kFirstRetry = 8, kLongestRetry = 120;  // seconds until what was too slow is tried again

  // `seconds`: what the last picture took. Gives the level to show, 0 to count - 1.
  std::size_t choose(double seconds, bool playing, std::size_t count);

 private:
  std::size_t level_ = 0;
  double sum_ = 0;
  int pictures_ = 0;
  std::optional<std::size_t> too_slow_;
  bool has_tried_ = false;  // what was too slow
  double waited_ = 0, retry_ = kFirstRetry;
};

}  // namespace bodyopt::viewport
