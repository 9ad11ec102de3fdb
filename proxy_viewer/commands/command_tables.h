// The commands of each kind, in the order of menus and cheat sheet; commands() has all of them, in this order.
#pragma once

#include <span>

#include "proxy_viewer/commands/commands.h"

namespace bodyopt {

std::span<const Command> playback_commands();
std::span<const Command> camera_commands();
std::span<const Command> look_commands();
std::span<const Command> compare_commands();
std::span<const Command> pose_commands();
std::span<const Command> cast_commands();
std::span<const Command> file_commands();

// Of a command that goes on while its key is held.
inline constexpr bool kRepeats = true;

}  // namespace bodyopt
