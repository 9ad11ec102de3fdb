#include "proxy_viewer/platform/key_names.h"

#include <GLFW/glfw3.h>
#include <imgui.h>

#include <algorithm>
#include <cctype>
#include <iterator>
#include <string_view>

namespace bodyopt {
namespace {

struct Named {
  int key;
  const char* name;
  ImGuiKey imgui;
};
constexpr Named kNamed[] = {{GLFW_KEY_SPACE, "Space", ImGuiKey_Space},
                            {GLFW_KEY_LEFT, "Left", ImGuiKey_LeftArrow},
                            {GLFW_KEY_RIGHT, "Right", ImGuiKey_RightArrow},
                            {GLFW_KEY_UP, "Up", ImGuiKey_UpArrow},
                            {GLFW_KEY_DOWN, "Down", ImGuiKey_DownArrow},
                            {GLFW_KEY_HOME, "Home", ImGuiKey_Home},
                            {GLFW_KEY_END, "End", ImGuiKey_End},
                            {GLFW_KEY_TAB, "Tab", ImGuiKey_Tab},
                            {GLFW_KEY_ESCAPE, "Escape", ImGuiKey_Escape},
                            {GLFW_KEY_ENTER, "Enter", ImGuiKey_Enter},
                            {GLFW_KEY_DELETE, "Delete", ImGuiKey_Delete},
                            {GLFW_KEY_PAGE_UP, "PageUp", ImGuiKey_PageUp},
                            {GLFW_KEY_PAGE_DOWN, "PageDown", ImGuiKey_PageDown},
                            {GLFW_KEY_BACKSPACE, "Backspace", ImGuiKey_Backspace},
                            {GLFW_KEY_INSERT, "Insert", ImGuiKey_Insert},
                            {GLFW_KEY_KP_ENTER, "Enter", ImGuiKey_Enter}};
constexpr std::string_view kOfTextFields = "ACVXYZ";  // copy, paste and the like, as ImGuiKey has them

bool is_ascii(const std::string& text) {
  return std::ranges::all_of(text, [](char c) { return static_cast<unsigned char>(c) < 128; });
}

std::string name_of_key(int key, const std::string& printed) {
  const auto* const named = std::ranges::find(kNamed, key, &Named::key);
  if (named != std::end(kNamed)) return named->name;
  if (GLFW_KEY_F1 <= key && key <= GLFW_KEY_F25) return "F" + std::to_string(key - GLFW_KEY_F1 + 1);
  if (GLFW_KEY_KP_0 <= key && key <= GLFW_KEY_KP_9) return std::to_string(key - GLFW_KEY_KP_0);
  const bool is_digit = GLFW_KEY_0 <= key && key <= GLFW_KEY_9, is_letter = GLFW_KEY_A <= key && key <= GLFW_KEY_Z;
  if (is_digit || (is_letter && !is_ascii(printed))) return std::string(1, static_cast<char>(key));  // is ASCII
  std::string name = printed;
  if (name.size() == 1) name[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(name[0])));
  return name;
}

}  // namespace

std::string bare_key(const std::string& name) { return name.substr(name.rfind('+') + 1); }

std::string key_name(int key, const std::string& printed, int modifiers) {
  const std::string name = name_of_key(key, printed);
  if (name.empty()) return {};
  std::string prefix;
  if (modifiers & GLFW_MOD_CONTROL) prefix += "Ctrl+";
  if (modifiers & GLFW_MOD_ALT) prefix += "Alt+";
  if (modifiers & GLFW_MOD_SHIFT) prefix += "Shift+";
  return prefix + name;
}

std::optional<int> imgui_key(const std::string& name) {
  const auto* const named = std::ranges::find(kNamed, name, &Named::name);
  if (named != std::end(kNamed)) return named->imgui;
  const std::size_t letter = name.size() == 1 ? kOfTextFields.find(name) : std::string_view::npos;
  return letter < kOfTextFields.size() ? std::optional(ImGuiKey_A + static_cast<int>(letter)) : std::nullopt;
}

}  // namespace bodyopt
