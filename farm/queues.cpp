#include "farm/queues.h"

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <csignal>
#include <cstring>
#include <map>
#include <nlohmann/json.hpp>
#include <pugixml.hpp>
#include <set>
#include <sstream>
#include <tuple>

#include "base/json_file.h"
#include "runtime/core/atomic_file.h"
#include "runtime/core/error.h"
#include "runtime/core/file_kind.h"
#include "runtime/core/stopwatch.h"
#include "runtime/core/transformed.h"

extern char** environ;

namespace bodyopt::farm {
namespace {

constexpr std::size_t kMostOutput = 64 << 20;

namespace fs = std::filesystem;

constexpr char kJobsSchema[] = "bodyopt-jobs-1";
constexpr int kMostJobsOfAnArray = 1000;  // Slurm's MaxArraySize is 1001 unless it is set otherwise
constexpr double kPatience = 60;          // seconds for an answer of Slurm

constexpr char kTemplateVersion[] = "jobtemplate-2023-09";

fs::path jobs_file(const fs::path& folder) { return folder / "jobs.json"; }

std::string plain_name(const std::string& name) {
  std::string plain;
  for (const char c : name.substr(0, 60)) {
    plain += std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '-' || c == '.' ? c : '_';
  }
  return plain;
}

// '%' begins a field in the name of a log.
std::string log_pattern(const fs::path& folder) {
  std::string text;
  for (const char c : (folder / "logs").string()) text += c == '%' ? std::string("%%") : std::string(1, c);
  return text + "/%A_%a.log";
}

struct TaskGroup {
  int wave, block;
  bool is_chain;
  std::vector<int> indices;  // lane - block * kMostJobsOfAnArray
};

// Tasks of one wave, apart where later ones have to wait for only some of them, and where Slurm takes no more at once.
std::vector<TaskGroup> groups_of(const std::vector<const FarmTask*>& tasks, int join_wave) {
  std::set<int> chain_lanes;
  for (const FarmTask* task : tasks) {
    if (task->wave > 0 && task->wave != join_wave) chain_lanes.insert(task->lane);
  }
  std::map<std::tuple<int, bool, int>, std::vector<int>> groups;
  for (const FarmTask* task : tasks) {
    const bool is_chain = task->wave != join_wave && chain_lanes.contains(task->lane);
    const int block = task->lane / kMostJobsOfAnArray;
    groups[{task->wave, is_chain, block}].push_back(task->lane % kMostJobsOfAnArray);
  }
  std::vector<TaskGroup> list;
  for (const auto& [key, indices] : groups) {
    list.push_back({std::get<0>(key), std::get<2>(key), std::get<1>(key), indices});
  }
  return list;
}

std::vector<std::string> jobs_of(const fs::path& folder) {
  const fs::path path = jobs_file(folder);
  if (!fs::exists(path)) return {};
  const Json json = read_json(path, kJobsSchema);
  return transformed(JsonObject(json, path, "the top level").array("jobs"),
                     [&](const Json& job) { return job.get<std::string>(); });
}

std::string joined(const std::vector<std::string>& words, const char* separator) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : separator) + word;
  return text;
}

CommandResult ask_slurm(const std::vector<std::string>& words) {
  CommandResult result = run_command(words, kPatience);
  if (result.exit_code != 0) throw Error(ErrorKind::device, words.front(), " refused: ", result.output.substr(0, 2000));
  return result;
}

std::string printable(const std::string& name, std::size_t longest) {
  std::string text;
  for (const char c : name.substr(0, longest)) text += c >= ' ' && c < 127 && c != '{' && c != '}' ? c : '_';
  return text.empty() ? "show" : text;
}

std::string step_name(int wave) { return "wave " + std::to_string(wave); }

Json host_requirements(const TaskNeeds& needs) {
  if (needs.tasks_per_gpu > 1) {
    throw Error(ErrorKind::usage,
                "Open Job Description knows no shares of a GPU: ask for a whole one for each task (1), or for none");
  }
  Json amounts = Json::array({{{"name", "amount.worker.vcpu"}, {"min", needs.cpus}}});
  if (needs.tasks_per_gpu == 1) amounts.push_back({{"name", "amount.worker.gpu"}, {"min", 1}});
  return {{"amounts", amounts}};
}

