// Real characters and motion for tests, kept beside the checkout. What can do with a body of ours takes
// stand_in_human.h; the others are skipped without the files, and say why they need them.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "tests/support/paths.h"

namespace bodyopt {

// The path of a file of the shared data, or nothing when it is not there. BODYOPT_SHARED_DATA overrides the folder.
std::optional<std::filesystem::path> shared_data(const std::string& file);

inline constexpr const char *kNeedsOtherWriters =
                                "needs files that other programs wrote: the shared data, which is not here",
                            *kNeedsRealBodies =
                                "needs the proportions of real bodies: the shared data, which is not here",
                            *kNeedsRealMotion = "needs recorded motion: the shared data, which is not here",
                            *kNeedsReferences =
                                "needs what other programs computed: the shared data, which is not here";

}  // namespace bodyopt
