// The report of a trained character: report.json for programs, report.html for people.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "dataset/compare.h"
#include "draw/renderer.h"

namespace bodyopt::report {

struct TakeStart {
  std::string name;
  std::size_t column = 0;  // its first
};

// Frames from left to right, a column each, take after take.
struct FrameAxis {
  std::vector<int> frames;       // of every column
  std::vector<TakeStart> takes;  // by column, the first at 0; none: all of one take
};

struct PictureReport {
  std::string kind;  // "worst", "median" or "chosen"
  std::string take;
  int frame = 0;
  double rms_mm = 0, max_mm = 0;
  double heat_scale_mm = 1;  // error of the hottest colour
  std::string caption;       // a phrase on the pose, without a full stop; may be empty
  draw::Image image;         // truth, Direct Delta Mush, result, distance
};

// The mean error of every vertex over the held-out frames, painted on the rest skin from the front and from behind.
struct MeanErrorReport {
  double heat_scale_mm = 1;
  double largest_mm = 0;
  draw::Image image;
};

// The effect of flexing on the skin: a frame of a take with controls, by what was learned, at rest and flexed.
struct FlexReport {
  std::string take;
  int frame = 0;
  std::vector<std::pair<std::string, double>> controls;  // those above 0, falling
  double max_mm = 0;                                     // that flexing moves the skin by
  double heat_scale_mm = 1;
  draw::Image image;  // at rest, flexed, and how far flexing moves the skin
};

// Sections through the field of tissues, at rest and in the frame in which muscles are flexed or shortened most.
struct SectionsReport {
  std::string take;
  int frame = 0;
  std::vector<std::string> names;  // of the numbers in the picture, from 1
  draw::Image image;               // pairs: at rest, and then
};

struct RegionReport {
  std::string name;
  double moves_mm = 0, left_mm = 0;  // RMS of the un-posed motion of the training frames; what cross-validation leaves
  std::optional<double> expected_mm, true_mm;  // RMS over the held-out frames; expected of what the basis keeps
};

struct MuscleReport {
  std::string name;
  double percent = 0;  // of the un-posed motion that its strains explain
};

// Errors that the basis expects of the held-out frames, in millimetres RMS.
struct CoverageReport {
  double rms_mm = 0;
  std::vector<double> frame_mm;                // per held-out frame
  std::vector<std::string> regions;            // those the basis keeps
  std::vector<std::vector<double>> region_mm;  // per held-out frame, of every region
  std::optional<double> rank_correlation;      // of the frames' expected with their true errors; none where equal
  std::vector<std::size_t> worth_simulating;   // held-out frames (columns), worst first
};

// RMS over held-out frames of a take and an area of the rest skin, in millimetres.
struct AreaErrorsReport {
  double ddm_mm = 0, full_mm = 0;  // Direct Delta Mush alone; all that was learned
  double expected_mm = 0;          // what the basis itself expects of `full_mm`
};

// Errors on the held-out frames of a take, by area: dense parts of a mesh count as much as they are large.
struct TakeReport {
  std::string name;
  bool foreign = false;  // none of its frames was trained on
  std::uint32_t frames = 0;
  AreaErrorsReport errors;
  struct Part {
    std::string name;  // a joint, whose skin it is
    double area_m2 = 0;
    AreaErrorsReport errors;
  };
  std::vector<Part> parts;
  std::optional<double> rank_correlation;  // of expected with true errors of every frame and part; none where equal
};

// Everything needed to repeat a training. Paths as the user gave them.
struct ProvenanceReport {
  std::string program, command_line;
  std::vector<std::pair<std::string, std::string>> options;
  std::string basis_checksum, topology_hash, skeleton_hash;  // hexadecimal
  struct File {
    std::string what, path, xxh3;
  };
  std::vector<File> files;  // the dataset's own, and all that it names
  struct Take {
    std::string name, trained, heldout, left_out;  // frame ranges
  };
  std::vector<Take> takes;
};

// Further results of `bodyopt demo`.
struct DemoReport {
  bool quick = false;  // of too few frames to judge the errors
  std::uint32_t frames = 0, converged = 0;
  double median_residual = 0, worst_residual = 0;  // force left over relative to the elastic forces, converged frames
  double mean_iterations = 0;
  double draft_rms_mm = 0, draft_max_mm = 0;  // of a draft of the held-out motion
  double cpu_gpu_max_difference_m = 0;
  struct {
    double build_character = 0, simulate = 0, draft = 0, eval = 0;
  } seconds;
};

// A motion that stops suddenly: how far the jiggling skin is from the quasi-static one.
struct JiggleReport {
  std::uint32_t tets = 0, nodes = 0;
  double worst_quality = 0;              // of the tets: 1 regular, 0 flat
  double diffuse_mb = 0, jiggle_mb = 0;  // of their tables
  int moves_after = 0, stops = 0;        // the pose is held up to the one frame and from the other on
  double frames_per_second = 24;
  std::vector<int> frames;                   // one at least
  std::vector<double> rms_mm, max_mm;        // per frame, over the skin
  std::vector<std::uint32_t> inverted_tets;  // per frame: inside out where diffuse moves them
  double diffuse_ms = 0, jiggle_ms = 0;      // a frame; 0 where the device tells no times
  std::string device;
  struct Pictures {
    draw::Image strip;  // still above, jiggling below, coloured by the displacement; a column for each of strip_frames
    std::vector<int> strip_frames;
    double heat_scale_mm = 1;
    std::vector<std::uint8_t> animation;       // WebP of all frames: still on the left, jiggling on the right
    std::vector<std::uint8_t> slow_animation;  // the same at half the speed
    std::uint32_t width = 0, height = 0;       // their size in pixels
  };
  std::optional<Pictures> pictures;  // none without a Vulkan device
};

struct ReportData {
  struct {
    std::string name;
    std::uint32_t vertices = 0, joints = 0, muscles = 0;
    std::array<double, 3> bounding_box_m{};  // extents of the rest shape
  } character;
  struct {
    std::uint32_t train_frames = 0, heldout_frames = 0, unconverged = 0;  // unconverged: left out of both
    std::string how_to_hold_out;  // where none are: a sentence without a full stop
  } dataset;
  // Linear blending, Direct Delta Mush, any others, and last what was trained; none without held-out frames.
  std::vector<MethodResult> methods;
  FrameAxis heldout;              // of the per-frame errors
  std::vector<TakeReport> takes;  // those that hold frames out
  struct {
    double lbs = 0, ddm = 0;
  } unposing_residual_mm;                            // RMS of what is left to learn after un-posing, training frames
  double bytes_per_vertex = 0, expected_rms_mm = 0;  // of what was trained
  std::vector<std::pair<std::string, double>> bytes_by_stage;  // of what was trained; may be empty
  std::vector<TradeOffPoint> trade_off;                        // by rising bytes; may be empty
  std::vector<RegionReport> regions;
  std::optional<draw::Image> region_picture;  // from the front and from behind, numbered from 1 in their order
  std::vector<MuscleReport> muscles;          // what they explain, falling
  std::optional<CoverageReport> coverage;
  std::vector<std::string> warnings;
  std::string device;  // on which the held-out frames were evaluated
  double train_seconds = 0, peak_memory_mib = 0;
  std::vector<PictureReport> pictures;  // in the order in which they are shown; none without a Vulkan device
  std::optional<MeanErrorReport> mean_error;
  std::optional<FlexReport> flexed;        // none where no control was learned
  std::optional<SectionsReport> sections;  // none where there are no muscles
  ProvenanceReport provenance;
  std::optional<JiggleReport> jiggle;
  std::optional<DemoReport> demo;
};

// Writes report.json, which it returns, and report.html into `folder`, which is made if need be. Throws Error(mismatch)
// when a number is not finite or a curve has another length than the frames, Error(file).
Json write_report(const ReportData& data, const std::filesystem::path& folder);

}  // namespace bodyopt::report
