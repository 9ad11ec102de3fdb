// Every command of the viewport, once. It has a name for scripts and the command line, a key, a place in the menus,
// help on the cheat sheet, and an action.
#pragma once

#include <array>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

#include "runtime/core/error.h"
#include "viewport/commands/controls.h"

namespace bodyopt::viewport {

// The tables of commands, and their parts: arguments as text, and help. Readers of text throw Error(usage) that names
// what was expected.

// The parts of the controls, each of its own type, and all of them.
auto parts_of(auto& c) {
  auto& s = c.settings;
  return std::tie(c, c.playback, c.camera, c.requests, c.curating, c.brush, c.marking, s, s.look, s.compare, s.pose,
                  s.jiggle, s.ghosts, s.cast, s.hud);
}

// A command's action: a function without a capture, of the part of the controls that it changes and the argument.
class CommandAction {
 public:
  template <typename Function>
  constexpr CommandAction(Function) : run_([](Controls& c, const std::string& a) { run(+Function{}, c, a); }) {}

  void operator()(Controls& controls, const std::string& argument) const { run_(controls, argument); }

 private:
  template <typename Part>
  static void run(void (*function)(Part&, const std::string&), Controls& controls, const std::string& argument) {
    function(std::get<Part&>(parts_of(controls)), argument);
  }

