// What the stack makes of a dataset: measured, and written as another one.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "trainer/curate/shape_stack.h"

namespace bodyopt {

struct FrameEffect {
  std::size_t frame = 0;  // of the database
  double rms_mm = 0, max_mm = 0;
};

struct ModifierEffect {
  std::string name;
  std::vector<FrameEffect> frames;  // those that it changes
  double rms_mm = 0, max_mm = 0;    // over these
  std::size_t worst = 0;            // the frame in which a vertex moves by max_mm
};

// How far each modifier moves the shapes that those before it leave; of one, where `name` is not empty. Shows progress.
// Throws Error(usage) where there is none of the name.
std::vector<ModifierEffect> measure_modifiers(const ShapeStack& stack, const std::string& name);

// A dataset of the same clips whose caches are the shapes through the stack, without those that are dropped or did not
// converge, and without modifiers. Mirror images get clips of their own. dataset.json is written last. Throws
// Error(usage) where `folder` has a dataset already, Error(file).
Dataset bake_dataset(const ShapeStack& stack, const std::filesystem::path& folder);

}  // namespace bodyopt
