// Buttons, the frame in large digits, and the bar: click or drag to scrub, also while playing. It shows the range,
// whose ends are dragged, the keys, and the error of every frame.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

#include "runtime/core/text.h"
#include "viewport/panels/panels.h"
#include "viewport/platform/gui.h"

namespace bodyopt::viewport {
namespace {

constexpr ImU32 kBar = IM_COL32(38, 38, 41, 255), kRange = IM_COL32(62, 62, 66, 255);
constexpr ImU32 kTick = IM_COL32(110, 110, 116, 255), kKeyColour = IM_COL32(120, 170, 220, 255);
constexpr ImU32 kUnkeyed = IM_COL32(150, 92, 30, 255);

// Numbers at round distances, as many as there is room for.
void draw_ticks(ImDrawList& list, const FrameBar& bar) {
  const double per_pixel = static_cast<double>(bar.last - bar.first) / static_cast<double>(std::max(1.0f, bar.size.x));
  std::int64_t distance = 1;
  for (int k = 0; static_cast<double>(distance) <= 60 * per_pixel; ++k) distance *= k % 2 == 0 ? 5 : 2;
  for (std::int64_t frame = bar.first / distance * distance; frame <= bar.last; frame += distance) {
    if (frame < bar.first) continue;
    const float x = bar.x(static_cast<double>(frame));
    list.AddLine({x, bar.at.y + bar.size.y - 6}, {x, bar.at.y + bar.size.y}, kTick);
    list.AddText(nullptr, 12, {x + 3, bar.at.y + bar.size.y - 14}, kTick, std::to_string(frame).c_str());
  }
}

std::string text_of(float error) { return formatted("%.2f mm", static_cast<double>(error)); }

// The frames that were measured, brighter than the others, and their RMS from the bottom; `worst`: the full height.
void draw_error_columns(ImDrawList& list, const FrameBar& bar, const Snapshot& snapshot, float worst) {
  const std::vector<ErrorRow>& errors = snapshot.errors;
  const float bottom = bar.at.y + bar.size.y;
  // One column per pixel at most, as high as the worst of its frames.
  float drawn = bar.at.x, highest = 0;
  bool measured = false;
  for (std::size_t k = 0; k < errors.size(); ++k) {
    const double frame = snapshot.first_frame + static_cast<double>(k);
    if (frame < bar.first || bar.last < frame) continue;
    measured = measured || errors[k].measured;
    if (worst > 0 && std::isfinite(errors[k].rms)) highest = std::max(highest, errors[k].rms / worst);
    const float right = bar.x(frame + 0.5);
    if (right < drawn + 1 && k + 1 < errors.size()) continue;
    if (measured) list.AddRectFilled({drawn, bar.at.y}, {right, bottom}, kRange);
    if (highest > 0) list.AddRectFilled({drawn, bottom - (bar.size.y - 2) * highest}, {right, bottom}, kErrorColour);
    drawn = right;
    highest = 0;
    measured = false;
  }
}

void draw_errors(ImDrawList& list, const FrameBar& bar, const Snapshot& snapshot) {
  const float worst = snapshot.worst ? snapshot.errors[*snapshot.worst].rms : 0;
  draw_error_columns(list, bar, snapshot, worst);
  if (!(worst > 0) || !bar.shows(snapshot.first_frame + static_cast<int>(*snapshot.worst))) return;
  const float x = bar.x(snapshot.first_frame + static_cast<double>(*snapshot.worst));
  const std::string text = text_of(worst);
  const float width = ImGui::CalcTextSize(text.c_str()).x * 12 / ImGui::GetFontSize();
  const bool fits = x + 6 + width < bar.at.x + bar.size.x;
  list.AddCircleFilled({x, bar.at.y + 2}, 2.5f, kAccent);
  list.AddText(nullptr, 12, {fits ? x + 6 : x - 6 - width, bar.at.y - 3}, kAccent, text.c_str());
}

std::string describe(const ErrorRow& error) {
  if (!error.measured) return "not measured yet";
  return std::isfinite(error.rms) ? text_of(error.rms) + " RMS" : "nothing to compare with";
}

void explain_frame(const FrameBar& bar, const Snapshot& snapshot, const char* rest) {
  const int frame = bar.frame(ImGui::GetIO().MousePos.x);
  const auto index = static_cast<std::size_t>(frame - snapshot.first_frame);
  const std::string error = index < snapshot.errors.size() ? ": " + describe(snapshot.errors[index]) : "";
  ImGui::SetTooltip("frame %d%s%s", frame, error.c_str(), rest);
}

void draw_frames(const Snapshot& snapshot, Controls& controls, const FrameBar& bar) {
  Playback& playback = controls.playback;
  ImGui::SetCursorScreenPos(bar.at);
  ImGui::InvisibleButton("frames", bar.size);
  if (ImGui::IsItemActive()) playback.scrub(bar.frame(ImGui::GetIO().MousePos.x));
  if (ImGui::IsItemHovered()) explain_frame(bar, snapshot, "");
  ImDrawList& list = *ImGui::GetWindowDrawList();
  const ImVec2 end{bar.at.x + bar.size.x, bar.at.y + bar.size.y};
  list.AddRectFilled(bar.at, end, kBar, 3);
  list.AddRectFilled({bar.x(playback.in()), bar.at.y}, {bar.x(playback.out()), end.y}, kRange, 3);
  draw_ticks(list, bar);
  for (const int key : playback.keys()) {
    if (bar.shows(key)) list.AddCircleFilled({bar.x(key), bar.at.y + 6}, 3, kKeyColour, 4);
  }
  for (const auto& [frame, key] : controls.settings.pose.keys) {
    if (bar.shows(frame)) list.AddCircleFilled({bar.x(frame), bar.at.y + 14}, 4, kAccent, 4);
  }
  for (const auto& [frame, key] : controls.settings.shot_camera.keys) {
    const float x = bar.x(frame), y = bar.at.y + 23;
    if (bar.shows(frame)) list.AddTriangleFilled({x - 4, y}, {x + 4, y - 4}, {x + 4, y + 4}, kCameraColour);
  }
}

// An end of the range, to be dragged: a flag over the bar, towards the other end.
void draw_end(const char* command, int end, float side, Controls& controls, const FrameBar& bar) {
  constexpr float kSize = 9;
  const float x = bar.x(end), top = bar.at.y - kSize - 1;
  ImGui::SetCursorScreenPos({std::min(x, x + side * kSize), top});
  ImGui::InvisibleButton(command, {kSize, kSize});
  const bool held = ImGui::IsItemActive(), hovered = ImGui::IsItemHovered();
  if (hovered && !held) explain(command);
  const int frame = bar.frame(ImGui::GetIO().MousePos.x);
  if (held && frame != end) attempt(controls, command + (" " + std::to_string(frame)));
  ImGui::GetWindowDrawList()->AddTriangleFilled({x, top}, {x + side * kSize, top}, {x, top + kSize},
                                                held || hovered ? kAccent : kTick);
}

// Draws errors under the bar: a click goes to the worst frame, and from there to its worst vertex.
void draw_sparkline(const Snapshot& snapshot, Controls& controls, const FrameBar& bar) {
  ImGui::SetCursorScreenPos(bar.at);
  const bool clicked = ImGui::InvisibleButton("errors", bar.size);
  if (ImGui::IsItemHovered()) explain_frame(bar, snapshot, "\nclick: to the worst frame, then to its worst vertex");
  ImDrawList& list = *ImGui::GetWindowDrawList();
  list.AddRectFilled(bar.at, {bar.at.x + bar.size.x, bar.at.y + bar.size.y}, kBar, 3);
  draw_errors(list, bar, snapshot);
  if (!clicked) return;
  const bool is_there =
      snapshot.worst && snapshot.first_frame + static_cast<int>(*snapshot.worst) == controls.playback.frame();
  attempt(controls, is_there ? "worst-vertex" : "worst-frame");
}

// Pixel by pixel, as far as the sound swings while it passes; the loudest fills the height, silence is a line.
void draw_waveform(const Snapshot& snapshot, const Controls& controls, const FrameBar& bar) {
  ImDrawList& list = *ImGui::GetWindowDrawList();
  list.AddRectFilled(bar.at, {bar.at.x + bar.size.x, bar.at.y + bar.size.y}, kBar, 3);
  if (!snapshot.waveform) return;
  const auto seconds = [&](float x) {
    const double frame = bar.first + static_cast<double>((x - bar.at.x) / bar.size.x) * (bar.last - bar.first);
    return (frame - controls.sound.first) / snapshot.clip_fps;
  };
  constexpr float kSilent = 1e-3f;
  const float middle = bar.at.y + 0.5f * bar.size.y;
  const float half = 0.5f * bar.size.y / std::max(kSilent, snapshot.waveform->loudest);
  for (float x = bar.at.x; x < bar.at.x + bar.size.x; ++x) {
    const auto [low, high] = snapshot.waveform->swing(seconds(x), seconds(x + 1));
    list.AddRectFilled({x, middle - half * high}, {x + 1, middle - half * low + 1}, kKeyColour);
  }
}

void draw_head(const FrameBar& bar, float bottom, int frame) {
  if (!bar.shows(frame)) return;
  ImDrawList& list = *ImGui::GetWindowDrawList();
  const float x = bar.x(frame);
  list.AddLine({x, bar.at.y - 2}, {x, bottom}, kAccent, 2);
  list.AddTriangleFilled({x - 5, bar.at.y - 4}, {x + 5, bar.at.y - 4}, {x, bar.at.y + 4}, kAccent);
}

FrameBar draw_bars(const Snapshot& snapshot, Controls& controls, float bottom) {
  constexpr float kSparkline = 20, kGap = 4;
  const ImVec2 at = ImGui::GetCursorScreenPos();
  const float width = std::max(1.0f, ImGui::GetContentRegionAvail().x);
  const float sound = controls.sound.file.empty() ? 0 : kSoundHeight;
  const float below = (snapshot.errors.empty() ? 0 : kSparkline + kGap) + sound;
  const Playback& playback = controls.playback;
  const FrameBar frames{at,
                        {width, bottom - at.y - below},
                        controls.zooms ? playback.in() : playback.first(),
                        controls.zooms ? playback.out() : playback.last()};
  draw_frames(snapshot, controls, frames);
  if (!controls.zooms) {  // a flag that is dragged would take the bar along
    draw_end("in", controls.playback.in(), 1, controls, frames);
    draw_end("out", controls.playback.out(), -1, controls, frames);
  }
  if (!snapshot.errors.empty()) {
    draw_sparkline(snapshot, controls,
                   {{at.x, bottom - sound - kSparkline}, {width, kSparkline}, frames.first, frames.last});
  }
  if (sound > 0) {
    const FrameBar under{{at.x, bottom - sound + kGap}, {width, sound - kGap}, frames.first, frames.last};
    draw_waveform(snapshot, controls, under);
  }
  draw_head(frames, bottom, playback.frame());
  return frames;
}

// Draws the sheet under the bar, each key under its frame; the names are to its left.
void draw_dope_sheet(Controls& controls, const FrameBar& bar, float top) {
  ImGui::SetCursorScreenPos({ImGui::GetWindowPos().x + ImGui::GetStyle().WindowPadding.x, top});
  const float name_width = bar.at.x - kDiamond - ImGui::GetCursorScreenPos().x;
  ImGui::BeginChild("Sheet", {0, 0}, false, ImGuiWindowFlags_NoScrollbar);
  const auto draw = controls.curves ? draw_curves : draw_key_lines;
  draw(controls, name_width, name_width + bar.size.x + 2 * kDiamond, bar.first, bar.last);
  ImGui::EndChild();
}

void draw_buttons(Controls& controls) {
  Playback& playback = controls.playback;
  const float left = ImGui::GetCursorPosX();
  ImGui::PushStyleVar(ImGuiStyleVar_ItemSpacing, {3, 6});
  ImGui::BeginGroup();
  for (const auto& [command, text] : {std::pair{"first", "|<"}, std::pair{"step-back", "<"},
                                      std::pair{"play", playback.playing() ? "||" : "\xe2\x96\xb6"},
                                      std::pair{"step", ">"}, std::pair{"last", ">|"}}) {
    command_button(controls, command, text, 30);
    ImGui::SameLine();
  }
  for (const auto& [command, text] : {std::pair{"backwards", "\xe2\x97\x80"}, std::pair{"every-frame", "all"}}) {
    command_switch(controls, command, text, 30);
    ImGui::SameLine();
  }
  const float width = ImGui::GetCursorPosX() - left - 3;
  ImGui::NewLine();
  ImGui::SetNextItemWidth(0.5f * width - 2);
  command_choice(controls, "mode", nullptr);
  ImGui::SameLine();
  double speed = playback.speed();
  const double low = shots::PlaySettings::kSlowest, high = shots::PlaySettings::kFastest;
  ImGui::SetNextItemWidth(0.5f * width - 1);
  if (ImGui::SliderScalar("##speed", ImGuiDataType_Double, &speed, &low, &high, "%.2f x",
                          ImGuiSliderFlags_AlwaysClamp)) {
    playback.set_speed(speed);
  }
  explain("speed");
  ImGui::EndGroup();
  ImGui::PopStyleVar();
}

// Draws a number that can be typed into.
void draw_frame_number(const Snapshot& snapshot, Controls& controls) {
  const Playback& playback = controls.playback;
  ImGui::BeginGroup();
  ImGui::PushFont(large_font());
  ImGui::PushStyleColor(ImGuiCol_FrameBg, 0);
  ImGui::PushStyleVar(ImGuiStyleVar_FramePadding, {3, 0});
  ImGui::SetNextItemWidth(ImGui::CalcTextSize("000000").x);
  int frame = playback.frame();
  if (ImGui::InputInt("##frame", &frame, 0, 0, ImGuiInputTextFlags_EnterReturnsTrue)) {
    attempt(controls, "frame " + std::to_string(frame));
  }
  ImGui::PopStyleVar();
  ImGui::PopStyleColor();
  ImGui::PopFont();
  explain("frame");
  // A dataset's frames follow each other here, while their takes number them otherwise.
  const std::vector<std::string>& names = controls.curating.frames;
  const auto place = static_cast<std::size_t>(playback.frame() - snapshot.first_frame);
  if (place < names.size()) {
    ImGui::TextDisabled("%s  of %zu", names[place].c_str(), names.size());
  } else {
    ImGui::TextDisabled("%d\xe2\x80\x93%d  %g fps", playback.in(), playback.out(), snapshot.clip_fps);
  }
  ImGui::EndGroup();
}

// Draws the buttons for a key of the pose that is shown.
void draw_key_buttons(Controls& controls) {
  constexpr float kWidth = 104;
  const bool has_key = controls.settings.pose.keys.contains(controls.playback.frame());
  ImGui::BeginGroup();
  const bool is_unkeyed = controls.is_unkeyed();
  ImGui::PushStyleColor(ImGuiCol_Button, is_unkeyed ? kUnkeyed : ImGui::GetColorU32(ImGuiCol_Button));
  command_button(controls, "key", is_unkeyed ? "Key this pose" : nullptr, kWidth);
  ImGui::PopStyleColor();
  ImGui::BeginDisabled(!has_key);
  command_button(controls, "unkey", nullptr, kWidth);
  ImGui::EndDisabled();
  ImGui::EndGroup();
}

}  // namespace

void draw_timeline(const Snapshot& snapshot, Controls& controls, const PanelLayout& layout) {
  // Windows below have no room for the keys' buttons, the number, the buttons of playback.
  constexpr float kKeysWidth = 640, kNumberWidth = 480, kButtonsWidth = 330;
  ImGui::SetNextWindowPos({0, layout.bottom()});
  ImGui::SetNextWindowSize({layout.width, layout.timeline});
  ImGui::Begin("Timeline", nullptr, kFixedWindow | ImGuiWindowFlags_NoScrollbar);
  if (layout.width >= kButtonsWidth) {
    draw_buttons(controls);
    ImGui::SameLine(0, 14);
  }
  if (layout.width >= kNumberWidth) {
    draw_frame_number(snapshot, controls);
    ImGui::SameLine(0, 14);
  }
  if (layout.width >= kKeysWidth) {
    draw_key_buttons(controls);
    ImGui::SameLine(0, 14);
  }
  ImGui::SetCursorPosY(14);
  const FrameBar bar = draw_bars(snapshot, controls, layout.height - layout.sheet - 10);
  if (layout.sheet > 0) draw_dope_sheet(controls, bar, layout.height - layout.sheet - 4);
  ImGui::End();
}

}  // namespace bodyopt::viewport
