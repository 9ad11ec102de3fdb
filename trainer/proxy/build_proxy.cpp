#include "trainer/proxy/build_proxy.h"

#include <algorithm>
#include <limits>
#include <nlohmann/json.hpp>
#include <numeric>
#include <set>

#include "base/progress.h"
#include "base/wording.h"
#include "runtime/core/error.h"
#include "runtime/core/stopwatch.h"
#include "runtime/deformer/deformer.h"
#include "runtime/host/carry_skin.h"
#include "runtime/host/device_choice.h"
#include "runtime/threads/tbb_executor.h"
#include "trainer/train/data/learned_poses.h"
#include "trainer/train/features/features.h"
#include "trainer/train/fit/train.h"
#include "trainer/train/skinning/ddm.h"

namespace bodyopt::trainer {
namespace {

// Empty where the region keeps no vertex.
RegionWeights region_at(const RegionWeights& region, const VertexRows& rows) {
  RegionWeights result{region.name, {}, {}};
  for (std::size_t k = 0; k < region.vertices.size(); ++k) {
    const auto row = std::lower_bound(rows.begin(), rows.end(), region.vertices[k]);
    if (row == rows.end() || *row != region.vertices[k]) continue;
    result.vertices.push_back(static_cast<std::uint32_t>(row - rows.begin()));
    result.weights.push_back(region.weights[k]);
  }
  return result;
}

constexpr std::size_t kBlock = 10, kHeldoutEvery = 5;

constexpr std::size_t kMostMeasured = 200;

// Muscles of which no fibre lies on the skin.
std::vector<std::string> lost_muscles(const Basis& basis, const std::vector<Muscle>& muscles) {
  const StrainTable strain = make_strain_table(basis, muscles);
  const std::vector<std::size_t> kept = fibre_muscles(strain, muscles);
  const std::set<std::size_t> there(kept.begin(), kept.end());
  std::vector<std::string> lost;
  for (std::size_t m = 0; m < muscles.size(); ++m) {
    if (!there.contains(m)) lost.push_back(muscles[m].name);
  }
  return lost;
}

class ProxyBuilder {
 public:
  ProxyBuilder(const SampleSet& set, const ProxyOptions& options, std::vector<std::string>& notes)
      : set_(set), options_(options), notes_(notes) {
    const bool heldout = !set.heldout.empty();
    measured_ = some_samples(heldout ? set.heldout : set.train, kMostMeasured);
    built_.report.full_vertices = static_cast<std::uint32_t>(set.character.vertices.rows());
    built_.report.measured_on = std::to_string(measured_.size()) + (heldout ? " held-out frames" : " training frames");
  }

  void add(const LevelSkin& made) {
    const auto& [error, skin] = made;
    const std::string name = "level " + std::to_string(built_.levels.size());
    const SampleSet samples = proxy_samples(set_, skin);
    for (const std::string& note : samples.notes) notes_.push_back(name + ": " + note);

    Level level;
    level.basis.mesh = make_mesh_table(in_order(samples.character, morton_order(samples.character.vertices)));
    level.carried = map_skin(set_.character, level.basis.mesh);
    LevelReport report = measured_skin(samples, level, error);
    TrainingResult trained = train(samples, options_.train);
    say_of(trained, name);
    level.basis = std::move(trained.basis);
    if (!built_.levels.empty()) level.basis.metadata.erase(kLearnedPoses);  // the first level has them
    measure_result(level, report);
    built_.levels.push_back(std::move(level));
    built_.report.levels.push_back(report);
  }

  BuiltProxy take() {
    built_.levels.front().basis.metadata["levels"] = to_json(built_.report).dump();
    return std::move(built_);
  }

 private:
  LevelReport measured_skin(const SampleSet& samples, const Level& level, double error) const {
    LevelReport report;
    report.vertices = level.basis.mesh.vertex_count();
    report.error = 1e3 * error;
    const SkinDistance distance = skin_distance(set_.character, samples.character);
    report.distance_rms = distance.rms;
    report.distance_max = distance.max;
    report.skin_rms = carried_rms_mm(level, set_.character, some_samples(set_.train, kMostMeasured),
                                     some_samples(samples.train, kMostMeasured));
    return report;
  }

  void say_of(const TrainingResult& trained, const std::string& name) {
    if (built_.levels.empty()) {  // of the data, which all levels share
      notes_.insert(notes_.end(), trained.warnings.begin(), trained.warnings.end());
    }
    if (const std::vector<std::string> lost = lost_muscles(trained.basis, set_.muscles); !lost.empty()) {
      notes_.push_back(name + ": " + count_of(lost.size(), "muscle has", "muscles have") +
                       " no fibre on the skin: " + list_names(lost, 6));
    }
  }

  void measure_result(const Level& level, LevelReport& report) const {
    const ErrorStatistics errors = level_errors(level, set_.character, measured_);
    report.rms = errors.rms;
    report.p99 = errors.p99;
    report.max = errors.max;
    report.bytes = static_cast<double>(total_bytes(level.basis));
    report.map_bytes = static_cast<double>(level.carried.bytes());
  }

