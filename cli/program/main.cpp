// The `bodyopt` program.
#include "cli/run_command.h"

int main(int argc, char** argv) {
  bodyopt::cli::prepare_process();
  return bodyopt::cli::run_command({argv + 1, argv + argc});
}
