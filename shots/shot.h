// A shot: a character, its clip as it is posed and driven, and which of its frames are evaluated how. It is read from
// files (shot_files.h), or made of what is open in the viewport; whoever evaluates it gets the same bits.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "assets/clip.h"
#include "runtime/basis/attachments.h"
#include "runtime/basis/levels.h"
#include "runtime/deformer/deformer.h"

namespace bodyopt {

class Progress;

// Takes a sentence for the user.
using Tell = std::function<void(const std::string&)>;

struct Shot {
  std::string name;                    // of the character
  std::unique_ptr<Deformer> deformer;  // has the weights by which the skin is shown
  bool jiggles = false;                // frames go on from each other; they rise
  bool checks = false;                 // every stage runs on the CPU, too
  CarriedSkin carried;                 // of a proxy: the full skin
  Attachments attached;                // meshes that follow the skin of the deformer
  Clip clip;                           // with the weights of modifiers and the controls of the basis
  std::vector<int> frames;             // of the clip
  int preroll = 0;                     // frames of the clip that the jiggle steps before the first

  const Basis& basis() const { return deformer->basis(); }
  // Of `count` frames from frames[begin] on.
  std::vector<Pose> poses(std::size_t begin, std::size_t count) const;
};

// Gets the frames of a shot.
class SkinSink {
 public:
  virtual ~SkinSink() = default;
  // What the deformer gave of `poses`, which are frames[begin], frames[begin + 1], ...
  virtual void append(const Evaluation& part, std::span<const Pose> poses, std::size_t begin) = 0;
};

// Why frames of the clip cannot jiggle: the dynamics step at another rate. Empty: they can.
std::string problem_of_rate(const Dynamics& dynamics, const Clip& clip);

// Steps the frames of the clip that come before the first. Shows progress. Throws as Deformer::jiggle().
void preroll(Shot& shot, const Tell& tell);

// Evaluates frames[begin] and all after it, a part at a time; the bits do not depend on the parts. Advances `progress`
// by their number. Throws as Deformer and the sink do; the frames before are then in the sink.
void evaluate(Shot& shot, SkinSink& sink, Progress& progress, std::size_t begin = 0);

}  // namespace bodyopt
