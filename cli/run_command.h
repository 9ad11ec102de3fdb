// The verbs of the `bodyopt` program, as functions of this process.
#pragma once

#include <string>
#include <vector>

#include "farm/plan.h"

namespace bodyopt::cli {

// Precedes the first verb. Messages go to standard error; the first interrupt ends a verb soon, the second at once.
// Files over their limit are errors. As many files may be open as the system allows, and OMP_NUM_THREADS limits
// threads.
void prepare_process();

// Runs `bodyopt` with these arguments, which begin with the verb, and returns its exit code. It may be called again.
int run_command(const std::vector<std::string>& arguments);

// Outputs of a show's list, made in this process one after the other.

// A step of a plan, from its words after the verb. `progress`: as of eval. Throw Error(usage) where they cannot be
// read, and as the verbs do.
void eval_step(const farm::FarmStep& step, const std::string& progress);
void join_step(const farm::FarmStep& step, const std::string& progress);

// If one fails, the others are made all the same. Throws Error of the kind that the last failure had, and
// Error(interrupted) at once.
void run_steps(const std::vector<const farm::FarmStep*>& steps, const std::string& progress);

// Checks the list as a whole and makes all its outputs that are not made yet. Throws Error(usage) where something is
// wrong with it, before anything is made, and as run_steps().
void run_show_list(const std::string& list, const std::string& progress);

}  // namespace bodyopt::cli
