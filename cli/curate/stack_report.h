// The stack of modifiers, and how many frames each of them takes, for programs and for people.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "assets/character.h"
#include "cli/arguments/common.h"
#include "dataset/dataset.h"
#include "trainer/curate/local_models.h"
#include "trainer/curate/modifier_types.h"
#include "trainer/curate/pose_database.h"

namespace bodyopt::cli {

// Arguments and functions of the verbs below `curate`.

struct CurateArguments {
  std::string dataset, name, type, new_name, out, take, frames, list, mesh, picture;
  std::vector<std::string> settings, joints, muscles, regions, near_joints;
  double strength = 1, within = -1, degrees = kAlikeDegrees, spread = 30;
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

// Counts, by take, the frames of a database that a modifier's selections name.
struct TakenFrames {
  std::vector<std::pair<std::string, std::size_t>> by_take;  // those of which it takes any
  std::size_t taken = 0, all = 0;
};

TakenFrames taken_frames(const PoseDatabase& database, const Modifier& modifier);
Json to_json(const TakenFrames& frames);
// "drops 127 of 161 frames (rom 120, walk 7)"; "would drop" where it is switched off.
std::string text_of(const TakenFrames& frames, const ModifierType& type, bool enabled);

// A frame of the database.
Json frame_json(const PoseDatabase& database, std::size_t n);

// The stack for programs and for people.
struct StackReport {
  Json list;
  std::string text;
};

StackReport report_stack(const Dataset& dataset, const std::optional<PoseDatabase>& database);

// The stack as it is now: what every edit ends with. `database`: none where it cannot be read.
void emit_stack(const CurateArguments& arguments, const Dataset& dataset, const std::optional<PoseDatabase>& database);
// Writes the stack after an edit that needed no database.
void emit_stack(const CurateArguments& arguments);

// Two shapes of a skin and how far they are apart.

inline constexpr double kFinestScale = 0.1;  // mm: of less nothing is to be seen

// Draws two shapes in one pose. Colours of the second show its distance from the first (hottest at scale_mm), seen from
// the side where it is largest.
void draw_apart(const Character& character, const Positions& before, const Positions& after, double scale_mm,
                const std::string& path);

}  // namespace bodyopt::cli
