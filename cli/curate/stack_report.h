// The stack of modifiers, and how many frames each of them takes, for programs and for people.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "assets/characters/character.h"
#include "cli/curate/curate_arguments.h"
#include "dataset/dataset.h"
#include "trainer/curate/modifier_types.h"
#include "trainer/curate/pose_database.h"

namespace bodyopt::cli {

// Counts, by take, the frames of a database that a modifier's selections name.
struct TakenFrames {
  std::vector<std::pair<std::string, std::size_t>> by_take;  // those of which it takes any
  std::size_t taken = 0, all = 0;
};

TakenFrames taken_frames(const trainer::PoseDatabase& database, const Modifier& modifier);
Json to_json(const TakenFrames& frames);
// "drops 127 of 161 frames (rom 120, walk 7)"; "would drop" where it is switched off.
std::string text_of(const TakenFrames& frames, const trainer::ModifierType& type, bool enabled);

// A frame of the database.
Json frame_json(const trainer::PoseDatabase& database, std::size_t n);

// The stack for programs and for people.
struct StackReport {
  Json list;
  std::string text;
};

StackReport report_stack(const Dataset& dataset, const std::optional<trainer::PoseDatabase>& database);

// The stack as it is now: what every edit ends with. `database`: none where it cannot be read.
void emit_stack(const CurateArguments& arguments, const Dataset& dataset,
                const std::optional<trainer::PoseDatabase>& database);
// Writes the stack after an edit that needed no database.
void emit_stack(const CurateArguments& arguments);

// Two shapes of a skin and how far they are apart.

inline constexpr double kFinestScale = 0.1;  // mm: of less nothing is to be seen

// Draws two shapes in one pose. Colours of the second show its distance from the first (hottest at scale_mm), seen from
// the side where it is largest.
void draw_apart(const Character& character, const Positions& before, const Positions& after, double scale_mm,
                const std::string& path);

}  // namespace bodyopt::cli
