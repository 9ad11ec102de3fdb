#include "proxy_viewer/panels/widgets.h"

#include <algorithm>
#include <utility>

#include "draw/colours.h"

namespace bodyopt {
namespace {

constexpr float kLabelShare = 0.36f;  // of a line

// What commands are called on buttons and in menus, where that is not their name.
constexpr std::pair<const char*, const char*> kCommandLabels[] = {{"step", "One frame on"},
                                                                  {"step-back", "One frame back"},
                                                                  {"first", "To the first frame"},
                                                                  {"last", "To the last frame"},
                                                                  {"frame", "Go to frame"},
                                                                  {"in", "Range begins here"},
                                                                  {"out", "Range ends here"},
                                                                  {"key", "Set key"},
                                                                  {"unkey", "Remove key"},
                                                                  {"save", "Save session"},
                                                                  {"export-clip", "Export motion"},
                                                                  {"screenshot", "Picture"},
                                                                  {"sequence", "Movie or pictures"},
                                                                  {"save-state", "Save camera and look"},
                                                                  {"load-state", "Load camera and look"},
                                                                  {"reload", "Read files again"},
                                                                  {"lead", "Make another the lead"},
                                                                  {"remove", "Remove a character"}};

// After it the item before is hovered for long enough to be asked about.
void show_tooltip(const std::string& text) {
  if (!ImGui::IsItemHovered(ImGuiHoveredFlags_AllowWhenDisabled)) return;
  ImGui::BeginTooltip();
  ImGui::PushTextWrapPos(320);
  ImGui::TextUnformatted(text.c_str());
  ImGui::PopTextWrapPos();
  ImGui::EndTooltip();
}

struct Scalar {
  void* value;
  const void *low, *high;
};

bool slide_scalar(const char* label, ImGuiDataType type, const Scalar& scalar, const char* format, const char* help,
                  ImGuiSliderFlags flags) {
  ImGui::PushID(label);
  label_before(label);
  const bool moved = ImGui::SliderScalar("##bar", type, scalar.value, scalar.low, scalar.high, format,
                                         flags | ImGuiSliderFlags_AlwaysClamp);
  if (help) show_tooltip(help);
  ImGui::PopID();
  return moved;
}

}  // namespace

ImU32 opaque(const std::array<float, 3>& linear) {
  const std::array<std::uint8_t, 3> colour = srgb(linear);
  return IM_COL32(colour[0], colour[1], colour[2], 255);
}

std::string label_of(const Command& command) {
  for (const auto& [name, label] : kCommandLabels) {
    if (std::string(name) == command.name) return label;
  }
  std::string text = command.name;
  std::replace(text.begin(), text.end(), '-', ' ');
  text[0] = static_cast<char>(text[0] - 'a' + 'A');
  return text;
}

void attempt(Controls& controls, const std::string& line) {
  controls.attempt([&] { run_command(controls, line); });
}

void explain(const Command& command) {
  const std::string help = command.help;
  show_tooltip(*command.key == 0 ? help : help + "  (" + command.key + ")");
}

void explain(const char* command) { explain(*find_command(command)); }

void command_button(Controls& controls, const char* command, const char* text, float width) {
  const Command& c = *find_command(command);
  ImGui::PushID(command);
  if (ImGui::Button(text ? text : label_of(c).c_str(), {width, 0})) attempt(controls, command);
  explain(c);
  ImGui::PopID();
}

void command_switch(Controls& controls, const char* command, const char* text, float width) {
  const bool on = find_command(command)->value(controls) == "on";
  ImGui::PushStyleColor(ImGuiCol_Text, on ? kAccent : kQuiet);
  command_button(controls, command, text, width);
  ImGui::PopStyleColor();
}

void command_tick(Controls& controls, const char* command, const char* text) {
  const Command& c = *find_command(command);
  bool on = c.value(controls) == "on";
  ImGui::PushID(command);
  if (ImGui::Checkbox(text ? text : label_of(c).c_str(), &on)) {
    attempt(controls, std::string(command) + (on ? " on" : " off"));
  }
  const auto why = controls.missing.find(std::string(command) + " on");
  if (why == controls.missing.end()) {
    explain(c);
  } else {
    show_tooltip(why->second);
  }
  ImGui::PopID();
}

void command_choice(Controls& controls, const char* command, const char* text,
                    const std::vector<std::string>* available) {
  const Command& c = *find_command(command);
  const std::string current = c.value(controls);
  ImGui::PushID(command);
  if (text) label_before(text);
  if (ImGui::BeginCombo("##choice", current.c_str())) {
    for (const std::string& choice : choices_of(c)) {
      const bool missing = available && std::ranges::find(*available, choice) == available->end();
      const ImGuiSelectableFlags flags = missing ? ImGuiSelectableFlags_Disabled : ImGuiSelectableFlags_None;
      if (ImGui::Selectable(choice.c_str(), choice == current, flags)) {
        attempt(controls, std::string(command) + " " + choice);
      }
      if (missing) show_tooltip(set_or(controls.missing, command + (" " + choice), "it is what is shown"));
    }
    ImGui::EndCombo();
  }
  explain(c);
  ImGui::PopID();
}

void label_before(const char* text) {
  const float width = ImGui::GetContentRegionAvail().x;
  const float left = ImGui::GetCursorPosX();
  ImGui::AlignTextToFramePadding();
  ImGui::TextUnformatted(text);
  const bool fits = ImGui::CalcTextSize(text).x < kLabelShare * width;  // otherwise it has a line of its own
  if (fits) ImGui::SameLine(left + kLabelShare * width);
  ImGui::SetNextItemWidth(-1);
}

float share_of_line(int count) {
  const float spaces = static_cast<float>(count - 1) * ImGui::GetStyle().ItemSpacing.x;
  return std::max(1.0f, (ImGui::GetContentRegionAvail().x - spaces) / static_cast<float>(count));
}

bool slide(const char* label, double& value, double low, double high, const char* format, const char* help,
           ImGuiSliderFlags flags) {
  return slide_scalar(label, ImGuiDataType_Double, {&value, &low, &high}, format, help, flags);
}

bool slide(const char* label, int& value, int low, int high, const char* format, const char* help) {
  return slide_scalar(label, ImGuiDataType_S32, {&value, &low, &high}, format, help, 0);
}

}  // namespace bodyopt
