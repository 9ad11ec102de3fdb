// How the character looks, and what is shown of its inside.
#include <algorithm>

#include "proxy_viewer/panels/panels.h"
#include "proxy_viewer/panels/widgets.h"

namespace bodyopt {
namespace {

struct Tick {
  const char* command;
  bool available;
};

}  // namespace

void draw_look(const Snapshot& snapshot, Controls& controls) {
  const bool has_tets = !snapshot.cast.empty() && snapshot.cast.front().tets > 0;
  const bool wears = std::ranges::any_of(snapshot.cast, &CharacterRow::wears);
  command_choice(controls, "style", "Style");
  const float half = ImGui::GetCursorPosX() + 0.5f * ImGui::GetContentRegionAvail().x;
  bool left = true;
  for (const Tick& tick : {Tick{"wire", true}, Tick{"skeleton", true}, Tick{"fibres", !snapshot.fibres.empty()},
                           Tick{"tets", has_tets}, Tick{"anatomy", snapshot.has_character}, Tick{"grid", true},
                           Tick{"axes", true}, Tick{"shadow", true}, Tick{"follow", true}, Tick{"worn", wears}}) {
    if (!left) ImGui::SameLine(half);
    left = !left;
    ImGui::BeginDisabled(!tick.available);
    command_tick(controls, tick.command);
    ImGui::EndDisabled();
  }
  if (has_tets && controls.settings.look.tets) {
    slide("Cut", controls.settings.look.tet_cut, 0, 1, "%.2f", find_command("tet-cut")->help);
  }
  if (snapshot.has_character && controls.settings.look.anatomy) {
    command_choice(controls, "anatomy-axis", "Across");
    slide("At", controls.settings.look.anatomy_at, 0, 1, "%.3f", find_command("anatomy-at")->help);
  }
}

}  // namespace bodyopt
