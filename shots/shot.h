// A shot: a character, its clip as it is posed and driven, and which of its frames are evaluated how. It is read from
// files (shot_files.h), or made of what is open in the viewport; whoever evaluates it gets the same bits.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "assets/caches/bound_skin.h"
#include "assets/caches/cache_writer.h"
#include "assets/clips/clip.h"
#include "runtime/core/executor.h"
#include "runtime/deformer/deformer.h"
#include "runtime/deformer/following_meshes.h"
#include "shots/session/posed_clip.h"
#include "shots/session/view_settings.h"

namespace bodyopt::shots {

// Takes a sentence for the user.
using Tell = std::function<void(const std::string&)>;

// Nothing in it has a value of its own: the compiler refuses who makes one and leaves something out.
struct Shot {
  std::string name;                    // of the character
  std::unique_ptr<Deformer> deformer;  // has the weights by which the skin is shown
  bool jiggles;                        // frames go on from each other; they rise
  bool checks;                         // every stage runs on the CPU, too
  FollowingMeshes following;           // they go with the skin of the deformer
  Clip clip;                           // with the weights of modifiers and the controls of the basis
  std::vector<int> frames;             // of the clip, one at least
  int preroll;                         // frames of the clip that the jiggle steps before the first
  SkinSurface surface;                 // of the character's own file, where that is known
  std::vector<SkinSurface> surfaces;   // of the attached meshes, where that is known
  std::optional<BoundSkin> bound;      // with the joints of the frames, where the skin is written bound to them

  const Basis& basis() const { return deformer->basis(); }
  // Returns the poses of `count` frames from frames[begin] on.
  std::vector<Pose> poses(std::size_t begin, std::size_t count) const;
  // The clip from the first of the frames, of which there is one, to the last.
  Clip played_clip() const;
};

// How a clip is posed in the viewport, and driven.
struct ShotPosing {
  Turning turning;
  ViewSettings::Posing pose;
  float jiggle = 1;                     // how much of it is shown
  std::vector<std::string> channels{};  // "NAME=VALUE" over the whole clip
};

// Makes of a shot whose clip is as it was read what the viewport shows: poses, keys and drives the clip, and weighs the
// skin. Throws Error(usage) for channels that are not there, Error(mismatch) where it cannot jiggle.
void pose_shot(const ShotPosing& posing, Shot& shot, const Tell& tell);

// Gets the frames of a shot.
class SkinSink {
 public:
  virtual ~SkinSink() = default;
  // Takes what the deformer gave of `poses`, which are frames[begin], frames[begin + 1], ... It is called by one thread
  // at a time, while the next frames are evaluated: where frames jiggle these wait, so that it may ask for the motion.
  virtual void append(const Evaluation& part, std::span<const Pose> poses, std::size_t begin) = 0;
};

// Why frames of the clip cannot jiggle: the dynamics step at another rate. Empty: they can.
std::string problem_of_rate(const Dynamics& dynamics, const Clip& clip);

// The frames that the jiggle steps before the first one that is wanted: a second, or as much of it as the clip has.
int usual_preroll(const Clip& clip, int first);

// Evaluates frames[begin] and all after it, a part at a time; the bits do not depend on the parts. Of a jiggle the
// pre-roll comes before the first. `label`, `kept`: of the Progress that it shows. Throws as Deformer and the sink do;
// the frames before are then in the sink.
void evaluate(Shot& shot, SkinSink& sink, const std::string& label, std::size_t begin = 0,
              const std::string& kept = "nothing of it is kept");

// The caches of a shot: PC2, MDD, USD or glTF of its skin, and one of each attached mesh.

// The file and the form of a cache.
struct CacheChoice {
  std::string out;         // .pc2, .mdd, .usda or .glb
  bool full_skin = false;  // of a proxy: the skin of the full character
  CacheSpace space{};      // of .pc2 and .mdd
};

// Throws Error(usage) for what the format that `out` names cannot hold.
void require_form(const CacheChoice& choice);

class ShotCaches : public SkinSink {
 public:
  // The shot must outlive it, and stay where it is. Attached meshes get shot.<mesh>.pc2 beside shot.pc2. Throws
  // Error(usage) where there is no full skin to carry, and as write_cache().
  ShotCaches(const CacheChoice& choice, Shot& shot);

  void append(const Evaluation& part, std::span<const Pose> poses, std::size_t begin) override;
  // Puts them in place. Throws Error(file) where frames are missing.
  void close();

  std::size_t frames() const { return frames_; }  // that all of them hold
  std::uint32_t points() const { return points_; }
  // Paths of the attached meshes' caches, in the order of the shot's.
  const std::vector<std::string>& attached_paths() const { return attached_paths_; }

  // Puts the frames so far aside in a folder, instead of close(), where no append() has failed; nothing more can be
  // written then. Returns the files.
  std::vector<std::filesystem::path> put_aside(const std::filesystem::path& folder);
  // To be called before any frame: the first `frames` are those that put_aside() left.
  void take_up(const std::filesystem::path& folder, std::size_t frames);

 private:
  std::vector<CacheWriter*> writers() const;  // of the skin, then of what is attached

  CacheChoice choice_;
  Shot& shot_;
  FollowingMeshes::Memory following_;
  std::unique_ptr<CacheWriter> skin_;
  std::vector<std::unique_ptr<CacheWriter>> attached_;
  std::vector<std::string> attached_paths_;
  std::vector<std::unique_ptr<const BoundSkin>> bound_;  // of the attached meshes, where the skin is bound
  std::uint32_t points_ = 0;
  std::size_t frames_ = 0;
  std::unique_ptr<Executor> threads_;
};

}  // namespace bodyopt::shots
