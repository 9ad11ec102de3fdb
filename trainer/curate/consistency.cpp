#include "trainer/curate/consistency.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "base/content_hash.h"
#include "base/parallel.h"
#include "base/progress.h"
#include "base/quantile.h"
#include "dataset/modifier.h"
#include "geometry/surface_distance.h"
#include "runtime/core/error.h"
#include "trainer/curate/modifier_types.h"
#include "trainer/curate/offset_cache.h"
#include "trainer/curate/pose_space.h"

namespace bodyopt::trainer {
namespace {

// consistency: takes from every frame what passes by its pose disagree in, smoothed over the skin and capped. It
// repeats that as long as less is left every time. What changes with the pose is in all passes: bulges at the ends of
// the range keep their size. Frames held out are neither moved nor asked: they judge.

using Eigen::Index;

// Raised whenever the same frames are made to agree in another way.
constexpr std::uint64_t kConsistencyVersion = 10;

struct ConsistencySettings {
  double degrees, smooth, cap;  // metres
  int iterations;
};

// The sum of all parts' deviations of every frame, N x 3V.
Displacements deviations(const Displacements& displacements, const std::vector<SkinPart>& parts,
                         const std::vector<LocalModels>& models) {
  Displacements sum = Displacements::Zero(displacements.rows(), displacements.cols());
  for (std::size_t p = 0; p < parts.size(); ++p) {
    const RegionWeights& region = parts[p].region;
    const Displacements own = part_deviations(displacements, parts[p], models[p]);
    for (std::size_t k = 0; k < region.vertices.size(); ++k) {
      sum.middleCols<3>(3 * Index{region.vertices[k]}) +=
          static_cast<float>(region.weights[k]) * own.middleCols<3>(3 * static_cast<Index>(k));
    }
  }
  return sum;
}

// Subtracts the deviation, smoothed over the skin; moves no vertex by more than the cap in all.
void take_from(Displacements& displacements, const Displacements& begun, const Displacements& deviation,
               const SkinSmoother& smoother, double cap, const std::vector<char>& moves) {
  parallel_for(moves.size(), [&](std::size_t n) {
    if (!moves[n]) return;
    const auto row = static_cast<Index>(n);
    const Eigen::RowVectorXd raw = deviation.row(row).cast<double>();
    if (raw.isZero(0)) return;
    const Positions smooth = smoother(Eigen::Map<const Positions>(raw.data(), raw.size() / 3, 3));
    for (Index v = 0; v < smooth.rows(); ++v) {
      const Eigen::RowVector3f start = begun.row(row).segment<3>(3 * v);
      Eigen::RowVector3f change = displacements.row(row).segment<3>(3 * v) - start - smooth.row(v).cast<float>();
      const float size = change.norm();
      if (size > static_cast<float>(cap)) change *= static_cast<float>(cap) / size;
      displacements.row(row).segment<3>(3 * v) = start + change;
    }
  });
}

Displacements made_consistent(const ModifierInput& input, const ConsistencySettings& settings,
                              const Displacements& begun) {
  const PoseDatabase& database = input.database;
  const std::vector<SkinPart> parts = skin_parts(database);
  std::vector<LocalModels> models;
  std::vector<char> used = input.selected;
  for (std::size_t n = 0; n < used.size(); ++n) used[n] = used[n] && !database.frames[n].heldout;
  std::vector<char> moves = used;
  for (std::size_t n = 0; n < moves.size(); ++n) moves[n] = moves[n] && !input.frozen[n];
  Progress progress("curate: consistency", parts.size() + static_cast<std::size_t>(settings.iterations));
  for (const SkinPart& part : parts) {
    models.push_back(local_models(database, part, settings.degrees, used, input.frozen, begun));
    progress.advance();
  }
  const SkinSmoother smoother(database.character.vertices, database.character.triangles, settings.smooth);
  Displacements best = begun, deviation = deviations(best, parts, models);
  float least = deviation.norm();
  for (int k = 0; k < settings.iterations; ++k) {
    Displacements next = best;
    take_from(next, begun, deviation, smoother, settings.cap, moves);
    deviation.resize(0, 0);  // as large as all shapes: before the next is worked out
    deviation = deviations(next, parts, models);
    // A disagreement that does not shrink is no history: all stays as the step before left it.
    if (!(deviation.norm() < least)) break;
    least = deviation.norm();
    best = std::move(next);
    progress.advance();
  }
  return best;
}

// A hash of all that made_consistent() looks at.
std::uint64_t key_of(const ModifierInput& input, const ConsistencySettings& settings) {
  const PoseDatabase& database = input.database;
  std::vector<std::uint64_t> below(database.frames.size());
  parallel_for(below.size(), [&](std::size_t n) { below[n] = input.key_below(n); });
  ContentHash hash;
  hash.add(kConsistencyVersion);
  for (const double setting :
       {settings.degrees, settings.smooth, settings.cap, static_cast<double>(settings.iterations)}) {
    hash.add(setting);
  }
  for (const RegionWeights& region : database.regions) {
    hash.add(region.name);
    hash.append(region.vertices.data(), region.vertices.size() * sizeof(region.vertices[0]));
    hash.append(region.weights.data(), region.weights.size() * sizeof(region.weights[0]));
  }
  for (std::size_t n = 0; n < below.size(); ++n) {
    const DatabaseFrame& frame = database.frames[n];
    hash.add(below[n]);
    for (const float control : frame.pose.controls) hash.add(static_cast<double>(control));
    for (const int number :
         {frame.take, frame.frame, int{frame.heldout}, int{input.selected[n]}, int{input.frozen[n]}}) {
      hash.add(static_cast<std::uint64_t>(number));
    }
  }
  return hash.value();
}

// The part of a frame's shape that its pass alone has, 3 per vertex of the part of the skin, un-posed, metres; zero
// without shares. `displacements`: N x 3V.
Eigen::RowVectorXf frame_deviation(const Displacements& displacements, const SkinPart& part,
                                   const std::vector<FrameShare>& shares) {
  const std::vector<std::uint32_t>& vertices = part.region.vertices;
  Eigen::RowVectorXf result = Eigen::RowVectorXf::Zero(3 * static_cast<Index>(vertices.size()));
  for (const FrameShare& other : shares) {
    const float share = static_cast<float>(other.share);
    for (std::size_t k = 0; k < vertices.size(); ++k) {
      result.segment<3>(3 * static_cast<Index>(k)) +=
          share * displacements.row(static_cast<Index>(other.frame)).segment<3>(3 * Index{vertices[k]});
    }
  }
  return result;
}

// Root mean square over the region of a row of its vertices' vectors, mm.
double region_rms_mm(const RegionWeights& region, const Eigen::RowVectorXf& row) {
  const auto square = [&](std::size_t k) { return double{row.segment<3>(3 * static_cast<Index>(k)).squaredNorm()}; };
  return 1e3 * std::sqrt(mean_over(region, square));
}

// The largest vector of a row over the region's vertices, each times its weight, mm.
double largest_mm(const RegionWeights& region, const Eigen::RowVectorXf& row) {
  double largest = 0;
  for (std::size_t k = 0; k < region.vertices.size(); ++k) {
    const double size{row.segment<3>(3 * static_cast<Index>(k)).norm()};
    largest = std::max(largest, region.weights[k] * size);
  }
  return 1e3 * largest;
}

RegionAgreement agreement(const SkinPart& part, const LocalModels& models, const Displacements& deviations) {
  RegionAgreement result;
  result.region = part.region.name;
  result.neighbours = median(models.neighbours);
  double sum = 0;
  std::size_t compared = 0;
  for (std::size_t n = 0; n < models.shares.size(); ++n) {
    if (models.shares[n].empty()) continue;
    ++compared;
    sum += std::pow(region_rms_mm(part.region, deviations.row(static_cast<Index>(n))), 2);
  }
  result.single =
      1 - static_cast<double>(compared) / static_cast<double>(std::max<std::size_t>(models.shares.size(), 1));
  if (compared > 0) result.same_pose = static_cast<double>(models.same_pose) / static_cast<double>(compared);
  result.deviation_mm = compared > 0 ? std::sqrt(sum / static_cast<double>(compared)) : 0;
  return result;
}

using WorstOfPair = std::map<std::pair<std::size_t, std::size_t>, DisagreeingPair>;

void add_pairs(const PoseDatabase& database, const SkinPart& part, const LocalModels& models,
               const Displacements& deviations, WorstOfPair& worst) {
  for (std::size_t n = 0; n < models.others.size(); ++n) {
    for (const std::size_t other : models.others[n]) {
      if (other <= n) continue;
      const double apart =
          region_rms_mm(part.region, deviations.row(static_cast<Index>(other)) - deviations.row(static_cast<Index>(n)));
      if (!(apart > 0)) continue;
      DisagreeingPair& there = worst[{n, other}];
      if (apart <= there.apart_mm) continue;
      there = {.first = n,
               .second = other,
               .region = part.region.name,
               .apart_mm = apart,
               .pose_degrees = pose_distance(database.frames[n].pose, database.frames[other].pose, part.joints)};
    }
  }
}

std::size_t frames_between(std::size_t a, std::size_t b) { return a > b ? a - b : b - a; }

// The worst first. Two motions that pass each other disagree over many frames. Only the worst of pairs whose frames lie
// close together is named, so that a contradiction is listed once.
std::vector<DisagreeingPair> ranked(const WorstOfPair& worst, std::size_t most) {
  constexpr std::size_t kSameMoment = 6;  // frames
  std::vector<DisagreeingPair> all, result;
  for (const auto& [frames, pair] : worst) all.push_back(pair);
  std::ranges::stable_sort(all, [](const auto& a, const auto& b) { return a.apart_mm > b.apart_mm; });
  for (const DisagreeingPair& pair : all) {
    if (result.size() == most) break;
    const bool is_named = std::ranges::any_of(result, [&](const DisagreeingPair& other) {
      return frames_between(pair.first, other.first) < kSameMoment &&
             frames_between(pair.second, other.second) < kSameMoment;
    });
    if (!is_named) result.push_back(pair);
  }
  return result;
}

}  // namespace

ConsistencyReport report_consistency(const ShapeStack& stack, double degrees, std::size_t most) {
  const PoseDatabase& database = stack.database();
  const std::size_t count = database.dataset.modifiers.size(), frames = database.frames.size();
  if (frames == 0) {
    throw Error(ErrorKind::mismatch, (database.dataset.folder / "dataset.json").string(),
                " names no takes: there are no frames to compare");
  }
  const Index vertices = database.character.vertices.rows();
  const Displacements displacements =
      all_displacements(database, "curate: un-posing", [&](std::size_t n) { return stack.offsets(n, count); });
  std::vector<char> used(frames), anchors(frames, false);
  for (std::size_t n = 0; n < frames; ++n) used[n] = !stack.is_dropped(n);
  ConsistencyReport report;
  WorstOfPair worst;
  Eigen::VectorXd of_frame = Eigen::VectorXd::Zero(static_cast<Index>(frames));
  const std::vector<SkinPart> parts = skin_parts(database);
  Progress progress("curate: comparing like poses", parts.size());
  std::vector<LocalModels> all_models;
  for (const SkinPart& part : parts) {
    const LocalModels& models =
        all_models.emplace_back(local_models(database, part, degrees, used, anchors, displacements));
    const Displacements deviations = part_deviations(displacements, part, models);
    report.regions.push_back(agreement(part, models, deviations));
    add_pairs(database, part, models, deviations, worst);
    for (std::size_t k = 0; k < part.region.vertices.size(); ++k) {
      const Eigen::VectorXd square =
          deviations.middleCols<3>(3 * static_cast<Index>(k)).cast<double>().rowwise().squaredNorm();
      of_frame += part.region.weights[k] * square;
    }
    progress.advance();
  }
  report.pairs = ranked(worst, most);
  for (DisagreeingPair& pair : report.pairs) {
    const auto part =
        std::ranges::find(parts, pair.region, [](const SkinPart& p) -> const std::string& { return p.region.name; });
    const LocalModels& models = all_models[static_cast<std::size_t>(part - parts.begin())];
    pair.difference = frame_deviation(displacements, *part, models.shares[pair.second]) -
                      frame_deviation(displacements, *part, models.shares[pair.first]);
    pair.most_mm = largest_mm(part->region, pair.difference);
  }
  for (const double square : of_frame)
    report.frame_mm.push_back(1e3 * std::sqrt(square / static_cast<double>(vertices)));
  return report;
}

PairInOnePose in_one_pose(const ShapeStack& stack, const DisagreeingPair& pair) {
  const PoseDatabase& database = stack.database();
  const Positions first = stack.offsets(pair.first, database.dataset.modifiers.size());
  Positions second = first;
  for (const SkinPart& part : skin_parts(database)) {
    if (part.region.name != pair.region) continue;
    for (std::size_t k = 0; k < part.region.vertices.size(); ++k) {
      second.row(Index{part.region.vertices[k]}) +=
          part.region.weights[k] * pair.difference.segment<3>(3 * static_cast<Index>(k)).cast<double>();
    }
  }
  const UnposedSpace::Frame pose = stack.space().frame(database.frames[pair.first].pose);
  return {pose.shape(first), pose.shape(second)};
}

Displacements part_deviations(const Displacements& displacements, const SkinPart& part, const LocalModels& models) {
  Displacements result = Displacements::Zero(displacements.rows(), 3 * static_cast<Index>(part.region.vertices.size()));
  parallel_for(models.shares.size(), [&](std::size_t n) {
    result.row(static_cast<Index>(n)) = frame_deviation(displacements, part, models.shares[n]);
  });
  return result;
}

Displacements all_displacements(const PoseDatabase& database, const std::string& title,
                                const std::function<Positions(std::size_t frame)>& offsets) {
  Displacements displacements(static_cast<Index>(database.frames.size()), 3 * database.character.vertices.rows());
  Progress progress(title, database.frames.size());
  parallel_for(database.frames.size(), [&](std::size_t n) {
    const Positions own = offsets(n);
    displacements.row(static_cast<Index>(n)) =
        Eigen::Map<const Eigen::RowVectorXd>(own.data(), own.size()).cast<float>();
    progress.advance();
  });
  return displacements;
}

ShapeModifier prepare_consistency(const ModifierInput& input) {
  const ConsistencySettings settings{parameter(input, "degrees", kAlikeDegrees, 0.1, 180),
                                     1e-3 * parameter(input, "smooth_mm", 10, 0.01, 1000),
                                     1e-3 * parameter(input, "cap_mm", kUsualCapMm, 0, 1000),
                                     static_cast<int>(parameter(input, "iterations", 10, 1, 20))};
  const std::uint64_t key = key_of(input, settings);
  const PoseDatabase& database = input.database;
  // N x 3V: what is added to every frame.
  const auto changes = std::make_shared<Displacements>(static_cast<Index>(database.frames.size()),
                                                       3 * database.character.vertices.rows());
  const auto numbers = [&] { return std::span(changes->data(), static_cast<std::size_t>(changes->size())); };
  if (changes->size() > 0 && !input.cache.find(key, numbers())) {
    *changes = all_displacements(database, "curate: un-posing", input.below);
    *changes = made_consistent(input, settings, *changes) - *changes;
    input.cache.keep(key, numbers());
  }
  const auto change = [changes](std::size_t frame) -> Positions {
    using Change = Eigen::Matrix<float, Eigen::Dynamic, 3, Eigen::RowMajor>;
    const float* row = changes->row(static_cast<Index>(frame)).data();
    return Eigen::Map<const Change>(row, changes->cols() / 3, 3).cast<double>();
  };
  ShapeModifier modifier{
      .cause = [change](std::size_t frame) -> std::optional<std::uint64_t> {
        const Positions own = change(frame);
        if (own.isZero(0)) return std::nullopt;
        return hash_of(own);
      },
      .apply = [change](const FrameInHand& frame, Positions& offsets) { offsets += change(frame.number); }};
  if (changes->size() > 0 && changes->isZero(0)) {
    modifier.note =
        "moves no frame: no like poses disagree, none are near enough to tell ('curate report' says where), or a "
        "first step would have left more than there is";
  }
  return modifier;
}

}  // namespace bodyopt::trainer
