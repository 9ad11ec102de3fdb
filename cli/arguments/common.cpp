#include "cli/arguments/common.h"

#include <fmt/core.h>
#include <spdlog/spdlog.h>
#include <sys/resource.h>

#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <new>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>
#include <vector>

#include "assets/clips/clip_source.h"
#include "base/wording.h"
#include "base/written_over.h"
#include "farm/plan.h"
#include "runtime/basis/file_schema.h"
#include "runtime/core/atomic_file.h"
#include "runtime/core/error.h"
#include "runtime/core/file_problem.h"

namespace bodyopt::cli {

CLI::App& add_verb(CLI::App& parent, const std::string& name, const std::string& description) {
  return *parent.add_subcommand(name, description);
}

template <typename Value>
CLI::Option* add_option(CLI::App& verb, const std::string& name, Value& value, const std::string& description) {
  return verb.add_option(name, value, description);
}

template <typename Text>
CLI::Option* add_option(CLI::App& verb, const std::string& name, Text& value, const std::string& type,
                        const std::string& description) {
  CLI::Option* option = add_option(verb, name, value, description)->type_name(type);
  if (type.starts_with("FILE.")) return option->check(must_end_in(type.substr(4)));
  return option->check([](const std::string& text) {
    return text.empty() ? std::string("expected a value, found an empty one: a shell variable that is not set?") : "";
  });
}

template <typename Number>
CLI::Option* add_number(CLI::App& verb, const std::string& name, Number& value, double low, double high,
                        const std::string& description) {
  CLI::Option* option = add_option(verb, name, value, description)->capture_default_str();
  if constexpr (std::is_integral_v<Number>) {
    return option->check(CLI::Range(static_cast<int>(low), static_cast<int>(high)));
  } else {
    return option->check(number_from(low, high));
  }
}

CLI::Option* add_flag(CLI::App& verb, const std::string& name, bool& value, const std::string& description) {
  return verb.add_flag(name, value, description);
}

void add_former_option(CLI::App& verb, const std::string& name, const std::string& since) {
  const auto warn = [=](const std::string&) { spdlog::warn("{} has no effect any more: {}", name, since); };
  verb.add_option_function<std::string>(name, warn)->group("");  // not among the help's
}

std::function<std::string(const std::string&)> number_from(double low, double high) {
  return [low, high](const std::string& text) {
    const char* begin = text.c_str();
    char* end = nullptr;
    const double value = std::strtod(begin, &end);
    const bool is_number = end == begin + text.size() && !text.empty();
    return is_number && value >= low && value <= high
               ? std::string()
               : fmt::format("expected a number from {:g} to {:g}, found '{}'", low, high, text);
  };
}

std::string above_zero(const std::string& text) {
  const bool is_one =
      number_from(std::numeric_limits<double>::denorm_min(), std::numeric_limits<double>::max())(text).empty();
  return is_one ? "" : "expected a number above 0, found '" + text + "'";
}

std::function<std::string(const std::string&)> must_end_in(const std::string& extension) {
  return [extension](const std::string& name) {
    const std::string wanted = missing_ending(name, extension);
    return wanted.empty() ? "" : "'" + name + "' does not end in " + wanted;
  };
}

template CLI::Option* add_option(CLI::App&, const std::string&, int&, const std::string&);
template CLI::Option* add_option(CLI::App&, const std::string&, std::int64_t&, const std::string&);
template CLI::Option* add_option(CLI::App&, const std::string&, unsigned&, const std::string&);
template CLI::Option* add_option(CLI::App&, const std::string&, std::uint64_t&, const std::string&);
template CLI::Option* add_option(CLI::App&, const std::string&, float&, const std::string&);
template CLI::Option* add_option(CLI::App&, const std::string&, double&, const std::string&);
template CLI::Option* add_option(CLI::App&, const std::string&, std::string&, const std::string&);
template CLI::Option* add_option(CLI::App&, const std::string&, std::optional<int>&, const std::string&);
template CLI::Option* add_option(CLI::App&, const std::string&, std::optional<std::uint16_t>&, const std::string&);
template CLI::Option* add_option(CLI::App&, const std::string&, std::vector<unsigned>&, const std::string&);
template CLI::Option* add_option(CLI::App&, const std::string&, std::vector<float>&, const std::string&);
template CLI::Option* add_option(CLI::App&, const std::string&, std::vector<double>&, const std::string&);
template CLI::Option* add_option(CLI::App&, const std::string&, std::vector<std::string>&, const std::string&);
template CLI::Option* add_option(CLI::App&, const std::string&, std::vector<std::pair<std::string, std::string>>&,
                                 const std::string&);

template CLI::Option* add_option(CLI::App&, const std::string&, std::string&, const std::string&, const std::string&);
template CLI::Option* add_option(CLI::App&, const std::string&, std::vector<std::string>&, const std::string&,
                                 const std::string&);

template CLI::Option* add_number(CLI::App&, const std::string&, int&, double, double, const std::string&);
template CLI::Option* add_number(CLI::App&, const std::string&, std::int64_t&, double, double, const std::string&);
template CLI::Option* add_number(CLI::App&, const std::string&, unsigned&, double, double, const std::string&);
template CLI::Option* add_number(CLI::App&, const std::string&, float&, double, double, const std::string&);
template CLI::Option* add_number(CLI::App&, const std::string&, double&, double, double, const std::string&);

namespace {

int print_failure = 0;  // errno of the first that failed

}  // namespace

// Flushed here: what does not fit the buffer is written before, and a later flush tells nothing of its failure.
void print(const std::string& text) {
  const bool is_printed = std::fputs(text.c_str(), stdout) >= 0 && std::fflush(stdout) == 0;
  if (!is_printed && print_failure == 0) print_failure = errno;
}

void require_printed() {
  const int failure = std::exchange(print_failure, 0);
  if (failure == 0) return;
  std::clearerr(stdout);
  throw Error(ErrorKind::file, "standard output cannot be written: ", std::strerror(failure));
}

void JsonOption::add(CLI::App& verb) {
  add_option(verb, "--json", path, "Write the result as JSON to FILE ('-': standard output)")->type_name("FILE");
}

void JsonOption::require_writable() const {
  if (path.empty() || path == "-") return;
  refuse_other_kind(path, schema);
  cli::require_writable(path);
}

void JsonOption::print(const std::string& text) const {
  if (path != "-") cli::print(text);
}

void JsonOption::emit(const Json& result, const std::string& text) const {
  // Names of files may be any bytes: those that are no text are replaced.
  const std::string json = result.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
  if (path == "-") return cli::print(json);
  if (!path.empty()) {
    refuse_other_kind(path, schema);
    write_file_atomically(path, json);
  }
  cli::print(text);
}

void ClipArguments::add(CLI::App& verb) {
  add_option(verb, "--clip", source, "CLIP", "Motion: FILE.glb#name, FILE.glb (its only or first clip) or FILE.bvh")
      ->required();
  add_option(verb, "--frames", frames, "R", "Frames, as 1-100, 1-100x2 or comma lists of them (default: all)");
  add_number(verb, "--fps", options.fps, kLeastRate, kMostRate, "Frames a second at which the clip is sampled");
  add_option(verb, "--first-frame", options.first_frame, "Number of the clip's first frame")->capture_default_str();
  add_option(verb, "--controls", options.controls, "FILE",
             "Controls over the clip's frames, such as muscles flexed (controls.json)");
  add_retargeting(verb, options.joint_map, options.up);
}

void ClipArguments::add_unit(CLI::App& verb) {
  add_option(verb, "--unit", options.unit,
             "Metres per unit of the clip's file (default: as the character was read for training; a BVH's bones tell)")
      ->check(above_zero);
}

std::filesystem::path cache_folder() {
  // A path that is not absolute is to be ignored (XDG Base Directory Specification).
  const auto absolute = [](const char* name) -> std::filesystem::path {
    const char* value = std::getenv(name);
    return value != nullptr && value[0] == '/' ? value : "";
  };
  if (const auto caches = absolute("XDG_CACHE_HOME"); !caches.empty()) return caches / "bodyopt";
  const auto home = absolute("HOME");
  return home.empty() ? home : home / ".cache" / "bodyopt";
}

void DeviceArguments::add(CLI::App& verb) {
  add_option(verb, "--device", choice.name, "auto, cpu, or a Vulkan device by index or name (see 'bodyopt devices')")
      ->capture_default_str()
      ->type_name("D");
  add_flag(verb, "--require-device", choice.require_device, "Fail when there is no Vulkan device, never use the CPU");
}

void add_unit(CLI::App& verb, double& unit) {
  add_option(verb, "--unit", unit,
             "Metres per unit of the character's file (default: metres, or the unit that its size tells)")
      ->check(above_zero);
}

void add_retargeting(CLI::App& verb, std::string& joint_map, std::string& up) {
  add_option(verb, "--joint-map", joint_map, "FILE",
             "Which joint of the clip moves which, where names do not tell (joint_map.json)");
  add_option(verb, "--up", up, "AXIS",
             "Axis of a BVH that is up: x, y, z, --up=-x, =-y, =-z (default: its motion tells)");
}

void refuse_report_over_others(const CLI::App& verb) {
  for (const CLI::App* subverb : verb.get_subcommands()) refuse_report_over_others(*subverb);
  const CLI::Option* json = verb.get_option_no_throw("--json");
  if (json == nullptr || json->empty() || json->results().front() == "-") return;
  std::vector<std::filesystem::path> others;
  for (const CLI::Option* option : verb.get_options()) {
    if (option == json) continue;
    for (const std::string& value : option->results()) {
      if (!value.empty()) others.push_back(split_source(value).path);
    }
  }
  refuse_over("--json", json->results().front(), others);
}

void refuse_overwriting(const std::filesystem::path& out, const std::filesystem::path& input) {
  std::error_code ignored;
  if (std::filesystem::equivalent(out, input, ignored)) {
    throw Error(ErrorKind::usage, "--out ", out, " would write over the input of that name");
  }
}

std::filesystem::path dataset_file(const std::filesystem::path& given) {
  return std::filesystem::is_directory(given) ? given / "dataset.json" : given;
}

void require_writable(const std::filesystem::path& path) { const AtomicFile probe(path); }

namespace {

std::string kept_command_line;
std::vector<std::string> kept_verb_arguments;

}  // namespace

void keep_command_line(const std::vector<std::string>& arguments) {
  kept_command_line = "bodyopt";
  kept_verb_arguments = {arguments.begin() + (arguments.empty() ? 0 : 1), arguments.end()};
  for (const std::string& argument : arguments) {
    const bool plain = !argument.empty() && argument.find_first_of(" \t\n\"'$*?#&;|<>()\\") == std::string::npos;
    kept_command_line += " " + (plain ? argument : farm::quoted_for_shell(argument));
  }
}

const std::string& command_line() { return kept_command_line; }

const std::vector<std::string>& verb_arguments() { return kept_verb_arguments; }

void warn(const std::string& note) { spdlog::warn("{}", note); }

void say(const std::vector<std::string>& notes) {
  for (const std::string& note : notes) warn(note);
}

void make_folder(const std::filesystem::path& folder) {
  std::error_code failure, ignored;
  std::filesystem::create_directories(folder, failure);
  if (!std::filesystem::is_directory(folder, ignored)) {
    throw Error(ErrorKind::file, "'", folder, "' cannot be made a folder: ", with_cause(failure));
  }
}

std::string describe(const ErrorStatistics& errors) {
  return format("RMS {:.3f} mm, p99 {:.3f} mm, max {:.3f} mm, jitter {:.3f} mm", errors.rms, errors.p99, errors.max,
                errors.jitter);
}

double peak_memory_mib() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024;
}

