#include "cli/arguments/exit_code.h"

#include <spdlog/spdlog.h>

#include <filesystem>
#include <new>

#include "runtime/core/error.h"

namespace bodyopt::cli {

int exit_code_of(const std::function<void()>& body) {
  try {
    body();
    return 0;
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

}  // namespace bodyopt::cli
