// The verb of the viewport, or what says that there is none.
#pragma once

#include <CLI/CLI.hpp>

namespace bodyopt::cli {

void add_view(CLI::App& app);

}  // namespace bodyopt::cli
