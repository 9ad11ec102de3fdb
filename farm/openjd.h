// A plan as a job of Open Job Description (specification 2023-09), which AWS Deadline Cloud and its open worker run.
#pragma once

#include <filesystem>
#include <string>

#include "assets/json_file.h"
#include "farm/plan.h"

namespace bodyopt {

// The job template: a step per wave, a task per task, on hosts that have what a task needs. The plan's folder and the
// program are parameters of the job. Throws Error(usage) for a share of a GPU, which Open Job Description has no word
// for.
Json openjd_template(const FarmPlan& plan, const std::filesystem::path& folder, const std::string& program,
                     const TaskNeeds& needs);

}  // namespace bodyopt
