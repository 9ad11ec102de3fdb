// Levels of detail of a character, trained on its own shapes.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "runtime/basis/basis.h"
#include "runtime/basis/levels.h"
#include "runtime/core/json.h"
#include "trainer/proxy/level_skins.h"
#include "trainer/train/data/samples.h"
#include "trainer/train/options.h"

namespace bodyopt::trainer {

// A proxy learns from the full skin's data at the vertices that stay; without a dataset, from shapes that a trained
// basis gives.

// The character with the simplified skin: names, joints and, of every vertex that stays, place and weights are the
// same. Its output vertices are its welded ones.
Character proxy_character(const Character& character, const SimplifiedSkin& skin);

// The samples of the proxy have the same frames, muscles, controls and painted regions. Shapes stay where they are, and
// only rows of them are read. A painted region that keeps no vertex is left out, with a note.
SampleSet proxy_samples(const SampleSet& set, const SimplifiedSkin& skin);

// One sample for every pose, named by `frames`, its shape by the teacher on the CPU; shapes stay in memory. Every fifth
// block of ten frames is held out. The poses' controls are the teacher's. Throws Error(mismatch) where the teacher is
// not of this character, or a pose does not fit.
SampleSet taught_samples(const Character& character, const std::vector<Muscle>& muscles, const Basis& teacher,
                         std::span<const Pose> poses, std::span<const int> frames);

struct ProxyOptions {
  // Metres, rising, for the skin of each level (simplify_skin). Empty: default_errors(), as far as they make levels.
  std::vector<double> errors;
  TrainOptions train{.centres =
                         64};  // on so few vertices 256 cost a third more bytes and gain a hundredth of the error
};

// Measurements of a level; errors in mm.
struct LevelReport {
  std::uint32_t vertices = 0;                 // welded
  double error = 0;                           // that was asked of its skin
  double distance_rms = 0, distance_max = 0;  // of the full rest skin's vertices from its own
  double skin_rms = 0;               // what carrying the full skin leaves where every vertex of its own is exact
  double rms = 0, p99 = 0, max = 0;  // of its result, carried to the full skin, from the shapes
  double bytes = 0;                  // of its tables
  double map_bytes = 0;              // of what carries the full skin, on top
};
Json to_json(const LevelReport& report);
struct ProxyReport {
  std::uint32_t full_vertices = 0;
  std::string measured_on;  // "72 held-out frames"
  std::vector<LevelReport> levels;
};
// The first level's metadata "levels".
Json to_json(const ProxyReport& report);
// Reads the first level's metadata; no levels where it has none. Throws Error(file) where it is damaged.
ProxyReport read_proxy_report(const Basis& basis);

struct BuiltProxy {
  std::vector<Level> levels;
  ProxyReport report;
};

// Simplifies the skin for each error, transfers weights, painted regions and shapes, and trains each as train() does.
// Shows progress. `notes`: gets what the user should know. Throws as train(), and, before any training, as
// level_skins().
BuiltProxy build_proxy(const SampleSet& set, const ProxyOptions& options, std::vector<std::string>& notes);

struct FrameTime {
  double microseconds = 0;  // of a frame, all stages, on the CPU
  double carrying = 0;      // microseconds of carrying the full skin, on top; 0 where there is none
  int threads = 1;
};

// Times the bind pose (any pose takes as long): the best of three batches of 32.
FrameTime frame_time(const Level& level);

}  // namespace bodyopt::trainer
