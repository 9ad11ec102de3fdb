// consistency: takes from every frame what passes by its pose disagree in, smoothed over the skin and capped, several
// times over, as long as less is left every time. What changes with the pose is in all passes: bulges at the ends of
// the range keep their size. Frames held out are neither moved nor asked: they judge.
#include "base/content_hash.h"
#include "base/parallel.h"
#include "base/progress.h"
#include "geometry/laplacian.h"
#include "trainer/curate/consistency_report.h"
#include "trainer/curate/hash_of.h"
#include "trainer/curate/modifier_type.h"

namespace bodyopt {
namespace {

using Eigen::Index;

// Raised whenever the same frames are made to agree in another way.
constexpr std::uint64_t kConsistencyVersion = 10;

struct ConsistencySettings {
  double degrees, smooth, cap;  // metres
  int iterations;
};

// What all parts together say of every frame, N x 3V.
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

// Smoothed over the skin; no vertex by more than the cap in all.
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
    // What does not come together is no history: all stays as the step before left it.
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

}  // namespace

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

}  // namespace bodyopt
