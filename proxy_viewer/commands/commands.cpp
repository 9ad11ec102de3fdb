#include "proxy_viewer/commands/commands.h"

#include <algorithm>
#include <sstream>

#include "assets/wording.h"
#include "proxy_viewer/commands/command_arguments.h"
#include "runtime/core/error.h"

namespace bodyopt {

void add_marker(Controls& controls, const MarkedPair& pair) {
  for (const MarkedPair& there : controls.marking.pairs) {
    if (there.of_lead != pair.of_lead && there.of_second != pair.of_second) continue;
    throw Error(ErrorKind::usage, "vertex " + std::to_string(pair.of_lead) + " of the lead or " +
                                      std::to_string(pair.of_second) + " of the other is marked already");
  }
  controls.marking.pairs.push_back(pair);
}

std::vector<std::string> choices_of(const Command& command) {
  const std::string all = command.argument;
  std::vector<std::string> choices;
  if (all.find('|') == std::string::npos || all.find_first_not_of("abcdefghijklmnopqrstuvwxyz|-") < all.size()) {
    return choices;
  }
  std::istringstream stream(all);
  for (std::string choice; std::getline(stream, choice, '|');) choices.push_back(choice);
  return choices;
}

std::span<const Command> commands() {
  static const std::vector<Command> all = [] {
    std::vector<Command> joined;
    for (const std::span<const Command> some :
         {playback_commands(), camera_commands(), look_commands(), compare_commands(), pose_commands(), cast_commands(),
          file_commands()}) {
      joined.insert(joined.end(), some.begin(), some.end());
    }
    return joined;
  }();
  return all;
}

const Command* find_command(const std::string& name) {
  const auto found = std::ranges::find_if(commands(), [&](const Command& c) { return name == c.name; });
  return found == commands().end() ? nullptr : &*found;
}

const Command* find_command_by_key(const std::string& key) {
  if (key.empty()) return nullptr;
  const auto found = std::ranges::find_if(commands(), [&](const Command& c) { return key == c.key; });
  return found == commands().end() ? nullptr : &*found;
}

void run_command(Controls& controls, const std::string& text) {
  const std::size_t begin = std::min(text.find_first_not_of(kBlank), text.size());
  const std::size_t end = std::min(text.find_first_of(kBlank, begin), text.size());
  const std::string name = text.substr(begin, end - begin);
  const std::size_t argument = text.find_first_not_of(kBlank, end);
  const std::size_t last = text.find_last_not_of(kBlank);
  const Command* command = find_command(name);
  if (!command) {
    std::vector<std::string> names;
    for (const Command& c : commands()) names.emplace_back(c.name);
    throw Error(ErrorKind::usage, "there is no command '" + name + "' in the viewport; the nearest is '" +
                                      nearest_names(names, name).front() + "'");
  }
  const std::string rest = argument == std::string::npos ? "" : text.substr(argument, last - argument + 1);
  if (rest.empty() && *command->argument != 0 && *command->argument != '[') {
    throw Error(ErrorKind::usage, name + ": expected " + command->argument);
  }
  if (!rest.empty() && *command->argument == 0) {
    throw Error(ErrorKind::usage, name + ": takes no argument, found '" + rest + "'");
  }
  // A switch without an argument turns round.
  const bool turns_on = rest.empty() && command->value && command->value(controls) == "off";
  const auto missing = controls.missing.find(name + " " + (turns_on ? "on" : rest));
  if (missing != controls.missing.end()) throw Error(ErrorKind::usage, missing->first + ": " + missing->second);
  controls.poses.note(controls.settings.pose);  // what sliders made of it
  try {
    command->run(controls, rest);
  } catch (const Error& error) {
    throw Error(error.kind(), name + ": " + error.what());
  }
}

std::vector<std::string> script_commands(const std::string& text) {
  std::vector<std::string> found;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t first = text.find_first_not_of(kBlank, begin);
    const bool remark = first != std::string::npos && text[first] == '#';
    const std::size_t end = std::min(text.find_first_of(remark ? "\n" : ";\n", begin), text.size());
    const std::string command = text.substr(begin, end - begin);
    if (!remark && command.find_first_not_of(kBlank) != std::string::npos) found.push_back(command);
    begin = end + 1;
  }
  return found;
}

}  // namespace bodyopt
