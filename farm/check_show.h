// Do the elements of a show exist, fit each other, and write different files?
#pragma once

#include <string>
#include <vector>

#include "farm/show_list.h"

namespace bodyopt {

// What planning has to know of an element.
struct CheckedElement {
  const ShowElement* element = nullptr;
  std::vector<int> frames;
  double frame_ms = 0;                // on one core
  std::vector<std::string> attached;  // names of the meshes that ride on the skin
};

// Those that are sound. What is wrong with the others goes to `problems`, a sentence each. Every file is read once.
std::vector<CheckedElement> check_show(const ShowList& list, std::vector<std::string>& problems);

}  // namespace bodyopt
