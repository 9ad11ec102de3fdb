// The frame in large digits, buttons, and the bar: click or drag to scrub, also while playing; the range; keys; the
// error of every frame.
#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "proxy_viewer/commands.h"
#include "proxy_viewer/panels.h"

namespace bodyopt {
namespace {

constexpr ImU32 kBar = IM_COL32(38, 38, 41, 255), kRange = IM_COL32(62, 62, 66, 255);
constexpr ImU32 kTick = IM_COL32(110, 110, 116, 255), kHead = IM_COL32(242, 158, 64, 255);
constexpr ImU32 kKey = IM_COL32(120, 170, 220, 255), kError = IM_COL32(220, 90, 70, 255);

void button(const char* text, const char* command, Controls& controls) {
  if (ImGui::Button(text, {30, 24})) find_command(command)->run(controls, "");
  if (ImGui::IsItemHovered()) {
    ImGui::SetTooltip("%s (%s)", find_command(command)->help, find_command(command)->key);
  }
  ImGui::SameLine(0, 3);
}

struct Bar {
  ImVec2 at, size;
  int first, last;

  float x(double frame) const {
    const double t = last > first ? (frame - first) / (last - first) : 0;
    return at.x + static_cast<float>(std::clamp(t, 0.0, 1.0)) * size.x;
  }
  int frame(float x) const {
    const double t = std::clamp(static_cast<double>((x - at.x) / std::max(1.0f, size.x)), 0.0, 1.0);
    return first + static_cast<int>(std::lround(t * (last - first)));
  }
};

// Numbers at round distances, as many as there is room for.
void draw_ticks(ImDrawList& list, const Bar& bar) {
  const double per_pixel = static_cast<double>(bar.last - bar.first) / static_cast<double>(std::max(1.0f, bar.size.x));
  int distance = 1;
  for (const int factor : {5, 2, 5, 2, 5, 2, 5, 2}) {
    if (distance > 60 * per_pixel) break;
    distance *= factor;
  }
  char text[16];
  for (int frame = bar.first / distance * distance; frame <= bar.last; frame += distance) {
    if (frame < bar.first) continue;
    const float x = bar.x(frame);
    list.AddLine({x, bar.at.y + bar.size.y - 6}, {x, bar.at.y + bar.size.y}, kTick);
    std::snprintf(text, sizeof(text), "%d", frame);
    list.AddText(nullptr, 12, {x + 3, bar.at.y + bar.size.y - 14}, kTick, text);
  }
}

void draw_errors(ImDrawList& list, const Bar& bar, const std::vector<float>& errors) {
  float highest = 0;
  for (const float error : errors) highest = std::isfinite(error) ? std::max(highest, error) : highest;
  if (highest <= 0) return;
  for (std::size_t k = 0; k < errors.size(); ++k) {
    if (!std::isfinite(errors[k])) continue;
    const float x = bar.x(bar.first + static_cast<double>(k));
    const float height = (bar.size.y - 4) * errors[k] / highest;
    list.AddLine({x, bar.at.y + bar.size.y}, {x, bar.at.y + bar.size.y - height}, kError);
  }
}

void draw_bar(const Snapshot& snapshot, Controls& controls) {
  Playback& playback = controls.playback;
  const Bar bar{ImGui::GetCursorScreenPos(), {ImGui::GetContentRegionAvail().x, 34}, playback.first(), playback.last()};
  ImGui::InvisibleButton("frames", bar.size);
  if (ImGui::IsItemActive()) playback.scrub(bar.frame(ImGui::GetIO().MousePos.x));
  ImDrawList& list = *ImGui::GetWindowDrawList();
  const ImVec2 end{bar.at.x + bar.size.x, bar.at.y + bar.size.y};
  list.AddRectFilled(bar.at, end, kBar, 3);
  list.AddRectFilled({bar.x(playback.in()), bar.at.y}, {bar.x(playback.out()), end.y}, kRange, 3);
  draw_errors(list, bar, snapshot.error_mm);
  draw_ticks(list, bar);
  for (const int key : playback.keys()) list.AddCircleFilled({bar.x(key), bar.at.y + 6}, 3, kKey, 4);
  const float head = bar.x(playback.frame());
  list.AddLine({head, bar.at.y - 2}, {head, end.y}, kHead, 2);
  list.AddTriangleFilled({head - 5, bar.at.y - 4}, {head + 5, bar.at.y - 4}, {head, bar.at.y + 4}, kHead);
  if (ImGui::IsItemHovered()) {
    const int frame = bar.frame(ImGui::GetIO().MousePos.x);
    const std::size_t index = static_cast<std::size_t>(frame - bar.first);
    if (index < snapshot.error_mm.size() && std::isfinite(snapshot.error_mm[index])) {
      ImGui::SetTooltip("%d: %.2f mm", frame, static_cast<double>(snapshot.error_mm[index]));
    } else {
      ImGui::SetTooltip("%d", frame);
    }
  }
}

}  // namespace

void draw_timeline(const Snapshot& snapshot, Controls& controls, const Layout& layout) {
  ImGui::SetNextWindowPos({0, layout.height - layout.timeline});
  ImGui::SetNextWindowSize({layout.width, layout.timeline});
  constexpr ImGuiWindowFlags kFixed = ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove |
                                      ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoBringToFrontOnFocus;
  ImGui::Begin("Timeline", nullptr, kFixed);
  Playback& playback = controls.playback;
  ImGui::BeginGroup();
  button("|<", "first", controls);
  button("<", "step-back", controls);
  button(playback.playing() ? "||" : "\xe2\x96\xb6", "play", controls);
  button(">", "step", controls);
  button(">|", "last", controls);
  ImGui::NewLine();
  const char* const modes[] = {"loop", "ping-pong", "once"};
  int mode = static_cast<int>(playback.mode());
  ImGui::SetNextItemWidth(76);
  if (ImGui::Combo("##mode", &mode, modes, 3)) run_command(controls, std::string("mode ") + modes[mode]);
  ImGui::SameLine(0, 3);
  float speed = static_cast<float>(playback.speed());
  ImGui::SetNextItemWidth(82);
  if (ImGui::SliderFloat("##speed", &speed, static_cast<float>(Playback::kSlowest),
                         static_cast<float>(Playback::kFastest), "%.2f x")) {
    controls.settings.playback.speed = std::clamp(static_cast<double>(speed), Playback::kSlowest, Playback::kFastest);
    playback.set_speed(controls.settings.playback.speed);
  }
  ImGui::EndGroup();
  ImGui::SameLine(0, 12);
  ImGui::BeginGroup();
  ImGui::SetWindowFontScale(2.1f);
  ImGui::Text("%5d", playback.frame());
  ImGui::SetWindowFontScale(1);
  ImGui::TextDisabled("%d\xe2\x80\x93%d  %g fps", playback.in(), playback.out(), snapshot.clip_fps);
  ImGui::EndGroup();
  ImGui::SameLine(0, 12);
  ImGui::SetCursorPosY(20);
  draw_bar(snapshot, controls);
  ImGui::End();
}

}  // namespace bodyopt
