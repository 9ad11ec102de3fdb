// Frames before and after, see-through.
#include "proxy_viewer/panels/panels.h"
#include "proxy_viewer/panels/widgets.h"
#include "proxy_viewer/state/view_settings.h"

namespace bodyopt {

void draw_ghosts(const Snapshot&, Controls& controls) {
  constexpr int kLongestStep = 48;  // of the slider: it is to be set by hand
  ViewSettings::Ghosts& ghosts = controls.settings.ghosts;
  command_tick(controls, "toggle-ghosts", "On");
  slide("Before", ghosts.before, 0, kMostGhosts, "%d", "ghosts of frames before, in blue");
  slide("After", ghosts.after, 0, kMostGhosts, "%d", "ghosts of frames after, in orange");
  slide("Step", ghosts.step, 1, kLongestStep, ghosts.step == 1 ? "%d frame" : "%d frames",
        find_command("ghost-step")->help);
  slide("Opacity", ghosts.opacity, 0, 1, "%.2f", find_command("ghost-opacity")->help);
}

}  // namespace bodyopt
