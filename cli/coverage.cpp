// bodyopt coverage: how well a basis knows the poses of a clip, and which frames to simulate next.
#include "trainer/train/coverage/coverage.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <span>

#include "assets/controls.h"
#include "assets/frame_range.h"
#include "cli/arguments/common.h"
#include "report/heat_strip.h"
#include "report/svg.h"
#include "runtime/core/atomic_file.h"
#include "runtime/core/error.h"
#include "trainer/curate/named_shapes.h"

namespace bodyopt::cli {
namespace {

struct CoverageArguments {
  std::string basis, truth, picture;
  double unit = 0;
  int worst = 20;
  ClipArguments clip;
  JsonOption json;
};

// Per frame, RMS in mm.
std::vector<double> true_errors(const Basis& basis, const std::vector<Pose>& poses, const std::string& path) {
  const NamedShapes truth(path);
  if (truth.sample_count() != poses.size() || truth.point_count() != basis.mesh.output_count()) {
    throw Error(
        ErrorKind::mismatch,
        format("%s has %u samples of %u points, the frames asked for are %zu of %u: another clip, frame range "
               "or mesh",
               path.c_str(), truth.sample_count(), truth.point_count(), poses.size(), basis.mesh.output_count()));
  }
  Deformer deformer(basis, {.name = "cpu"});
  ErrorAccumulator accumulator(truth.point_count());
  for (std::uint32_t k = 0; k < truth.sample_count(); ++k) {
    accumulator.add(static_cast<int>(k), deformer.evaluate({&poses[k], 1}).positions, truth.sample(k));
  }
  return accumulator.finish().frame_rms;
}

HeatStrip strip(const std::vector<int>& frames, const std::vector<std::string>& regions,
                const std::vector<ExpectedError>& errors) {
  HeatStrip strip;
  strip.frames.frames = frames;
  strip.regions = regions;
  for (const ExpectedError& error : errors) {
    strip.whole_mm.push_back(error.rms_mm);
    strip.regions_mm.push_back(error.region_mm);
  }
  return strip;
}

// The region with the largest error; none where there are no regions.
Json worst_region(const std::vector<std::string>& regions, const ExpectedError& error) {
  if (regions.empty()) return {{"region", ""}, {"region_expected_mm", 0}};
  const auto worst = std::max_element(error.region_mm.begin(), error.region_mm.end());
  return {{"region", regions[static_cast<std::size_t>(worst - error.region_mm.begin())]},
          {"region_expected_mm", *worst}};
}

// That move the region's skin.
std::vector<std::string> joint_names(const Basis& basis, std::size_t region) {
  const CoverageTable& coverage = basis.coverage;
  std::vector<std::string> names;
  for (std::uint32_t k = coverage.joint_begin[region]; k < coverage.joint_begin[region + 1]; ++k) {
    names.push_back(basis.skeleton.joints[coverage.joints[k]].name);
  }
  return names;
}

void run(const CoverageArguments& arguments) {
  arguments.json.require_writable();
  if (!arguments.picture.empty()) require_writable(arguments.picture);
  const Basis basis = load_basis(arguments.basis);
  ErrorExpectation{basis};  // refuses a basis without coverage before the clip is read
  const std::vector<std::string>& regions = basis.coverage.names;
  std::vector<int> frames;
  const double unit = arguments.unit > 0 ? arguments.unit : kept_unit(basis);
  Clip clip = arguments.clip.read(basis, unit, frames);
  for (const std::string& name : arrange_controls(basis.residual.controls, clip)) {
    spdlog::warn("control '{}' is none that the basis was trained with: it has no effect", name);
  }
  const std::vector<Pose> poses = poses_of(clip, frames);

  const std::vector<ExpectedError> errors = expected_errors(basis, poses);
  std::vector<double> expected;
  for (const ExpectedError& error : errors) expected.push_back(error.rms_mm);

  Json per_frame = Json::array(), per_region = Json::array();
  for (std::size_t k = 0; k < frames.size(); ++k) {
    per_frame.push_back({{"frame", frames[k]}, {"expected_rms_mm", expected[k]}});
    per_frame.back().update(worst_region(regions, errors[k]));
  }
  for (std::size_t r = 0; r < regions.size(); ++r) {
    std::vector<double> of_region;
    for (const ExpectedError& error : errors) of_region.push_back(error.region_mm[r]);
    per_region.push_back(
        {{"region", regions[r]}, {"joints", joint_names(basis, r)}, {"expected_rms_mm", root_mean_square(of_region)}});
  }
  const auto worst = static_cast<std::size_t>(arguments.worst);
  std::vector<int> next;
  std::string text = format("%8s %14s   %s\n", "frame", "expected mm", "most of all");
  for (const std::size_t k : worth_simulating(expected, worst, spreading_gap(frames.size(), worst))) {
    next.push_back(frames[k]);
    text += format("%8d %14.3f   %s, %.3f mm\n", frames[k], expected[k],
                   per_frame[k]["region"].get<std::string>().c_str(), per_frame[k]["region_expected_mm"].get<double>());
  }
  std::sort(next.begin(), next.end());
  const double rms = root_mean_square(expected);
  text += format("expected over %zu frames: %.3f mm RMS\n", frames.size(), rms);
  text += "worth simulating next: --frames " + format_frame_range(next) + "\n";
  Json result = {{"frames", frames.size()},
                 {"expected_rms_mm", rms},
                 {"worth_simulating", format_frame_range(next)},
                 {"regions", per_region},
                 {"per_frame", per_frame}};
  if (!arguments.truth.empty()) {
    const std::vector<double> measured = true_errors(basis, poses, arguments.truth);
    const double correlation = rank_correlation(expected, measured);
    for (std::size_t k = 0; k < measured.size(); ++k) result["per_frame"][k]["true_rms_mm"] = measured[k];
    result["rank_correlation"] = correlation;
    result["true_rms_mm"] = root_mean_square(measured);
    text += format("true: %.3f mm RMS; the frames' expected and true errors rank alike with Spearman's rho %.3f\n",
                   root_mean_square(measured), correlation);
  }
  if (!arguments.picture.empty()) {
    const std::string svg = svg_file(heat_strip(strip(frames, regions, errors)));
    write_file_atomically(arguments.picture, std::as_bytes(std::span(svg)));
    text += "wrote " + arguments.picture + "\n";
  }
  arguments.json.emit(result, text);
}

}  // namespace

void add_coverage(CLI::App& app) {
  auto arguments = std::make_shared<CoverageArguments>();
  CLI::App& verb =
      *app.add_subcommand("coverage", "How well a basis knows the poses of a clip, and which frames to simulate next");
  verb.add_option("basis", arguments->basis, "Basis (.safetensors)")->required()->type_name("BASIS");
  arguments->clip.add(verb);
  verb.add_option("--worst", arguments->worst, "Frames to list")->capture_default_str()->check(CLI::Range(1, 10000));
  verb.add_option("--truth", arguments->truth,
                  "Shapes of these frames (.pc2, .nodes, or DATASET#TAKE): are the expected errors right?")
      ->type_name("CACHE");
  verb.add_option("--picture", arguments->picture, "Heat strip to write: frames from left to right, a row per region")
      ->type_name("FILE.svg")
      ->check(must_end_in(".svg"));
  verb.add_option("--unit", arguments->unit,
                  "Metres per unit of the clip's file (default: as the character was read for training)")
      ->check(above_zero);
  arguments->json.add(verb);
  verb.callback([arguments] { run(*arguments); });
}

}  // namespace bodyopt::cli
