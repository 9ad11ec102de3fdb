#include "viewport/panels/panels.h"

#include <algorithm>
#include <array>
#include <utility>

#include "draw/colours.h"

namespace bodyopt::viewport {
namespace {

constexpr float kLabelShare = 0.36f;  // of a line

Keymap explained_keys = Keymap::bodyopt;  // of the panels that are being drawn

// Labels on buttons and in menus, where they are not the command's name.
constexpr std::pair<const char*, const char*> kCommandLabels[] = {{"step", "One frame on"},
                                                                  {"step-back", "One frame back"},
                                                                  {"first", "To the first frame"},
                                                                  {"last", "To the last frame"},
                                                                  {"frame", "Go to frame"},
                                                                  {"in", "Range begins here"},
                                                                  {"out", "Range ends here"},
                                                                  {"key", "Set key"},
                                                                  {"unkey", "Remove key"},
                                                                  {"camera-key", "Set camera key"},
                                                                  {"camera-unkey", "Remove camera key"},
                                                                  {"paste-flipped", "Paste flipped"},
                                                                  {"save", "Save session"},
                                                                  {"export-clip", "Export motion"},
                                                                  {"screenshot", "Picture"},
                                                                  {"sequence", "Movie or pictures"},
                                                                  {"save-state", "Save camera and look"},
                                                                  {"load-state", "Load camera and look"},
                                                                  {"reload", "Read files again"},
                                                                  {"lead", "Make another the lead"},
                                                                  {"remove", "Remove a character"},
                                                                  {"character", "Add character"},
                                                                  {"recover", "Bring back unsaved work"},
                                                                  {"unit", "Unit of characters"},
                                                                  {"select-also", "Select one more"},
                                                                  {"worn", "Attached"}};

// Labels of comparisons, where they are not their name.
constexpr std::pair<const char*, const char*> kComparisonLabels[] = {{"lbs", "linear blending"},
                                                                     {"ddm", "Direct Delta Mush"},
                                                                     {"linear", "linear part of learned"},
                                                                     {"full", "learned"}};

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
  if (help) explain_text(help);
  ImGui::PopID();
  return moved;
}

constexpr float kSide = 272, kNarrowSide = 216;     // width of the side panel
constexpr float kNarrow = 900, kNarrowest = 560;    // windows: below, it is narrower, or there is no room for it
constexpr float kTimeline = 84, kLowest = 240;      // height; below that of windows there is no room for it
constexpr float kSheet = 0.25f, kLowestSheet = 64;  // of the height, with the timeline; of the dope sheet
constexpr float kCurves = 0.4f;                     // of the height, with the timeline

PanelLayout layout_of(const Controls& controls, float width, float height) {
  PanelLayout layout{width, height, 0, 0, 0};
  if (!controls.panels) return layout;
  layout.menu = ImGui::GetFrameHeight();
  if (height >= kLowest) layout.timeline = kTimeline;
  if (controls.dope_sheet && layout.timeline > 0) {
    layout.sheet = std::max(kLowestSheet, (controls.curves ? kCurves : kSheet) * height - kTimeline);
  }
  if (!controls.sound.file.empty() && layout.timeline > 0) layout.timeline += kSoundHeight;
  layout.timeline += layout.sheet;
  if (width >= kNarrowest && shots::shows_side_panel(controls.settings))
    layout.side = width < kNarrow ? kNarrowSide : kSide;
  return layout;
}

// Each takes a quarter of a view at most, or some more of its height: as much is left free on the other side.
Overlaid overlaid(const Snapshot& snapshot, const Controls& controls, const PanelLayout& layout) {
  constexpr float kMost = 0.25f, kMostHigh = 0.3f, kLowestBar = 132;
  const float wide = kMost * layout.right() / (shows_two_views(snapshot, controls) ? 2 : 1),
              high = kMostHigh * (layout.bottom() - layout.menu);
  Overlaid over;
  if (controls.settings.hud.legend) {
    const float names = names_height(snapshot, controls), bar = colour_bar_width(snapshot, controls);
    if (names <= high) over.top = names;
    if (bar <= wide && layout.bottom() - layout.menu >= kLowestBar) over.right = bar;
    over.bottom = colour_keys_height(snapshot, controls, over.right == 0, high);
  }
  if (controls.settings.hud.on && kHudWidth <= wide) over.left = kHudWidth;
  return over;
}

using Draw = void (*)(const Snapshot&, Controls&);

// The order is that of kSections.
constexpr std::array<Draw, shots::kSections.size()> kDraw = {
    draw_look,      draw_cameras, draw_compare, draw_curate, draw_pose, draw_poses,    draw_keys,
    draw_modifiers, draw_muscles, draw_jiggle,  draw_ghosts, draw_cast, draw_transfer, draw_output};

// The panel on the right, its sections one above the other.
void draw_side_panel(const Snapshot& snapshot, Controls& controls, const PanelLayout& layout) {
  ImGui::SetNextWindowPos({layout.right(), layout.menu});
  ImGui::SetNextWindowSize({layout.side, std::max(1.0f, layout.bottom() - layout.menu - layout.messages)});
  ImGui::Begin("Side", nullptr, kFixedWindow);
  for (std::size_t k = 0; k < shots::kSections.size(); ++k) {
    const shots::Section& section = shots::kSections[k];
    if (kDraw[k] == draw_curate && !snapshot.curation) continue;
    if (kDraw[k] == draw_transfer && snapshot.cast.size() < 2) continue;
    const bool was_open = shots::is_open(controls.settings, section);
    ImGui::SetNextItemOpen(was_open, ImGuiCond_Always);
    const bool open = ImGui::CollapsingHeader(section.title);
    if (controls.typed.revealed_section == section.name) {
      ImGui::SetScrollHereY(0);
      controls.typed.revealed_section.clear();
    }
    if (open != was_open) controls.settings.hud.panels[section.name] = open;
    if (!open) continue;
    ImGui::PushID(section.name);
    kDraw[k](snapshot, controls);
    ImGui::PopID();
    ImGui::Spacing();
  }
  ImGui::End();
}

}  // namespace

