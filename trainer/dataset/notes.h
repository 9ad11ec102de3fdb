// Wording shared by the notes and messages of the readers.
#pragma once

#include <cstddef>
#include <span>
#include <string>

namespace bodyopt {

// "'a', 'b', 'c'", cut after `shown` with the count of the rest; "none" for nothing.
std::string list_names(std::span<const std::string> names, std::size_t shown = 12);

// "1 vertex", "3 vertices".
std::string count_of(std::size_t count, const std::string& one, const std::string& many);

}  // namespace bodyopt
