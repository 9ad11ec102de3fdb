// The report of a trained character: report.json for programs, report.html for people.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "proxy_viewer/render/renderer.h"

namespace bodyopt {

// Errors of one method on the held-out frames, in millimetres, after the root's translation is taken out.
struct MethodReport {
  double rms = 0, p99 = 0, max = 0, jitter = 0;
  std::vector<double> frame_rms, frame_max;  // per held-out frame
  double bytes_per_vertex = 0;               // of the tables this method needs at run time
  std::uint32_t coefficients = 0;            // learned coefficients per frame; 0 for skinning alone
};

struct PictureReport {
  std::string kind;  // "worst", "median" or "chosen"
  int frame = 0;
  double rms_mm = 0, max_mm = 0;
  double heat_scale_mm = 1;  // error of the hottest colour
  std::string caption;       // a phrase on the pose, without a full stop; may be empty
  Image image;               // a triptych
};

struct SimulationReport {
  std::uint32_t frames = 0, converged = 0;
  double median_residual = 0, worst_residual = 0;  // force left over relative to the elastic forces, converged frames
  double mean_iterations = 0;
  double draft_rms_mm = 0, draft_max_mm = 0;  // of a draft of the held-out motion
};

// A basis of another size that the training could have given.
struct TradeOffReport {
  double bytes_per_vertex = 0, expected_rms_mm = 0, microseconds = 0;
  std::uint32_t coefficients = 0;
};

struct ReportData {
  bool quick = false;  // of too few frames to judge the errors
  struct {
    std::string name;
    std::uint32_t vertices = 0, joints = 0, muscles = 0;
    std::array<double, 3> bounding_box_m{};  // extents of the rest shape
  } character;
  struct {
    std::uint32_t train_frames = 0, heldout_frames = 0, unconverged = 0;  // unconverged: left out of both
  } dataset;
  MethodReport lbs, ddm, linear, full;
  std::vector<int> heldout_frame_numbers;  // of the per-frame errors, ascending
  struct {
    double lbs = 0, ddm = 0;
  } unposing_residual_mm;       // RMS of what is left to learn after un-posing, training frames
  double bytes_per_vertex = 0;  // of `full`
  std::vector<std::pair<std::string, double>> bytes_by_stage;  // of `full`; may be empty
  std::vector<TradeOffReport> trade_off;                       // by rising bytes; may be empty
  double cpu_gpu_max_difference_m = 0;
  std::string device;
  struct {
    double build_character = 0, simulate = 0, draft = 0, train = 0, eval = 0;
  } seconds;
  double peak_memory_mib = 0;
  std::vector<PictureReport> pictures;  // in the order in which they are shown
  std::optional<SimulationReport> simulation;
};

// Writes report.json and report.html into `folder`, which is made if need be. Throws Error(mismatch) when a number is
// not finite or a curve has another length than the frames, Error(file).
void write_report(const ReportData& data, const std::filesystem::path& folder);

}  // namespace bodyopt
