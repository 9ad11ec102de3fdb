// bodyopt check: does a dataset belong together; is a character fit for use.
#include "trainer/dataset/check.h"

#include <algorithm>
#include <filesystem>

#include "cli/common.h"
#include "runtime/basis/error.h"
#include "trainer/simulate/materials.h"
#include "trainer/simulate/muscle_fibres.h"

namespace bodyopt::cli {
namespace {

struct CheckArguments {
  std::string path;
  double unit = 0;
  JsonOption json;
};

void check_character(const CheckArguments& arguments) {
  const Character character = read_character(arguments.path, arguments.unit);
  const auto box = (character.vertices.colwise().maxCoeff() - character.vertices.colwise().minCoeff()).eval();
  const std::string surface = describe_surface(character);
  std::string text =
      format("%s: %u vertices, %td after welding seams, %zu joints, %.3f x %.3f x %.3f m\nsurface: %s\n",
             character.name.c_str(), character.output_count(), static_cast<std::ptrdiff_t>(character.vertices.rows()),
             character.skeleton.size(), box(0), box(1), box(2), surface.c_str());
  if (!surface.starts_with("closed")) text += "simulate puts such a skin in a coarse cage\n";
  for (const std::string& note : character.notes) text += "note: " + note + "\n";
  arguments.json.emit({{"vertices", character.output_count()},
                       {"welded_vertices", character.vertices.rows()},
                       {"joints", character.skeleton.size()},
                       {"bounding_box_m", {box(0), box(1), box(2)}},
                       {"surface", surface},
                       {"notes", character.notes}},
                      text);
}

// What keeps a take's controls from flexing muscles in its frames; empty: nothing.
std::string control_problem(const Clip& clip, const std::vector<int>& frames, const std::vector<Muscle>& muscles) {
  try {
    flexed_muscles(clip.controls, muscles);
  } catch (const Error& error) {
    return error.what();
  }
  for (const int frame : frames) {
    if (frame < clip.first_frame || frame > clip.last_frame()) continue;  // check_dataset says so
    const Pose& pose = clip.poses[static_cast<std::size_t>(frame - clip.first_frame)];
    for (std::size_t c = 0; c < clip.controls.size(); ++c) {
      const float value = pose.controls[c];
      if (value >= 0 && value <= 1) continue;
      return format("the control '%s' is %g in frame %d, expected 0 (relaxed) to 1 (all a muscle can): in per cent?",
                    clip.controls[c].c_str(), static_cast<double>(value), frame);
    }
  }
  return "";
}

// Adds what is wrong with the controls of each take. Without muscles they may mean anything.
void check_controls(const Dataset& dataset, std::vector<TakeCheck>& checks) {
  const auto has_controls = [](const DatasetTake& take) { return !take.controls.empty(); };
  if (dataset.muscles.empty() || std::none_of(dataset.takes.begin(), dataset.takes.end(), has_controls)) return;
  const Skeleton skeleton = read_character(dataset.folder / dataset.character, dataset.unit).skeleton;
  const std::vector<Muscle> muscles = read_muscles(dataset.folder / dataset.muscles, skeleton);
  for (std::size_t k = 0; k < checks.size(); ++k) {
    const DatasetTake& take = dataset.takes[k];
    if (!has_controls(take)) continue;
    const std::string problem = control_problem(read_clip(dataset, take, skeleton), take.frames, muscles);
    if (!problem.empty()) checks[k].problems.push_back(take.controls + ": " + problem);
  }
}

void check(const CheckArguments& arguments) {
  std::filesystem::path path = arguments.path;
  if (std::filesystem::is_directory(path)) path /= "dataset.json";
  const Dataset dataset = read_dataset(path);
  if (!dataset.materials.empty()) read_materials(dataset.folder / dataset.materials);
  std::vector<TakeCheck> takes = check_dataset(dataset);
  check_controls(dataset, takes);
  Json result = Json::array();
  std::string text, first_problem;
  for (const TakeCheck& take : takes) {
    text += format(
        "%s: %u points, %u samples, %.2f mm RMS from the skinned character (frame %d, nearest to the bind "
        "pose: %.2f mm)\n",
        take.name.c_str(), take.points, take.samples, take.fit_mm, take.rest_frame, take.rest_fit_mm);
    for (const std::string& problem : take.problems) {
      text += "  PROBLEM: " + problem + "\n";
      if (first_problem.empty()) first_problem = path.string() + ", take '" + take.name + "': " + problem;
    }
    result.push_back({{"name", take.name},
                      {"points", take.points},
                      {"samples", take.samples},
                      {"fit_mm", take.fit_mm},
                      {"rest_fit_mm", take.rest_fit_mm},
                      {"problems", take.problems}});
  }
  if (takes.empty()) first_problem = path.string() + " names no takes: nothing to train on";
  text += first_problem.empty() ? "it belongs together\n" : "it does not belong together\n";
  arguments.json.emit({{"takes", result}, {"belongs_together", first_problem.empty()}}, text);
  if (!first_problem.empty()) throw Error(ErrorKind::mismatch, first_problem);
}

void run(const CheckArguments& arguments) {
  const std::string extension = std::filesystem::path(arguments.path).extension();
  if (extension == ".glb" || extension == ".gltf") return check_character(arguments);
  check(arguments);
}

}  // namespace

void add_check(CLI::App& app) {
  auto arguments = std::make_shared<CheckArguments>();
  CLI::App& verb = *app.add_subcommand("check", "Does a dataset belong together? Is a character fit for use?");
  verb.add_option("dataset", arguments->path, "dataset.json or its folder, or a character (.glb, .gltf)")
      ->required()
      ->type_name("DATASET");
  add_unit(verb, arguments->unit);
  arguments->json.add(verb);
  verb.callback([arguments] { run(*arguments); });
}

}  // namespace bodyopt::cli