Json step_of(int wave, const std::vector<int>& lanes, const TaskNeeds& needs) {
  Json step{{"name", step_name(wave)}};
  step["hostRequirements"] = host_requirements(needs);
  if (wave > 0) step["dependencies"] = Json::array({{{"dependsOn", step_name(wave - 1)}}});
  step["parameterSpace"]["taskParameterDefinitions"] =
      Json::array({{{"name", "Lane"}, {"type", "INT"}, {"range", number_ranges(lanes)}}});
  step["script"]["actions"]["onRun"] = {
      {"command", "{{Param.Program}}"},
      {"args",
       {"farm", "run", "{{Param.Plan}}", std::to_string(wave) + ".{{Task.Param.Lane}}", "--progress", "openjd"}},
      {"cancelation", {{"mode", "NOTIFY_THEN_TERMINATE"}, {"notifyPeriodInSeconds", 30}}}};
  return step;
}

constexpr std::size_t kMostLayers = 1000, kMostFrames = 100'000;
constexpr char kLayerRule[] = "there are no layers, or more than 1,000";
constexpr char kFrameToken[] = "#IFRAME#";  // the frame's number, in a command

bool is_name(const std::string& text) {
  return text.size() >= 3 && std::ranges::all_of(text, [](unsigned char c) {
           return c < 128 && (std::isalnum(c) != 0 || c == '_' || c == '.');
         });
}

// Spells a name as OpenCue takes it.
std::string cue_name(const std::string& text) {
  std::string name;
  for (const unsigned char c : text.substr(0, 60)) {
    name += c < 128 && std::isalnum(c) != 0 ? static_cast<char>(std::tolower(c)) : '_';
  }
  while (name.size() < 3) name += '_';
  return name;
}

std::string layer_name(int wave) { return "wave" + std::to_string(wave); }

void put(pugi::xml_node parent, const char* name, const std::string& text) {
  parent.append_child(name).text().set(text.c_str());
}

void add_layer(pugi::xml_node layers, int wave, const std::vector<int>& lanes, const std::string& command,
               const TaskNeeds& needs) {
  pugi::xml_node layer = layers.append_child("layer");
  layer.append_attribute("name") = layer_name(wave).c_str();
  layer.append_attribute("type") = "Render";
  put(layer, "cmd", command + " " + std::to_string(wave) + "." + kFrameToken);
  put(layer, "range", number_ranges(lanes));
  put(layer, "chunk", "1");
  put(layer, "cores", std::to_string(needs.cpus) + ".0");
  put(layer, "threadable", needs.cpus > 1 ? "True" : "False");
  if (needs.tasks_per_gpu == 1) put(layer, "gpus", "1");
  pugi::xml_node threads = layer.append_child("env").append_child("key");
  threads.append_attribute("name") = "OMP_NUM_THREADS";
  threads.text().set(needs.cpus);
}

void add_dependency(pugi::xml_node depends, const std::string& job, int wave, int on, const char* type) {
  pugi::xml_node depend = depends.append_child("depend");
  depend.append_attribute("type") = type;
  put(depend, "depjob", job);
  put(depend, "deplayer", layer_name(wave));
  put(depend, "onjob", job);
  put(depend, "onlayer", layer_name(on));
}

std::map<int, std::vector<int>> lanes_by_wave(const FarmPlan& plan) {
  std::map<int, std::vector<int>> waves;
  for (const FarmTask& task : plan.tasks) waves[task.wave].push_back(task.lane);
  return waves;
}

}  // namespace

CommandResult run_command(const std::vector<std::string>& words, double seconds) {
  const auto fail = [&](const auto&... what) { throw Error(ErrorKind::device, "'", words.front(), "' ", what...); };
  std::vector<char*> pointers;
  for (const std::string& word : words) pointers.push_back(const_cast<char*>(word.c_str()));
  pointers.push_back(nullptr);
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) fail("cannot be started: ", std::strerror(errno));
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, ends[1], STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&actions, ends[1], STDERR_FILENO);
  pid_t process = -1;
  const int failure = posix_spawnp(&process, pointers[0], &actions, nullptr, pointers.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  close(ends[1]);
  if (failure != 0) {
    close(ends[0]);
    fail("cannot be started: ", std::strerror(failure), " (is it installed?)");
  }
  CommandResult result;
  bool is_late = false;
  const Stopwatch watch;
  char buffer[65536];
  for (;;) {
    const double left = seconds - watch.seconds();
    pollfd ready{ends[0], POLLIN, 0};
    is_late = left <= 0 || poll(&ready, 1, static_cast<int>(1e3 * left) + 1) == 0;
    if (is_late || result.output.size() > kMostOutput) break;
    const ssize_t got = read(ends[0], buffer, sizeof(buffer));
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) break;
    result.output.append(buffer, static_cast<std::size_t>(got));
  }
  close(ends[0]);
  if (is_late) kill(process, SIGKILL);
  int status = 0;
  while (waitpid(process, &status, 0) < 0 && errno == EINTR) {
  }
  if (is_late) fail("gave no answer in ", static_cast<int>(seconds), " s");
  result.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  return result;
}

