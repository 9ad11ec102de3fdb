#include "trainer/curate/consistency_report.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "base/parallel.h"
#include "base/progress.h"
#include "dataset/modifier.h"
#include "runtime/core/error.h"
#include "trainer/curate/pose_space.h"

namespace bodyopt {
using Eigen::Index;

namespace {

// Root mean square over the region of a row of its vertices' vectors, mm.
double region_rms_mm(const RegionWeights& region, const Eigen::RowVectorXf& row) {
  const auto square = [&](std::size_t k) { return double{row.segment<3>(3 * static_cast<Index>(k)).squaredNorm()}; };
  return 1e3 * std::sqrt(mean_over(region, square));
}

// Of a row of the vectors of a region's vertices, as far as the region has them.
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
  std::vector<int> neighbours = models.neighbours;
  const auto middle = neighbours.begin() + static_cast<std::ptrdiff_t>(neighbours.size() / 2);
  std::nth_element(neighbours.begin(), middle, neighbours.end());
  result.neighbours = *middle;
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

// The worst first. Two motions that pass each other disagree over many frames: of pairs whose frames lie close together
// the worst is named, so that a contradiction is in the list once.
std::vector<DisagreeingPair> ranked(const WorstOfPair& worst, std::size_t most) {
  constexpr std::size_t kSameMoment = 6;  // frames
  std::vector<DisagreeingPair> all, result;
  for (const auto& [frames, pair] : worst) all.push_back(pair);
  std::stable_sort(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.apart_mm > b.apart_mm; });
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
    throw Error(ErrorKind::mismatch, (database.dataset.folder / "dataset.json").string() +
                                         " names no takes: there are no frames to compare");
  }
  const Index vertices = database.character.vertices.rows();
  const Displacements displacements =
      all_displacements(database, "curate: un-posing", [&](std::size_t n) { return stack.offsets(n, count); });
  std::vector<char> used(frames), anchors(frames, false);
  for (std::size_t n = 0; n < frames; ++n) used[n] = !stack.is_dropped(n);
  ConsistencyReport report;
  WorstOfPair worst;
  Eigen::VectorXd of_frame = Eigen::VectorXd::Zero(static_cast<Index>(frames)),
                  of_vertex = Eigen::VectorXd::Zero(vertices);
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
      of_vertex[Index{part.region.vertices[k]}] += part.region.weights[k] * square.mean();
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
  for (const double square : of_vertex) report.vertex_mm.push_back(1e3 * std::sqrt(square));
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

}  // namespace bodyopt
