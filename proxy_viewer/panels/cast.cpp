// Who is in the scene, and ghosts of the lead.
#include <filesystem>

#include "proxy_viewer/panels/panels.h"
#include "proxy_viewer/panels/widgets.h"
#include "runtime/core/formatted.h"

namespace bodyopt {
namespace {

std::string with_commas(std::uint32_t number) {
  std::string digits = std::to_string(number);
  for (int at = static_cast<int>(digits.size()) - 3; at > 0; at -= 3) digits.insert(static_cast<std::size_t>(at), ",");
  return digits;
}

void draw_line(const char* what, const std::string& text) {
  ImGui::TextDisabled("%s", what);
  ImGui::SameLine(0.42f * ImGui::GetWindowContentRegionMax().x);
  ImGui::TextUnformatted(text.c_str());
  if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", text.c_str());
}

// And what can be done with it.
void draw_name(const CharacterRow& row, int number, std::size_t count, Controls& controls) {
  const std::string text = std::to_string(number);
  ImGui::PushID(number);
  ImGui::AlignTextToFramePadding();
  ImGui::Text("%d  %s", number, row.name.c_str());
  if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", row.basis.c_str());
  const float remove = ImGui::GetFrameHeight(), lead = 44, right = ImGui::GetWindowContentRegionMax().x;
  if (count > 1) {
    ImGui::SameLine(right - remove - lead - ImGui::GetStyle().ItemSpacing.x);
    if (ImGui::Button("Lead", {lead, 0})) attempt(controls, "lead " + text);
    explain("lead");
    ImGui::SameLine(right - remove);
    if (ImGui::Button("\xc3\x97", {remove, remove})) attempt(controls, "remove " + text);
    explain("remove");
  }
  ImGui::PopID();
}

}  // namespace

void draw_cast(const Snapshot& snapshot, Controls& controls) {
  int number = 0;
  for (const CharacterRow& row : snapshot.cast) {
    draw_name(row, ++number, snapshot.cast.size(), controls);
    draw_line("shown", row.method);
    if (row.level_count > 1) {
      draw_line("level", std::to_string(row.level) + " of " + std::to_string(row.level_count - 1));
    }
    draw_line("vertices", with_commas(row.vertices));
    draw_line("triangles", with_commas(row.triangles));
    if (row.tets > 0) draw_line("tetrahedra", with_commas(row.tets));
    draw_line("tables", formatted("%.1f MiB", static_cast<double>(row.bytes) / (1 << 20)));
    draw_line("clip", row.clip.empty() ? "bind pose" : row.clip);
    if (!row.truth.empty()) draw_line("truth", std::filesystem::path(row.truth).filename().string());
    ImGui::Separator();
  }
  ViewSettings::Cast& cast = controls.settings.cast;
  slide("Copies", cast.copies, 1, kMostCopies, "%d", find_command("copies")->help);
  slide("Delay", cast.delay, 0, 48, cast.delay == 1 ? "%d frame" : "%d frames", find_command("copy-delay")->help);
  ImGui::PushTextWrapPos(0);
  ImGui::TextDisabled("drop files onto the window to add them");
  ImGui::PopTextWrapPos();
}

// Frames before and after, see-through.
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
