// Brushes on the skin of one frame of a dataset: strokes stay in memory until they are kept as the sculpt of a
// modifier.
#pragma once

#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "geometry/brush.h"
#include "trainer/curate/pose_database.h"
#include "trainer/curate/shape_stack.h"

namespace bodyopt {
class JsonObject;
}

namespace bodyopt::trainer {

// Sculpts delta_k of a modifier of the type sculpt spread over poses (Shepard 1968). The offset of a frame is sum_k w_k
// delta_k, with w_k = f(d_k) (1 / d_k^2) / sum_j (1 / d_j^2). The distance d_k is that of its pose from sculpt k's, in
// the joints that move what was sculpted. The falloff f goes smoothly from 1 at 0 to 1/2 at half the spread and to 0 at
// the spread. At the poses sculpted the offset is exact.

struct SculptedFrame {
  std::size_t frame = 0;  // of the database
  Positions delta;        // V x 3, un-posed, metres
};

class SculptedFrames {
 public:
  // `parameters`: of the modifier; `place` is for messages. Throws Error(mismatch) where a sculpt is of another mesh,
  // or of no frame of the database, Error(file).
  SculptedFrames(const PoseDatabase& database, const JsonObject& parameters, const std::string& place);

  // Adds a sculpt, in the place of that of its frame where there is one.
  void put(SculptedFrame sculpt);
  const std::vector<SculptedFrame>& sculpts() const { return sculpts_; }
  double spread() const { return spread_; }  // degrees
  const std::vector<std::uint32_t>& joints() const { return joints_; }
  // The share w_k that a frame has of every sculpt.
  std::vector<double> weights(std::size_t frame) const;
  // V x 3: what all of them add to a frame.
  Positions sum(std::size_t frame) const;

 private:
  void choose_joints();

  const PoseDatabase& database_;
  std::vector<SculptedFrame> sculpts_;
  std::vector<std::uint32_t> named_joints_, joints_;  // as the parameters say; or those that move what was sculpted
  double spread_;                                     // degrees
};

// Why the frame would not become what is sculpted in the modifier `name`: "is switched off". Empty: it would, or there
// is no such modifier yet.
std::string why_not_shown(const PoseDatabase& database, const std::string& name, std::size_t frame);

class FrameSculpting {
 public:
  // Sculpts a frame as the stack leaves it, for the modifier `name`, which keep() makes where there is none. Spread:
  // over how many degrees; none: what the modifier has, 30 for a new one. Throws Error(usage) where the modifier is no
  // sculpt, or would hide part of a stroke. It would if switched off, of less than full strength, of a part of the skin
  // or of other frames.
  FrameSculpting(std::shared_ptr<const ShapeStack> stack, std::size_t frame, std::string name,
                 std::optional<double> spread_degrees);
  FrameSculpting(const FrameSculpting&) = delete;
  FrameSculpting& operator=(const FrameSculpting&) = delete;

  std::size_t frame() const { return frame_; }
  const ShapeStack& stack() const { return *stack_; }
  const Positions& skin() const { return skin_; }  // V x 3, posed, metres, with all strokes
  // Whether strokes have changed anything that is not kept.
  bool has_change() const { return surface_ != begun_; }

  // Begins a stroke. `mirrored`: a second hand does the same on the other side of the body.
  void begin(const Brush& brush, bool mirrored);
  // Touches a point of skin(). Throws Error(mismatch) where the body's other side is to be touched, and is not its
  // mirror image.
  void touch(const SkinPoint& at);
  // A grab: what was touched last goes so far from where it was then, metres, world.
  void pull(const Eigen::Vector3d& way);

  // Whether the modifier has a sculpt of the frame, or will have.
  bool is_sculpted() const;
  // The share of this frame's sculpt that every frame of the database takes.
  const std::vector<double>& weights();

  // Writes the strokes into the dataset as one edit. Where another process has edited its stack meanwhile, they are put
  // on top of that. Waits no longer than `patience` for others that edit. Returns what the artist should know. Throws
  // as put_sculpt(), and Error(file); the strokes stay then.
  std::vector<std::string> keep(std::chrono::milliseconds patience) const;

 private:
  const Character& character() const { return stack_->database().character; }
  SkinPoint mirror_image(const SkinPoint& at);
  std::vector<std::string> put_into(std::vector<Modifier>& modifiers, const Positions& strokes) const;
  void show();

  std::shared_ptr<const ShapeStack> stack_;
  std::size_t frame_;
  std::string name_;
  UnposedSpace::Frame space_;
  SculptedFrames sculpted_;
  Positions own_;              // V x 3: what the modifier adds to the frame without the strokes
  Positions begun_, surface_;  // V x 3, un-posed: without the strokes, and with them
  Positions skin_;
  SurfaceDistance paths_;
  std::optional<BrushStroke> stroke_;
  SkinPoint at_;  // where it touched last, un-posed
  bool is_mirrored_ = false;
  std::unique_ptr<NearestSkin> rest_;  // of the rest skin, once a stroke is mirrored
  std::vector<double> weights_;
  std::vector<std::uint32_t> weighed_joints_;  // that they are of
};

}  // namespace bodyopt::trainer
