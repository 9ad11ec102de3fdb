// The `bodyopt` program.
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>
#include <sys/resource.h>

#include <csignal>
#include <cstdio>
#include <filesystem>
#include <new>

#include "cli/common.h"
#include "runtime/basis/error.h"
#include "trainer/progress.h"

namespace {

// While a dataset is trained on, the caches of all its takes are open.
void allow_many_open_files() {
  rlimit limit{};
  if (getrlimit(RLIMIT_NOFILE, &limit) != 0) return;
  limit.rlim_cur = limit.rlim_max;
  setrlimit(RLIMIT_NOFILE, &limit);
}

}  // namespace

int main(int argc, char** argv) {
  using namespace bodyopt;
  using namespace bodyopt::cli;
  spdlog::set_default_logger(spdlog::stderr_color_mt("bodyopt"));
  spdlog::set_pattern("%^%l%$: %v");
  catch_interrupts();
  std::signal(SIGXFSZ, SIG_IGN);  // a file over the limit (ulimit -f) is then an error of writing it, as a full disk is
  allow_many_open_files();
  keep_command_line(argc, argv);

  CLI::App app{"Bodyopt learns how a character's skin moves and replays it in real time."};
  app.name("bodyopt");
  app.set_version_flag("--version", BODYOPT_VERSION);
  app.require_subcommand(1);
  app.option_defaults()->always_capture_default(false);
  add_demo(app);
  add_rom(app);
  add_simulate(app);
  add_muscles(app);
  add_dataset(app);
  add_check(app);
  add_regions(app);
  add_train(app);
  add_test(app);
  add_improve(app);
  add_proxy(app);
  add_dynamics(app);
  add_attach(app);
  add_eval(app);
  add_compare(app);
  add_coverage(app);
  add_view(app);
  add_export(app);
  add_picture(app);
  add_info(app);
  add_devices(app);

  try {
    app.parse(argc, argv);
    return std::fflush(stdout) == 0 ? 0 : static_cast<int>(ErrorKind::file);
  } catch (const CLI::Success& success) {
    return app.exit(success);
  } catch (const CLI::ParseError& error) {
    app.exit(error);
    return static_cast<int>(ErrorKind::usage);
  } catch (const Error& error) {
    spdlog::error("{}", error.what());
    return error.exit_code();
  } catch (const std::filesystem::filesystem_error& error) {  // a name that is too long, a loop of links
    spdlog::error("{}", error.what());
    return static_cast<int>(ErrorKind::file);
  } catch (const std::bad_alloc&) {
    spdlog::error("out of memory");
    return static_cast<int>(ErrorKind::interrupted);
  } catch (const std::exception& error) {
    spdlog::error("a defect of bodyopt: {}", error.what());
    return 70;
  }
}
