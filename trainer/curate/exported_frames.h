// Frames that are given out to be sculpted. What comes back is a sculpt of what was given out, whatever the stack has
// become meanwhile.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "dataset/dataset.h"
#include "dataset/modifier.h"
#include "trainer/curate/shape_stack.h"

namespace bodyopt::trainer {

// A file of modifiers/exported/ says which frame was exported to be sculpted, and what stack made it. Each export has
// its own file, so that those of two artists merge.
struct ExportRecord {
  std::string take;
  int frame = 0;
  std::string skin;                 // a PC2 cache of one sample, un-posed, relative to the dataset's folder
  std::vector<Modifier> modifiers;  // the stack that made it
  bool operator==(const ExportRecord&) const = default;
};

// The files that exports are written down in, the latest last; the first may be of an earlier version, which wrote all
// into modifiers/exported.json.
std::vector<std::filesystem::path> export_files(const Dataset& dataset);
// One record, or those of an earlier version's file, the latest last. Throws Error(file).
std::vector<ExportRecord> read_export_file(const std::filesystem::path& path);
// Takes the files away. The caller holds the dataset's lock. Throws Error(file).
void forget_exports(const Dataset& dataset);

struct ExportedFrame {
  Positions skin;  // V x 3, un-posed: the rest skin with the frame's displacements, metres
  std::vector<Modifier> modifiers;
  std::string mark{};  // that its mesh is named by; empty: it was not written down
};

// A frame as the stack makes it now.
ExportedFrame exported_now(const ShapeStack& stack, std::size_t frame);
// Writes it down, and returns its mark; the latest 200 of all frames stay. `path`: the dataset.json. Throws
// Error(file).
std::string keep_exported(const std::filesystem::path& path, const ShapeStack& stack, std::size_t frame,
                          const ExportedFrame& exported);
// Exports of a frame that can be used, the latest first. The files are hints: what is damaged, of another character, of
// a newer version, or names missing files is left out, with a note. `name`: the modifier whose sculpts of then are
// needed, too.
struct KeptExports {
  std::vector<ExportedFrame> frames;
  std::vector<std::string> notes;
};
KeptExports kept_exports(const ShapeStack& stack, std::size_t frame, const std::string& name);

// The sum (V x 3) that the sculpts of a stack's modifier `name` add to a frame; zero where it is missing or off.
Positions sculpted_by(const PoseDatabase& database, const std::vector<Modifier>& modifiers, const std::string& name,
                      std::size_t frame);

// Modifiers that one of two stacks has, and the other has not, or has otherwise.
std::vector<std::string> names_that_differ(const std::vector<Modifier>& before, const std::vector<Modifier>& now);

}  // namespace bodyopt::trainer
