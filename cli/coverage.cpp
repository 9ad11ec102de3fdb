// bodyopt coverage: how well a basis knows the poses of a clip, and which frames to simulate next.
#include "trainer/train/coverage.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>

#include "cli/common.h"
#include "proxy_viewer/render/renderer.h"
#include "runtime/basis/error.h"
#include "trainer/dataset/controls.h"
#include "trainer/dataset/frame_range.h"
#include "trainer/dataset/shape_reader.h"

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
  const ShapeReader truth(path);
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

// A row of the strip per region and one more, on top, for the whole skin; a column per frame, or for the worst of
// several where they are more than fit.
Image strip(const std::vector<ExpectedError>& errors) {
  constexpr std::uint32_t kRow = 8, kTop = 24, kWidest = 2400, kWidth = 1200;  // pixels
  const std::size_t rows = 1 + errors.front().region_mm.size();
  const std::size_t frames = errors.size(), columns = std::min<std::size_t>(frames, kWidest);
  std::vector<double> cells(rows * columns);
  double largest = 0;
  for (std::size_t k = 0; k < frames; ++k) {
    for (std::size_t row = 0; row < rows; ++row) {
      const double mm = row == 0 ? errors[k].rms_mm : errors[k].region_mm[row - 1];
      double& cell = cells[row * columns + k * columns / frames];
      cell = std::max(cell, mm);
      largest = std::max(largest, mm);
    }
  }
  const auto scale = std::max<std::uint32_t>(1, kWidth / static_cast<std::uint32_t>(columns));
  Image image;
  image.width = scale * static_cast<std::uint32_t>(columns);
  image.height = kTop + kRow * static_cast<std::uint32_t>(rows - 1);
  image.rgba.resize(std::size_t{4} * image.width * image.height);
  for (std::uint32_t y = 0; y < image.height; ++y) {
    for (std::uint32_t x = 0; x < image.width; ++x) {
      const double mm = cells[(y < kTop ? 0 : 1 + (y - kTop) / kRow) * columns + x / scale];
      const auto colour = heat_colour(static_cast<float>(largest > 0 ? mm / largest : 0));
      std::uint8_t* pixel = image.rgba.data() + std::size_t{4} * (std::size_t{y} * image.width + x);
      for (std::size_t c = 0; c < 3; ++c) pixel[c] = static_cast<std::uint8_t>(std::lround(255 * colour[c]));
      pixel[3] = 255;
    }
  }
  return image;
}

void run(const CoverageArguments& arguments) {
  arguments.json.require_writable();
  if (!arguments.picture.empty()) require_writable(arguments.picture);
  const Basis basis = load_basis(arguments.basis);
  const std::vector<RegionCoverage> regions = read_coverage(basis);
  std::vector<int> frames;
  const double unit = arguments.unit > 0 ? arguments.unit : kept_unit(basis);
  Clip clip = arguments.clip.read(basis.skeleton, unit, frames);
  for (const std::string& name : arrange_controls(basis.residual.controls, clip)) {
    spdlog::warn("control '{}' is none that the basis was trained with: it has no effect", name);
  }
  const std::vector<Pose> poses = poses_of(clip, frames);

  const std::vector<ExpectedError> errors = expected_errors(basis, regions, poses);
  std::vector<double> expected;
  for (const ExpectedError& error : errors) expected.push_back(error.rms_mm);

  Json per_frame = Json::array(), per_region = Json::array();
  for (std::size_t k = 0; k < frames.size(); ++k) {
    const auto worst = std::max_element(errors[k].region_mm.begin(), errors[k].region_mm.end());
    const auto r = static_cast<std::size_t>(worst - errors[k].region_mm.begin());
    per_frame.push_back({{"frame", frames[k]},
                         {"expected_rms_mm", expected[k]},
                         {"region", r},
                         {"joint", regions.empty() ? "" : regions[r].joints.front()},
                         {"region_expected_mm", regions.empty() ? 0 : *worst}});
  }
  for (std::size_t r = 0; r < regions.size(); ++r) {
    double mean2 = 0;
    for (const ExpectedError& error : errors) mean2 += error.region_mm[r] * error.region_mm[r];
    per_region.push_back({{"joint", regions[r].joints.front()},
                          {"expected_rms_mm", std::sqrt(mean2 / static_cast<double>(errors.size()))}});
  }
  const std::size_t gap = std::max<std::size_t>(2, frames.size() / (4 * static_cast<std::size_t>(arguments.worst)));
  std::vector<int> next;
  std::string text = format("%8s %14s   %s\n", "frame", "expected mm", "most of all");
  for (const std::size_t k : worth_simulating(expected, static_cast<std::size_t>(arguments.worst), gap)) {
    next.push_back(frames[k]);
    text += format("%8d %14.3f   %s, %.3f mm\n", frames[k], expected[k],
                   per_frame[k]["joint"].get<std::string>().c_str(), per_frame[k]["region_expected_mm"].get<double>());
  }
  std::sort(next.begin(), next.end());
  double mean2 = 0;
  for (const double mm : expected) mean2 += mm * mm;
  const double rms = std::sqrt(mean2 / static_cast<double>(std::max<std::size_t>(1, expected.size())));
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
    double true_mean2 = 0;
    for (const double mm : measured) true_mean2 += mm * mm / static_cast<double>(measured.size());
    result["true_rms_mm"] = std::sqrt(true_mean2);
    text += format("true: %.3f mm RMS; the frames' expected and true errors rank alike with Spearman's rho %.3f\n",
                   std::sqrt(true_mean2), correlation);
  }
  if (!arguments.picture.empty()) {
    write_png(strip(errors), arguments.picture);
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
  verb.add_option("--truth", arguments->truth, "Shapes of these frames (.pc2, .nodes): are the expected errors right?")
      ->type_name("CACHE");
  verb.add_option("--picture", arguments->picture, "Heat strip to write: frames from left to right, a row per region")
      ->type_name("FILE.png")
      ->check(must_end_in(".png"));
  verb.add_option("--unit", arguments->unit,
                  "Metres per unit of the clip's file (default: as the character was read for training)")
      ->check(CLI::PositiveNumber);
  arguments->json.add(verb);
  verb.callback([arguments] { run(*arguments); });
}

}  // namespace bodyopt::cli
