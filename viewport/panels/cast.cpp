// Panels of the characters in the scene, and of the lead's ghosts.
#include <algorithm>
#include <filesystem>

#include "runtime/core/text.h"
#include "viewport/panels/panels.h"

namespace bodyopt::viewport {
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

// Draws the name with buttons for what can be done with it.
void draw_name(const CharacterRow& row, std::size_t count, Controls& controls) {
  const std::string text = std::to_string(row.number);
  ImGui::PushID(&row);
  ImGui::AlignTextToFramePadding();
  ImGui::Text("%d  %s", row.number, row.name.c_str());
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

// How the lead and the second of the cast match, part by part: where a transfer may be trusted.

constexpr float kMostPartRows = 16;

void draw_number(const char* format, double value) {
  ImGui::TableNextColumn();
  ImGui::Text(format, value);
}

void draw_part(const MatchedPartRow& part, Controls& controls) {
  ImGui::TableNextRow();
  ImGui::TableNextColumn();
  ImGui::PushStyleColor(ImGuiCol_Text, part.is_guess ? kAccent : ImGui::GetColorU32(ImGuiCol_Text));
  if (ImGui::Selectable(part.joint.c_str(), part.joint == controls.joint, ImGuiSelectableFlags_SpanAllColumns)) {
    attempt(controls, "select " + part.joint);
  }
  if (part.is_guess && ImGui::IsItemHovered()) {
    ImGui::SetTooltip("another anatomy: what is carried here is a guess");
  }
  draw_number("%.2f", part.confidence);
  draw_number("%.2f", part.size);
  draw_number("%.0f %%", 100 * part.unevenness);
  ImGui::PopStyleColor();
}

void draw_parts(const std::vector<MatchedPartRow>& parts, Controls& controls) {
  const float height =
      ImGui::GetTextLineHeightWithSpacing() * std::min(kMostPartRows, static_cast<float>(parts.size() + 1));
  constexpr ImGuiTableFlags kFlags = ImGuiTableFlags_ScrollY | ImGuiTableFlags_RowBg | ImGuiTableFlags_SizingFixedFit;
  if (!ImGui::BeginTable("parts", 4, kFlags, {0, height})) return;
  ImGui::TableSetupScrollFreeze(0, 1);
  ImGui::TableSetupColumn("held by", ImGuiTableColumnFlags_WidthStretch);
  for (const char* title : {"sure", "size", "uneven"}) ImGui::TableSetupColumn(title);
  ImGui::TableHeadersRow();
  for (const MatchedPartRow& part : parts) {
    ImGui::PushID(&part);
    draw_part(part, controls);
    ImGui::PopID();
  }
  ImGui::EndTable();
}

}  // namespace

void draw_cast(const Snapshot& snapshot, Controls& controls) {
  for (const CharacterRow& row : snapshot.cast) {
    draw_name(row, snapshot.cast.size(), controls);
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
  shots::ViewSettings::Cast& cast = controls.settings.cast;
  slide("Copies", cast.copies, 1, shots::kMostCopies, "%d", find_command("copies")->help);
  slide("Delay", cast.delay, 0, 48, cast.delay == 1 ? "%d frame" : "%d frames", find_command("copy-delay")->help);
  ImGui::PushTextWrapPos(0);
  ImGui::TextDisabled("drop files onto the window to add them");
  ImGui::PopTextWrapPos();
}

// Frames before and after, see-through.
void draw_ghosts(const Snapshot&, Controls& controls) {
  constexpr int kLongestStep = 48;  // of the slider: it is to be set by hand
  shots::ViewSettings::Ghosts& ghosts = controls.settings.ghosts;
  command_tick(controls, "toggle-ghosts", "On");
  slide("Before", ghosts.before, 0, shots::kMostGhosts, "%d", "ghosts of frames before, in blue");
  slide("After", ghosts.after, 0, shots::kMostGhosts, "%d", "ghosts of frames after, in orange");
  slide("Step", ghosts.step, 1, kLongestStep, ghosts.step == 1 ? "%d frame" : "%d frames",
        find_command("ghost-step")->help);
  slide("Opacity", ghosts.opacity, 0, 1, "%.2f", find_command("ghost-opacity")->help);
  command_tick(controls, "trail", "Trail of the joint");
}

void draw_transfer(const Snapshot& snapshot, Controls& controls) {
  command_choice(controls, "match", "Show");
  if (!snapshot.match) {
    ImGui::TextDisabled("colours or confidence: they are matched then");
    return;
  }
  const MatchRow& match = *snapshot.match;
  const int lead = snapshot.cast.at(0).number, second = snapshot.cast.at(1).number;
  ImGui::TextDisabled("%d to %d: sure by %.2f, size %.3g", lead, second, match.confidence, match.size);
  if (match.same_topology) ImGui::TextDisabled("the same triangles");
  if (match.volumes) {
    ImGui::TextDisabled("volume: %d %+.1f %%, %d %+.1f %%", lead, 100 * (match.volumes->front() - 1), second,
                        100 * (match.volumes->back() - 1));
  }
  if (!match.to_simulate.empty()) {
    ImGui::TextDisabled("worth simulating of %d:", second);
    ImGui::TextWrapped("%s", match.to_simulate.c_str());
  }
  draw_parts(match.parts, controls);
}

}  // namespace bodyopt::viewport
