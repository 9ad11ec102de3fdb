// A plan as a job of Open Job Description (specification 2023-09), which AWS Deadline Cloud and its open worker run.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "assets/json_file.h"
#include "farm/job_text.h"
#include "farm/plan.h"

namespace bodyopt {

// The job template: a step per wave, a task per task, on hosts that have what a task needs. The plan's folder and the
// program are parameters of the job. Throws Error(usage) for a share of a GPU, which Open Job Description has no word
// for.
Json openjd_template(const FarmPlan& plan, const std::filesystem::path& folder, const std::string& program,
                     const TaskNeeds& needs);

// What of the rules below a template breaks, a sentence each; of the specification these are the ones that a generated
// template could break. Version "jobtemplate-2023-09"; only known keys; names of 1 to 128 (steps: 64) characters
// without control characters, of steps and parameters each once; 1 or more steps; dependencies on other steps that
// exist; task parameters INT with a range of 1 or more numbers, as "1-5" and commas, without ':' (there it is a step);
// a command, and fields "{{...}}" that name a parameter of the template; amounts of hosts that the specification names,
// above 0.
std::vector<std::string> check_openjd(const Json& job);

}  // namespace bodyopt
