// Errors as exit codes.
#pragma once

#include <functional>

namespace bodyopt::cli {

// Runs it; says on standard error what went wrong, and returns the exit code that README lists for it.
int exit_code_of(const std::function<void()>& body);

}  // namespace bodyopt::cli
