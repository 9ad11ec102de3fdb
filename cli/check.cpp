// bodyopt check: does a dataset belong together; is a character fit for use; does a clip suit a character.
#include "trainer/check/check.h"

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "assets/clips/axis_turns.h"
#include "assets/clips/clip_source.h"
#include "base/wording.h"
#include "cli/arguments/common.h"
#include "cli/arguments/dataset_arguments.h"
#include "geometry/mesh.h"
#include "report/region_picture.h"
#include "runtime/core/error.h"
#include "runtime/core/file_kind.h"
#include "runtime/core/transformed.h"
#include "runtime/host/stages.h"
#include "trainer/anatomy/anatomy_report.h"
#include "trainer/check/foresee.h"
#include "trainer/check/shape_doubts.h"
#include "trainer/motion/attached_rig.h"
#include "trainer/motion/held_turns.h"
#include "trainer/simulate/simulate.h"
#include "trainer/train/data/samples.h"

namespace bodyopt::cli {
namespace {

struct CheckArguments {
  std::string path, limits, picture, muscles;
  FieldArguments anatomy;
  ClipArguments clip;
  double unit = 0;
  JsonOption json;
};

// Places of one kind of defect; of two: between parts of different joints.
struct PlaceList {
  const char *key, *title;
  const std::vector<trainer::RestPlace>& places;
  bool of_two = false;
};

// Everything of it that has places, in the order in which these are numbered.
std::vector<PlaceList> lists_of(const trainer::CharacterForecast& forecast) {
  return {{"self_intersections", "the skin passes through itself at rest", forecast.intersections},
          {"holes", "the skin is open", forecast.holes},
          {"flipped", "faces wind oppositely", forecast.flipped},
          {"near_parts", "parts of different joints nearly touch at rest (a lattice may glue them)",
           forecast.near_parts, true},
          {"glued_parts", "a cage holds skin of different joints together", forecast.glued, true},
          {"riders", "loose pieces follow the others", forecast.loose_pieces}};
}

// first: the number of the first; unnumbered: the numbers that the picture lacks, which become null.
Json places_json(const PlaceList& list, std::size_t first, const std::vector<std::size_t>& unnumbered) {
  Json result = Json::array();
  for (const trainer::RestPlace& place : list.places) {
    const std::size_t number = first + result.size();
    const bool is_shown = std::ranges::find(unnumbered, number) == unnumbered.end();
    Json& entry = result.emplace_back(Json{{"number", is_shown ? Json(number) : Json()}, {"joint", place.joint}});
    if (list.of_two) entry["other_joint"] = place.other;
    entry["vertices"] = place.vertices.size();
    entry["vertex"] = place.vertex;
    entry["position_m"] = {place.position[0], place.position[1], place.position[2]};
  }
  return result;
}

// first: the number of the first.
std::string places_text(const PlaceList& list, std::size_t first) {
  constexpr std::size_t kShown = 8;
  const std::vector<trainer::RestPlace>& places = list.places;
  if (places.empty()) return "";
  std::string text = std::string(list.title) + ":\n";
  for (std::size_t k = 0; k < std::min(places.size(), kShown); ++k) {
    const trainer::RestPlace& place = places[k];
    text += format("{:4}  {}: {}, one is {} at {:.3f} {:.3f} {:.3f} m\n", first + k,
                   place.joint + (list.of_two ? " and " + place.other : ""),
                   count_of(place.vertices.size(), "vertex", "vertices"), place.vertex, place.position[0],
                   place.position[1], place.position[2]);
  }
  if (places.size() > kShown) text += format("  and at {} more\n", places.size() - kShown);
  return text;
}

// The places, numbered in their order. Returns the numbers that it lacks: of places inside, or covered by others.
std::vector<std::size_t> draw_places(const Character& character, const std::vector<trainer::RestPlace>& places,
                                     const std::string& path) {
  std::vector<report::VertexList> vertices;
  for (const trainer::RestPlace& place : places) vertices.push_back(place.vertices);
  draw::Renderer renderer;
  const Positions skin = upright_skin(character.skeleton, character.vertices);
  const report::RegionPicture picture =
      report::places_picture(renderer, skin, character.triangles, vertices, 700, 1000);
  draw::write_png(picture.image, path);
  return picture.unnumbered;
}

// "without a number in the picture (inside, or covered by another place): 3, 5"
std::string unnumbered_text(const std::vector<std::size_t>& unnumbered) {
  std::string numbers;
  for (const std::size_t number : unnumbered) numbers += (numbers.empty() ? "" : ", ") + std::to_string(number);
  return numbers.empty() ? ""
                         : "without a number in the picture (inside, or covered by another place): " + numbers + "\n";
}

Json verbs_json(const std::vector<trainer::VerbForecast>& foreseen) {
  return transformed(foreseen, [&](const trainer::VerbForecast& verb) {
    return Json{{"verb", verb.verb},   {"fills", trainer::name_of(verb.fill)},
                {"nodes", verb.nodes}, {"contact", verb.has_contact},
                {"why", verb.why},     {"remedy", verb.remedy},
                {"glued", verb.glued}};
  });
}

std::string verbs_text(const std::vector<trainer::VerbForecast>& foreseen) {
  std::string text = format("{:17} {:13} {:>7}  {:8} why\n", "verb", "fills", "nodes", "contact");
  for (const trainer::VerbForecast& verb : foreseen) {
    const bool simulates = verb.verb.starts_with("simulate");
    text += format("{:17} {:13} {:7}  {:8} {}\n", verb.verb, trainer::name_of(verb.fill), verb.nodes,
                   simulates ? (verb.has_contact ? "yes" : "no") : "-", verb.why);
    if (!verb.glued.empty()) text += format("{:17} holds together: {}\n", "", verb.glued);
    if (!verb.remedy.empty()) text += format("{:17} remedy: {}\n", "", verb.remedy);
  }
  return text;
}

// All clips in the character's own file.
std::vector<Clip> own_clips(const std::string& path, const Skeleton& skeleton, double unit) {
  std::vector<Clip> clips;
  for (const std::string& name : clip_names(path)) {
    clips.push_back(read_clip(format("{}#{}", path, name), skeleton, {.unit = unit}));
    for (const std::string& note : clips.back().notes) say({format("clip '{}': {}", name, note)});
  }
  return clips;
}

// Forecasts how the verbs will treat the character: in JSON, as a table, and in a picture where asked.
Json foreseen(const CheckArguments& arguments, const Character& character, std::string& text) {
  const std::string& picture = arguments.picture;
  const trainer::CharacterForecast forecast =
      trainer::foresee(character, own_clips(arguments.path, character.skeleton, arguments.unit), arguments.unit);
  text += verbs_text(forecast.verbs);
  const std::vector<PlaceList> lists = lists_of(forecast);
  std::vector<trainer::RestPlace> numbered;
  for (const PlaceList& list : lists) {
    text += places_text(list, numbered.size() + 1);
    numbered.insert(numbered.end(), list.places.begin(), list.places.end());
  }
  std::vector<std::size_t> unnumbered;
  if (!picture.empty()) unnumbered = draw_places(character, numbered, picture);
  text += unnumbered_text(unnumbered);
  for (const std::string& remark : forecast.remarks) text += "note: " + remark + "\n";
  Json result = {{"foreseen", verbs_json(forecast.verbs)}, {"remarks", forecast.remarks}};
  std::size_t first = 1;
  for (const PlaceList& list : lists) {
    result[list.key] = places_json(list, first, unnumbered);
    first += list.places.size();
  }
  return result;
}

// Warns where skin and muscles do not fit each other.
std::vector<std::string> misfits(const Character& character, const std::vector<Muscle>& muscles,
                                 const trainer::AnatomyOptions& options) {
  return trainer::report_anatomy(character, muscles, trainer::AnatomyField(character, muscles, options)).warnings;
}

void check_character(const CheckArguments& arguments) {
  const Character character = read_character(arguments.path, arguments.unit);
  const Eigen::RowVector3d box = box_sides(character.vertices);
  const std::string surface = trainer::describe_surface(character);
  std::string text = format(
      "{}: {} vertices, {} after welding seams, {} joints, {:.3f} x {:.3f} x {:.3f} m\nsurface: {}\n", character.name,
      character.output_count(), character.vertices.rows(), character.skeleton.size(), box(0), box(1), box(2), surface);
  for (const std::string& note : character.notes) text += "note: " + note + "\n";
  Json result = {{"vertices", character.output_count()},
                 {"welded_vertices", character.vertices.rows()},
                 {"joints", character.skeleton.size()},
                 {"bounding_box_m", {box(0), box(1), box(2)}},
                 {"surface", surface},
                 {"notes", character.notes}};
  result.update(foreseen(arguments, character, text));
  if (!arguments.muscles.empty()) {
    const std::vector<Muscle> muscles = read_muscles(arguments.muscles, character.skeleton);
    const std::vector<std::string> found = misfits(character, muscles, arguments.anatomy.options(character.skeleton));
    for (const std::string& misfit : found) text += "note: " + misfit + "\n";
    result["anatomy"] = found;
  }
  if (!arguments.picture.empty()) text += "wrote " + arguments.picture + "\n";
  arguments.json.emit(result, text);
}

// Lists turns beyond the character's limits that the chosen frames hold.
Json held_beyond_limits(const std::string& path, const Skeleton& own, const std::vector<Pose>& own_poses,
                        std::string& text) {
  const trainer::JointLimits own_limits = trainer::read_joint_limits(path, own);
  const trainer::AttachedRig rig(own, own_limits.detached);
  const trainer::JointLimits limits = rig.attached(own_limits);
  const Skeleton& skeleton = rig.skeleton();
  const std::vector<Pose> poses = rig.attached(own_poses);
  Json held = Json::array();
  for (const trainer::HeldTurn& turn : trainer::held_turns(limits, skeleton, poses)) {
    const std::string description = describe(turn, skeleton, poses.size());
    text += "  PROBLEM: " + description + "\n";
    held.push_back({{"joint", skeleton.joints[turn.joint].name},
                    {"degrees", turn.degrees},
                    {"axis", turn.axis},
                    {"share_of_frames", turn.share},
                    {"problem", description}});
  }
  if (held.empty()) text += "no joint is held beyond its limits\n";
  const std::vector<std::string> unknown = trainer::turning_without_limits(limits, skeleton, poses);
  if (!unknown.empty()) text += "note: the limits say nothing of " + list_names(unknown) + ": not judged\n";
  return held;
}

// Reading it says how it suits the character; limits say whether it keeps to them.
void check_clip(const CheckArguments& arguments) {
  const Character character = read_character(arguments.path, arguments.unit);
  say(character.notes);
  std::vector<int> frames;
  const Clip clip = arguments.clip.read(character.skeleton, arguments.unit, frames);
  std::string text = clip.name + ": " + count_of(frames.size(), "frame", "frames") + "\n";
  Json result = {{"clip", clip.name}, {"frames", frames.size()}, {"notes", clip.notes}};
  if (!arguments.limits.empty()) {
    result["held_beyond_limits"] =
        held_beyond_limits(arguments.limits, character.skeleton, shots::poses_of(clip, frames), text);
  }
  arguments.json.emit(result, text);
}

// Joints that the frames to learn from do not tell apart.
std::string coupling_of(const Dataset& dataset) {
  const Skeleton skeleton = read_character(dataset.folder / dataset.character, dataset.unit).skeleton;
  std::vector<Pose> poses;
  for (const DatasetTake& take : dataset.takes) {
    std::vector<int> learned = take.frames;
    std::erase_if(learned, [&](int frame) { return std::ranges::find(take.heldout, frame) != take.heldout.end(); });
    for (Pose& pose : shots::poses_of(read_clip(dataset, take, skeleton), learned)) poses.push_back(std::move(pose));
  }
  return describe(trainer::coupled_joints(skeleton, poses), skeleton);
}

std::string take_text(const trainer::TakeCheck& take) {
  std::string text = format("{}: {} points, {} samples, ", take.name, take.points, take.samples);
  if (take.unconverged > 0) text += format("{} not solved (unconverged, or not simulated yet), ", take.unconverged);
  if (take.compared == 0) return text + "none compared with the skinned character\n";
  return text + format("{:.2f} mm RMS from the skinned character (frame {}, nearest to the bind pose: {:.2f} mm)\n",
                       take.fit_mm, take.rest_frame, take.rest_fit_mm);
}

void check(const CheckArguments& arguments) {
  const std::filesystem::path path = dataset_file(arguments.path);
  const Dataset dataset = read_dataset(path);
  const std::vector<trainer::TakeCheck> takes = trainer::check_dataset(dataset);
  const std::string mismatch = trainer::first_problem(takes, path);
  Json result = Json::array();
  std::string text;
  for (const trainer::TakeCheck& take : takes) {
    text += take_text(take);
    for (const std::string& problem : take.problems) text += "  PROBLEM: " + problem + "\n";
    result.push_back({{"name", take.name},
                      {"points", take.points},
                      {"samples", take.samples},
                      {"unconverged", take.unconverged},
                      {"compared", take.compared},
                      {"fit_mm", take.compared > 0 ? Json(take.fit_mm) : Json()},
                      {"rest_fit_mm", take.compared > 0 ? Json(take.rest_fit_mm) : Json()},
                      {"problems", take.problems}});
  }
  std::vector<std::string> notes;
  std::vector<trainer::VerbForecast> foreseen;
  if (mismatch.empty()) {
    const trainer::SampleSet samples = trainer::read_samples(dataset);
    foreseen = trainer::foresee_training(samples);
    text += verbs_text(foreseen);
    const std::string coupled = coupling_of(dataset);
    if (!coupled.empty()) notes.push_back(coupled);
    std::vector<std::string> anatomy;
    if (!samples.muscles.empty())
      anatomy =
          misfits(samples.character, samples.muscles, trainer::anatomy_options(dataset, samples.character.skeleton));
    for (const std::vector<std::string>& some :
         {samples.notes, trainer::shape_doubts(samples), trainer::short_takes(dataset), trainer::coarse_takes(dataset),
          anatomy}) {
      notes.insert(notes.end(), some.begin(), some.end());
    }
  }
  for (const std::string& note : notes) text += "note: " + note + "\n";
  const bool has_problem = std::ranges::any_of(takes, [](const auto& take) { return !take.problems.empty(); });
  text += mismatch.empty() ? "it belongs together\n"
          : has_problem    ? "it does not belong together\n"
                           : "nothing tells whether its files belong together\n";
  arguments.json.emit(
      {{"takes", result}, {"foreseen", verbs_json(foreseen)}, {"notes", notes}, {"belongs_together", mismatch.empty()}},
      text);
  if (!mismatch.empty()) throw Error(ErrorKind::mismatch, mismatch);
}

void run(const CheckArguments& arguments) {
  arguments.json.require_writable();
  const std::string extension = std::filesystem::path(arguments.path).extension();
  const bool is_character = is_called_scene(arguments.path);
  if (!is_character && extension != ".json" && std::filesystem::is_regular_file(arguments.path)) {
    throw Error(ErrorKind::file, arguments.path,
                ": expected a dataset (.json, or its folder) or a character (.glb, .gltf, .fbx)",
                looks_like(arguments.path));
  }
  if (!arguments.picture.empty()) {
    if (!is_character || !arguments.clip.source.empty()) {
      throw Error(ErrorKind::usage, "--picture draws a character (.glb, .gltf, .fbx) alone");
    }
    require_writable(arguments.picture);
  }
  if (!arguments.muscles.empty() && (!is_character || !arguments.clip.source.empty())) {
    throw Error(ErrorKind::usage,
                "--muscles are checked with a character (.glb, .gltf, .fbx) alone; a dataset has its own");
  }
  if (!arguments.clip.source.empty()) {
    if (!is_character)
      throw Error(ErrorKind::usage, "--clip is checked with a character (.glb, .gltf, .fbx), not a dataset");
    return check_clip(arguments);
  }
  if (is_character) return check_character(arguments);
  check(arguments);
}

}  // namespace

void add_check(CLI::App& app) {
  const auto [verb, arguments] = add_verb<CheckArguments>(
      app, "check", "Check whether a dataset belongs together, a character is fit for use, and a clip suits it", run);
  add_required(verb, "dataset", arguments.path, "DATASET",
               "dataset.json or its folder, or a character (.glb, .gltf, .fbx)");
  arguments.clip.add(verb);
  CLI::Option& clip = *verb.get_option("--clip")->required(false);
  add_option(verb, "--limits", arguments.limits, "FILE",
             "Joint limits (limits.json): does the clip hold joints beyond them?")
      ->needs(&clip);
  for (const char* of_clip : {"--frames", "--fps", "--first-frame", "--controls", "--joint-map", "--up"}) {
    verb.get_option(of_clip)->needs(&clip);
  }
  CLI::Option* muscles = add_option(verb, "--muscles", arguments.muscles, "FILE",
                                    "A character's muscles.json: do its paths fit its skin?");
  arguments.anatomy.add(verb);
  for (const char* of_anatomy : {"--body-fat", "--kind", "--corrections"}) verb.get_option(of_anatomy)->needs(muscles);
  add_option(verb, "--picture", arguments.picture, "FILE.png",
             "Also draw where a character's skin passes through itself, is open or turned, nearly touches, is held "
             "together by a cage or loose, numbered as listed, from the sides where that is");
  add_unit(verb, arguments.unit);
  arguments.json.add(verb);
}

}  // namespace bodyopt::cli
