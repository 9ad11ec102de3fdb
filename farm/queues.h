// A plan as a job of a queue: Slurm, Open Job Description or OpenCue.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "base/json_file.h"
#include "farm/plan.h"

namespace bodyopt::farm {

struct CommandResult {
  int exit_code = -1;  // 128 + n: ended by signal n
  std::string output;  // standard output and error
};

// Runs without a shell: nothing in an argument has a meaning. Waits for the program `words[0]`, found on the PATH; ends
// it after so many seconds. Throws Error(device) where it cannot be started, and where it took too long.
CommandResult run_command(const std::vector<std::string>& words, double seconds);

// A plan on Slurm: an array of jobs per wave.
struct SlurmOptions {
  TaskNeeds needs{};                // a share of a GPU is a shard of one (gres/shard)
  std::vector<std::string> sbatch;  // further options of sbatch, as they are
};

// The command lines of sbatch, one per array, in order. The jobs that an array has to wait for, by number, joined by
// ":", take the place of "{before}". Each array is of tasks of one wave. `script`: what an array's job runs.
struct SlurmArray {
  std::vector<std::string> words;
  std::vector<std::size_t> after;  // arrays before it; empty: it need not wait
};
std::vector<SlurmArray> slurm_arrays(const std::vector<const FarmTask*>& tasks, const std::string& show, bool joins,
                                     const std::filesystem::path& folder, const SlurmOptions& options);

// The script: `program` runs the task of an array's job.
std::string slurm_script(const std::string& program, const std::filesystem::path& folder);

// Submits the tasks; the numbers of their jobs are kept in jobs.json in the plan's folder. Throws Error(device) where
// Slurm refuses, Error(usage) where jobs of the plan are in the queue already.
std::vector<std::string> submit_to_slurm(const std::vector<const FarmTask*>& tasks, const FarmPlan& plan,
                                         const std::filesystem::path& folder, const std::string& program,
                                         const SlurmOptions& options);

// Jobs of the plan that wait or run, by what squeue calls their state. Throws Error(device) without an answer.
std::map<std::string, int> jobs_in_queue(const std::filesystem::path& folder);
// Takes the jobs of the plan out of the queue; what runs gets a SIGTERM first and leaves a checkpoint. Returns how many
// arrays there were.
std::size_t cancel_in_slurm(const std::filesystem::path& folder);

// A plan as a job of Open Job Description (specification 2023-09), which AWS Deadline Cloud and its open worker run.

// The job template: a step per wave, a task per task, on hosts that have what a task needs. The plan's folder and the
// program are parameters of the job. Throws Error(usage) for a share of a GPU, which it has no word for.
Json openjd_template(const FarmPlan& plan, const std::filesystem::path& folder, const std::string& program,
                     const TaskNeeds& needs);

// Throws Error(file) where a file of that name is there that is no job template.
void require_replaceable_openjd(const std::filesystem::path& file);

// A plan as a job of OpenCue: the job specification (cjsl 1.13) that its cuebot takes, with commands for RQD's shell.

// The specification as XML: a layer per wave, a frame of it per task. A task whose jiggle goes on from that of another
// waits for that one alone (FRAME_BY_FRAME), what joins for all. Nothing in the names of folder and program has a
// meaning to the shell. Throws Error(usage) for a share of a GPU, which OpenCue has no number for.
std::string opencue_job(const FarmPlan& plan, const std::filesystem::path& folder, const std::string& program,
                        const std::string& user, const TaskNeeds& needs);

// Names the rule of OpenCue that a plan, the names in its command or a user break, in a sentence; empty: none. A user
// has a name of 3 or more letters, digits, '.' and '_', and is not root. There are 1 to 1,000 layers and at most
// 100,000 frames. A command holds no other '#' than that of #IFRAME#, and no control characters.
std::string opencue_problem(const FarmPlan& plan, const std::filesystem::path& folder, const std::string& program,
                            const std::string& user);

// Throws Error(file) where a file of that name is there that is no job of OpenCue.
void require_replaceable_opencue(const std::filesystem::path& file);

}  // namespace bodyopt::farm
