// Every command of the viewport, once: what it is called in scripts and on the command line, its key, its place in the
// menus, its line on the cheat sheet, and what it does.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "proxy_viewer/commands/controls.h"

namespace bodyopt {

struct Command {
  const char* name;      // "play": as typed
  const char* argument;  // "FRAME"; empty: none
  const char* key;       // "Ctrl+Left"; empty: none
  const char* menu;      // "Playback"
  const char* help;      // a line
  void (*run)(Controls& controls, const std::string& argument);
  // What is set: "on", "off", or one of the words of `argument`; null where nothing lasts.
  std::string (*value)(const Controls& controls) = nullptr;
  bool repeats = false;  // while its key is held
};

// The words of an argument "loop|ping-pong|once"; none of any other argument.
std::vector<std::string> choices_of(const Command& command);

constexpr const char* kMenus[] = {"File", "Playback", "Camera", "Look", "Compare", "Pose", "View"};

std::span<const Command> commands();

// Null where there is none.
const Command* find_command(const std::string& name);
const Command* find_command_by_key(const std::string& key);

// Runs "frame 12". Throws Error(usage) that names what is not known (and what is like it), the argument that is wrong,
// or what is missing to do it.
void run_command(Controls& controls, const std::string& text);

// The commands of a script, parted by ';' or line ends; a command that begins with '#' is a remark up to the line's
// end.
std::vector<std::string> script_commands(const std::string& text);

// As the command "marker" does, after a click. Throws Error(usage) where either vertex is marked already.
void add_marker(Controls& controls, const MarkedPair& pair);

}  // namespace bodyopt
