#include "proxy_viewer/platform/key_names.h"

#include <GLFW/glfw3.h>

#include <algorithm>
#include <cctype>

namespace bodyopt {
namespace {

struct Named {
  int key;
  const char* name;
};
constexpr Named kNamed[] = {{GLFW_KEY_SPACE, "Space"},
                            {GLFW_KEY_LEFT, "Left"},
                            {GLFW_KEY_RIGHT, "Right"},
                            {GLFW_KEY_UP, "Up"},
                            {GLFW_KEY_DOWN, "Down"},
                            {GLFW_KEY_HOME, "Home"},
                            {GLFW_KEY_END, "End"},
                            {GLFW_KEY_TAB, "Tab"},
                            {GLFW_KEY_ESCAPE, "Escape"},
                            {GLFW_KEY_ENTER, "Enter"},
                            {GLFW_KEY_DELETE, "Delete"},
                            {GLFW_KEY_PAGE_UP, "PageUp"},
                            {GLFW_KEY_PAGE_DOWN, "PageDown"},
                            {GLFW_KEY_BACKSPACE, "Backspace"},
                            {GLFW_KEY_INSERT, "Insert"},
                            {GLFW_KEY_KP_ENTER, "Enter"}};

bool is_ascii(const std::string& text) {
  return std::all_of(text.begin(), text.end(), [](char c) { return static_cast<unsigned char>(c) < 128; });
}

std::string name_of_key(int key, const std::string& printed) {
  for (const Named& named : kNamed) {
    if (named.key == key) return named.name;
  }
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

}  // namespace bodyopt
