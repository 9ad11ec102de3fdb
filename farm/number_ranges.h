// Whole numbers as queues take them.
#pragma once

#include <string>
#include <vector>

namespace bodyopt {

// Of rising numbers "0-5,7". Steps are not used: queues disagree on how they are written.
std::string number_ranges(const std::vector<int>& numbers);

}  // namespace bodyopt
