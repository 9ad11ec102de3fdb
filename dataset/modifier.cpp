#include "dataset/modifier.h"

#include <algorithm>
#include <set>

#include "base/json_file.h"
#include "runtime/core/error.h"
#include "runtime/core/transformed.h"

namespace bodyopt {
namespace {

namespace fs = std::filesystem;

constexpr const char* kHistorySchema = "bodyopt-modifier-history-1";
constexpr std::size_t kMostStates = 200;  // edits that can be undone

// Stacks in the order in which they came to be.
struct StackHistory {
  std::vector<std::vector<Modifier>> states;
  std::size_t now = 0;
};

fs::path history_path(const Dataset& dataset) { return dataset.folder / "modifiers" / "history.json"; }

// Finds the dataset in its history. A process that was killed wrote the history alone: dataset.json is then a step
// before or behind. A stack that is none of these was edited by hand or merged, and begins a new history.
void find_place(StackHistory& history, const std::vector<Modifier>& modifiers) {
  const auto is_at = [&](std::size_t k) { return k < history.states.size() && history.states[k] == modifiers; };
  if (is_at(history.now)) return;
  if (history.now > 0 && is_at(history.now - 1)) {
    --history.now;
  } else if (is_at(history.now + 1)) {
    ++history.now;
  } else {
    history.states.push_back(modifiers);
    history.now = history.states.size() - 1;
  }
}

StackHistory read_history(const Dataset& dataset) {
  StackHistory history;
  const fs::path path = history_path(dataset);
  if (fs::exists(path)) {
    const JsonFile top(path, kHistorySchema, "the history", {"schema", "now", "states"});
    history.now = static_cast<std::size_t>(top.integer("now", 0));
    for (const Json& state : top.array("states")) history.states.push_back(read_modifiers(state, path));
  }
  find_place(history, dataset.modifiers);
  return history;
}

void write_history(StackHistory& history, const Dataset& dataset) {
  if (history.states.size() > kMostStates) {
    history.states.erase(history.states.begin(), history.states.end() - kMostStates);
    history.now = std::min(history.now, kMostStates - 1);
  }
  const Json states = transformed(history.states, [&](const std::vector<Modifier>& state) { return to_json(state); });
  fs::create_directories(history_path(dataset).parent_path());
  write_json({{"schema", kHistorySchema}, {"now", history.now}, {"states", states}}, history_path(dataset));
}

// The history first: what it holds too much is undone by the next that reads it.
Dataset write_both(Dataset dataset, StackHistory& history, const fs::path& path) {
  dataset.modifiers = history.states[history.now];
  write_history(history, dataset);
  write_dataset(dataset, path);
  return dataset;
}

Dataset step(const fs::path& path, bool back, std::chrono::milliseconds patience) {
  const FileLock lock = lock_to_change(path, patience);
  const Dataset dataset = read_dataset(path);
  StackHistory history = read_history(dataset);
  if (back ? history.now == 0 : history.now + 1 == history.states.size()) {
    throw Error(ErrorKind::usage, path,
                back ? ": there is no edit of the modifiers left to undo"
                     : ": there is no undone edit of the modifiers to redo");
  }
  history.now += back ? std::size_t(-1) : 1;
  return write_both(dataset, history, path);
}

}  // namespace

const Modifier* find_modifier(const std::vector<Modifier>& modifiers, const std::string& name) {
  const auto found = std::ranges::find(modifiers, name, &Modifier::name);
  return found == modifiers.end() ? nullptr : &*found;
}

Modifier read_modifier(const Json& json, const std::filesystem::path& path, const std::string& place) {
  const JsonObject object(json, path, place);
  Modifier modifier;
  modifier.name = object.name("name");
  modifier.type = object.name("type");
  if (object.has("enabled")) modifier.enabled = object.boolean("enabled");
  if (object.has("strength")) modifier.strength = object.number("strength", 0, 1);
  if (object.has("frames")) modifier.frames = object.array("frames");
  for (const auto& [key, value] : json.items()) {
    if (key == "mask" || key == "parameters") {
      if (!value.is_object()) object.refuse("'", key, "' is not an object");
      (key == "mask" ? modifier.mask : modifier.parameters) = value;
    } else if (key != "name" && key != "type" && key != "enabled" && key != "strength" && key != "frames") {
      modifier.newer[key] = value;
    }
  }
  return modifier;
}

Json to_json(const Modifier& modifier) {
  Json json = {
      {"name", modifier.name}, {"type", modifier.type}, {"enabled", modifier.enabled}, {"strength", modifier.strength}};
  if (!modifier.frames.empty()) json["frames"] = modifier.frames;
  if (!modifier.mask.empty()) json["mask"] = modifier.mask;
  if (!modifier.parameters.empty()) json["parameters"] = modifier.parameters;
  json.update(modifier.newer);
  return json;
}

std::vector<Modifier> read_modifiers(const Json& list, const std::filesystem::path& path) {
  std::vector<Modifier> modifiers;
  std::set<std::string> names;
  for (std::size_t k = 0; k < list.size(); ++k) {
    const std::string place = "modifiers[" + std::to_string(k) + "]";
    modifiers.push_back(read_modifier(list[k], path, place));
    if (!names.insert(modifiers.back().name).second) {
      JsonObject(list[k], path, place).refuse("has the name of an earlier modifier: merged by hand?");
    }
  }
  return modifiers;
}

Json to_json(const std::vector<Modifier>& modifiers) {
  return transformed(modifiers, [&](const Modifier& modifier) { return to_json(modifier); });
}

Dataset edit_modifiers(const fs::path& path, const std::function<void(const Dataset&, std::vector<Modifier>&)>& edit,
                       std::chrono::milliseconds patience) {
  const FileLock lock = lock_to_change(path, patience);
  Dataset dataset = read_dataset(path);
  std::vector<Modifier> modifiers = dataset.modifiers;
  edit(dataset, modifiers);
  if (modifiers == dataset.modifiers) return dataset;
  StackHistory history = read_history(dataset);
  history.states.resize(history.now + 1);
  history.states.push_back(std::move(modifiers));
  ++history.now;
  return write_both(dataset, history, path);
}

bool is_edited(const Dataset& dataset) { return !dataset.modifiers.empty() || fs::exists(history_path(dataset)); }

void look_at_stacks(const fs::path& path, bool forget,
                    const std::function<void(const Dataset&, const std::vector<std::vector<Modifier>>&)>& look) {
  const FileLock lock = lock_to_change(path);
  const Dataset dataset = read_dataset(path);
  StackHistory history = read_history(dataset);
  if (forget) {
    history = {{dataset.modifiers}, 0};
    write_history(history, dataset);
  }
  look(dataset, history.states);
}

Dataset undo_modifiers(const fs::path& path, std::chrono::milliseconds patience) { return step(path, true, patience); }
Dataset redo_modifiers(const fs::path& path, std::chrono::milliseconds patience) { return step(path, false, patience); }

}  // namespace bodyopt
