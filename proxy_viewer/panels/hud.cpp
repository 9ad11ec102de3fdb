// Figures over the picture: rate, times of stages, device, memory, dropped frames, and how far the pose is from those
// that were trained.
#include <imgui.h>

#include <algorithm>
#include <string>

#include "proxy_viewer/panels/panels.h"
#include "runtime/core/text.h"

namespace bodyopt {
namespace {

// Lines of text from the top left corner, on no window of their own.
class Lines {
 public:
  Lines(float x, float y) : at_{x, y} {}

  void add(const std::string& text, ImU32 colour = IM_COL32(190, 190, 194, 255)) {
    ImDrawList& list = *ImGui::GetBackgroundDrawList();
    list.AddText({at_.x + 1, at_.y + 1}, IM_COL32(0, 0, 0, 210), text.c_str());
    list.AddText(at_, colour, text.c_str());
    at_.y += ImGui::GetTextLineHeight() + 3;
  }

  void add(double value, const char* unit, const std::string& what) {
    add(formatted("%.*f %s  ", value < 100 ? 2 : 0, value, unit) + what);
  }

 private:
  ImVec2 at_;
};

void add_coverage(const Snapshot& snapshot, Lines& lines) {
  constexpr ImU32 kOutside = IM_COL32(194, 140, 255, 255);
  if (snapshot.outside > 0) {
    lines.add("not trained for: " + snapshot.outside_feature + " (" + snapshot.outside_by + " beyond)", kOutside);
  }
  if (snapshot.expected_mm) lines.add(*snapshot.expected_mm, "mm", "expected error");
}

void add_live(const LiveRow& live, Lines& lines) {
  constexpr ImU32 kLive = IM_COL32(120, 205, 140, 255);
  lines.add(live.frame ? "live: frame " + std::to_string(*live.frame) : "live: no pose has come", kLive);
  if (live.rejected == 0) return;
  lines.add(std::to_string(live.rejected) + " rejected, the last: " + live.last_rejection, kErrorColour);
}

void add_pins(const Snapshot& snapshot, Lines& lines) {
  for (const MissedPin& pin : snapshot.missed_pins) lines.add(describe(pin), kErrorColour);
}

// Side by side, so many lines would cover the first body.
bool stands_on_a_body(const Snapshot& snapshot, const Controls& controls) {
  const ViewSettings::Compare& compare = controls.settings.compare;
  return compare.layout == CompareLayout::side_by_side && !snapshot.compared.empty() && !compare.activation;
}

void add_times(const Snapshot& snapshot, Lines& lines) {
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
void add_turned(const Snapshot& snapshot, const Controls& controls, Lines& lines) {
  const auto count =
      std::ranges::count_if(snapshot.joints, [&](const JointRow& row) { return controls.is_posed(row.name); });
  if (count > 0) lines.add(std::to_string(count) + (count == 1 ? " joint posed" : " joints posed"), kAccent);
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
  ImGui::SetNextWindowPos({12, layout.bottom() - 12}, ImGuiCond_Always, {0, 1});
  ImGui::SetNextWindowSizeConstraints({0, 0}, {std::max(200.0f, layout.width - 24), layout.height});
  return std::max(200.0f, layout.width - 60);
}

}  // namespace

void draw_hud(const Snapshot& snapshot, const Controls& controls, const PanelLayout& layout) {
  Lines lines(14, layout.menu + 12);
  if (snapshot.live) add_live(*snapshot.live, lines);
  lines.add(snapshot.shown_fps, "fps", std::to_string(controls.playback.dropped()) + " dropped");
  if (!stands_on_a_body(snapshot, controls)) add_times(snapshot, lines);
  add_turned(snapshot, controls, lines);
  add_pins(snapshot, lines);
  add_coverage(snapshot, lines);
}

void draw_messages(Controls& controls, PanelLayout& layout) {
  let_news_pass(controls.messages);
  if (controls.messages.empty()) return;
  const float width = place_window(layout);
  constexpr ImGuiWindowFlags kOverlay = ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_AlwaysAutoResize |
                                        ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoFocusOnAppearing;
  ImGui::Begin("Messages", nullptr, kOverlay);
  ImGui::PushTextWrapPos(width);
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

}  // namespace bodyopt
