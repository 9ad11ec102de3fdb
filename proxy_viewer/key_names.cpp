#include "proxy_viewer/key_names.h"

#include <GLFW/glfw3.h>

#include <cctype>

namespace bodyopt {
namespace {

struct Named {
  int key;
  const char* name;
};
constexpr Named kNamed[] = {{GLFW_KEY_SPACE, "Space"},       {GLFW_KEY_LEFT, "Left"},
                            {GLFW_KEY_RIGHT, "Right"},       {GLFW_KEY_UP, "Up"},
                            {GLFW_KEY_DOWN, "Down"},         {GLFW_KEY_HOME, "Home"},
                            {GLFW_KEY_END, "End"},           {GLFW_KEY_TAB, "Tab"},
                            {GLFW_KEY_ESCAPE, "Escape"},     {GLFW_KEY_ENTER, "Enter"},
                            {GLFW_KEY_DELETE, "Delete"},     {GLFW_KEY_PAGE_UP, "PageUp"},
                            {GLFW_KEY_PAGE_DOWN, "PageDown"}};

std::string bare_name(int key, int scancode) {
  for (const Named& named : kNamed) {
    if (named.key == key) return named.name;
  }
  if (GLFW_KEY_F1 <= key && key <= GLFW_KEY_F25) return "F" + std::to_string(key - GLFW_KEY_F1 + 1);
  if (GLFW_KEY_KP_0 <= key && key <= GLFW_KEY_KP_9) return std::to_string(key - GLFW_KEY_KP_0);
  const char* printed = glfwGetKeyName(key, scancode);
  if (!printed) return {};
  std::string name = printed;
  if (name.size() == 1) name[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(name[0])));
  return name;
}

}  // namespace

std::string key_name(int key, int scancode, int modifiers) {
  const std::string name = bare_name(key, scancode);
  if (name.empty()) return {};
  std::string prefix;
  if (modifiers & GLFW_MOD_CONTROL) prefix += "Ctrl+";
  if (modifiers & GLFW_MOD_ALT) prefix += "Alt+";
  if (modifiers & GLFW_MOD_SHIFT) prefix += "Shift+";
  return prefix + name;
}

}  // namespace bodyopt