std::string slurm_script(const std::string& program, const fs::path& folder) {
  return "#!/bin/sh\n# Written by 'bodyopt farm submit'. $1: the wave; $2: the lane of the array's first job.\n"
         "export OMP_NUM_THREADS=\"${SLURM_CPUS_PER_TASK:-1}\"\n"
         "exec " +
         quoted_for_shell(program) + " farm run " + quoted_for_shell(folder.string()) +
         " \"$1.$(($2 + SLURM_ARRAY_TASK_ID))\"\n";
}

std::vector<SlurmArray> slurm_arrays(const std::vector<const FarmTask*>& tasks, const std::string& show, bool joins,
                                     const fs::path& folder, const SlurmOptions& options) {
  const int join_wave = joins && !tasks.empty() ? tasks.back()->wave : -1;
  const std::vector<TaskGroup> groups = groups_of(tasks, join_wave);
  std::vector<SlurmArray> arrays;
  for (const TaskGroup& group : groups) {
    SlurmArray array;
    array.words = {"sbatch",
                   "--parsable",
                   "--job-name=bodyopt-" + plain_name(show),
                   "--array=" + number_ranges(group.indices),
                   "--cpus-per-task=" + std::to_string(options.needs.cpus),
                   "--output=" + log_pattern(folder),
                   "--requeue",
                   "--signal=B:TERM@30"};
    if (options.needs.tasks_per_gpu == 1) array.words.push_back("--gres=gpu:1");
    if (options.needs.tasks_per_gpu > 1) array.words.push_back("--gres=shard:1");
    array.words.insert(array.words.end(), options.sbatch.begin(), options.sbatch.end());
    for (std::size_t k = 0; k < arrays.size(); ++k) {
      const bool is_before = group.wave == join_wave ? groups[k].wave < group.wave
                                                     : groups[k].is_chain && groups[k].wave + 1 == group.wave;
      if (is_before) array.after.push_back(k);
    }
    // A task itself finds what has failed before it, and names it.
    if (!array.after.empty()) array.words.push_back("--dependency=afterany:{before}");
    for (const std::string& word : {(folder / "task.sh").string(), std::to_string(group.wave),
                                    std::to_string(group.block * kMostJobsOfAnArray)}) {
      array.words.push_back(word);
    }
    arrays.push_back(std::move(array));
  }
  return arrays;
}

std::vector<std::string> submit_to_slurm(const std::vector<const FarmTask*>& tasks, const FarmPlan& plan,
                                         const fs::path& folder, const std::string& program,
                                         const SlurmOptions& options) {
  const RunLock lock(folder / ".submit.lock", "submitting this plan");
  if (!jobs_in_queue(folder).empty()) {
    throw Error(ErrorKind::usage, folder,
                ": its jobs are in the queue already: 'bodyopt farm status' tells of "
                "them, 'bodyopt farm cancel' takes them out");
  }
  if (folder.string().find('\\') != std::string::npos) {
    throw Error(ErrorKind::usage, folder, ": Slurm does not write logs into folders with '\\' in their name");
  }
  fs::create_directories(folder / "logs");
  write_file_atomically(folder / "task.sh", slurm_script(program, folder));
  chmod((folder / "task.sh").c_str(), 0755);
  std::vector<std::string> jobs;
  for (SlurmArray& array : slurm_arrays(tasks, plan.show, plan.joins, folder, options)) {
    const std::vector<std::string> before = transformed(array.after, [&](const std::size_t k) { return jobs[k]; });
    for (std::string& word : array.words) {
      if (word == "--dependency=afterany:{before}") word = "--dependency=afterany:" + joined(before, ":");
    }
    const std::string answer = ask_slurm(array.words).output;
    jobs.push_back(answer.substr(0, answer.find_first_of(";\n")));
    write_json({{"schema", kJobsSchema}, {"jobs", jobs}}, jobs_file(folder));
  }
  return jobs;
}

std::map<std::string, int> jobs_in_queue(const fs::path& folder) {
  const std::vector<std::string> jobs = jobs_of(folder);
  if (jobs.empty()) return {};
  // Jobs that are long gone are an error to squeue; those of this user are not.
  std::istringstream lines(ask_slurm({"squeue", "--me", "--noheader", "--array", "--format=%F %T"}).output);
  std::map<std::string, int> states;
  for (std::string job, state; lines >> job >> state;) {
    if (std::ranges::find(jobs, job) != jobs.end()) ++states[state];
  }
  return states;
}

