// The sections of the side panel, and which are open: kept with the settings, by name.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "proxy_viewer/state/view_settings.h"

namespace bodyopt {

struct Section {
  const char* name;   // "look": in settings and commands
  const char* title;  // "Look"
  bool open;          // to begin with
};

constexpr std::array<Section, 13> kSections = {{{"look", "Look", true},
                                                {"cameras", "Cameras", false},
                                                {"compare", "Compare", true},
                                                {"curate", "Curate", true},
                                                {"pose", "Pose", true},
                                                {"keys", "Keys", false},
                                                {"modifiers", "Modifiers", false},
                                                {"muscles", "Muscles", false},
                                                {"jiggle", "Jiggle", false},
                                                {"ghosts", "Ghosts", false},
                                                {"cast", "Cast", false},
                                                {"transfer", "Transfer", false},
                                                {"output", "Output", false}}};
constexpr const char* kSidePanel = "side";  // all of them

inline std::vector<std::string> section_names() {
  std::vector<std::string> names;
  for (const Section& section : kSections) names.emplace_back(section.name);
  return names;
}

inline bool is_open(const ViewSettings& settings, const Section& section) {
  const auto found = settings.hud.panels.find(section.name);
  return found == settings.hud.panels.end() ? section.open : found->second;
}

inline bool shows_side_panel(const ViewSettings& settings) {
  const auto found = settings.hud.panels.find(kSidePanel);
  return found == settings.hud.panels.end() || found->second;
}

// Closes the others.
inline void open_section(ViewSettings& settings, const std::string& name) {
  settings.hud.panels[kSidePanel] = true;
  for (const Section& section : kSections) settings.hud.panels[section.name] = section.name == name;
}

}  // namespace bodyopt
