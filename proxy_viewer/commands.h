// Every command of the viewport, once: what it is called in scripts and on the command line, its key, its place in the
// menus, its line on the cheat sheet, and what it does.
#pragma once

#include <span>
#include <string>

#include "proxy_viewer/controls.h"

namespace bodyopt {

struct Command {
  const char* name;      // "play": as typed
  const char* argument;  // "FRAME"; empty: none
  const char* key;       // "Ctrl+Left"; empty: none
  const char* menu;      // "Playback"; empty: only typed
  const char* help;      // a line
  void (*run)(Controls& controls, const std::string& argument);
};

std::span<const Command> commands();

// Null where there is none.
const Command* find_command(const std::string& name);
const Command* find_command_by_key(const std::string& key);

// Runs "frame 12", or several, parted by ';' or line ends; '#' begins a remark. Throws Error(usage) that names what is
// not known (and what is like it), or the argument that is wrong; those before it have run.
void run_commands(Controls& controls, const std::string& text);

}  // namespace bodyopt
