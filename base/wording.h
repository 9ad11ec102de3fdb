// Names, counts and numbers as messages word them.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace bodyopt {

// "'a', 'b', 'c'", cut after `shown` with the count of the rest; "none" for nothing.
std::string list_names(std::span<const std::string> names, std::size_t shown = 12);

// Adds the note "`what``names`.", where there are any.
void note_names(const std::string& what, std::span<const std::string> names, std::vector<std::string>& notes);

// The names of things.
template <typename Named>
std::vector<std::string> names_of(const Named& all) {
  std::vector<std::string> names;
  for (const auto& one : all) names.push_back(one.name);
  return names;
}

// "1 vertex", "3 vertices".
std::string count_of(std::size_t count, const std::string& one, const std::string& many);

// The ending that a name should have, of ".pc2|.usda|.glb", as people say it: ".pc2, .usda or .glb". Empty: it has one.
std::string missing_ending(const std::string& name, const std::string& endings);

// The value in four digits.
std::string rounded(double value);

// The three of `names` that take the fewest letters added, dropped or changed to become `wanted`, nearest first;
// capital and small letters are alike.
std::vector<std::string> nearest_names(std::span<const std::string> names, const std::string& wanted);

}  // namespace bodyopt
