// Every command, in its menu: those with a choice of words as menus of their own, those with any other argument by the
// prompt.
#include <imgui_internal.h>

#include <algorithm>
#include <utility>

#include "viewport/panels/panels.h"

namespace bodyopt::viewport {
namespace {

bool needs_argument(const Command& command) { return *command.argument != 0 && *command.argument != '['; }

void draw_choices(const Command& command, const std::vector<std::string>& choices, Controls& controls) {
  const bool open = ImGui::BeginMenu(label_of(command).c_str());
  if (!open) return explain(command);
  const std::string current = command.value ? command.value(controls) : "";
  for (const std::string& choice : choices) {
    if (ImGui::MenuItem(label_of(command, choice).c_str(), nullptr, choice == current)) {
      attempt(controls, std::string(command.name) + " " + choice);
    }
  }
  ImGui::EndMenu();
}

// Files that were open lately, by their names; the whole path under the mouse.
void draw_recent(const Command& command, Controls& controls) {
  if (!ImGui::BeginMenu("Open recent", !controls.recent.empty())) return explain(command);
  for (std::size_t k = 0; k < controls.recent.size(); ++k) {
    const std::string& file = controls.recent[k];
    const std::string name = file.substr(file.rfind('/') + 1) + "##" + std::to_string(k);
    if (ImGui::MenuItem(name.c_str())) attempt(controls, "recent " + std::to_string(k + 1));
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", file.c_str());
  }
  ImGui::EndMenu();
}

void draw_item(const Command& command, Controls& controls) {
  if (std::string("browse") == command.name) return;  // what it is for are items themselves
  if (std::string("recent") == command.name) return draw_recent(command, controls);
  const std::vector<std::string> choices = choices_of(command);
  if (!choices.empty()) return draw_choices(command, choices, controls);
  const std::vector<std::string> browsed = browsed_commands();
  const bool browses = std::ranges::find(browsed, command.name) != browsed.end(), types = needs_argument(command);
  const bool on = command.value && command.value(controls) == "on";
  if (std::string("save") == command.name && !controls.session_file.empty()) {
    if (ImGui::MenuItem("Save session", key_of(command, controls.keymap))) attempt(controls, "save");
    if (ImGui::MenuItem("Save session as\xe2\x80\xa6")) attempt(controls, "browse save");
    return explain(command);
  }
  const std::string label = label_of(command) + (browses || types ? "\xe2\x80\xa6" : "");
  if (ImGui::MenuItem(label.c_str(), key_of(command, controls.keymap), on)) {
    if (browses) {
      attempt(controls, std::string("browse ") + command.name);
    } else if (types) {
      controls.typed.prompt = std::string(command.name) + " ";
      controls.prompt = true;
    } else {
      attempt(controls, command.name);
    }
  }
  explain(command);
}

void draw_title(const Snapshot& snapshot) {
  if (snapshot.cast.empty()) return;
  const CharacterRow& lead = snapshot.cast.front();
  const std::string text = lead.clip.empty() ? lead.name : lead.name + "  \xe2\x80\x93  " + lead.clip;
  const float at = ImGui::GetWindowWidth() - ImGui::CalcTextSize(text.c_str()).x - 14;
  if (at < ImGui::GetCursorPosX()) return;
  ImGui::SameLine(at);
  ImGui::TextDisabled("%s", text.c_str());
}

// Takes letters typed before the field hears, which begins one picture after it was asked to.
std::string early_letters() {
  std::string text;
  for (const ImWchar letter : ImGui::GetIO().InputQueueCharacters) {
    char utf8[5];
    text += ImTextCharToUtf8(utf8, letter);
  }
  ImGui::GetIO().InputQueueCharacters.clear();
  return text;
}

// A field that is entered by the keyboard has all its text selected, which the next letter would replace.
int leave_nothing_selected(ImGuiInputTextCallbackData* data) {
  bool& hears = *static_cast<bool*>(data->UserData);
  if (!hears) data->CursorPos = data->SelectionStart = data->SelectionEnd = data->BufTextLen;
  hears = true;
  return 0;
}

// Draws a field for what is typed; whether Enter was, be it before the field hears.
bool draw_field(const char* id, const char* hint, std::string& text, bool hears, Controls& controls) {
  constexpr ImGuiInputTextFlags kFlags = ImGuiInputTextFlags_EnterReturnsTrue | ImGuiInputTextFlags_CallbackAlways;
  const bool enters = ImGui::InputTextWithHint(id, hint, &text, kFlags, leave_nothing_selected, &hears);
  return std::exchange(controls.typed.entered, false) || enters;
}

// Typing stops at once: the next letters are keys again, not for a field that is gone.
void stop_typing() {
  ImGui::ClearActiveID();
  ImGui::GetIO().WantTextInput = false;
  ImGui::GetCurrentContext()->WantTextInputNextFrame = 0;
}

// A folder's list, to choose a file for a command from.

constexpr float kDialogWidth = 600, kDialogHeight = 380;

// A name that is refused can be mended.
void run_with_file(Controls& controls) {
  const FileDialog dialog = *controls.dialog;
  const Requests before = controls.requests;
  controls.dialog.reset();
  controls.folder = dialog.folder.string();
  attempt(controls, dialog.command + " " + dialog.file());
  if (controls.requests == before) controls.dialog = dialog;
}

// The request of a click on the list.
struct Choice {
  std::string folder;  // to be entered
  bool done = false;
};

Choice draw_entries(FileDialog& dialog) {
  Choice choice;
  ImGui::BeginChild("entries", {0, -2.9f * ImGui::GetFrameHeightWithSpacing()});
  for (const FolderEntry& entry : dialog.entries) {
    ImGui::PushID(&entry);
    const bool clicked = ImGui::Selectable("##entry", entry.name == dialog.name, ImGuiSelectableFlags_AllowDoubleClick);
    ImGui::SameLine(6);
    ImGui::TextUnformatted((entry.is_folder ? entry.name + "/" : entry.name).c_str());
    if (clicked && entry.is_folder) choice.folder = entry.name;
    if (clicked && !entry.is_folder) {
      dialog.name = entry.name;
      choice.done = ImGui::IsMouseDoubleClicked(0);
    }
    ImGui::PopID();
  }
  ImGui::EndChild();
  return choice;
}

// A line to type a command into, and the commands that are like what was typed.

constexpr float kPromptWidth = 520;
constexpr int kMostHints = 8;

// Draws the help of the command that is typed, or of those whose names contain it.
void draw_hints(std::string& text) {
  const std::string name = text.substr(0, text.find(' '));
  const Command* typed = find_command(name);
  int count = 0;
  for (const Command& command : commands()) {
    const bool matches = typed && text.find(' ') != std::string::npos
                             ? &command == typed
                             : std::string(command.name).find(name) != std::string::npos;
    if (!matches || ++count > kMostHints) continue;
    ImGui::PushID(command.name);
    if (ImGui::Selectable("##take", false, ImGuiSelectableFlags_DontClosePopups))
      text = std::string(command.name) + " ";
    ImGui::SameLine(14);
    ImGui::Text("%s", command.name);
    // Words of an argument may be many: the help has a line of its own where they reach it.
    const std::string head = std::string(command.name) + " " + command.argument;
    ImGui::SameLine();
    ImGui::TextDisabled("%s", command.argument);
    if (ImGui::CalcTextSize(head.c_str()).x < 0.4f * kPromptWidth) {
      ImGui::SameLine(0.45f * kPromptWidth);
    } else {
      ImGui::Indent(0.08f * kPromptWidth);
    }
    ImGui::TextDisabled("%s", command.help);
    if (ImGui::CalcTextSize(head.c_str()).x >= 0.4f * kPromptWidth) ImGui::Unindent(0.08f * kPromptWidth);
    ImGui::PopID();
  }
}

}  // namespace

void draw_menu_bar(const Snapshot& snapshot, Controls& controls) {
  if (!ImGui::BeginMainMenuBar()) return;
  for (const char* menu : kMenus) {
    if (!ImGui::BeginMenu(menu)) continue;
    for (const Command& command : commands()) {
      if (std::string(menu) == command.menu) draw_item(command, controls);
    }
    if (ImGui::IsKeyPressed(ImGui::GetKeyIndex(ImGuiKey_Escape))) ImGui::CloseCurrentPopup();
    ImGui::EndMenu();
  }
  draw_title(snapshot);
  ImGui::EndMainMenuBar();
}

void draw_file_dialog(Controls& controls, const PanelLayout& layout) {
  FileDialog& dialog = *controls.dialog;
  ImGui::SetNextWindowPos({0.5f * layout.width, 0.5f * layout.height}, ImGuiCond_Always, {0.5f, 0.5f});
  ImGui::SetNextWindowSize({std::max(80.0f, std::min(kDialogWidth, layout.width - 16)),
                            std::max(80.0f, std::min(kDialogHeight, layout.height - 16))});
  ImGui::Begin("File", nullptr, kOverWindow);
  const Command& command = *find_command(dialog.command);
  ImGui::Text("%s", label_of(command).c_str());
  ImGui::SameLine();
  ImGui::TextDisabled("%s", dialog.folder.string().c_str());
  const Choice choice = draw_entries(dialog);
  ImGui::TextDisabled("%s: %s", command.argument, command.help);
  if (ImGui::IsWindowAppearing()) ImGui::SetKeyboardFocusHere();
  ImGui::SetNextItemWidth(-1);
  const bool begins = ImGui::GetActiveID() != ImGui::GetID("##name");
  if (const std::string early = begins ? early_letters() : ""; !early.empty()) {
    dialog.name = dialog.is_typed ? dialog.name + early : early;  // in place of what was proposed
    dialog.is_typed = true;
  }
  const bool hears = !begins || !dialog.is_typed;
  bool done = draw_field("##name", command.argument, dialog.name, hears, controls) || choice.done;
  const float width = share_of_line(2);
  ImGui::BeginDisabled(dialog.name.empty());
  done |= ImGui::Button(dialog.replaces() && writes_file(dialog.command) ? "Replace" : label_of(command).c_str(),
                        {width, 0});
  ImGui::EndDisabled();
  ImGui::SameLine();
  const bool left = ImGui::Button("Cancel", {width, 0}) || ImGui::IsKeyPressed(ImGui::GetKeyIndex(ImGuiKey_Escape));
  ImGui::End();
  if (left || done) stop_typing();
  if (left) {
    controls.quits_when_saved = false;
    return controls.dialog.reset();
  }
  if (!choice.folder.empty()) {
    controls.attempt([&] { dialog = browse_folder(dialog.command, dialog.folder / choice.folder, dialog.name); });
  } else if (done && !dialog.name.empty()) {
    run_with_file(controls);
  }
}

void draw_question(Controls& controls, const PanelLayout& layout) {
  ImGui::SetNextWindowPos({0.5f * layout.width, 0.4f * layout.height}, ImGuiCond_Always, {0.5f, 0.5f});
  ImGui::SetNextWindowSize({std::max(80.0f, std::min(430.0f, layout.width - 16)), 0});
  ImGui::Begin("Question", nullptr, kOverWindow);
  const bool escapes = ImGui::IsKeyPressed(ImGui::GetKeyIndex(ImGuiKey_Escape));
  if (controls.asks_to_save) {
    ImGui::TextWrapped("Poses, keys, cameras or markers are in no session file yet.");
    const float width = share_of_line(3);
    if (ImGui::Button("Save", {width, 0})) {
      controls.asks_to_save = false;
      controls.quits_when_saved = true;
      attempt(controls, "save");
    }
    ImGui::SameLine();
    if (ImGui::Button("Do not save", {width, 0})) controls.requests.quit = true;
    ImGui::SameLine();
    if (ImGui::Button("Cancel", {width, 0}) || escapes) controls.asks_to_save = false;
  } else {
    ImGui::TextWrapped("A viewport ended before its work was saved: %s. Bring that back?",
                       controls.recoverable_what.c_str());
    const float width = share_of_line(3);
    if (ImGui::Button("Bring it back", {width, 0})) attempt(controls, "recover");
    ImGui::SameLine();
    if (ImGui::Button("Discard", {width, 0})) attempt(controls, "recover discard");
    ImGui::SameLine();
    if (ImGui::Button("Not now", {width, 0}) || escapes) controls.recoverable.clear();
  }
  ImGui::End();
}

void draw_prompt(Controls& controls, const PanelLayout& layout) {
  const float width = std::min(kPromptWidth, layout.width - 16);
  ImGui::SetNextWindowPos({0.5f * layout.right(), layout.menu + 24}, ImGuiCond_Always, {0.5f, 0});
  ImGui::SetNextWindowSize({std::max(80.0f, width), 0});
  ImGui::Begin("Prompt", nullptr, kOverWindow | ImGuiWindowFlags_NoScrollbar);
  const bool is_chosen_from = ImGui::IsPopupOpen("", ImGuiPopupFlags_AnyPopup);  // which the focus would close
  if (!is_chosen_from && !ImGui::IsAnyItemActive()) ImGui::SetKeyboardFocusHere();
  ImGui::SetNextItemWidth(-1);
  std::string& text = controls.typed.prompt;
  const bool hears = ImGui::GetActiveID() == ImGui::GetID("##command");
  if (!hears) text += early_letters();
  const bool entered = draw_field("##command", "a command, as: frame 12", text, hears, controls);
  const bool left = ImGui::IsItemDeactivated() && !entered && ImGui::IsKeyPressed(ImGui::GetKeyIndex(ImGuiKey_Escape));
  draw_hints(text);
  ImGui::End();
  if (entered && text.find_first_not_of(' ') != std::string::npos) attempt(controls, text);
  if (!entered && !left) return;
  controls.prompt = false;
  text.clear();
  stop_typing();
}

}  // namespace bodyopt::viewport
