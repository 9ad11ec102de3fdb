// What the colours of a heat map mean, and of distances the largest of the frame.
#include <algorithm>
#include <cmath>
#include <optional>

#include "draw/colours.h"
#include "proxy_viewer/panels/panels.h"
#include "proxy_viewer/panels/widgets.h"
#include "runtime/core/formatted.h"

namespace bodyopt {
namespace {

constexpr float kBarWidth = 14, kBarHeight = 176, kBarMargin = 16, kBarPadding = 8;
constexpr ImU32 kBehind = IM_COL32(20, 20, 22, 150);  // text over a bright character
constexpr int kLabels = 5, kSteps = 44;

struct Heat {
  const char* title;
  double most;     // of the frame that is shown, mm; not a number where it was not measured
  double hottest;  // at the top of the bar
};

// That colours the lead: none, or the first of several.
std::optional<Heat> heat_of(const Snapshot& snapshot, const Controls& controls) {
  const ViewSettings::Compare& compare = controls.settings.compare;
  if (snapshot.match) {
    if (compare.match == MatchView::colours) return std::nullopt;  // which are no heat
    return Heat{"unsure (0: the same)", NAN, 1};
  }
  if (compare.coverage && snapshot.knows_coverage) {
    return Heat{"expected error, mm", snapshot.most_expected_mm.value_or(NAN), controls.heat_mm()};
  }
  if (snapshot.compared.empty() || !(compare.heat || compare.activation)) return std::nullopt;
  const auto index = static_cast<std::size_t>(controls.playback.frame() - snapshot.first_frame);
  const ErrorRow error = index < snapshot.errors.size() ? snapshot.errors[index] : ErrorRow{};
  return Heat{compare.activation ? "learned, mm" : "distance, mm", static_cast<double>(error.max), controls.heat_mm()};
}

// Three digits, or as many as it has before the point.
std::string millimetres(double value) { return formatted(std::abs(value) < 100 ? "%.3g" : "%.0f", value); }

// Ends at `right`; its middle is at y.
void draw_text(ImDrawList& list, float right, float y, ImU32 colour, const std::string& text) {
  const ImVec2 size = ImGui::CalcTextSize(text.c_str());
  list.AddText({right - size.x, y - 0.5f * size.y}, colour, text.c_str());
}

std::string describe_largest(const Heat& heat) {
  return std::isfinite(heat.most) ? "largest " + millimetres(heat.most) + " mm" : "";
}

float widest_text(const Heat& heat, const std::string& largest) {
  return std::max(ImGui::CalcTextSize(heat.title).x, ImGui::CalcTextSize(largest.c_str()).x);
}

}  // namespace

float colour_bar_width(const Snapshot& snapshot, const Controls& controls) {
  // Not that of the frame: the camera would be framed again from frame to frame.
  static const std::string kUsualLargest = "largest 88.8 mm";
  const std::optional<Heat> heat = heat_of(snapshot, controls);
  return heat && controls.settings.hud.legend ? kBarMargin + widest_text(*heat, kUsualLargest) + kBarPadding : 0;
}

void draw_colour_bar(const Snapshot& snapshot, const Controls& controls, const PanelLayout& layout) {
  const float line = ImGui::GetTextLineHeight();
  if (controls.settings.compare.coverage && !snapshot.knows_coverage) {
    draw_text(*ImGui::GetBackgroundDrawList(), layout.right() - kBarMargin, layout.bottom() - kBarMargin - 0.5f * line,
              kAccent, "no expected error: the basis was trained without shapes");
  }
  const std::optional<Heat> heat = heat_of(snapshot, controls);
  if (!heat) return;
  const float height = std::min(kBarHeight, layout.bottom() - layout.menu - 4 * line - 2 * kBarMargin);
  if (height < 40) return;
  const float right = layout.right() - kBarMargin, bottom = layout.bottom() - kBarMargin - 0.5f * line;
  const float left = right - kBarWidth, top = bottom - height;
  ImDrawList& list = *ImGui::GetBackgroundDrawList();
  const std::string largest = describe_largest(*heat);
  list.AddRectFilled({right - widest_text(*heat, largest) - kBarPadding, top - 3.1f * line},
                     {right + 12, bottom + line}, kBehind, 6);
  for (int k = 0; k < kSteps; ++k) {
    const float low = static_cast<float>(k) / kSteps, high = static_cast<float>(k + 1) / kSteps;
    const ImU32 a = opaque(heat_colour(low)), b = opaque(heat_colour(high));
    list.AddRectFilledMultiColor({left, bottom - high * height}, {right, bottom - low * height}, b, b, a, a);
  }
  for (int k = 0; k < kLabels; ++k) {
    const float share = static_cast<float>(k) / (kLabels - 1);
    draw_text(list, left - 7, bottom - share * height, ImGui::GetColorU32(ImGuiCol_Text),
              millimetres(static_cast<double>(share) * heat->hottest));
  }
  draw_text(list, right, top - 1.3f * line, ImGui::GetColorU32(ImGuiCol_Text), heat->title);
  if (largest.empty()) return;
  const float share = static_cast<float>(std::min(1.0, heat->most / heat->hottest));
  list.AddTriangleFilled({right + 8, bottom - share * height - 4}, {right + 8, bottom - share * height + 4},
                         {right + 1, bottom - share * height}, kAccent);
  draw_text(list, right, top - 2.4f * line, kAccent, largest);
}

}  // namespace bodyopt
