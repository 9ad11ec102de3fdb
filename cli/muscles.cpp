// bodyopt muscles: from anatomy to muscles.json.
#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>

#include "base/wording.h"
#include "cli/arguments/common.h"
#include "report/pictures.h"
#include "runtime/core/error.h"
#include "runtime/core/transformed.h"
#include "trainer/anatomy/muscle_candidates.h"
#include "trainer/muscle_models/fit.h"

namespace bodyopt::cli {
namespace {

namespace muscle_models = trainer::muscle_models;
using muscle_models::FittedMuscle;

struct ImportArguments {
  std::string character, out, picture;
  std::vector<std::pair<std::string, std::string>> sources;  // model, mapping
  double unit = 0;
  bool has_trunk = false;
  JsonOption json;
};

// Reports a model's paths that bend around surfaces, in its default pose.
Json wrap_report(const muscle_models::Model& model, const std::vector<std::string>& leave_out) {
  const muscle_models::ModelPose pose = pose_model(model, default_values(model));
  const std::set<std::string> ignored(leave_out.begin(), leave_out.end());
  Json report = Json::array();
  for (const muscle_models::ModelMuscle& muscle : model.muscles) {
    if (muscle.wraps.empty() || ignored.contains(muscle.name)) continue;
    Json honoured = Json::array(), straight = Json::array();
    for (const muscle_models::Wrap& wrap : muscle.wraps)
      (muscle_models::honoured(wrap) ? honoured : straight).push_back(wrap.name);
    muscle_models::ModelMuscle unwrapped = muscle;
    unwrapped.wraps.clear();
    std::vector<muscle_models::PathStop> chords = trace_path(muscle, pose);
    const double length = path_length(chords);
    for (muscle_models::PathStop& stop : chords) stop.arc = 0;
    report.push_back({{"muscle", muscle.name},
                      {"honoured", honoured},
                      {"not_honoured", straight},
                      {"length_mm", 1000 * length},
                      {"straight_error_mm", 1000 * (path_length(trace_path(unwrapped, pose)) - length)},
                      {"via_point_error_mm", 1000 * (path_length(chords) - length)}});
  }
  return report;
}

Json muscle_report(const std::vector<FittedMuscle>& fitted) {
  return transformed(fitted, [&](const FittedMuscle& muscle) {
    return Json{{"name", muscle.muscle.name},
                {"points", muscle.muscle.path.size()},
                {"radius_mm", 1000 * muscle.muscle.radius},
                {"full_radius_mm", 1000 * muscle.full_radius},
                {"pushed_mm", 1000 * muscle.largest_push}};
  });
}

bool depends_on_pose(const muscle_models::ModelMuscle& muscle) {
  return std::ranges::any_of(
      muscle.path, [](const muscle_models::PathPoint& point) { return point.condition || !point.moving.empty(); });
}

std::string describe_source(const muscle_models::Model& model, const std::vector<FittedMuscle>& fitted,
                            const Json& wraps) {
  double push = 0;
  int thinned = 0;
  for (const FittedMuscle& muscle : fitted) {
    push = std::max(push, muscle.largest_push);
    thinned += muscle.muscle.radius < muscle.full_radius ? 1 : 0;
  }
  std::string text =
      format("{}: {} muscles; points moved under the skin by {:.1f} mm at most; {} made thinner to fit\n", model.file,
             fitted.size(), 1000 * push, thinned);
  const auto reduced = std::ranges::count_if(model.muscles, depends_on_pose);
  if (reduced > 0) {
    text += format("  {} have conditional or moving points, kept as they are in the model's default pose\n", reduced);
  }
  for (const Json& wrap : wraps) {
    if (wrap["not_honoured"].empty()) continue;
    text += format("  {}: not bent around {}\n", wrap["muscle"].get<std::string>(),
                   list_names(wrap["not_honoured"].get<std::vector<std::string>>()));
  }
  return text;
}

void draw(const Character& character, const std::vector<Muscle>& muscles, const std::string& path) {
  std::vector<report::MuscleTube> tubes;
  for (const Muscle& muscle : muscles) {
    report::MuscleTube tube{{}, muscle.radius};
    for (const MusclePoint& point : muscle.path) tube.path.push_back(point.position);
    tubes.push_back(tube);
  }
  draw::Renderer renderer;
  draw::write_png(report::muscle_picture(renderer, floats_of(character.vertices), report::flat(character.triangles),
                                         tubes, 700, 1000),
                  path);
}

void import(const ImportArguments& arguments) {
  arguments.json.require_writable();
  refuse_overwriting(arguments.out, arguments.character);
  for (const auto& [model, mapping] : arguments.sources) {
    for (const std::string& input : {model, mapping}) refuse_overwriting(arguments.out, input);
  }
  require_writable(arguments.out);
  if (!arguments.picture.empty()) require_writable(arguments.picture);
  const Character character = read_character(arguments.character, arguments.unit);
  say(character.notes);
  std::vector<Muscle> muscles;
  std::set<std::string> names;
  Json sources = Json::array();
  std::string text;
  for (const auto& [model_path, mapping_path] : arguments.sources) {
    const muscle_models::Model model = muscle_models::read_model(model_path);
    say(model.notes);
    const muscle_models::Mapping mapping = muscle_models::read_mapping(mapping_path);
    const std::vector<FittedMuscle> fitted = fit_muscles(model, mapping, character);
    for (const FittedMuscle& muscle : fitted) {
      if (!names.insert(muscle.muscle.name).second) {
        throw Error(ErrorKind::mismatch, model_path, ": the muscle '", muscle.muscle.name,
                    "' comes from an earlier --from already: leave it out in one mapping");
      }
      muscles.push_back(muscle.muscle);
    }
    const Json wraps = wrap_report(model, mapping.leave_out);
    text += describe_source(model, fitted, wraps);
    sources.push_back({{"model", model_path},
                       {"mapping", mapping_path},
                       {"notes", model.notes},
                       {"muscles", muscle_report(fitted)},
                       {"wraps", wraps}});
  }
  std::size_t of_trunk = 0;
  if (arguments.has_trunk) {
    const trainer::TrunkMuscles trunk = trainer::trunk_muscles(character, muscles);
    say(trunk.notes);
    of_trunk = trunk.muscles.size();
    muscles.insert(muscles.end(), trunk.muscles.begin(), trunk.muscles.end());
    text += format("trunk and neck: {} muscles, laid by the skeleton's landmarks\n", of_trunk);
  }
  write_muscles(muscles, character.skeleton, arguments.out);
  if (!arguments.picture.empty()) draw(character, muscles, arguments.picture);
  text += format("wrote {}: {} muscles\n", arguments.out, muscles.size());
  arguments.json.emit(
      {{"muscles", arguments.out}, {"count", muscles.size()}, {"sources", sources}, {"of_trunk", of_trunk}}, text);
}

}  // namespace

void add_muscles(CLI::App& app) {
  CLI::App& verb = add_verb(app, "muscles", "Fit muscles to a character");
  verb.require_subcommand(1);
  const auto [subverb, arguments] =
      add_verb<ImportArguments>(verb, "import", "Fit the muscles of OpenSim or MuJoCo models to a character", import);
  add_required(subverb, "character", arguments.character, "CHARACTER", "Character (.glb, .gltf, .fbx)");
  add_required(subverb, "--from", arguments.sources, "MODEL MAPPING",
               "Muscle model (.osim, MuJoCo .xml) and the mapping (.json) of its segments to the character's joints; "
               "may be given several times");
  add_flag(subverb, "--trunk", arguments.has_trunk,
           "Also the muscles of a human's trunk and neck that models of legs and arms lack, laid by the "
           "landmarks of the character's own skeleton");
  add_option(subverb, "--out", arguments.out, "FILE.json", "The character's muscles")->required();
  add_option(subverb, "--picture", arguments.picture, "FILE.png",
             "Also draw them, from the front, from behind and from the left");
  add_unit(subverb, arguments.unit);
  arguments.json.add(subverb);
}

}  // namespace bodyopt::cli
