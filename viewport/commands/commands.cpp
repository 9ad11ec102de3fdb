#include "viewport/commands/commands.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <sstream>

#include "base/wording.h"
#include "runtime/core/error.h"

namespace bodyopt::viewport {
namespace {

template <typename Number>
Number parsed(const std::string& text, const char* what) {
  Number value = 0;
  const auto [end, problem] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (problem != std::errc{} || end != text.data() + text.size() || !std::isfinite(value)) refuse(text, what);
  return value;
}

template <typename Number>
Number require_within(Number value, const std::string& text, const char* what, Number low, Number high) {
  if (low <= value && value <= high) return value;
  std::ostringstream expected;
  expected << what << " from " << low << " to " << high;
  refuse(text, expected.str());
}

}  // namespace

[[noreturn]] void refuse(const std::string& argument, const std::string& expected) {
  throw Error(ErrorKind::usage, "'" + argument + "' is not " + expected);
}

void require_ending(const std::string& file, const std::string& endings) {
  const std::string wanted = missing_ending(file, endings);
  if (!wanted.empty()) refuse(file, "a file that ends in " + wanted);
}

const std::string& known(const std::string& name, const std::vector<std::string>& names, const char* what) {
  if (names.empty()) refuse(name, std::string("a ") + what + ": there is none");
  if (std::ranges::find(names, name) != names.end()) return name;
  refuse(name, std::string("a ") + what + "; the nearest is '" + nearest_names(names, name).front() + "'");
}

double number(const std::string& text) { return parsed<double>(text, "a number"); }

double number_within(const std::string& text, double low, double high) {
  return require_within(number(text), text, "a number", low, high);
}

int integer(const std::string& text) { return parsed<int>(text, "a whole number"); }

int integer_within(const std::string& text, int low, int high) {
  return require_within(integer(text), text, "a whole number", low, high);
}

std::vector<std::string> words(const std::string& text) {
  std::istringstream stream(text);
  std::vector<std::string> all;
  for (std::string word; stream >> word;) all.push_back(word);
  return all;
}

std::vector<std::string> words(const std::string& text, std::size_t count, const std::string& expected) {
  const std::vector<std::string> all = words(text);
  if (all.size() != count) refuse(text, expected);
  return all;
}

std::string name_of(bool on) { return name_of(on, kSwitchNames); }

void toggle(bool& value, const std::string& argument) {
  if (argument.empty()) {
    value = !value;
  } else {
    choose(value, argument, kSwitchNames);
  }
}

std::pair<std::string, std::string> split_last(const std::string& text, const std::string& expected) {
  const std::size_t blank = text.find_last_of(kBlank);
  const std::size_t end = blank == std::string::npos ? blank : text.find_last_not_of(kBlank, blank);
  if (end == std::string::npos) refuse(text, expected);
  return {text.substr(0, end + 1), text.substr(blank + 1)};
}

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

const Command* find_command_by_key(const std::string& key, Keymap keymap) {
  if (key.empty()) return nullptr;
  const auto found = std::ranges::find_if(commands(), [&](const Command& c) { return key == key_of(c, keymap); });
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
  controls.poses.note(controls.settings, controls.playback.frame());  // what sliders made of it
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

}  // namespace bodyopt::viewport
