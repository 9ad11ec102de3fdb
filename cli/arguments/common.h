// Shared parts of the verbs: their registration, the clip arguments, the result's two forms.
#pragma once

#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <type_traits>
#include <vector>

#include "assets/caches/pc2.h"
#include "dataset/compare.h"
#include "runtime/basis/character_unit.h"
#include "runtime/basis/skeleton.h"
#include "runtime/host/device_choice.h"
#include "shots/clip_choice.h"

namespace bodyopt::cli {

// Functions that are compiled once declare verbs and their options. CLI11 is headers alone, which every verb would
// compile again.

// A verb of the program, or a verb below one.
CLI::App& add_verb(CLI::App& parent, const std::string& name, const std::string& description);

// A verb with arguments of its own, which live as long as it does; it runs with them. `Parameter`: as `run` takes them.
template <typename Arguments>
struct DeclaredVerb {
  CLI::App& verb;
  Arguments& arguments;
};
template <typename Arguments, typename Parameter = const Arguments&>
DeclaredVerb<Arguments> add_verb(CLI::App& parent, const std::string& name, const std::string& description,
                                 void (*run)(std::type_identity_t<Parameter>)) {
  const auto arguments = std::make_shared<Arguments>();
  CLI::App& verb = add_verb(parent, name, description);
  verb.callback([arguments, run] { run(*arguments); });
  return {verb, *arguments};
}

// `value` takes what the user gives; its types are those that common.cpp lists.
template <typename Value>
CLI::Option* add_option(CLI::App& verb, const std::string& name, Value& value, const std::string& description);

// Text may not be empty: most likely a shell variable is not set, which must not mean the default. `type`: as the help
// calls it. A "FILE.png" must end in .png, lest a slip overwrite a character.
template <typename Text>
CLI::Option* add_option(CLI::App& verb, const std::string& name, Text& value, const std::string& type,
                        const std::string& description);

// An option that must be given. `type`: as the help calls it.
template <typename Value>
CLI::Option* add_required(CLI::App& verb, const std::string& name, Value& value, const std::string& type,
                          const std::string& description) {
  return add_option(verb, name, value, description)->required()->type_name(type);
}

// A number, finite, within these ends; the help shows its default.
template <typename Number>
CLI::Option* add_number(CLI::App& verb, const std::string& name, Number& value, double low, double high,
                        const std::string& description);

CLI::Option* add_flag(CLI::App& verb, const std::string& name, bool& value, const std::string& description);

// An option that earlier versions had: it takes a value and says on standard error that it has no effect, since...
void add_former_option(CLI::App& verb, const std::string& name, const std::string& since);

// Checks of options give what is wrong, or nothing. A number, finite, within these ends.
std::function<std::string(const std::string&)> number_from(double low, double high);

// A number above 0 and finite, which CLI11 does not ask of "nan".
std::string above_zero(const std::string& text);

// A file's name that ends as said.
std::function<std::string(const std::string&)> must_end_in(const std::string& extension);

using fmt::format;

// Frames a second that clips and dynamics may have.
constexpr double kLeastRate = 1e-3, kMostRate = 1e5;

// Says it as a warning on standard error.
void warn(const std::string& note);
// Says each note once so.
void say(const std::vector<std::string>& notes);

// Prints on standard output, all that goes there.
void print(const std::string& text);
// Throws Error(file) where standard output did not take all that was printed since the last call.
void require_printed();

// --json FILE; '-' is standard output, which then holds nothing else.
struct JsonOption {
  std::string path, schema{};  // of the result, where it has one
  void add(CLI::App& verb);
  // Throws Error(file), or Error(usage) over a file of another kind, now rather than after long work.
  void require_writable() const;
  // Prints `text` for people, unless standard output is taken by the JSON.
  void print(const std::string& text) const;
  // Prints `text` for people (unless standard output is taken by the JSON) and writes `result` where asked.
  void emit(const Json& result, const std::string& text) const;
};

// --clip CLIP [--frames R] [--fps N] [--first-frame N] [--controls FILE] [--joint-map FILE] [--up AXIS] [--unit N]
struct ClipArguments : shots::ClipChoice {
  void add(CLI::App& verb);
  // --unit, of verbs in which it is that of no character.
  void add_unit(CLI::App& verb);
  // Reads the clip, says its notes, and gives the frames asked for (all without --frames). Throws as ClipChoice.
  // `unit`: that of the character.
  template <typename Target>  // a Skeleton or a Basis
  Clip read(const Target& target, double unit, std::vector<int>& frame_numbers) const {
    Clip clip = shots::ClipChoice::read(target, unit);
    say(clip.notes);
    frame_numbers = chosen_frames(clip);
    return clip;
  }
};

// The folder of what the program can make again: bodyopt in $XDG_CACHE_HOME, or in ~/.cache; or empty.
std::filesystem::path cache_folder();

// --device D [--require-device]
struct DeviceArguments {
  DeviceChoice choice{.pipeline_cache = cache_folder()};
  void add(CLI::App& verb);
};

void add_unit(CLI::App& verb, double& unit);
// --joint-map FILE, --up AXIS: of every verb that reads clips.
void add_retargeting(CLI::App& verb, std::string& joint_map, std::string& up);

// A dataset given by its folder or its dataset.json: that file.
std::filesystem::path dataset_file(const std::filesystem::path& given);

// Throws Error(usage) where --json of the verb that is run names what another of its arguments does.
void refuse_report_over_others(const CLI::App& verb);
// Throws Error(usage) when `out` is the file `input`.
void refuse_overwriting(const std::filesystem::path& out, const std::filesystem::path& input);
// Throws Error(file) now rather than after long work.
void require_writable(const std::filesystem::path& path);

// The user's command line, "bodyopt" and its arguments; run_command() keeps it.
void keep_command_line(const std::vector<std::string>& arguments);
const std::string& command_line();
// The words that follow the verb on the command line.
const std::vector<std::string>& verb_arguments();

// Makes the folder where it is missing. Throws Error(file).
void make_folder(const std::filesystem::path& folder);

std::string describe(const ErrorStatistics& errors);
double peak_memory_mib();

// Runs it; says on standard error what went wrong, and returns the exit code that README lists for it.
int exit_code_of(const std::function<void()>& body);

// --unit-out, --axis: of verbs that write caches for other programs.
void add_cache_space(CLI::App& verb, CacheSpace& space);

// The poses of some clips. Says their notes. Throws as read_clip(). `unit`: of the character.
std::vector<Pose> read_poses(const std::vector<std::string>& sources, const Skeleton& skeleton, double unit,
                             ClipOptions options);

// One per verb, in the file of its name: declares its arguments and what it runs.
void add_demo(CLI::App& app);
void add_rig(CLI::App& app);
void add_rom(CLI::App& app);
void add_simulate(CLI::App& app);
void add_muscles(CLI::App& app);
void add_dataset(CLI::App& app);
void add_curate(CLI::App& app);
void add_check(CLI::App& app);
void add_anatomy(CLI::App& app);
void add_train(CLI::App& app);
void add_test(CLI::App& app);
void add_improve(CLI::App& app);
void add_proxy(CLI::App& app);
void add_dynamics(CLI::App& app);
void add_attach(CLI::App& app);
void add_transfer(CLI::App& app);
void add_modifiers(CLI::App& app);
void add_eval(CLI::App& app);
void add_join(CLI::App& app);
void add_compare(CLI::App& app);
void add_coverage(CLI::App& app);
void add_regions(CLI::App& app);
void add_export(CLI::App& app);
void add_picture(CLI::App& app);
void add_farm(CLI::App& app);
void add_info(CLI::App& app);
void add_devices(CLI::App& app);
void add_bench(CLI::App& app);

}  // namespace bodyopt::cli