ImU32 opaque(const std::array<float, 3>& linear) {
  const std::array<std::uint8_t, 3> colour = draw::srgb(linear);
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

std::string label_of(const Command& command, const std::string& choice) {
  for (const auto& [name, label] : kComparisonLabels) {
    if (std::string("compare") == command.name && choice == name) return label;
  }
  return choice;
}

void attempt(Controls& controls, const std::string& line) {
  controls.attempt([&] { run_command(controls, line); });
}

void explain_text(const std::string& text) {
  if (!ImGui::IsItemHovered(ImGuiHoveredFlags_AllowWhenDisabled)) return;
  ImGui::BeginTooltip();
  ImGui::PushTextWrapPos(320);
  ImGui::TextUnformatted(text.c_str());
  ImGui::PopTextWrapPos();
  ImGui::EndTooltip();
}

void explain(const Command& command) {
  const std::string help = command.help;
  const std::string key = key_of(command, explained_keys);
  explain_text(key.empty() ? help : help + "  (" + key + ")");
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
    explain_text(why->second);
  }
  ImGui::PopID();
}

void command_choice(Controls& controls, const char* command, const char* text,
                    const std::vector<std::string>* available) {
  const Command& c = *find_command(command);
  const std::string current = c.value(controls);
  ImGui::PushID(command);
  if (text) label_before(text);
  if (ImGui::BeginCombo("##choice", label_of(c, current).c_str())) {
    for (const std::string& choice : choices_of(c)) {
      const bool missing = available && std::ranges::find(*available, choice) == available->end();
      const ImGuiSelectableFlags flags = missing ? ImGuiSelectableFlags_Disabled : ImGuiSelectableFlags_None;
      if (ImGui::Selectable(label_of(c, choice).c_str(), choice == current, flags)) {
        attempt(controls, std::string(command) + " " + choice);
      }
      if (missing) explain_text(shots::set_or(controls.missing, command + (" " + choice), "it is what is shown"));
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

PictureRoom draw_panels(const Snapshot& snapshot, Controls& controls, std::uint32_t width, std::uint32_t height) {
  explained_keys = controls.keymap;
  PanelLayout layout = layout_of(controls, static_cast<float>(width), static_cast<float>(height));
  layout.overlaid = overlaid(snapshot, controls, layout);
  if (controls.panels) draw_menu_bar(snapshot, controls);
  draw_messages(snapshot, controls, layout);
  if (layout.timeline > 0) draw_timeline(snapshot, controls, layout);
  if (layout.side > 0) draw_side_panel(snapshot, controls, layout);
  draw_comparison(snapshot, controls, layout);
  if (controls.settings.hud.legend) {
    draw_colour_bar(snapshot, controls, layout);
    draw_colour_keys(snapshot, controls, layout);
  }
  if (controls.settings.hud.on) draw_hud(snapshot, controls, layout);
  if (controls.prompt) draw_prompt(controls, layout);
  if (controls.dialog) draw_file_dialog(controls, layout);
  const bool asks = controls.asks_to_save || (!controls.recoverable.empty() && !controls.headless);
  if (asks) draw_question(controls, layout);
  if (controls.cheat_sheet) draw_cheat_sheet(controls, layout);
  const auto pixels = [](float value) { return static_cast<std::uint32_t>(std::max(1.0f, value)); };
  return {{0, static_cast<std::int32_t>(layout.menu), pixels(layout.right()), pixels(layout.bottom() - layout.menu)},
          layout.overlaid};
}

void draw_loading(const std::string& text) {
  const ImVec2 all = ImGui::GetIO().DisplaySize, size = ImGui::CalcTextSize(text.c_str());
  ImGui::GetBackgroundDrawList()->AddText({0.5f * (all.x - size.x), 0.5f * (all.y - size.y)},
                                          ImGui::GetColorU32(ImGuiCol_Text), text.c_str());
}

void visit_texts(const Snapshot& snapshot, const Controls& controls,
                 const std::function<void(const std::string&)>& visit) {
  for (const CharacterRow& row : snapshot.cast) {
    for (const std::string* text : {&row.name, &row.basis, &row.clip, &row.truth}) visit(*text);
  }
  for (const JointRow& row : snapshot.joints) visit(row.name);
  for (const ControlRow& row : snapshot.controls) visit(row.name);
  for (const std::string& fibre : snapshot.fibres) visit(fibre);
  if (snapshot.curation) {
    for (const StackRow& row : snapshot.curation->modifiers) visit(row.name);
    for (const PoseDot& dot : snapshot.curation->dots) visit(dot.text);
    for (const std::string& pair : snapshot.curation->pairs) visit(pair);
    for (const std::string& region : controls.curating.regions) visit(region);
  }
  visit(snapshot.outside_feature);
  visit(snapshot.device);
  for (const auto& [name, view] : controls.settings.cameras) visit(name);
  for (const ClipCamera& camera : controls.file_cameras) visit(camera.name);
  const PanelState& typed = controls.typed;
  for (const std::string* text : {&typed.prompt, &typed.joint_filter, &typed.camera, &typed.open, &typed.screenshot,
                                  &typed.sequence, &typed.turntable, &typed.state}) {
    visit(*text);
  }
  visit(controls.brush.modifier);
  for (const PoseFile& file : controls.pose_library.poses()) visit(file.path.stem().string());
  if (controls.dialog) {
    visit(controls.dialog->folder.string());
    visit(controls.dialog->name);
    for (const FolderEntry& entry : controls.dialog->entries) visit(entry.name);
  }
  for (const Message& message : controls.messages) visit(message.text);
}

}  // namespace bodyopt::viewport