std::size_t cancel_in_slurm(const fs::path& folder) {
  const std::vector<std::string> jobs = jobs_of(folder);
  if (jobs.empty()) return 0;
  std::vector<std::string> words{"scancel", "--quiet"};
  words.insert(words.end(), jobs.begin(), jobs.end());
  ask_slurm(words);
  return jobs.size();
}

Json openjd_template(const FarmPlan& plan, const std::filesystem::path& folder, const std::string& program,
                     const TaskNeeds& needs) {
  Json steps = Json::array();
  for (const auto& [wave, lanes] : lanes_by_wave(plan)) steps.push_back(step_of(wave, lanes, needs));
  return {{"specificationVersion", kTemplateVersion},
          {"name", "bodyopt " + printable(plan.show, 100)},
          {"parameterDefinitions",
           {{{"name", "Plan"},
             {"type", "PATH"},
             {"objectType", "DIRECTORY"},
             {"dataFlow", "INOUT"},
             {"default", folder.string()}},
            {{"name", "Program"}, {"type", "STRING"}, {"default", program}}}},
          {"steps", steps}};
}

std::string opencue_job(const FarmPlan& plan, const std::filesystem::path& folder, const std::string& program,
                        const std::string& user, const TaskNeeds& needs) {
  if (needs.tasks_per_gpu > 1) {
    throw Error(ErrorKind::usage,
                "OpenCue knows shares of a GPU by their memory alone: ask for a whole one for each "
                "task (1), or for none");
  }
  const std::map<int, std::vector<int>> waves = lanes_by_wave(plan);
  const std::string job_name = "bodyopt_" + cue_name(plan.show);
  pugi::xml_document document;
  document.append_child(pugi::node_doctype)
      .set_value("spec PUBLIC \"SPI Cue  Specification Language\" \"http://localhost:8080/spcue/dtd/cjsl-1.13.dtd\"");
  pugi::xml_node spec = document.append_child("spec");
  put(spec, "show", cue_name(plan.show));
  put(spec, "shot", "farm");
  put(spec, "user", user);
  pugi::xml_node job = spec.append_child("job");
  job.append_attribute("name") = job_name.c_str();
  put(job, "paused", "False");
  pugi::xml_node layers = job.append_child("layers"), depends = spec.append_child("depends");
  const std::string command = quoted_for_shell(program) + " farm run " + quoted_for_shell(folder.string());
  const int join_wave = plan.joins ? plan.wave_count() - 1 : -1;
  for (const auto& [wave, lanes] : waves) {
    add_layer(layers, wave, lanes, command, needs);
    if (wave == join_wave) {
      for (int before = 0; before < wave; ++before) {
        add_dependency(depends, job_name, wave, before, "LAYER_ON_LAYER");
      }
    } else if (wave > 0) {
      add_dependency(depends, job_name, wave, wave - 1, "FRAME_BY_FRAME");
    }
  }
  std::ostringstream text;
  document.save(text, "  ");
  return text.str();
}

std::string opencue_problem(const FarmPlan& plan, const std::filesystem::path& folder, const std::string& program,
                            const std::string& user) {
  if (!is_name(user)) return "'" + user + "' is no name of a user: 3 or more letters, digits, '.' and '_'";
  if (user == "root") return "no job may be root's";
  const std::size_t layers = lanes_by_wave(plan).size();
  if (layers == 0) return kLayerRule;
  const std::string first = layer_name(plan.tasks.front().wave), words = program + folder.string();
  if (words.find('#') != std::string::npos) {
    return first + "'s command does not hold #IFRAME# once and no other '#', which OpenCue would replace";
  }
  if (std::ranges::any_of(words, [](unsigned char c) { return c < ' ' || c == 127; })) {
    return first + "'s command holds a control character";
  }
  if (layers > kMostLayers) return kLayerRule;
  return plan.tasks.size() > kMostFrames ? "there are more than 100,000 frames" : "";
}

void require_replaceable_openjd(const fs::path& file) {
  require_replaceable_json(file, "specificationVersion", kTemplateVersion, "a job template");
}

void require_replaceable_opencue(const fs::path& file) {
  if (!fs::is_regular_file(file)) return;
  pugi::xml_document document;
  if (document.load_file(file.c_str()) && document.child("spec").child("job")) return;
  throw Error(ErrorKind::file, file,
              ": is there already, and a job of OpenCue would take its place: expected one, with ", "<spec> and <job>",
              looks_like(file), ": give another name, or remove it");
}

}  // namespace bodyopt::farm
