// The dataset whose frames are looked at: what its panel shows, and edits of its stack.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "trainer/curate/consistency.h"
#include "trainer/curate/pose_space.h"
#include "viewport/commands/controls.h"
#include "viewport/panels/snapshot.h"
#include "viewport/scene/scene.h"

namespace bodyopt::viewport {

class Curation {
 public:
  // Takes up the lead's truth where that is a whole dataset; otherwise there is nothing to curate. Gives the controls
  // the names for commands.
  void look(const Scene& scene, Controls& controls);
  // Describes the map for the panel, in the colours asked for; errors are those of the snapshot. `brushed`: the share
  // of every database frame in the last stroke, while that is drawn; empty: nothing was brushed.
  void describe(const Controls& controls, Snapshot& snapshot, std::span<const double> brushed) const;

  bool is_open() const { return stack_ != nullptr; }
  void require_open() const;  // throws Error(usage)
  const std::shared_ptr<const trainer::ShapeStack>& stack() const { return stack_; }
  // Returns the place in the database of a frame of the clip.
  std::size_t number_of(int frame) const;
  // Compares like poses of the whole dataset. Shows progress. Throws as require_open().
  void find_contradictions(Controls& controls);
  // Throw as require_open(), change_modifier() and undo_modifiers(); Error(file) soon, where another process edits.
  void edit(const ModifierEdit& edit) const;
  void step(bool back) const;

 private:
  bool has_its_frames(const trainer::ShapeStack& stack, const std::vector<std::size_t>& numbers) const;
  void take_over(const std::shared_ptr<const trainer::ShapeStack>& stack, Controls& controls);
  void begin(const std::shared_ptr<const trainer::ShapeStack>& stack, std::vector<std::size_t> numbers,
             Controls& controls);
  void name_modifiers(Controls& controls) const;
  void choose_region(const std::string& name);
  std::vector<PoseDot> dots(const std::vector<double>& heat) const;
  std::vector<double> values(MapColour colour, const Snapshot& snapshot, std::span<const double> brushed) const;
  std::filesystem::path path() const { return stack_->database().dataset.folder / "dataset.json"; }

  std::shared_ptr<const trainer::ShapeStack> stack_;
  int first_frame_ = 1;               // of the clip
  std::vector<std::size_t> numbers_;  // of the frames of the clip, in the database
  std::vector<trainer::SkinPart> parts_;
  std::string region_;
  trainer::PoseMap map_;
  std::optional<trainer::ConsistencyReport> report_;
};

}  // namespace bodyopt::viewport
