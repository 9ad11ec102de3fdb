// Figures over the picture: rate, times of stages, device, memory, dropped frames, and how far the pose is from those
// that were trained.
#include <imgui.h>

#include <algorithm>
#include <functional>
#include <string>

#include "runtime/core/text.h"
#include "viewport/panels/panels.h"

namespace bodyopt::viewport {
namespace {

constexpr ImU32 kPlain = IM_COL32(190, 190, 194, 255);
constexpr float kHudLeft = 14;

// Takes the figures, a line each.
struct Lines {
  std::function<void(const std::string& text, ImU32 colour)> draw;

  void add(const std::string& text, ImU32 colour = kPlain) const { draw(text, colour); }
  void add(double value, const char* unit, const std::string& what) const {
    add(formatted("%.*f %s  ", value < 100 ? 2 : 0, value, unit) + what);
  }
};

void add_coverage(const Snapshot& snapshot, const Lines& lines) {
  constexpr ImU32 kOutside = IM_COL32(194, 140, 255, 255);
  if (snapshot.outside > 0) {
    lines.add("not trained for: " + snapshot.outside_feature + " (" + snapshot.outside_by + " beyond)", kOutside);
  }
  if (snapshot.expected_mm) lines.add(*snapshot.expected_mm, "mm", "expected error");
}

void add_live(const LiveRow& live, const Lines& lines) {
  constexpr ImU32 kLive = IM_COL32(120, 205, 140, 255);
  lines.add(live.frame ? "live: frame " + std::to_string(*live.frame) : "live: no pose has come", kLive);
  if (live.rejected == 0) return;
  lines.add(std::to_string(live.rejected) + " rejected, the last: " + live.last_rejection, kErrorColour);
}

void add_pins(const Snapshot& snapshot, const Lines& lines) {
  for (const shots::MissedPin& pin : snapshot.missed_pins) lines.add(shots::describe(pin), kErrorColour);
}

void add_times(const Snapshot& snapshot, const Lines& lines) {
  lines.add(snapshot.frame_ms, "ms", "picture");
  lines.add(snapshot.draw_ms, "ms", "draw");
  snapshot.stage_seconds.for_each(
      [&](const StageDescription& stage, double seconds) { lines.add(1e3 * seconds, "ms", stage.name); });
  if (!snapshot.cast.empty()) lines.add("skin: " + snapshot.cast.front().method);
  if (snapshot.level_count > 1) {
    lines.add("level " + std::to_string(snapshot.level) + " of " + std::to_string(snapshot.level_count - 1));
  }
  lines.add(snapshot.memory_mib, "MiB", "memory");
  lines.add(snapshot.device);
}

// Poses hold for all frames, and are easily forgotten.
void add_turned(const Snapshot& snapshot, const Controls& controls, const Lines& lines) {
  const auto count =
      std::ranges::count_if(snapshot.joints, [&](const JointRow& row) { return controls.is_posed(row.name); });
  if (count > 0) lines.add(std::to_string(count) + (count == 1 ? " joint posed" : " joints posed"), kAccent);
}

void add_figures(const Snapshot& snapshot, const Controls& controls, bool all, const Lines& lines) {
  if (snapshot.live) add_live(*snapshot.live, lines);
  lines.add(snapshot.shown_fps, "fps", std::to_string(controls.playback.dropped()) + " dropped");
  if (all) add_times(snapshot, lines);
  add_turned(snapshot, controls, lines);
  add_pins(snapshot, lines);
  add_coverage(snapshot, lines);
}

// Errors stay for half a minute or until they are clicked away, other news for some seconds: the newest few.

// A picture that comes late is no time to read.
void let_news_pass(std::vector<Message>& messages) {
  constexpr std::size_t kShown = 4;
  constexpr double kPassing = 6, kErrorPassing = 30;  // seconds
  const double passed = std::min(0.3, static_cast<double>(ImGui::GetIO().DeltaTime));
  for (Message& message : messages) message.shown += passed;
  std::erase_if(messages, [](const Message& m) { return m.shown > (m.error ? kErrorPassing : kPassing); });
  if (messages.size() > kShown) messages.erase(messages.begin(), messages.end() - kShown);
}

// Gives the width of its text.
float place_window(const PanelLayout& layout) {
  constexpr float kMostOfSide = 0.4f;  // of its height
  if (layout.side > 0) {
    ImGui::SetNextWindowPos({layout.right(), layout.bottom()}, ImGuiCond_Always, {0, 1});
    ImGui::SetNextWindowSizeConstraints({layout.side, 0},
                                        {layout.side, std::max(1.0f, kMostOfSide * (layout.bottom() - layout.menu))});
    return layout.side - 24;
  }
  const float high = layout.timeline > 0 ? layout.timeline : layout.height;
  ImGui::SetNextWindowPos({12, layout.height - (layout.timeline > 0 ? 0 : 12)}, ImGuiCond_Always, {0, 1});
  ImGui::SetNextWindowSizeConstraints({0, 0}, {std::max(200.0f, layout.width - 24), high});
  return std::max(200.0f, layout.width - 60);
}

}  // namespace

void draw_hud(const Snapshot& snapshot, const Controls& controls, const PanelLayout& layout) {
  if (layout.overlaid.left == 0) return;
  // From the top left corner, on no window of their own, as long as there is room.
  constexpr float kWidth = kHudWidth - kHudLeft;
  float y = layout.menu + std::max(12.0f, layout.overlaid.top + 4);
  const auto draw = [&](const std::string& text, ImU32 colour) {
    const float height = ImGui::CalcTextSize(text.c_str(), nullptr, false, kWidth).y;
    if (y + height > layout.bottom() - layout.overlaid.bottom) return;
    ImDrawList& list = *ImGui::GetBackgroundDrawList();
    for (const auto& [off, ink] : {std::pair(1.0f, IM_COL32(0, 0, 0, 210)), {0.0f, colour}}) {
      list.AddText(nullptr, 0, {kHudLeft + off, y + off}, ink, text.c_str(), nullptr, kWidth);
    }
    y += height + 3;
  };
  add_figures(snapshot, controls, !shows_two_views(snapshot, controls), {draw});
}

void draw_messages(const Snapshot& snapshot, Controls& controls, PanelLayout& layout) {
  let_news_pass(controls.messages);
  const bool has_figures = controls.settings.hud.on && layout.overlaid.left == 0 && layout.side > 0;
  if (controls.messages.empty() && !has_figures) return;
  const float width = place_window(layout);
  constexpr ImGuiWindowFlags kOverlay = ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_AlwaysAutoResize |
                                        ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoFocusOnAppearing;
  ImGui::Begin("Messages", nullptr, kOverlay);
  ImGui::PushTextWrapPos(width);
  const auto draw = [](const std::string& text, ImU32 colour) {
    ImGui::PushStyleColor(ImGuiCol_Text, colour);
    ImGui::TextUnformatted(text.c_str());
    ImGui::PopStyleColor();
  };
  if (has_figures) add_figures(snapshot, controls, false, {draw});
  for (const Message& message : controls.messages) {
    if (message.error) {
      ImGui::TextColored({1, 0.5f, 0.38f, 1}, "%s", message.text.c_str());
    } else {
      ImGui::TextUnformatted(message.text.c_str());
    }
  }
  ImGui::PopTextWrapPos();
  ImGui::SetScrollHereY(1);  // to the newest, where there is no room for all
  if (ImGui::IsWindowHovered() && ImGui::IsMouseClicked(ImGuiMouseButton_Left)) controls.messages.clear();
  if (layout.side > 0) layout.messages = ImGui::GetWindowHeight();
  ImGui::End();
}

}  // namespace bodyopt::viewport
