#include "cli/run_command.h"

#include <fcntl.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>
#include <sys/resource.h>
#include <tbb/global_control.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <optional>
#include <sstream>

#include "base/progress.h"
#include "base/wording.h"
#include "cli/arguments/common.h"
#include "cli/view/view.h"
#include "runtime/core/error.h"

namespace bodyopt::cli {
namespace {

struct VerbGroup {
  const char* title;
  std::vector<void (*)(CLI::App&)> verbs;
};

// Lists `help` among the verbs: as_options() gives it its meaning.
void add_help(CLI::App& app) { app.add_subcommand("help", "Show what a verb does: help VERB is VERB --help"); }

void add_verbs(CLI::App& app) {
  const VerbGroup groups[] = {
      {"To begin with", {add_help, add_demo, add_info, add_check, add_devices}},
      {"A character's muscles and motion", {add_rig, add_muscles, add_anatomy, add_rom}},
      {"Shapes to learn from", {add_simulate, add_dataset, add_curate, add_export, add_picture}},
      {"Learning", {add_train, add_test, add_coverage, add_improve, add_regions}},
      {"What goes with a trained character", {add_proxy, add_dynamics, add_attach, add_transfer, add_modifiers}},
      {"Using it", {add_eval, add_join, add_view, add_compare, add_bench, add_farm}},
  };
  std::size_t grouped = 0;
  for (const VerbGroup& group : groups) {
    for (const auto add : group.verbs) add(app);
    const std::vector<CLI::App*> verbs = app.get_subcommands([](CLI::App*) { return true; });
    for (; grouped < verbs.size(); ++grouped) verbs[grouped]->group(group.title);
  }
}

// Throws Error(usage) where the first argument is no verb, with the verb that may be meant.
void require_verb(const CLI::App& app, const std::string& name) {
  std::vector<std::string> verbs;
  for (const CLI::App* verb : app.get_subcommands([](const CLI::App*) { return true; })) {
    verbs.push_back(verb->get_name());
  }
  if (name.starts_with('-') || std::ranges::find(verbs, name) != verbs.end()) return;
  throw Error(ErrorKind::usage, "'", name, "' is no verb of bodyopt; the nearest is '",
              nearest_names(verbs, name).front(), "' (bodyopt --help lists all)");
}

// Throws Error(usage) at an option that the verb before it on the command line does not have. It names the one of that
// verb that may be meant.
void require_options(const CLI::App& verb) {
  std::vector<std::string> options;
  for (const CLI::Option* option : verb.get_options()) {
    for (const std::string& name : option->get_lnames()) options.push_back("--" + name);
  }
  for (const std::string& argument : verb.remaining()) {
    const std::string name = argument.substr(0, argument.find('='));
    if (!name.starts_with("--") || name == "--") continue;
    if (std::ranges::find(options, name) != options.end()) continue;  // after a "--" it is none
    throw Error(ErrorKind::usage, "'", verb.get_name(), "' has no option ", name, "; the nearest is ",
                nearest_names(options, name).front(), " (--help lists all)");
  }
  for (const CLI::App* subverb : verb.get_subcommands()) require_options(*subverb);
}

// `bodyopt help VERB` is `bodyopt VERB --help`.
std::vector<std::string> as_options(std::vector<std::string> arguments) {
  if (arguments.front() == "help") {
    arguments.erase(arguments.begin());
    arguments.push_back("--help");
  }
  return arguments;
}

// Parses, and so runs the verb. Throws Error.
int parse(CLI::App& app, std::vector<std::string> arguments) {
  require_verb(app, arguments.front());
  std::ranges::reverse(arguments);  // as CLI11 takes them
  try {
    app.parse(arguments);
  } catch (const CLI::Success& success) {
    std::ostringstream text;  // CLI11 would not tell whether it was printed
    app.exit(success, text);
    print(text.str());
  } catch (const CLI::ParseError& error) {
    require_options(app);
    app.exit(error);
    return static_cast<int>(ErrorKind::usage);
  }
  return 0;
}

// While a dataset is trained on, the caches of all its takes are open.
void allow_many_open_files() {
  rlimit limit{};
  if (getrlimit(RLIMIT_NOFILE, &limit) != 0) return;
  limit.rlim_cur = limit.rlim_max;
  setrlimit(RLIMIT_NOFILE, &limit);
}

// Schedulers tell programs in OMP_NUM_THREADS how many cores are theirs; `bodyopt farm` sets it, too. The limit holds
// for as long as the process lives.
void limit_threads() {
  static std::optional<tbb::global_control> limit;
  const char* given = std::getenv("OMP_NUM_THREADS");
  const int count = given ? std::atoi(given) : 0;
  if (count >= 1) limit.emplace(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(count));
}

// The number of a closed stream would be given to the next file that is opened, and what is printed would go into it.
// Reading what should be written fails as a closed stream does.
void keep_closed_streams_apart() {
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (fcntl(stream, F_GETFD) < 0) open("/dev/null", stream == STDIN_FILENO ? O_WRONLY : O_RDONLY);
  }
}

constexpr double kUncutMinutes = 1e5;  // of a task: no element is cut into parts

// Runs the step in this process; what it prints stands in the log.
int run_step(const farm::FarmStep& step, const std::string& progress) {
  return exit_code_of([&] {
    make_folder(std::filesystem::path(step.out).parent_path());
    (step.arguments.front() == "join" ? join_step : eval_step)(step, progress);
  });
}

}  // namespace

