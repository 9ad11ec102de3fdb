// A plan as a job of OpenCue: the job specification (cjsl 1.13) that its cuebot takes, with commands for RQD's shell.
#pragma once

#include <filesystem>
#include <string>

#include "farm/plan.h"

namespace bodyopt {

// The specification as XML: a layer per wave, a frame of it per task. A task whose jiggle goes on from that of another
// waits for that one alone (FRAME_BY_FRAME), what joins for all. Nothing in the names of folder and program has a
// meaning to the shell. Throws Error(usage) for a share of a GPU, which OpenCue has no number for.
std::string opencue_job(const FarmPlan& plan, const std::filesystem::path& folder, const std::string& program,
                        const std::string& user, const TaskNeeds& needs);

// Which of OpenCue's rules a plan, the names in its command or a user break, in a sentence; empty: none. A user has a
// name of 3 or more letters, digits, '.' and '_', and is not root; there are 1 to 1,000 layers and at most 100,000
// frames; a command holds no other '#' than that of #IFRAME#, and no control characters.
std::string opencue_problem(const FarmPlan& plan, const std::filesystem::path& folder, const std::string& program,
                            const std::string& user);

}  // namespace bodyopt
