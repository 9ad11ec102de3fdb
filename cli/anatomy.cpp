// bodyopt anatomy: what lies inside a character, in numbers and in sections.
#include <cmath>
#include <nlohmann/json.hpp>

#include "assets/characters/muscles.h"
#include "cli/arguments/dataset_arguments.h"
#include "geometry/mend_surface.h"
#include "report/pictures.h"
#include "runtime/core/error.h"
#include "runtime/core/stopwatch.h"
#include "runtime/core/transformed.h"
#include "trainer/anatomy/anatomy_report.h"
#include "trainer/anatomy/section.h"

namespace bodyopt::cli {
namespace {

constexpr const char* kAnatomySchema = "bodyopt-anatomy-1";

struct AnatomyArguments {
  std::string character, muscles, picture;
  FieldArguments field;
  double cell_mm = 0, unit = 0;
  JsonOption json{.path = {}, .schema = kAnatomySchema};
};

constexpr double kCubicCentimetres = 1e6;  // in a cubic metre

Json parts_json(const trainer::AnatomyReport& report) {
  Json parts = Json::object();
  for (const trainer::AnatomyReport::OfPart& part : report.parts) {
    parts[part.name] = {{"volume_cm3", kCubicCentimetres * part.volume},
                        {"bone_percent", 100 * part.bone},
                        {"fat_percent", 100 * part.fat},
                        {"cavity_percent", 100 * part.cavity},
                        {"muscle_percent", 100 * part.muscle},
                        {"other_lean_percent", 100 * part.other_lean}};
  }
  return parts;
}

Json muscles_json(const trainer::AnatomyReport& report) {
  return transformed(report.muscles, [](const trainer::AnatomyReport::OfMuscle& muscle) {
    const Json bones =
        transformed(muscle.bones, [](const std::string& bone) { return bone.empty() ? Json() : Json(bone); });
    return Json{{"name", muscle.name},
                {"volume_cm3", kCubicCentimetres * muscle.volume},
                {"target_cm3", kCubicCentimetres * muscle.target},
                {"pieces", muscle.pieces},
                {"ends_off_bone_mm", {1e3 * muscle.ends_off_bone[0], 1e3 * muscle.ends_off_bone[1]}},
                {"end_bones", bones}};
  });
}

Json anatomy_json(const trainer::AnatomyReport& report, const trainer::AnatomyField& field, double seconds) {
  return {{"schema", kAnatomySchema},
          {"kind", trainer::name_of(field.kind())},
          {"kind_because", field.why_kind()},
          {"parts", parts_json(report)},
          {"muscles", muscles_json(report)},
          {"limb_factors", report.limb_factors},
          {"mirror_difference_percent", report.mirror_difference ? Json(100 * *report.mirror_difference) : Json()},
          {"seconds", seconds},
          {"warnings", report.warnings}};
}

std::string anatomy_text(const trainer::AnatomyReport& report, const trainer::AnatomyField& field, double seconds) {
  std::string text =
      format("a {}: {}\n\n{:<12} {:>10} {:>7} {:>7} {:>7} {:>7} {:>11}\n", trainer::name_of(field.kind()),
             field.why_kind(), "part", "cm3", "bone %", "fat %", "cavity", "muscle", "other lean");
  for (const trainer::AnatomyReport::OfPart& part : report.parts) {
    text += format("{:<12} {:>10.1f} {:>7.1f} {:>7.1f} {:>7.1f} {:>7.1f} {:>11.1f}\n", part.name,
                   kCubicCentimetres * part.volume, 100 * part.bone, 100 * part.fat, 100 * part.cavity,
                   100 * part.muscle, 100 * part.other_lean);
  }
  if (!report.muscles.empty()) {
    text += format("\n{:<24} {:>8} {:>8} {:>6} {:>17}  {}\n", "muscle", "cm3", "wanted", "pieces", "ends off bone, mm",
                   "bones");
  }
  for (const trainer::AnatomyReport::OfMuscle& muscle : report.muscles) {
    text += format("{:<24} {:>8.1f} {:>8.1f} {:>6} {:>8.1f} {:>8.1f}  {}, {}\n", muscle.name,
                   kCubicCentimetres * muscle.volume, kCubicCentimetres * muscle.target, muscle.pieces,
                   1e3 * muscle.ends_off_bone[0], 1e3 * muscle.ends_off_bone[1],
                   muscle.bones[0].empty() ? "-" : muscle.bones[0], muscle.bones[1].empty() ? "-" : muscle.bones[1]);
  }
  text += "\n";
  for (const auto& [limb, factor] : report.limb_factors) {
    text += format("{}: muscles of {:.2f} times the measured volumes\n", limb, factor);
  }
  if (report.mirror_difference) {
    text += format("left and right differ by {:.3g} % at most\n", 100 * *report.mirror_difference);
  }
  for (const std::string& warning : report.warnings) text += "warning: " + warning + "\n";
  return text + format("found in {:.1f} s\n", seconds);
}

// More samples than this do not fit into most memories.
void require_few_samples(const Character& character, double cell) {
  constexpr double kMost = 2e7;
  const double samples = std::abs(enclosed_volume(character.vertices, character.triangles)) / (cell * cell * cell);
  if (!(cell > 0) || samples <= kMost) return;
  throw Error(ErrorKind::usage,
              format("--cell {:g}: this skin would hold {:.1e} samples, of 2e7 at most: memory would run "
                     "out; give larger cells, or leave it out",
                     1e3 * cell, samples));
}

std::string draw_sections(const std::string& path, const trainer::AnatomyField& field, const Character& character,
                          const std::vector<Muscle>& muscles) {
  constexpr int kPixels = 480;
  const trainer::TissueColours colours(muscles);
  std::vector<draw::Image> pictures;
  std::string text = "wrote " + path + ":";
  for (const trainer::NamedPlane& named : trainer::telling_planes(field, kPixels)) {
    const auto tissue_at = [&](const Eigen::Vector3d& point) { return field.tissue_at(point); };
    pictures.push_back(report::section_image(
        trainer::section_of(named.plane, trainer::rest_points(named.plane, character.vertices, character.triangles),
                            tissue_at),
        colours));
    text += format("{} {} {}", pictures.size() > 1 ? "," : "", pictures.size(), named.name);
  }
  draw::write_png(report::numbered_sheet(pictures), path);
  return text + "\n";
}

void run(const AnatomyArguments& arguments) {
  arguments.json.require_writable();
  if (!arguments.picture.empty()) require_writable(arguments.picture);
  const Character character = read_character(arguments.character, arguments.unit);
  say(character.notes);
  trainer::AnatomyOptions options = arguments.field.options(character.skeleton);
  options.cell = 1e-3 * arguments.cell_mm;
  require_few_samples(character, options.cell);
  std::vector<Muscle> muscles;
  if (!arguments.muscles.empty()) muscles = read_muscles(arguments.muscles, character.skeleton);
  const Stopwatch stopwatch;
  const trainer::AnatomyField field(character, muscles, options);
  const double seconds = stopwatch.seconds();
  trainer::AnatomyReport report = trainer::report_anatomy(character, muscles, field);
  if (const std::string crossing = trainer::skin_crossing(character); !crossing.empty())
    report.warnings.push_back(crossing);
  std::string text = anatomy_text(report, field, seconds);
  if (!arguments.picture.empty()) text += draw_sections(arguments.picture, field, character, muscles);
  arguments.json.emit(anatomy_json(report, field, seconds), text);
}

}  // namespace

void add_anatomy(CLI::App& app) {
  const auto [verb, arguments] = add_verb<AnatomyArguments>(
      app, "anatomy", "Show what lies inside a character: bone, fat, cavity, muscles; in numbers and in sections", run);
  add_required(verb, "character", arguments.character, "CHARACTER", "Character (.glb, .gltf, .fbx)");
  add_option(verb, "--muscles", arguments.muscles, "muscles.json (default: no muscles are told apart)")
      ->type_name("FILE");
  arguments.field.add(verb);
  add_option(verb, "--cell", arguments.cell_mm,
             "Millimetres between samples (default: 5 of a human, by the body's volume)")
      ->check(above_zero);
  add_option(verb, "--picture", arguments.picture, "FILE.png",
             "Also draw sections: of a human thigh, calf, hip, loin, chest, upper arm and forearm; of others five "
             "across and one along the middle");
  add_unit(verb, arguments.unit);
  arguments.json.add(verb);
}

}  // namespace bodyopt::cli