void prepare_process() {
  keep_closed_streams_apart();
  spdlog::set_default_logger(spdlog::stderr_color_mt("bodyopt"));
  spdlog::set_pattern("%^%l%$: %v");
  catch_interrupts();
  std::signal(SIGXFSZ, SIG_IGN);  // a file over the limit (ulimit -f) is then an error of writing it, as a full disk is
  allow_many_open_files();
  limit_threads();
}

int run_command(const std::vector<std::string>& arguments) {
  keep_command_line(arguments);
  set_progress_style(ProgressStyle::automatic);
  CLI::App app{"Bodyopt learns how a character's skin moves and replays it in real time."};
  app.name("bodyopt");
  app.set_version_flag("--version", BODYOPT_VERSION);
  app.require_subcommand(1);
  app.option_defaults()->always_capture_default(false);
  app.footer(
      "To see it work: bodyopt demo --quick --out demo, then bodyopt view demo/basis.safetensors demo/heldout.glb\n"
      "bodyopt VERB --help lists its options; docs/walkthrough.md leads from a character of your own to a trained one.");
  add_verbs(app);
  app.parse_complete_callback([&] { refuse_report_over_others(app); });

  if (arguments.empty()) {
    std::fputs(app.help().c_str(), stderr);
    return static_cast<int>(ErrorKind::usage);
  }
  int parsed = 0;
  const int code = exit_code_of([&] { parsed = parse(app, as_options(arguments)); });
  const int printed = exit_code_of(require_printed);
  if (code != 0 || parsed != 0) return std::max(code, parsed);
  return printed;
}

void run_steps(const std::vector<const farm::FarmStep*>& steps, const std::string& progress) {
  int last = 0;
  std::size_t failed = 0;
  for (const farm::FarmStep* step : steps) {
    const int code = run_step(*step, progress);
    if (code == 0) continue;
    ++failed;
    last = code;
    if (code == static_cast<int>(ErrorKind::interrupted)) {
      throw Error(ErrorKind::interrupted, step->out, " was interrupted; the same command goes on with it");
    }
  }
  if (failed > 0) throw Error(static_cast<ErrorKind>(last), format("{} of {} steps failed", failed, steps.size()));
}

void run_show_list(const std::string& file, const std::string& progress) {
  std::vector<std::string> problems;
  const farm::ShowList list = farm::read_show_list(file, problems);
  say(list.notes);
  const farm::FarmPlan plan = farm::plan_show(list, kUncutMinutes, problems);
  for (const std::string& problem : problems) spdlog::error("{}", problem);
  if (!problems.empty()) {
    throw Error(ErrorKind::usage, format("{}: {} problems; nothing is evaluated", file, problems.size()));
  }
  std::vector<const farm::FarmStep*> steps;
  for (const farm::FarmTask& task : plan.tasks) {
    for (const farm::FarmStep& step : task.steps) steps.push_back(&step);
  }
  run_steps(steps, progress);
}

}  // namespace bodyopt::cli
