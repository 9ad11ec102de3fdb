// bodyopt coverage: how well a basis knows the poses of a clip, and which frames to simulate next.
#include "trainer/train/coverage/coverage.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <span>

#include "base/frame_range.h"
#include "base/json_file.h"
#include "cli/arguments/common.h"
#include "cli/arguments/shot_arguments.h"
#include "report/heat_strip.h"
#include "runtime/core/atomic_file.h"
#include "runtime/core/error.h"
#include "runtime/core/transformed.h"
#include "runtime/deformer/deformer.h"
#include "shots/shot_files.h"
#include "trainer/curate/named_shapes.h"

namespace bodyopt::cli {
namespace {

struct CoverageArguments {
  std::string basis, session, truth, picture;
  int worst = 20;
  ClipArguments clip;
  JsonOption json;
};

// True errors per frame, RMS in mm, of the skin before modifiers.
std::vector<double> true_errors(const Basis& basis, const std::vector<Pose>& poses, const std::string& path) {
  const trainer::NamedShapes truth(path);
  if (truth.sample_count() != poses.size() || truth.point_count() != basis.mesh.output_count()) {
    throw Error(ErrorKind::mismatch,
                format("{} has {} samples of {} points, the frames asked for are {} of {}: another clip, frame range "
                       "or mesh",
                       path, truth.sample_count(), truth.point_count(), poses.size(), basis.mesh.output_count()));
  }
  Deformer deformer(basis, {.name = "cpu"});
  ErrorAccumulator accumulator(truth.point_count());
  for (std::uint32_t k = 0; k < truth.sample_count(); ++k) {
    const Pose learned{poses[k].own_joints(), poses[k].controls};
    accumulator.add(static_cast<int>(k), deformer.evaluate({&learned, 1}).positions, truth.sample(k));
  }
  return accumulator.finish().frame_rms;
}

struct RegionError {
  std::string region;  // empty: there are no regions
  double mm = 0;
};

RegionError worst_region(const std::vector<std::string>& regions, const ExpectedError& error) {
  if (regions.empty()) return {};
  const auto worst = std::ranges::max_element(error.region_mm);
  return {regions[static_cast<std::size_t>(worst - error.region_mm.begin())], *worst};
}

// Names of the joints that move the region's skin.
std::vector<std::string> joint_names(const Basis& basis, std::size_t region) {
  const CoverageTable& coverage = basis.coverage;
  std::vector<std::string> names;
  for (std::uint32_t k = coverage.joint_begin[region]; k < coverage.joint_begin[region + 1]; ++k) {
    names.push_back(basis.skeleton.joints[coverage.joints[k]].name);
  }
  return names;
}

// Errors expected in a clip's frames.
struct ClipCoverage {
  std::vector<int> frames;
  std::vector<ExpectedError> errors;   // of each frame
  std::vector<RegionError> worst;      // of each frame, its region with the largest error
  std::vector<double> rms_mm;          // of each frame
  std::vector<std::size_t> simulated;  // places of those worth simulating next, the worst first
};

ClipCoverage coverage_of(const Basis& basis, std::vector<int> frames, const std::vector<Pose>& poses,
                         std::size_t listed) {
  ClipCoverage coverage{std::move(frames), trainer::expected_errors(basis, poses), {}, {}, {}};
  coverage.worst = transformed(coverage.errors,
                               [&](const ExpectedError& error) { return worst_region(basis.coverage.names, error); });
  coverage.rms_mm = transformed(coverage.errors, &ExpectedError::rms_mm);
  coverage.simulated =
      trainer::worth_simulating(coverage.rms_mm, listed, trainer::spreading_gap(coverage.frames.size(), listed));
  return coverage;
}

std::string next_frames(const ClipCoverage& coverage) {
  std::vector<int> next = transformed(coverage.simulated, [&](const std::size_t k) { return coverage.frames[k]; });
  std::ranges::sort(next);
  return format_frame_range(next);
}

Json result_of(const ClipCoverage& coverage, const Basis& basis) {
  Json per_frame = Json::array(), per_region = Json::array();
  for (std::size_t k = 0; k < coverage.frames.size(); ++k) {
    per_frame.push_back({{"frame", coverage.frames[k]},
                         {"expected_rms_mm", coverage.rms_mm[k]},
                         {"region", coverage.worst[k].region},
                         {"region_expected_mm", coverage.worst[k].mm}});
  }
  const std::vector<std::string>& regions = basis.coverage.names;
  for (std::size_t r = 0; r < regions.size(); ++r) {
    const std::vector<double> of_region =
        transformed(coverage.errors, [&](const ExpectedError& error) { return error.region_mm[r]; });
    per_region.push_back({{"region", regions[r]},
                          {"joints", joint_names(basis, r)},
                          {"expected_rms_mm", trainer::root_mean_square(of_region)}});
  }
  return {{"frames", coverage.frames.size()},
          {"expected_rms_mm", trainer::root_mean_square(coverage.rms_mm)},
          {"worth_simulating", next_frames(coverage)},
          {"regions", per_region},
          {"per_frame", per_frame}};
}

std::string coverage_text(const ClipCoverage& coverage) {
  std::string text = format("{:>8} {:>14}   {}\n", "frame", "expected mm", "most of all");
  for (const std::size_t k : coverage.simulated) {
    text += format("{:8} {:14.3f}   {}, {:.3f} mm\n", coverage.frames[k], coverage.rms_mm[k], coverage.worst[k].region,
                   coverage.worst[k].mm);
  }
  text += format("expected over {} frames: {:.3f} mm RMS\n", coverage.frames.size(),
                 trainer::root_mean_square(coverage.rms_mm));
  return text + "worth simulating next: --frames " + next_frames(coverage) + "\n";
}

// Adds them to the result; returns what there is to say of them.
std::string compare_with_truth(const std::vector<double>& expected, const std::vector<double>& measured, Json& result) {
  const double correlation = trainer::rank_correlation(expected, measured);
  for (std::size_t k = 0; k < measured.size(); ++k) result["per_frame"][k]["true_rms_mm"] = measured[k];
  result["rank_correlation"] = correlation;
  result["true_rms_mm"] = trainer::root_mean_square(measured);
  return format("true: {:.3f} mm RMS; the frames' expected and true errors rank alike with Spearman's rho {:.3f}\n",
                trainer::root_mean_square(measured), correlation);
}

void run(const CoverageArguments& arguments) {
  arguments.json.require_writable();
  if (!arguments.picture.empty()) require_writable(arguments.picture);
  shots::ShotFiles files;
  files.basis = arguments.basis;
  files.clip = arguments.clip;
  files.device.name = "cpu";
  if (!arguments.session.empty()) shots::take_session(arguments.session, files);
  static_cast<void>(ErrorExpectation(load_basis(files.basis)));  // refuses one without coverage before the clip is read
  shots::Shot shot = shots::read_shot(files, warn);
  const Basis& basis = shot.basis();
  const std::vector<Pose> poses = shot.poses(0, shot.frames.size());
  const ClipCoverage coverage = coverage_of(basis, shot.frames, poses, static_cast<std::size_t>(arguments.worst));

  Json result = result_of(coverage, basis);
  std::string text = coverage_text(coverage);
  if (!arguments.truth.empty()) {
    text += compare_with_truth(coverage.rms_mm, true_errors(basis, poses, arguments.truth), result);
  }
  if (!arguments.picture.empty()) {
    const std::string svg = report::heat_strip({coverage.frames, coverage.rms_mm, basis.coverage.names,
                                                transformed(coverage.errors, &ExpectedError::region_mm)});
    write_file_atomically(arguments.picture, std::as_bytes(std::span(svg)));
    text += "wrote " + arguments.picture + "\n";
  }
  arguments.json.emit(result, text);
}

}  // namespace

void add_coverage(CLI::App& app) {
  const auto [verb, arguments] = add_verb<CoverageArguments>(
      app, "coverage", "Show how well a basis knows the poses of a clip, and which frames to simulate next", run);
  add_shot(verb, arguments.basis, arguments.clip, arguments.session);
  add_number(verb, "--worst", arguments.worst, 1, 10000, "Frames to list");
  add_option(verb, "--truth", arguments.truth,
             "Shapes of these frames (.pc2, .mdd, .nodes, or DATASET#TAKE): are the expected errors right?")
      ->type_name("CACHE");
  add_option(verb, "--picture", arguments.picture, "FILE.svg",
             "Heat strip to write: frames from left to right, a row per region");
  arguments.clip.add_unit(verb);
  arguments.json.add(verb);
}

}  // namespace bodyopt::cli
