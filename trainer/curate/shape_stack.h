// The one way to the shapes of a dataset: every frame through the stack of modifiers, when it is asked for. What takes
// long of it is kept (offset_cache.h), to the bit: an edit works out what follows it, in the frames that it touches.
#pragma once

#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <vector>

#include "trainer/curate/modifier_types.h"
#include "trainer/curate/offset_cache.h"
#include "trainer/curate/pose_database.h"

namespace bodyopt::trainer {

class MirrorImage;

class ShapeStack {
 public:
  // Modifiers that are off are left out, those of types that this version does not know, too, which a note says. What
  // looks at all frames (consistency) is worked out here, or read from modifiers/cache; shows progress then.
  // Throws Error(mismatch), naming the modifier, where one does not fit the dataset, and Error(file).
  // `space`: of the character, where it is made already.
  explicit ShapeStack(PoseDatabase database, std::shared_ptr<const UnposedSpace> space = nullptr);
  ~ShapeStack();
  ShapeStack(const ShapeStack&) = delete;
  ShapeStack& operator=(const ShapeStack&) = delete;

  // The selection, mask and names of parameters of a modifier, without working it out. Throws Error(mismatch).
  static void check_scope(const PoseDatabase& database, const Modifier& modifier);

  // The database with the mirror images that a symmetry modifier adds as takes of their own: "rom mirrored".
  const PoseDatabase& database() const { return database_; }
  const std::vector<std::string>& notes() const { return notes_; }
  // Whether a frame is left out of training.
  bool is_dropped(std::size_t frame) const { return dropped_[frame]; }
  // How many times a frame counts in training; 1 where no modifier says otherwise.
  double weight(std::size_t frame) const { return weights_[frame]; }
  // Whether automatic modifiers leave any of a frame alone.
  bool is_frozen(std::size_t frame) const { return frozen_part(frame).maxCoeff() > 0; }
  // Whether any modifier changes a frame's shape; if none does, the shape is the raw one, bit for bit.
  bool is_changed(std::size_t frame) const;

  // V x 3, welded, posed, metres. On any thread. Throws Error(file) at a damaged sample.
  Positions shape(std::size_t frame) const;
  // The un-posed offsets that the first `count` modifiers (of all, also those that are off) leave.
  Positions offsets(std::size_t frame, std::size_t count) const;
  // Posed, as the stack begins with it: raw, or the mirror image of what another frame has become.
  Positions begun(std::size_t frame) const;
  const UnposedSpace& space() const;
  // Null as long as nobody needed it.
  const std::shared_ptr<const UnposedSpace>& made_space() const { return space_; }

 private:
  struct Layer;
  struct Change;

  void add(std::size_t place, const Modifier& modifier, const ModifierType& type);
  void add_mirror_images(std::size_t place);
  void add_weight(const Layer& layer);
  void add_shape(std::size_t place, Layer layer, const ModifierType& type);
  Positions posed(std::size_t frame, std::size_t count) const;
  std::vector<Change> changes_of(std::size_t frame, std::size_t count) const;
  Positions through(const std::vector<Change>& changes, const FrameInHand& frame) const;
  std::vector<std::uint64_t> keys_after(std::span<const Change> changes, std::size_t frame,
                                        const Positions& start) const;
  std::uint64_t key_after(const Change& change, std::size_t frame, std::uint64_t before) const;
  std::uint64_t key(std::size_t frame, std::size_t count) const;
  void apply(const Layer& layer, const FrameInHand& frame, Positions& offsets) const;
  Eigen::VectorXd frozen_part(std::size_t frame) const;

  PoseDatabase database_;
  std::vector<std::string> notes_;
  std::vector<char> dropped_;
  std::vector<double> weights_;
  std::vector<Layer> layers_, freezes_;
  mutable std::once_flag space_made_;                  // shapes are asked for by several threads
  mutable std::shared_ptr<const UnposedSpace> space_;  // made with the first modifier
  OffsetCache cache_;
  std::uint64_t identity_;  // a hash of the character
  std::unique_ptr<MirrorImage> mirror_;
  std::size_t raw_frames_ = 0, mirror_place_ = 0;
};

}  // namespace bodyopt::trainer
