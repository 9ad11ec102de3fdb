// bodyopt farm: a show's list of shots to tasks of a queue, and what became of them.
#include <pwd.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <algorithm>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>

#include "base/written_over.h"
#include "cli/arguments/common.h"
#include "cli/arguments/shot_arguments.h"
#include "cli/results/pages.h"
#include "cli/run_command.h"
#include "farm/plan.h"
#include "farm/queues.h"
#include "farm/task_run.h"
#include "runtime/core/atomic_file.h"
#include "runtime/core/error.h"
#include "runtime/host/stages.h"

namespace bodyopt::cli {
namespace {

namespace fs = std::filesystem;

struct FarmArguments {
  std::string list, plan, out, openjd, opencue;
  double minutes = 5;
  int worst = 12;
  bool verify = false, slurm = false, hopeless = false;
  std::vector<std::string> tasks;
  farm::SlurmOptions queue;
  TaskArguments task;
  JsonOption json;
};

fs::path plan_folder(const FarmArguments& arguments) { return fs::absolute(arguments.plan).lexically_normal(); }

void plan(const FarmArguments& arguments) {
  std::vector<std::string> problems;
  const farm::ShowList list = farm::read_show_list(arguments.list, problems);
  say(list.notes);
  const farm::FarmPlan plan = farm::plan_show(list, arguments.minutes, problems);
  for (const std::string& problem : problems) spdlog::error("{}", problem);
  if (!problems.empty()) {
    throw Error(ErrorKind::usage, format("{}: {} problems; nothing is planned", arguments.list, problems.size()));
  }
  say(plan.notes);
  make_folder(arguments.out);
  farm::write_plan(plan, fs::absolute(arguments.out));
  double seconds = 0;
  std::size_t frames = 0;
  for (const farm::FarmTask& task : plan.tasks) {
    for (const farm::FarmStep& step : task.steps) {
      seconds += step.seconds;
      frames += step.frames;
    }
  }
  arguments.json.emit({{"plan", arguments.out},
                       {"elements", list.elements.size()},
                       {"frames", frames},
                       {"tasks", plan.tasks.size()},
                       {"waves", plan.wave_count()},
                       {"core_hours", seconds / 3600}},
                      format("{} elements, {} frames: {} tasks in {} waves, about {:.2f} core hours\nwrote {}\n",
                             list.elements.size(), frames, plan.tasks.size(), plan.wave_count(), seconds / 3600,
                             (fs::path(arguments.out) / "plan.json").string()));
}

void run_tasks(const FarmArguments& arguments) {
  const farm::FarmPlan plan = farm::read_plan(plan_folder(arguments));
  std::vector<const farm::FarmTask*> tasks;
  for (const farm::FarmTask& task : plan.tasks) {
    if (arguments.tasks.empty() || std::ranges::find(arguments.tasks, task.name()) != arguments.tasks.end()) {
      tasks.push_back(&task);
    }
  }
  if (tasks.size() < arguments.tasks.size()) {
    throw Error(ErrorKind::usage, arguments.plan, ": has no task '", arguments.tasks.front(),
                "'; tasks are named WAVE.LANE, as in plan.json");
  }
  std::vector<const farm::FarmStep*> steps;
  for (const farm::FarmTask* task : tasks) {
    for (const farm::FarmStep& step : task->steps) steps.push_back(&step);
  }
  run_steps(steps, arguments.task.progress);
}

Json status_entry(const farm::StepStatus& status) {
  Json entry{{"shot", status.step->shot},
             {"element", status.step->element},
             {"out", status.step->out},
             {"state", farm::name_of(status.state)}};
  if (status.failure) {
    entry["message"] = status.failure->message;
    entry["exit_code"] = status.failure->exit_code;
    entry["host"] = status.failure->host;
    entry["retry_may_help"] = status.may_be_retried;
  }
  return entry;
}

// Jobs of the plan that are in the queue now; an empty object where it gives no answer.
Json queue_of(const FarmArguments& arguments) {
  try {
    return farm::jobs_in_queue(plan_folder(arguments));
  } catch (const Error& error) {
    spdlog::warn("the queue cannot be asked: {}", error.what());
    return Json::object();
  }
}

void status(const FarmArguments& arguments) {
  const farm::FarmPlan plan = farm::read_plan(plan_folder(arguments));
  std::map<std::string, int> counts;
  Json open = Json::array();
  std::string failures;
  for (const std::vector<farm::StepStatus>& task : farm::status_of(plan, BODYOPT_VERSION, arguments.verify)) {
    for (const farm::StepStatus& status : task) {
      if (status.step->is_delivered) ++counts[farm::name_of(status.state)];
      if (status.state == farm::StepState::done) continue;
      open.push_back(status_entry(status));
      if (status.failure) failures += status.failure->message + "\n";
    }
  }
  std::string text;
  for (const auto& [state, count] : counts) text += format("{:8} {:6}\n", state, count);
  const Json queue = queue_of(arguments);
  for (const auto& [state, count] : queue.items()) text += format("{:8} {:6} in the queue\n", state, count.get<int>());
  arguments.json.emit({{"elements", counts}, {"queue", queue}, {"open", open}}, text + failures);
}

// Tasks of which something is not done. `retry` reads all files, for one may have been damaged.
std::vector<const farm::FarmTask*> open_tasks(const farm::FarmPlan& plan, bool is_retry, bool hopeless) {
  const std::vector<std::vector<farm::StepStatus>> statuses = farm::status_of(plan, BODYOPT_VERSION, is_retry);
  std::vector<const farm::FarmTask*> tasks;
  for (std::size_t t = 0; t < plan.tasks.size(); ++t) {
    const bool is_open = std::ranges::any_of(statuses[t], [&](const farm::StepStatus& status) {
      return status.state != farm::StepState::done && (!is_retry || hopeless || status.may_be_retried);
    });
    if (is_open) tasks.push_back(&plan.tasks[t]);
  }
  return tasks;
}

void report(const FarmArguments& arguments) {
  arguments.json.require_writable();
  require_writable(arguments.out);
  const farm::FarmPlan plan = farm::read_plan(plan_folder(arguments));
  const farm::ShowSummary summary = farm::summarize_show(plan, farm::status_of(plan, BODYOPT_VERSION, arguments.verify),
                                                         static_cast<std::size_t>(arguments.worst));
  const std::string page = show_page(plan, summary);
  write_file_atomically(arguments.out, std::as_bytes(std::span(page)));
  std::string text;
  for (const farm::FramesToSimulate& next : summary.simulate_next) {
    text += "worth simulating next, for " + next.basis + ": " + simulate_options(next) + "\n";
  }
  arguments.json.emit(to_json(plan, summary), text + "wrote " + arguments.out + "\n");
}

// This program, under the name by which other machines find it, too.
std::string own_program() { return fs::read_symlink("/proc/self/exe").string(); }

void require_no_problem(const std::string& problem, const std::string& file) {
  if (!problem.empty()) throw Error(ErrorKind::usage, file, ": would break a rule: ", problem);
}

void write_openjd(const FarmArguments& arguments, const farm::FarmPlan& plan) {
  refuse_over("--openjd", arguments.openjd, {farm::plan_file(plan_folder(arguments))});
  farm::require_replaceable_openjd(arguments.openjd);
  const Json job = farm::openjd_template(plan, plan_folder(arguments), own_program(), arguments.queue.needs);
  require_no_problem(plan.tasks.empty() ? "there are no steps" : "", arguments.openjd);
  write_json(job, arguments.openjd);
  arguments.json.emit({{"template", arguments.openjd}}, "wrote " + arguments.openjd + "\n");
}

void write_opencue(const FarmArguments& arguments, const farm::FarmPlan& plan) {
  farm::require_replaceable_opencue(arguments.opencue);
  const passwd* const entry = getpwuid(geteuid());
  const std::string user = entry != nullptr ? entry->pw_name : "";
  const std::string job = farm::opencue_job(plan, plan_folder(arguments), own_program(), user, arguments.queue.needs);
  require_no_problem(farm::opencue_problem(plan, plan_folder(arguments), own_program(), user), arguments.opencue);
  write_file_atomically(arguments.opencue, std::as_bytes(std::span(job)));
  arguments.json.emit({{"job", arguments.opencue}}, "wrote " + arguments.opencue + "\n");
}

void submit(const FarmArguments& arguments, bool is_retry) {
  const farm::FarmPlan plan = farm::read_plan(plan_folder(arguments));
  if (!arguments.openjd.empty()) return write_openjd(arguments, plan);
  if (!arguments.opencue.empty()) return write_opencue(arguments, plan);
  if (!arguments.slurm) {
    throw Error(
        ErrorKind::usage,
        "to which queue? Say --slurm, --openjd FILE or --opencue FILE ('bodyopt farm run' does the tasks here)");
  }
  const std::vector<const farm::FarmTask*> tasks = open_tasks(plan, is_retry, arguments.hopeless);
  std::vector<std::string> jobs;
  if (!tasks.empty()) {
    jobs = farm::submit_to_slurm(tasks, plan, plan_folder(arguments), own_program(), arguments.queue);
  }
  arguments.json.emit({{"tasks", tasks.size()}, {"jobs", jobs}},
                      tasks.empty() ? "nothing is left to do\n"
                                    : format("submitted {} tasks in {} arrays\n", tasks.size(), jobs.size()));
}

void cancel(const FarmArguments& arguments) {
  const std::size_t jobs = farm::cancel_in_slurm(plan_folder(arguments));
  arguments.json.emit({{"jobs", jobs}}, format("cancelled {} arrays\n", jobs));
}

// All parts share `arguments`: a run of the program is of one part.
CLI::App& add_part(CLI::App& farm, const char* name, const char* description,
                   const std::shared_ptr<FarmArguments>& arguments,
                   const std::function<void(const FarmArguments&)>& run) {
  CLI::App& part = add_verb(farm, name, description);
  part.callback([=] { run(*arguments); });
  if (std::string(name) != "plan") {
    add_option(part, "plan", arguments->plan, "PLAN", "Folder that 'farm plan' wrote")->required();
  }
  arguments->json.add(part);
  return part;
}

void add_queue(CLI::App& part, FarmArguments& arguments) {
  add_flag(part, "--slurm", arguments.slurm, "Submit to Slurm, as arrays of jobs");
  add_number(part, "--cpus", arguments.queue.needs.cpus, 1, 1024, "Cores of a task");
  add_option(part, "--tasks-per-gpu", arguments.queue.needs.tasks_per_gpu,
             "Ask for a GPU for each task (1), or for a shard of one (more); default: none")
      ->check(CLI::Range(1, 64));
  add_option(part, "--sbatch", arguments.queue.sbatch, "A further option for sbatch, as --sbatch=--partition=short")
      ->type_name("OPTION");
}

}  // namespace

void add_farm(CLI::App& app) {
  auto arguments = std::make_shared<FarmArguments>();
  CLI::App& farm = add_verb(app, "farm", "Evaluate many shots, on a queue of machines");
  farm.require_subcommand(1);
  CLI::App& planning = add_part(farm, "plan", "Check a list of shots and cut it into tasks", arguments, plan);
  add_required(planning, "shots", arguments->list, "SHOTS", "List of shots (.json, .jsonl, .csv)");
  add_option(planning, "--out", arguments->out, "PLAN", "Folder to write the plan into")->required();
  add_number(planning, "--task-minutes", arguments->minutes, 1e-3, 1e5, "What a task should last, on one core");

  CLI::App& submitting = add_part(farm, "submit", "Give what is not done to a queue", arguments,
                                  [](const FarmArguments& given) { submit(given, false); });
  add_queue(submitting, *arguments);
  add_option(submitting, "--openjd", arguments->openjd, "FILE.json",
             "Instead, write a job template of Open Job Description, for AWS Deadline Cloud and others");
  add_option(submitting, "--opencue", arguments->opencue, "FILE.xml",
             "Instead, write a job of OpenCue, for its launchSpec");
  CLI::App& retrying = add_part(farm, "retry", "Read everything that is done, and submit what is not whole", arguments,
                                [](const FarmArguments& given) { submit(given, true); });
  add_queue(retrying, *arguments);
  add_flag(retrying, "--hopeless", arguments->hopeless,
           "Also what failed for reasons that running again does not change");

  CLI::App& telling = add_part(farm, "status", "What is done, failed, left", arguments, status);
  add_flag(telling, "--verify", arguments->verify, "Read all inputs and outputs, not only their size and time");
  CLI::App& reporting = add_part(farm, "report", "A page on what the show has come to", arguments, report);
  add_option(reporting, "--out", arguments->out, "FILE.html", "Page to write, self-contained")->required();
  add_number(reporting, "--worst", arguments->worst, 0, 100, "Frames worth a look, at most");
  add_flag(reporting, "--verify", arguments->verify, "Read all inputs and outputs, not only their size and time");
  add_part(farm, "cancel", "Take what is queued out of the queue", arguments, cancel);

  CLI::App& running = add_part(farm, "run", "Do tasks on this machine, one after the other", arguments, run_tasks);
  add_option(running, "tasks", arguments->tasks, "Names of tasks, WAVE.LANE (default: all)")->type_name("TASK...");
  add_option(running, "--progress", arguments->task.progress, "As of eval")->type_name("STYLE");
}

}  // namespace bodyopt::cli
