// One entry of the stack of modifiers that a dataset's shapes are read through, as dataset.json has it.
#pragma once

#include <chrono>
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "dataset/dataset.h"
#include "runtime/core/atomic_file.h"
#include "runtime/core/json.h"

namespace bodyopt {

// Frames, mask and parameters stay as they are written: the code that knows the type checks them. Keys that a newer
// version wrote are kept.
struct Modifier {
  std::string name{};  // of the stack's entry, once in it
  std::string type{};  // "sculpt", "smooth" ...
  bool enabled = true;
  double strength = 1;
  Json frames = Json::array();       // selections, their union; empty: all frames
  Json mask = Json::object();        // joints, muscles, regions; empty: the whole skin
  Json parameters = Json::object();  // of the type
  Json newer = Json::object();       // keys that this version does not know

  bool operator==(const Modifier&) const = default;
};

// The one of a name; null where there is none.
const Modifier* find_modifier(const std::vector<Modifier>& modifiers, const std::string& name);

// Frames by a name, for modifiers to choose by.
struct NamedSelection {
  std::string name;
  Json frames;

  bool operator==(const NamedSelection&) const = default;
};

// `path` and `place` are for messages. Throws Error(file).
Modifier read_modifier(const Json& json, const std::filesystem::path& path, const std::string& place);
Json to_json(const Modifier& modifier);

// A stack, first to last. Throws Error(file), also where two have one name.
std::vector<Modifier> read_modifiers(const Json& list, const std::filesystem::path& path);
Json to_json(const std::vector<Modifier>& modifiers);

// modifiers/history.json: the stacks that a dataset had, for undo and redo.

// `path`: the dataset.json. All of these hold its lock and rename dataset.json into place last. If killed at any
// moment, they leave the old or the new one, and the history fits either. Each returns the dataset as it is then.

// Replaces the stack by what `edit` makes of it; what `edit` throws leaves all as it was. `patience`: with others.
Dataset edit_modifiers(const std::filesystem::path& path,
                       const std::function<void(const Dataset& dataset, std::vector<Modifier>& modifiers)>& edit,
                       std::chrono::milliseconds patience = kPatienceForChanges);
// Back to the stack before the last edit, and forth again. Throws Error(usage) where there is none.
Dataset undo_modifiers(const std::filesystem::path& path, std::chrono::milliseconds patience = kPatienceForChanges);
Dataset redo_modifiers(const std::filesystem::path& path, std::chrono::milliseconds patience = kPatienceForChanges);

// Whether it has modifiers, or had some.
bool is_edited(const Dataset& dataset);

// Calls `look` with the dataset and all stacks that undo and redo lead to, its own among them, while nobody edits.
// `forget`: the others are given up first.
void look_at_stacks(
    const std::filesystem::path& path, bool forget,
    const std::function<void(const Dataset& dataset, const std::vector<std::vector<Modifier>>& stacks)>& look);

}  // namespace bodyopt
