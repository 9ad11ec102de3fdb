// Edits of a dataset's stack of modifiers, each of them whole or not at all, and one step of undo.
#pragma once

#include <chrono>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "assets/caches/shape_reader.h"
#include "dataset/dataset.h"
#include "dataset/modifier.h"
#include "runtime/core/atomic_file.h"
#include "trainer/curate/exported_frames.h"
#include "trainer/curate/pose_database.h"
#include "trainer/curate/shape_stack.h"

namespace bodyopt::trainer {

// `path`: the dataset.json. Each throws Error(usage) where no modifier has the name (with the names nearest to it), and
// what check_modifier() says; nothing is changed then. `patience`: with others that edit.

// Changes to a modifier; what is not set stays.
struct ModifierChange {
  std::optional<std::string> name{};
  std::optional<double> strength{};
  std::optional<Json> frames{}, mask{};
  Json parameters = Json::object();  // those named are replaced, null takes one away
};

// Puts a modifier on top of the stack. An empty name becomes its type's, with a number where that is taken. Returns the
// database that it was checked against, with the stack as it is then.
PoseDatabase add_modifier(const std::filesystem::path& path, Modifier modifier);
// Returns the same.
PoseDatabase change_modifier(const std::filesystem::path& path, const std::string& name, const ModifierChange& change,
                             std::chrono::milliseconds patience = kPatienceForChanges);
// Moves it to a place from 1 on.
void move_modifier(const std::filesystem::path& path, const std::string& name, std::size_t place);
void enable_modifier(const std::filesystem::path& path, const std::string& name, bool enabled,
                     std::chrono::milliseconds patience = kPatienceForChanges);
void remove_modifier(const std::filesystem::path& path, const std::string& name);

// Throws Error(usage) at an unknown type; Error(mismatch) or Error(file), naming the modifier, where it does not fit
// the dataset. That is an unknown parameter, take, frame, joint, muscle or region, an empty selection, a mesh of
// another topology, a number that is not finite.
void check_modifier(const PoseDatabase& database, const Modifier& modifier);

// Puts shapes in the place of frames of a take, by a modifier of the type blend. It goes right above the blends that
// begin the stack, so that what was done to the frames is done to the shapes. `samples`: of `shapes`, that of every
// frame. Its cache is named by what is in it. Throws Error(file).
void put_shapes_over(const std::filesystem::path& path, const std::string& take, const std::vector<int>& frames,
                     const ShapeReader& shapes, const std::vector<std::uint32_t>& samples);

// Does so with shapes (O x 3, posed, metres) that are asked for one after the other; replaces the modifier `name`.
void put_shapes_over(const std::filesystem::path& path, const std::string& name, const std::string& take,
                     const std::vector<int>& frames, const std::function<std::vector<float>(std::size_t)>& shape);

// Throws Error(usage) where the modifier `name` of a stack is there and is no sculpt.
void require_sculpt(const std::vector<Modifier>& modifiers, const std::string& name);

// Makes the difference of two skins of a frame (V x 3, un-posed, metres) its sculpt in the modifier `name` of a stack
// being edited. The modifier is made where there is none. Returns what the artist should know: as add_sculpt(). Throws
// Error(mismatch) at a number that is not finite, Error(usage) where the modifier is no sculpt.
std::vector<std::string> put_sculpt(const PoseDatabase& database, std::vector<Modifier>& modifiers,
                                    const std::string& name, std::size_t frame, const Positions& before,
                                    const Positions& after, double spread_degrees);

// `mesh`: an artist's mesh of a frame, O x 3, output vertices, metres, posed or, where `unposed`, as export wrote it
// un-posed. Its difference from the exported frame is added to the sculpt that the modifier `name` had then, and
// becomes its sculpt. What else the stack has by now stays. The modifier is made where there is none. Returns what the
// artist should know: vertices that moved by more than a fifth of the character's size, or whose normals turned over.
// It also says where the mesh is the frame as exported, which changes nothing. Throws Error(mismatch) where the mesh
// does not fit.
std::vector<std::string> add_sculpt(const std::filesystem::path& path, const std::string& name, const std::string& take,
                                    int frame, const ExportedFrame& exported, const std::vector<float>& mesh,
                                    bool unposed, double spread_degrees);

// Effects of the stack on a dataset: measured, and written as another one.

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

// Writes a dataset of the same clips whose caches are the shapes through the stack, and that has no modifiers. Frames
// that are dropped or did not converge are left out. Mirror images get clips of their own. dataset.json is written
// last. Throws Error(usage) where `folder` has a dataset already or mirror images have controls, Error(file).
Dataset bake_dataset(const ShapeStack& stack, const std::filesystem::path& folder);

}  // namespace bodyopt::trainer