  void (*run_)(Controls& controls, const std::string& argument);
};

struct Command {
  const char* name;      // "play": as typed
  const char* argument;  // "FRAME"; empty: none
  const char* key;       // "Ctrl+Left"; empty: none. In the keymap bodyopt, see key_of()
  const char* menu;      // "Playback"
  const char* help;      // a line
  CommandAction run;
  // Returns the setting: "on", "off", or one of the words of `argument`; null where nothing lasts.
  std::string (*value)(const Controls& controls) = nullptr;
  bool repeats = false;  // while its key is held
};

// The words of an argument "loop|ping-pong|once"; none of any other argument.
std::vector<std::string> choices_of(const Command& command);

// The key of a command as a program's users know it: its own, or that of the table of changes; empty: none.
const char* key_of(const Command& command, Keymap keymap);

constexpr const char* kMenus[] = {"File", "Playback", "Camera", "Look",   "Compare",
                                  "Pose", "Keys",     "Cast",   "Curate", "View"};

std::span<const Command> commands();

// Null where there is none.
const Command* find_command(const std::string& name);
const Command* find_command_by_key(const std::string& key, Keymap keymap = Keymap::bodyopt);

// Runs "frame 12". Throws Error(usage) that names what is not known (and what is like it), the argument that is wrong,
// or what is missing to do it.
void run_command(Controls& controls, const std::string& text);

// The commands of a script, parted by ';' or line ends; a command that begins with '#' is a remark.
std::vector<std::string> script_commands(const std::string& text);

// Adds a marker as the command "marker" does, after a click. Throws Error(usage) where either vertex is marked already.
void add_marker(Controls& controls, const MarkedPair& pair);

inline constexpr const char* kBlank = " \t\r";

[[noreturn]] void refuse(const std::string& argument, const std::string& expected);
// Requires one of the endings, as ".glb|.bvh". Throws as refuse().
void require_ending(const std::string& file, const std::string& endings);

// Throws Error(usage) for a name that is none of these.
const std::string& known(const std::string& name, const std::vector<std::string>& names, const char* what);

double number(const std::string& text);

double number_within(const std::string& text, double low, double high);

int integer(const std::string& text);

int integer_within(const std::string& text, int low, int high);

std::vector<std::string> words(const std::string& text);

std::vector<std::string> words(const std::string& text, std::size_t count, const std::string& expected);

// Reads one of the names, which are in the order of the enumeration.
template <typename Choice, std::size_t N>
void choose(Choice& choice, const std::string& text, const std::array<const char*, N>& names) {
  std::string expected = "one of";
  for (std::size_t k = 0; k < N; ++k) {
    if (text == names[k]) {
      choice = static_cast<Choice>(k);
      return;
    }
    expected += std::string(" ") + names[k];
  }
  refuse(text, expected);
}

template <typename Choice, std::size_t N>
std::string name_of(Choice choice, const std::array<const char*, N>& names) {
  return names[static_cast<std::size_t>(choice)];
}

template <typename Choice, std::size_t N>
void choose_next(Choice& choice, const std::array<const char*, N>&) {
  choice = static_cast<Choice>((static_cast<std::size_t>(choice) + 1) % N);
}

inline constexpr std::array kSwitchNames{"off", "on"};

std::string name_of(bool on);

// Reads "on" or "off"; an empty argument switches the value.
void toggle(bool& value, const std::string& argument);

// Splits off the word after the last blank.
std::pair<std::string, std::string> split_last(const std::string& text, const std::string& expected);

// "auto", or what number_within() or integer_within() read.
template <typename Number>
std::optional<Number> automatic_or(const std::string& text, std::type_identity_t<Number> low,
                                   std::type_identity_t<Number> high,
                                   Number (*within)(const std::string&, Number, Number)) {
  return text == "auto" ? std::nullopt : std::optional(within(text, low, high));
}

// Returns the key of the frame that is shown. Throws Error(usage) where it has none: "frame 12 has no key", `of` what.
template <typename Key>
Key& require_key(const Controls& controls, std::map<int, Key>& keys, const char* of = "") {
  const auto key = keys.find(controls.playback.frame());
  if (key != keys.end()) return key->second;
  throw Error(ErrorKind::usage, "frame ", controls.playback.frame(), " has no key", of);
}

// Moves a key as "FROM TO" says; a key at the other frame is replaced. False: it is there already.
template <typename Key>
bool move_key(const Controls& controls, std::map<int, Key>& keys, const std::string& frames) {
  const auto w = words(frames, 2, "two frames");
  const int from = integer(w[0]), to = integer(w[1]);
  controls.playback.require_frame(to);
  const auto key = keys.find(from);
  if (key == keys.end()) refuse(w[0], "a frame that has a key");
  if (from == to) return false;
  keys[to] = key->second;
  keys.erase(key);
  return true;
}

// The commands of each kind, in the order of menus and cheat sheet; commands() has all of them, in this order.
std::span<const Command> playback_commands();
std::span<const Command> camera_commands();
std::span<const Command> look_commands();
std::span<const Command> compare_commands();
std::span<const Command> pose_commands();
std::span<const Command> cast_commands();
std::span<const Command> file_commands();

// Marks a command that goes on while its key is held.
inline constexpr bool kRepeats = true;

template <typename Value, typename Part>
auto& value_at(auto& controls, Value Part::*member) {
  using Found = std::conditional_t<std::is_const_v<std::remove_reference_t<decltype(controls)>>, const Part, Part>;
  return std::get<Found&>(parts_of(controls)).*member;
}

template <auto member>
constexpr Command switch_command(const char* name, const char* key, const char* menu, const char* help) {
  constexpr auto run = [](Controls& c, const std::string& a) { toggle(value_at(c, member), a); };
  return {name, "[on|off]", key, menu, help, run, [](const Controls& c) { return name_of(value_at(c, member)); }};
}

// Makes a command that chooses one of the names; `argument` has them, too.
template <const auto& names, auto member>
constexpr Command choice_command(const char* name, const char* argument, const char* menu, const char* help) {
  constexpr auto run = [](Controls& c, const std::string& a) { choose(value_at(c, member), a, names); };
  return {name, argument, "", menu, help, run, [](const Controls& c) { return name_of(value_at(c, member), names); }};
}

// Makes a command that the application fulfils once a picture is drawn.
template <bool Requests::*asked>
constexpr Command request_command(const char* name, const char* key, const char* menu, const char* help) {
  return {name, "", key, menu, help, [](Requests& requests, const std::string&) { requests.*asked = true; }};
}

}  // namespace bodyopt::viewport