  const SampleSet& set_;
  const ProxyOptions& options_;
  std::vector<std::string>& notes_;
  std::vector<Sample> measured_;
  BuiltProxy built_;
};

}  // namespace

Character proxy_character(const Character& character, const SimplifiedSkin& skin) {
  Character proxy;
  proxy.name = character.name;
  proxy.skeleton = character.skeleton;
  proxy.vertices.resize(static_cast<Eigen::Index>(skin.vertices.size()), 3);
  for (std::size_t v = 0; v < skin.vertices.size(); ++v) {
    proxy.vertices.row(static_cast<Eigen::Index>(v)) = character.vertices.row(skin.vertices[v]);
    proxy.weights.push_back(character.weights[skin.vertices[v]]);
  }
  proxy.triangles = proxy.output_triangles = skin.triangles;
  proxy.output_vertex.resize(skin.vertices.size());
  std::iota(proxy.output_vertex.begin(), proxy.output_vertex.end(), 0u);
  return proxy;
}

SampleSet proxy_samples(const SampleSet& set, const SimplifiedSkin& skin) {
  SampleSet proxy;
  proxy.character = proxy_character(set.character, skin);
  proxy.muscles = set.muscles;
  proxy.takes = set.takes;
  proxy.controls = set.controls;
  proxy.unconverged = set.unconverged;
  proxy.sparse = true;
  for (const RegionWeights& region : set.regions) {
    RegionWeights kept = region_at(region, skin.vertices);
    if (kept.vertices.empty()) {
      proxy.notes.push_back("region '" + region.name + "' keeps no vertex of the skin, and is left out");
    } else {
      proxy.regions.push_back(std::move(kept));
    }
  }
  const auto rows = std::make_shared<const VertexRows>(skin.vertices);
  for (const auto& [from, to] : {std::pair(&set.train, &proxy.train), std::pair(&set.heldout, &proxy.heldout)}) {
    for (Sample sample : *from) {
      sample.shape = sample.shape.at(rows);
      to->push_back(std::move(sample));
    }
  }
  return proxy;
}

SampleSet taught_samples(const Character& character, const std::vector<Muscle>& muscles, const Basis& teacher,
                         std::span<const Pose> poses, std::span<const int> frames) {
  require_same_character(make_mesh_table(in_order(character, morton_order(character.vertices))), character.skeleton,
                         teacher);
  SampleSet set;
  set.character = character;
  set.muscles = muscles;
  set.takes = {"clip"};
  set.controls = teacher.residual.controls;
  Deformer deformer(teacher, {.name = "cpu"});
  Progress progress("proxy: shapes of the basis", poses.size());
  for (std::size_t k = 0; k < poses.size(); ++k) {
    const Evaluation frame = deformer.evaluate(poses.subspan(k, 1));
    const bool heldout = k / kBlock % kHeldoutEvery == kHeldoutEvery - 1;
    (heldout ? set.heldout : set.train)
        .push_back({0, frames[k], poses[k], SampleShape(welded_from_output(character, frame.positions.data()))});
    progress.advance();
  }
  return set;
}

Json to_json(const LevelReport& report) {
  return {{"vertices", report.vertices},
          {"error_mm", report.error},
          {"distance_rms_mm", report.distance_rms},
          {"distance_max_mm", report.distance_max},
          {"skin_rms_mm", report.skin_rms},
          {"rms_mm", report.rms},
          {"p99_mm", report.p99},
          {"max_mm", report.max},
          {"bytes", report.bytes},
          {"map_bytes", report.map_bytes}};
}

Json to_json(const ProxyReport& report) {
  Json levels = Json::array();
  for (const LevelReport& level : report.levels) levels.push_back(to_json(level));
  return {{"full_vertices", report.full_vertices}, {"measured_on", report.measured_on}, {"levels", levels}};
}

ProxyReport read_proxy_report(const Basis& basis) {
  ProxyReport report;
  const auto text = basis.metadata.find("levels");
  if (text == basis.metadata.end()) return report;
  const std::string where = "the basis' metadata 'levels'";
  const auto json = parse_strict_json(text->second, where);
  try {
    report.full_vertices = json.at("full_vertices");
    report.measured_on = json.at("measured_on");
    for (const auto& level : json.at("levels")) {
      report.levels.push_back({level.at("vertices"), level.at("error_mm"), level.at("distance_rms_mm"),
                               level.at("distance_max_mm"), level.at("skin_rms_mm"), level.at("rms_mm"),
                               level.at("p99_mm"), level.at("max_mm"), level.at("bytes"), level.at("map_bytes")});
    }
  } catch (const Json::exception& error) {
    throw Error(ErrorKind::file, where + " is damaged: " + error.what());
  }
  return report;
}

BuiltProxy build_proxy(const SampleSet& set, const ProxyOptions& options, std::vector<std::string>& notes) {
  check_samples(set);
  ProxyBuilder builder(set, options, notes);
  for (const LevelSkin& skin : level_skins(set.character, shapes_of_skin(set), options.errors, notes))
    builder.add(skin);
  return builder.take();
}

FrameTime frame_time(const Level& level) {
  constexpr std::size_t kFrames = 32;
  constexpr int kRounds = 3;
  Deformer deformer(level.basis, {.name = "cpu"});
  const std::vector<Pose> poses(kFrames, bind_pose(level.basis.skeleton));
  const std::unique_ptr<Executor> threads = make_tbb_executor();
  double best = std::numeric_limits<double>::infinity(), carrying = best;
  for (int round = 0; round < kRounds; ++round) {
    const Evaluation frames = deformer.evaluate(poses);
    best = std::min(best, frames.stage_seconds.sum());
    const Stopwatch watch;
    carry_skin(level.basis.mesh, level.carried, frames.positions, frames.normals, *threads);
    carrying = std::min(carrying, watch.seconds());
  }
  if (level.carried.empty()) carrying = 0;
  return {1e6 * best / kFrames, 1e6 * carrying / kFrames, static_cast<int>(thread_count())};
}

}  // namespace bodyopt::trainer
