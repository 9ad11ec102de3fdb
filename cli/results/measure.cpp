#include "cli/results/measure.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "base/frame_range.h"
#include "cli/results/report_pictures.h"
#include "dataset/dataset.h"
#include "geometry/mesh.h"
#include "runtime/basis/safetensors.h"
#include "runtime/core/stopwatch.h"
#include "runtime/core/text.h"
#include "runtime/core/transformed.h"
#include "trainer/proxy/build_proxy.h"
#include "trainer/train/coverage/coverage.h"
#include "trainer/train/judge/test_errors.h"
#include "trainer/train/pack/trade_off.h"
#include "trainer/train/skinning/provenance.h"

namespace bodyopt::cli {
namespace {

report::FrameAxis heldout_axis(const trainer::SampleSet& set) {
  report::FrameAxis axis;
  for (std::size_t k = 0; k < set.heldout.size(); ++k) {
    const trainer::Sample& sample = set.heldout[k];
    if (k == 0 || sample.take != set.heldout[k - 1].take) {
      axis.takes.push_back({set.take_of(sample), k});
    }
    axis.frames.push_back(sample.frame);
  }
  return axis;
}

void describe_character(const trainer::SampleSet& set, report::ReportData& report) {
  const Character& character = set.character;
  const Eigen::RowVector3d box = box_sides(character.vertices);
  report.character.name = character.name;
  report.character.vertices = static_cast<std::uint32_t>(character.vertices.rows());
  report.character.joints = static_cast<std::uint32_t>(character.skeleton.size());
  report.character.muscles = static_cast<std::uint32_t>(set.muscles.size());
  report.character.bounding_box_m = {box(0), box(1), box(2)};
  report.dataset.train_frames = static_cast<std::uint32_t>(set.train.size());
  report.dataset.heldout_frames = static_cast<std::uint32_t>(set.heldout.size());
  if (set.heldout.empty()) report.dataset.how_to_hold_out = trainer::how_to_hold_out(set);
  report.dataset.unconverged = static_cast<std::uint32_t>(set.unconverged);
}

void describe_result(const trainer::TrainingResult& result, report::ReportData& report) {
  const Basis& basis = result.basis;
  const double vertices = std::max(1u, basis.mesh.vertex_count());
  report.bytes_per_vertex = trainer::bytes_per_vertex(basis);
  for (const auto& [stage, bytes] : table_bytes(basis)) {
    report.bytes_by_stage.emplace_back(stage, static_cast<double>(bytes) / vertices);
  }
  report.trade_off = result.curve;
  report.expected_rms_mm = result.expected_mm;
  for (const trainer::RegionFit& fit : result.fits) {
    report.regions.push_back({fit.name, fit.motion_rms_mm, fit.validation_rms_mm, {}, {}});
  }
  for (const trainer::MuscleShare& muscle : result.muscles) report.muscles.push_back({muscle.name, muscle.percent});
  std::ranges::stable_sort(report.muscles, std::greater{}, &report::MuscleReport::percent);
  report.warnings = result.warnings;
}

report::CoverageReport heldout_coverage(const trainer::SampleSet& set, const Training& training) {
  constexpr std::size_t kWorst = 20;
  report::CoverageReport report;
  report.regions = training.result.basis.coverage.names;
  const std::vector<ExpectedError> errors = trainer::expected_errors(training.result.basis, heldout_poses(set));
  report.frame_mm = transformed(errors, &ExpectedError::rms_mm);
  report.region_mm = transformed(errors, &ExpectedError::region_mm);
  report.rms_mm = trainer::root_mean_square(report.frame_mm);
  const double correlation = trainer::rank_correlation(report.frame_mm, training.methods.back().errors.frame_rms);
  if (std::isfinite(correlation)) report.rank_correlation = correlation;
  report.worth_simulating =
      trainer::worth_simulating(report.frame_mm, kWorst, trainer::spreading_gap(report.frame_mm.size(), kWorst));
  return report;
}

// Adds expected and true errors over the held-out frames for the regions that the basis keeps.
void add_heldout_errors(const std::vector<RegionWeights>& weights, const trainer::VertexErrors& errors,
                        report::ReportData& report) {
  const report::CoverageReport& coverage = *report.coverage;
  for (report::RegionReport& region : report.regions) {
    const auto kept = std::ranges::find(coverage.regions, region.name);
    if (kept == coverage.regions.end()) continue;
    const std::vector<double> frames = transformed(coverage.region_mm, [&](const std::vector<double>& frame) {
      return frame[static_cast<std::size_t>(kept - coverage.regions.begin())];
    });
    region.expected_mm = trainer::root_mean_square(frames);
  }
  for (const RegionWeights& region : weights) {
    const auto same = std::ranges::find(report.regions, region.name, &report::RegionReport::name);
    if (same != report.regions.end()) same->true_mm = trainer::region_rms(errors, region);
  }
}

report::AreaErrorsReport area_errors(const trainer::MethodErrors& errors) {
  return {errors.ddm, errors.full, errors.expected};
}

bool is_foreign(const trainer::SampleSet& set, const std::string& take) {
  return std::ranges::none_of(set.train, [&](const trainer::Sample& sample) { return set.take_of(sample) == take; });
}

std::vector<report::TakeReport> take_reports(const trainer::SampleSet& set, const Basis& basis) {
  std::vector<report::TakeReport> reports;
  for (const trainer::TakeErrors& take : trainer::test_errors(basis, set)) {
    report::TakeReport& report = reports.emplace_back();
    report.name = take.take;
    report.foreign = is_foreign(set, take.take);
    report.frames = static_cast<std::uint32_t>(take.frames.size());
    report.errors = area_errors(take.errors);
    for (const trainer::PartErrors& part : take.parts)
      report.parts.push_back({part.part, part.area, area_errors(part.errors)});
    if (std::isfinite(take.rank_correlation)) report.rank_correlation = take.rank_correlation;
  }
  return reports;
}

// Frames of a take among some samples, ascending.
std::vector<int> frames_of(const std::vector<trainer::Sample>& samples, std::size_t take) {
  std::vector<int> frames;
  for (const trainer::Sample& sample : samples) {
    if (static_cast<std::size_t>(sample.take) == take) frames.push_back(sample.frame);
  }
  std::ranges::sort(frames);
  return frames;
}

report::ProvenanceReport::Take take_of(const DatasetTake& take, std::size_t index, const trainer::SampleSet& set) {
  const std::vector<int> trained = frames_of(set.train, index), heldout = frames_of(set.heldout, index);
  std::vector<int> left_out;
  for (const int frame : take.frames) {
    const bool used = std::ranges::binary_search(trained, frame) || std::ranges::binary_search(heldout, frame);
    if (!used) left_out.push_back(frame);
  }
  std::ranges::sort(left_out);
  return {take.name, format_frame_range(trained), format_frame_range(heldout), format_frame_range(left_out)};
}

std::vector<std::pair<std::string, std::string>> options_of(const trainer::Provenance& provenance,
                                                            const trainer::TrainOptions& options, double unit) {
  const trainer::TrainOptions& own = provenance.options;
  const auto text = [](auto value) { return Json(value).dump(); };
  std::vector<std::pair<std::string, std::string>> list = {
      {"smoothing_radius_m", text(own.smoothing_radius)},
      {"smoothing_steps", text(own.smoothing_steps)},
      {"components", text(own.components)},
      {"centres", text(own.centres)},
      {"surface_curves", text(own.surface_curves)},
      {"seed", text(own.seed)},
      {"budget", own.budget > 0 ? text(own.budget) : "none"},
      {"tolerance_mm", own.tolerance_mm > 0 ? text(own.tolerance_mm) : "none"}};
  if (provenance.updated) list.emplace_back("updated", "from an earlier training of other frames");
  list.emplace_back("memory_gib", format("{:.9g}", options.memory_gib));
  if (unit > 0) list.emplace_back("unit_m", format("{:.9g}", unit));
  return list;
}

}  // namespace

Training train_and_measure(const trainer::SampleSet& set, const trainer::TrainOptions& options, bool ablate,
                           double unit, const std::string& out) {
  const Stopwatch watch;
  Training training{trainer::train(set, options), 0, {}, {}};
  for (const std::string& note : training.result.notes) spdlog::info(note);
  training.seconds = watch.seconds();
  Basis& basis = training.result.basis;
  say(training.result.warnings);
  keep_unit(basis, unit);
  save_basis(basis, out);
  training.unposing = trainer::unposing_residual(set, basis);
  if (set.heldout.empty()) return training;
  std::vector<std::string> unmade;
  training.methods = ablate ? trainer::ablate(set, options, training.result, training.seconds, unmade)
                            : trainer::compare_with_skinning(set, basis, training.seconds);
  for (const std::string& name : unmade) {
    spdlog::warn("'{}' is not in the table: the least that it learns takes more bytes than the full model", name);
  }
  return training;
}

std::string method_table(const std::vector<MethodResult>& methods) {
  std::string text = format("{:40} {:>8} {:>8} {:>8} {:>8} {:>10} {:>8}\n", "method (errors in mm)", "RMS", "p99",
                            "max", "jitter", "bytes/vtx", "seconds");
  for (const MethodResult& method : methods) {
    const ErrorStatistics& errors = method.errors;
    text += format("{:40} {:8.3f} {:8.3f} {:8.2f} {:8.3f} {:10.0f} {:8.1f}\n", method.name, errors.rms, errors.p99,
                   errors.max, errors.jitter, method.bytes_per_vertex, method.seconds);
  }
  return text;
}

std::vector<Pose> heldout_poses(const trainer::SampleSet& set) {
  return transformed(set.heldout, &trainer::Sample::pose);
}

report::ReportData report_of(const trainer::SampleSet& set, const Training& training,
                             const std::vector<Positions>& shapes, const std::string& pictures_on) {
  report::ReportData report;
  describe_character(set, report);
  describe_result(training.result, report);
  report.unposing_residual_mm.lbs = training.unposing.lbs;
  report.unposing_residual_mm.ddm = training.unposing.ddm;
  report.train_seconds = training.seconds;
  report.methods = training.methods;
  if (!training.methods.empty()) {
    report.takes = take_reports(set, training.result.basis);
    const trainer::VertexErrors errors = trainer::vertex_errors(set, shapes);
    report.heldout = heldout_axis(set);
    report.coverage = heldout_coverage(set, training);
    const std::vector<RegionWeights>& regions = training.result.regions;
    add_heldout_errors(regions, errors, report);
    if (!pictures_on.empty()) {
      ReportPictures pictures(set, shapes, training.methods.back().errors, training.result.basis, pictures_on);
      report.pictures = pictures.worst_and_median();
      report.mean_error = pictures.mean_error(errors);
      report.flexed = pictures.flexed();
      report.region_picture = pictures.regions(regions);
    }
  }
  report.peak_memory_mib = peak_memory_mib();
  return report;
}

report::ProvenanceReport provenance_of(const Dataset& dataset, const std::filesystem::path& dataset_file,
                                       const trainer::SampleSet& set, const trainer::TrainOptions& options,
                                       const std::filesystem::path& basis_file) {
  const Metadata metadata = read_safetensors(basis_file).metadata;
  const trainer::Provenance own = trainer::read_provenance(metadata, basis_file).value();
  report::ProvenanceReport report;
  report.program = own.program;
  report.command_line = command_line();
  report.options = options_of(own, options, dataset.unit);
  report.basis_checksum = metadata.at("checksum");
  report.topology_hash = metadata.at("topology_hash");
  report.skeleton_hash = metadata.at("skeleton_hash");
  report.files.push_back({"dataset", dataset_file.string(), hexadecimal(file_hash(dataset_file))});
  for (const HashedFile& file : hashed_files(dataset)) {
    report.files.push_back({file.what, file.path, hexadecimal(file.xxh3)});
  }
  for (std::size_t k = 0; k < dataset.takes.size(); ++k) report.takes.push_back(take_of(dataset.takes[k], k, set));
  return report;
}

Json levels_info(const std::vector<Level>& levels, const trainer::ProxyReport& report) {
  Json list = Json::array();
  for (std::size_t k = 0; k < std::min(levels.size(), report.levels.size()); ++k) {
    const trainer::FrameTime time = trainer::frame_time(levels[k]);
    list.push_back({{"level", k}});
    list.back().update(trainer::to_json(report.levels[k]));
    list.back().update({{"coefficients", levels[k].basis.residual.coefficient_count()},
                        {"measured_on", report.measured_on},
                        {"microseconds", time.microseconds},
                        {"carrying_microseconds", time.carrying},
                        {"threads", time.threads}});
  }
  return list;
}

std::string level_table(const Json& levels) {
  if (levels.empty()) return "";
  std::string text =
      format("{:>5} {:>9} {:>9} {:>18} {:>9} {:>9} {:>9} {:>9} {:>9} {:>11} {:>11}\n", "level", "vertices", "error mm",
             "rest RMS, max mm", "RMS mm", "p99 mm", "max mm", "kilobytes", "with map", "us a frame", "carried");
  for (const Json& level : levels) {
    const auto number = [&](const char* key) { return level.at(key).get<double>(); };
    text += format("{:5} {:9} {:9.2f} {:9.2f} {:8.2f} {:9.3f} {:9.2f} {:9.1f} {:9.0f} {:9.0f} {:11.0f} {:11.0f}\n",
                   level.at("level").get<unsigned>(), level.at("vertices").get<unsigned>(), number("error_mm"),
                   number("distance_rms_mm"), number("distance_max_mm"), number("rms_mm"), number("p99_mm"),
                   number("max_mm"), number("bytes") / 1e3, (number("bytes") + number("map_bytes")) / 1e3,
                   number("microseconds"), number("microseconds") + number("carrying_microseconds"));
  }
  return text + format(
                    "RMS, p99, max: carried to the full skin, on {}; with map, carried: with what that takes; us: "
                    "on this machine's CPU, {} threads\n",
                    levels[0].at("measured_on").get<std::string>(), levels[0].at("threads").get<int>());
}

}  // namespace bodyopt::cli
