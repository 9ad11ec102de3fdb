// The kinds of modifiers, and the space in which they act. Each kind has its prepare_<type> in this folder and a line
// of the table in modifier_types.cpp.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "assets/characters/character.h"
#include "runtime/basis/basis.h"
#include "trainer/curate/offset_cache.h"
#include "trainer/curate/pose_database.h"
#include "trainer/train/skinning/unpose.h"

namespace bodyopt {
class JsonObject;
}

namespace bodyopt::trainer {

// A shape as the displacement of the rest skin that Direct Delta Mush of the default radius poses into it. There and
// back is an isometry: what is not touched stays where it is to 1e-7 of its size.
class UnposedSpace {
 public:
  explicit UnposedSpace(const Character& character);
  // `ddm`: what build_ddm_basis() makes of the character without options, where that is there already.
  UnposedSpace(const Character& character, Basis ddm);

  // Rotation and translation of every vertex in one pose.
  class Frame {
   public:
    Positions offsets(const Positions& shape) const;  // V x 3 posed -> V x 3 un-posed, metres
    Positions shape(const Positions& offsets) const;  // and back
    // How a vertex is turned, un-posed to posed.
    const Eigen::Matrix3d& rotation(std::size_t vertex) const { return placements_[vertex].rotation; }

   private:
    friend class UnposedSpace;
    std::vector<VertexPlacement> placements_;  // V, welded
  };
  // Throws Error(mismatch) where the pose is of another skeleton.
  Frame frame(const Pose& pose) const;

 private:
  Basis basis_;
  std::vector<std::uint32_t> order_;  // welded vertex of each runtime vertex
};

// One frame on its way through the stack.
struct FrameInHand {
  std::size_t number = 0;  // of the database
  const UnposedSpace::Frame& space;
};

// A modifier that knows all it needs. Its functions are called on any thread.
struct ShapeModifier {
  // A hash of all that apply() makes of a frame's pose and offsets depends on: what was worked out is known again by
  // it. None: it leaves the frame as it is.
  std::function<std::optional<std::uint64_t>(std::size_t frame)> cause{};
  // Changes the offsets (V x 3, un-posed, metres) of one frame. Mask, strength, selection and frozen parts are seen to
  // by the stack.
  std::function<void(const FrameInHand& frame, Positions& offsets)> apply{};
  std::string note{};  // what whoever reads the shapes should know, after the modifier's name; mostly nothing
};

struct ModifierInput {
  const PoseDatabase& database;
  const UnposedSpace& space;
  const JsonObject& parameters;       // keys are checked against ModifierType::parameters already
  const std::string& place;           // "modifier 'elbow'", for messages
  const std::vector<char>& selected;  // of every frame
  const std::vector<char>& frozen;    // of every frame: whether all of it stays as it is
  const Eigen::VectorXd& mask;        // V
  // Offsets of a frame as the modifiers before this one leave them, and a hash of all that they come from. On any
  // thread, and as long as the modifier lives.
  std::function<Positions(std::size_t frame)> below;
  std::function<std::uint64_t(std::size_t frame)> key_below;
  const OffsetCache& cache;  // for what is not of single frames
};

struct ModifierType {
  enum class Effect { shape, drop, weight, freeze, mirror };
  const char* name;
  const char* what;  // one line
  std::vector<const char*> parameters;
  // Set for Effect::shape. Throws Error(mismatch) or Error(file) where the parameters do not fit the dataset.
  ShapeModifier (*prepare)(const ModifierInput& input);
  bool automatic = false;  // leaves frozen frames and parts alone
  bool kept = false;       // what it makes of a frame is cached: that takes longer to work out than to read
  Effect effect = Effect::shape;
};

std::span<const ModifierType> modifier_types();
// Null: of a newer version.
const ModifierType* find_modifier_type(const std::string& name);

// A number of the parameters, `usual` where it is not named.
double parameter(const ModifierInput& input, const char* key, double usual, double low, double high);

ShapeModifier prepare_sculpt(const ModifierInput& input);
ShapeModifier prepare_smooth(const ModifierInput& input);
ShapeModifier prepare_relax(const ModifierInput& input);
ShapeModifier prepare_volume(const ModifierInput& input);
ShapeModifier prepare_blend(const ModifierInput& input);
ShapeModifier prepare_detail(const ModifierInput& input);
ShapeModifier prepare_inflate(const ModifierInput& input);
ShapeModifier prepare_despike(const ModifierInput& input);
ShapeModifier prepare_consistency(const ModifierInput& input);

}  // namespace bodyopt::trainer
