// Who is in the scene.
#include <filesystem>

#include "proxy_viewer/panels.h"
#include "proxy_viewer/panels/widgets.h"
#include "proxy_viewer/setting_limits.h"

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

}  // namespace

void draw_cast(const Snapshot& snapshot, Controls& controls) {
  for (const CharacterRow& row : snapshot.cast) {
    ImGui::TextUnformatted(row.name.c_str());
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", row.basis.c_str());
    draw_line("shown", row.method);
    draw_line("vertices", with_commas(row.vertices));
    draw_line("triangles", with_commas(row.triangles));
    if (row.tets > 0) draw_line("tetrahedra", with_commas(row.tets));
    char size[32];
    std::snprintf(size, sizeof(size), "%.1f MiB", static_cast<double>(row.bytes) / (1 << 20));
    draw_line("tables", size);
    draw_line("clip", row.clip.empty() ? "bind pose" : row.clip);
    if (!row.truth.empty()) draw_line("truth", std::filesystem::path(row.truth).filename().string());
    ImGui::Separator();
  }
  ViewSettings::Cast& cast = controls.settings.cast;
  slide("Copies", cast.copies, 1, kMostCopies, "%d", find_command("copies")->help);
  slide("Delay", cast.delay, 0, 48, cast.delay == 1 ? "%d frame" : "%d frames", find_command("copy-delay")->help);
  ImGui::TextDisabled("drop files onto the window to add them");
}

}  // namespace bodyopt
