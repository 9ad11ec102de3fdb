// The viewport as a program: what `bodyopt view` runs.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "assets/clips/clip.h"
#include "runtime/host/device_choice.h"

namespace bodyopt::viewport {

struct ViewerOptions {
  // Bases or characters, each followed by its clip and point cache; by what they hold. None: the built-in arm.
  std::vector<std::string> files;
  ClipOptions clip;                         // its unit: of characters that are no basis, too
  std::optional<int> first, last, current;  // frames
  std::string truth;                        // of the first character: a point cache
  std::string proxy;                        // of the first basis: its coarser levels of detail
  std::string character;                    // of the first basis: for linear blending
  std::string limits;                       // of the first character's joints
  std::string muscles;                      // of the first character: for its section
  std::string joint_map, up;                // of the first character's clips
  std::string state;                        // cameras and settings to begin with
  std::string commands;                     // a script, run once all is loaded
  std::optional<std::uint16_t> live_port;   // of a pose stream
  std::uint32_t width = 1280, height = 720;
  bool vsync = true;
  bool headless = false;
  std::string out;          // headless: a picture, or a sequence of all frames of the range where it has ####
  std::string user_folder;  // folder of what outlives it, see Autosave and RecentFiles; empty: nothing does
  double seconds = 0;       // close after so long; 0: when the user does
  DeviceChoice device;      // of a Vulkan device; with validation every message is an error
};

// Returns when the window is closed, or the pictures are written. What fails while it is open is said in the window and
// on the terminal. Throws Error when it cannot begin, Error(device) when the device fails, Error(interrupted) after
// SIGINT or SIGTERM, and, headless, for whatever fails.
void run_viewer(const ViewerOptions& options);

}  // namespace bodyopt::viewport
