#include "proxy_viewer/controls.h"

#include <iostream>

namespace bodyopt {

void Controls::warn(const std::string& text) {
  if (!messages.empty() && messages.back().text == text) return;  // of every picture: once is enough
  std::cerr << "warning: " << text << "\n";
  messages.push_back({.error = true, .text = text});
}

}  // namespace bodyopt
