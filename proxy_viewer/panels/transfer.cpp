// How the lead and the second of the cast match, part by part: where a transfer from the one to the other may be
// trusted.
#include <algorithm>

#include "proxy_viewer/panels/panels.h"
#include "proxy_viewer/panels/widgets.h"

namespace bodyopt {
namespace {

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

void draw_transfer(const Snapshot& snapshot, Controls& controls) {
  command_choice(controls, "match", "Show");
  if (!snapshot.match) {
    ImGui::TextDisabled("colours or confidence: they are matched then");
    return;
  }
  const MatchRow& match = *snapshot.match;
  ImGui::TextDisabled("1 to 2: sure by %.2f, size %.3g", match.confidence, match.size);
  if (match.same_topology) ImGui::TextDisabled("the same triangles");
  if (match.volumes) {
    ImGui::TextDisabled("volume: 1 %+.1f %%, 2 %+.1f %%", 100 * (match.volumes->front() - 1),
                        100 * (match.volumes->back() - 1));
  }
  if (!match.to_simulate.empty()) {
    ImGui::TextDisabled("worth simulating of 2:");
    ImGui::TextWrapped("%s", match.to_simulate.c_str());
  }
  draw_parts(match.parts, controls);
}

}  // namespace bodyopt
