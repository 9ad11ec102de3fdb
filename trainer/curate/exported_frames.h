// modifiers/exported.json: frames as they were when they were given out to be sculpted. What comes back is a sculpt of
// what was given out, whatever the stack has become meanwhile.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "trainer/curate/shape_stack.h"

namespace bodyopt {

// As the file has it.
struct ExportRecord {
  std::string take;
  int frame = 0;
  std::string skin;                 // a PC2 cache of one sample, un-posed, relative to the dataset's folder
  std::vector<Modifier> modifiers;  // the stack that made it
  bool operator==(const ExportRecord&) const = default;
};

struct ExportedFrame {
  Positions skin;  // V x 3, un-posed: the rest skin with the frame's displacements, metres
  std::vector<Modifier> modifiers;
};

// The latest last; none where there is no file. Throws Error(file).
std::vector<ExportRecord> read_export_records(const Dataset& dataset);
// Takes the file away. The caller holds the dataset's lock.
void forget_exports(const Dataset& dataset);

// A frame as the stack makes it now.
ExportedFrame exported_now(const ShapeStack& stack, std::size_t frame);
// Writes it down; the latest 200 of all frames stay. `path`: the dataset.json. Throws Error(file).
void keep_exported(const std::filesystem::path& path, const ShapeStack& stack, std::size_t frame,
                   const ExportedFrame& exported);
// What was written down of a frame and still has its cache, the latest first. Throws Error(file), Error(mismatch) where
// it is of another character.
std::vector<ExportedFrame> kept_exports(const ShapeStack& stack, std::size_t frame);

// V x 3: what the sculpts of the modifier `name` of a stack add to a frame; nothing where there is none, or it is off.
Positions sculpted_by(const PoseDatabase& database, const std::vector<Modifier>& modifiers, const std::string& name,
                      std::size_t frame);

// Modifiers that one of two stacks has, and the other has not, or has otherwise.
std::vector<std::string> names_that_differ(const std::vector<Modifier>& before, const std::vector<Modifier>& now);

}  // namespace bodyopt
