// A plan as a job of OpenCue: the job specification (cjsl 1.13) that its cuebot takes, with commands for RQD's shell.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "farm/job_text.h"
#include "farm/plan.h"

namespace bodyopt {

// The specification as XML: a layer per wave, a frame of it per task. A task whose jiggle goes on from that of another
// waits for that one alone (FRAME_BY_FRAME), what joins for all. Nothing in the names of folder and program has a
// meaning to the shell. Throws Error(usage) for a share of a GPU, which OpenCue has no number for.
std::string opencue_job(const FarmPlan& plan, const std::filesystem::path& folder, const std::string& program,
                        const std::string& user, const TaskNeeds& needs);

// What of the rules below a job breaks, a sentence each; of OpenCue's these are the ones that a generated job could
// break. Elements in the order of the DTD; names of 3 or more letters, digits, '.' and '_', in layers each once; a user
// that is not root; 1 to 1,000 layers and at most 100,000 frames; ranges as "1-5,7"; cores with a decimal point
// (without, they are hundredths); a command that holds #IFRAME# once and no other '#', and no control characters;
// dependencies between two layers of the job.
std::vector<std::string> check_opencue(const std::string& xml);

}  // namespace bodyopt
