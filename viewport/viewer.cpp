#include "viewport/viewer.h"

#include <chrono>
#include <memory>

#include "base/progress.h"
#include "runtime/core/error.h"
#include "viewport/application.h"
#include "viewport/platform/window.h"

namespace bodyopt::viewport {
namespace {

using Clock = std::chrono::steady_clock;
using ValidationMessages = std::shared_ptr<const vulkan::ValidationLog>;

double seconds_between(Clock::time_point from, Clock::time_point to) {
  return std::chrono::duration<double>(to - from).count();
}

void run_turns(Application& application, Window& window, double most_seconds) {
  const Clock::time_point started = Clock::now();
  Clock::time_point last = started;
  while (!application.is_done()) {
    if (interrupted()) throw Error(ErrorKind::interrupted, "interrupted: the viewport ends, as a signal asked it to");
    const std::vector<WindowEvent> events = window.poll(application.patience());
    const Clock::time_point now = Clock::now();
    if (most_seconds > 0 && seconds_between(started, now) > most_seconds) break;
    application.turn(events, seconds_between(std::exchange(last, now), now));
  }
}

ValidationMessages run_window(const ViewerOptions& options) {
  Window window({.width = options.width, .height = options.height, .vsync = options.vsync});
  const auto device = std::make_shared<const vulkan::Device>(options.device, window.device_use());
  window.attach(device);
  Application application(options, device, &window);
  try {
    run_turns(application, window, options.seconds);
  } catch (...) {
    application.autosave();
    throw;
  }
  if (application.is_done()) {  // as somebody decided
    application.forget_autosave();
  } else {
    application.autosave();
  }
  return device->validation_log();
}

ValidationMessages run_headless(const ViewerOptions& options) {
  const auto device = std::make_shared<const vulkan::Device>(options.device, vulkan::DeviceUse{.draws = true});
  Application(options, device, nullptr).make_pictures();
  return device->validation_log();
}

}  // namespace

void run_viewer(const ViewerOptions& options) {
  const ValidationMessages log = options.headless ? run_headless(options) : run_window(options);
  const std::vector<std::string> messages = log->messages();  // those of the device's end, too
  if (messages.empty()) return;
  throw Error(ErrorKind::device, "Vulkan validation reported " + std::to_string(messages.size()) +
                                     " messages, first: " + messages.front());
}

}  // namespace bodyopt::viewport