int exit_code_of(const std::function<void()>& body) {
  try {
    body();
    return 0;
  } catch (const Error& error) {
    spdlog::error("{}", error.what());
    return error.exit_code();
  } catch (const std::filesystem::filesystem_error& error) {  // a name that is too long, a loop of links
    spdlog::error("{}", describe_refusal(error));
    return static_cast<int>(ErrorKind::file);
  } catch (const std::bad_alloc&) {
    spdlog::error("out of memory");
    return static_cast<int>(ErrorKind::interrupted);
  } catch (const std::exception& error) {
    spdlog::error("a defect of bodyopt: {}", error.what());
    return 70;
  }
}

void add_cache_space(CLI::App& verb, CacheSpace& space) {
  add_option(verb, "--unit-out", space.unit,
             "Metres per unit of the cache: the character's own --unit lays it on the mesh of its file")
      ->capture_default_str()
      ->check(above_zero);
  const std::map<std::string, bool> axes = {{"y", false}, {"z", true}};
  add_option(verb, "--axis", space.z_up, "Which axis of the cache is up: y as in glTF, or z as Blender has it")
      ->transform(CLI::CheckedTransformer(axes))
      ->option_text("y|z");
}

std::vector<Pose> read_poses(const std::vector<std::string>& sources, const Skeleton& skeleton, double unit,
                             ClipOptions options) {
  std::vector<Pose> poses;
  for (const std::string& source : sources) {
    options.unit = clip_unit(source, unit);
    const Clip clip = read_clip(source, skeleton, options);
    say(clip.notes);
    poses.insert(poses.end(), clip.poses.begin(), clip.poses.end());
  }
  return poses;
}

}  // namespace bodyopt::cli
