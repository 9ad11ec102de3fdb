// The verbs of the `bodyopt` program, as functions of this process.
#pragma once

#include <string>
#include <vector>

namespace bodyopt::cli {

// Before the first verb: messages go to standard error, the first interrupt ends a verb soon and the second at once, a
// file over its limit is an error, as many files may be open as the system allows, and no more threads work than
// OMP_NUM_THREADS says.
void prepare_process();

// What `bodyopt` does with these arguments, which begin with the verb, and the exit code. As often as one likes, one
// after the other.
int run_command(const std::vector<std::string>& arguments);

}  // namespace bodyopt::cli
