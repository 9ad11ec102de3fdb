// Arguments and functions of the verbs below `curate`.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "cli/arguments/common.h"
#include "trainer/curate/local_models.h"

namespace bodyopt::cli {

struct CurateArguments {
  std::string dataset, name, type, new_name, out, take, frames, list, mesh, picture;
  std::vector<std::string> settings, joints, muscles, regions, near_joints;
  double strength = 1, within = -1, degrees = trainer::kAlikeDegrees, spread = 30;
  int near = 0, frame = 0, worst = 10, heldout_every = 0;
  std::size_t place = 1;
  bool history = false, unposed = false, everywhere = false, whole_skin = false;
  JsonOption json;
};

// The path of its dataset.json.
inline std::filesystem::path path_of(const CurateArguments& arguments) { return dataset_file(arguments.dataset); }

// Modifiers put on the stack, and changed. `strength_given`: what is not named stays.
void add_to_stack(const CurateArguments& arguments);
void edit_stack(const CurateArguments& arguments, bool strength_given);

// Reports how far the stack's modifiers move the shapes.
void report_effects(const CurateArguments& arguments);

// Frames of like poses whose shapes disagree.
void report_disagreements(const CurateArguments& arguments);

// A frame as a mesh to be sculpted elsewhere, and back as a sculpt.
void export_frame(const CurateArguments& arguments);
void import_frame(const CurateArguments& arguments);

}  // namespace bodyopt::cli
