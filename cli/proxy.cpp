// bodyopt proxy: levels of detail of a character, for crowds and distance.
#include <spdlog/spdlog.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "assets/clips/controls.h"
#include "cli/arguments/common.h"
#include "cli/results/attachments.h"
#include "cli/results/measure.h"
#include "runtime/core/error.h"
#include "runtime/core/stopwatch.h"
#include "trainer/check/check.h"
#include "trainer/proxy/build_proxy.h"

namespace bodyopt::cli {
namespace {

struct ProxyArguments {
  std::string source, character, muscles, out;
  std::vector<double> errors_mm;
  ClipArguments clip;
  trainer::ProxyOptions options;
  JsonOption json;
};

struct Source {
  trainer::SampleSet set;
  std::filesystem::path character;  // its file
};

Source dataset_source(const ProxyArguments& arguments) {
  if (!arguments.character.empty() || !arguments.muscles.empty() || !arguments.clip.source.empty()) {
    throw Error(ErrorKind::usage, "--character, --muscles and --clip go with a basis; a dataset (", arguments.source,
                ") has its own");
  }
  const std::filesystem::path path = dataset_file(arguments.source);
  const Dataset dataset = read_dataset(path);
  const std::string mismatch = trainer::first_problem(trainer::check_dataset(dataset), path);
  if (!mismatch.empty()) throw Error(ErrorKind::mismatch, mismatch);
  return {trainer::read_samples(dataset), dataset.folder / dataset.character};
}

Source basis_source(const ProxyArguments& arguments) {
  if (arguments.character.empty() || arguments.clip.source.empty()) {
    throw Error(ErrorKind::usage, "a proxy of a basis needs its --character, and a --clip to show how it moves");
  }
  refuse_overwriting(arguments.out, arguments.source);
  const Basis teacher = load_basis(arguments.source);
  const double unit = kept_unit(teacher);
  const Character character = read_character(arguments.character, unit);
  std::vector<Muscle> muscles;
  if (!arguments.muscles.empty()) {
    muscles = read_muscles(arguments.muscles, character.skeleton);
  } else if (teacher.strain.fibre_count() > 0) {
    spdlog::warn(
        "the basis has {} fibres, the proxy will have none: without their strains it learns less of what it is shown; "
        "those of muscles come with --muscles muscles.json",
        teacher.strain.fibre_count());
  }
  std::vector<int> frames;
  Clip clip = arguments.clip.read(teacher, unit, frames);
  for (const std::string& name : arrange_controls(teacher.residual.controls, clip)) {
    spdlog::warn("control '{}' is none that the basis was trained with: it has no effect", name);
  }
  trainer::SampleSet set = trainer::taught_samples(character, muscles, teacher, shots::poses_of(clip, frames), frames);
  set.notes = character.notes;
  return {std::move(set), arguments.character};
}

void run(ProxyArguments arguments) {
  require_writable(arguments.out);
  arguments.json.require_writable();
  std::ranges::sort(arguments.errors_mm);
  for (const double error : arguments.errors_mm) arguments.options.errors.push_back(1e-3 * error);
  const Stopwatch watch;
  const bool of_basis = arguments.source.ends_with(".safetensors");
  const Source source = of_basis ? basis_source(arguments) : dataset_source(arguments);
  say(source.set.notes);
  std::vector<std::string> notes;
  auto [levels, report] = trainer::build_proxy(source.set, arguments.options, notes);
  say(notes);
  for (Level& level : levels) keep_unit(level.basis, source.set.character.unit);
  save_levels(levels, arguments.out);
  const std::vector<AttachedMesh> attached =
      attach_own_meshes(source.character, source.set.character.unit, source.set.character.output_count(),
                        levels.front().basis, arguments.out);
  const double seconds = watch.seconds();
  const Json table = levels_info(levels, report);
  arguments.json.emit(
      {{"proxy", arguments.out},
       {"seconds", seconds},
       {"levels", table},
       {"attached", cli::to_json(attached)},
       {"notes", notes}},
      describe(attached) + level_table(table) + format("wrote {} in {:.1f} s\n", arguments.out, seconds));
}

}  // namespace

void add_proxy(CLI::App& app) {
  const auto [verb, arguments] = add_verb<ProxyArguments, ProxyArguments>(
      app, "proxy", "Make levels of detail of a character: bases with fewer vertices", run);
  add_required(verb, "source", arguments.source, "DATASET|BASIS",
               "Dataset (dataset.json, or its folder), or a trained basis (.safetensors)");
  add_option(verb, "--out", arguments.out, "FILE.safetensors",
             "Levels to write: a basis, the first level, and the others")
      ->required();
  add_option(verb, "--error", arguments.errors_mm,
             "What the skin of each level may be off, mm (default: 1/500, 1/250 and 1/125 of the size)")
      ->type_name("MM")
      ->check(above_zero)
      ->expected(1, static_cast<int>(kMostLevels));
  add_option(verb, "--character", arguments.character, "The basis' character (.glb, .gltf, .fbx)")
      ->type_name("CHARACTER");
  add_option(verb, "--muscles", arguments.muscles, "The basis' muscles (muscles.json)")->type_name("FILE");
  arguments.clip.add(verb);
  CLI::Option* clip = verb.get_option("--clip")->required(false);
  for (const char* of_clip : {"--frames", "--fps", "--first-frame", "--controls"}) {
    verb.get_option(of_clip)->needs(clip);
  }
  add_option(verb, "--seed", arguments.options.train.seed, "Seed of every random choice")->capture_default_str();
  arguments.json.add(verb);
}

}  // namespace bodyopt::cli
