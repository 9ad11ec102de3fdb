#include "trainer/anatomy/muscle_candidates.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <numbers>

#include "base/parallel.h"
#include "runtime/core/error.h"
#include "trainer/anatomy/human_frame.h"
#include "trainer/anatomy/human_tables.h"

namespace bodyopt::trainer {
namespace {

using Eigen::Index;
using Eigen::Vector3d;

constexpr double kFanSpread = 0.12;                           // metres: parts that are farther apart have no fan
constexpr std::array<double, 4> kFan{0.12, 0.25, 0.37, 0.5};  // of the way to a part's neighbour

struct PlaceOnPath {
  double squared = std::numeric_limits<double>::max();  // distance
  double along = 0;                                     // 0 to 1
};

// A muscle's path and its share of the fans to the other parts of its sheet.
class PathFan {
 public:
  PathFan(const std::vector<HalfMuscle>& muscles, std::size_t own) : lines_{muscles[own].path} {
    for (std::size_t other = 0; other < muscles.size(); ++other) {
      if (other == own || !muscles[own].whole || !muscles[own].whole->is_sheet) continue;
      if (muscles[other].whole != muscles[own].whole) continue;
      const Positions away = muscles[other].path - muscles[own].path;
      if (away.rowwise().norm().mean() > kFanSpread) continue;
      for (const double share : kFan) lines_.push_back(muscles[own].path + share * away);
    }
    low_ = lines_[0].colwise().minCoeff();
    high_ = lines_[0].colwise().maxCoeff();
    for (const Positions& line : lines_) {
      low_ = low_.cwiseMin(line.colwise().minCoeff().transpose());
      high_ = high_.cwiseMax(line.colwise().maxCoeff().transpose());
    }
  }

  bool may_reach(const Vector3d& point, double reach) const {
    return (point.array() > low_.array() - reach).all() && (point.array() < high_.array() + reach).all();
  }

  PlaceOnPath nearest(const Vector3d& point, Index from = 0, Index to = kPathPoints - 1) const {
    PlaceOnPath best;
    const Positions* line = nullptr;
    Index at = 0;
    for (const Positions& candidate : lines_) {
      for (Index k = from; k <= to; ++k) {
        const double squared = (candidate.row(k).transpose() - point).squaredNorm();
        if (squared >= best.squared) continue;
        best.squared = squared;
        line = &candidate;
        at = k;
      }
    }
    best.along = static_cast<double>(at) / (kPathPoints - 1);
    for (const Index k : {at - 1, at}) {
      if (k >= 0 && k + 1 < kPathPoints) refine(*line, k, point, best);
    }
    return best;
  }

 private:
  static void refine(const Positions& line, Index k, const Vector3d& point, PlaceOnPath& best) {
    const Vector3d from = line.row(k), way = line.row(k + 1).transpose() - from;
    const double length = way.squaredNorm();
    if (!(length > 0)) return;
    const double share = std::clamp((point - from).dot(way) / length, 0.0, 1.0);
    const double squared = (from + share * way - point).squaredNorm();
    if (squared >= best.squared) return;
    best = {squared, (static_cast<double>(k) + share) / (kPathPoints - 1)};
  }

  std::vector<Positions> lines_;
  Vector3d low_, high_;
};

std::vector<bool> regions_on(const LeanSamples& lean, const Positions& path) {
  std::vector<bool> regions(256, false);
  for (Index k = 0; k < path.rows(); ++k) {
    const int sample = lean.grid.sample_at(Vector3d(path.row(k)));
    if (sample >= 0) regions[static_cast<std::size_t>(lean.tissue.region[static_cast<std::size_t>(sample)])] = true;
  }
  return regions;
}

struct Found {
  int sample;  // lean
  PlaceOnPath place;
};

std::vector<Found> samples_near(const LeanSamples& lean, const std::vector<HalfMuscle>& muscles, std::size_t m,
                                double reach) {
  const PathFan fan(muscles, m);
  const std::vector<bool> regions = regions_on(lean, muscles[m].path);
  std::vector<Found> found;
  for (std::size_t i = 0; i < lean.size(); ++i) {
    const Vector3d point = lean.points.row(static_cast<Index>(i));
    if (!fan.may_reach(point, reach) || !regions[static_cast<std::size_t>(lean.region(i))]) continue;
    const PlaceOnPath place = fan.nearest(point);
    if (place.squared < reach * reach) found.push_back({static_cast<int>(i), place});
  }
  return found;
}

struct TrunkMuscleRow {
  std::string name;
  double share;  // of the whole muscle's volume
  std::vector<LandmarkPoint> points;
};

const std::vector<TrunkMuscleRow>& trunk_muscle_rows() {
  static const std::vector<TrunkMuscleRow> rows = [] {
    const std::filesystem::path path = "rigs/human/trunk_muscles.json";
    const Json json = parse_json(kTrunkMuscles, path, "bodyopt-trunk-muscles-1");
    std::vector<TrunkMuscleRow> read;
    for (const JsonObject& row : JsonObject(json, path, "the file").objects("muscles")) {
      row.allow({"name", "share", "points"});
      read.push_back({row.name("name"), row.number("share", 0.01, 1), {}});
      for (const JsonObject& point : row.objects("points")) read.back().points.push_back(read_landmark_point(point));
      if (read.back().points.size() < 2) row.refuse("'points' are fewer than two");
    }
    return read;
  }();
  return rows;
}

// Lays a muscle in half space; it has no path where a landmark is missing.
Muscle lay(const TrunkMuscleRow& row, const LandmarkPlaces& landmarks, const BoneSurface& bones) {
  Muscle muscle;
  Positions path(static_cast<Index>(row.points.size()), 3);
  for (std::size_t k = 0; k < row.points.size(); ++k) {
    const std::optional<Vector3d> place = landmarks.place(row.points[k]);
    const int joint = place ? bones.foot(*place, -1).joint : -1;
    if (joint < 0) return {};
    path.row(static_cast<Index>(k)) = place->transpose();
    muscle.path.push_back({static_cast<std::uint32_t>(joint), {place->x(), place->y(), place->z()}});
  }
  const WholeMuscle* whole = find_whole_muscle(row.name);
  const double size = 1000 * landmarks.millimetre(),
               volume = whole ? row.share * whole->volume * size * size * size : 0;
  if (volume > 0) muscle.radius = std::sqrt(volume / (2 * path_length(path)));  // as divide_muscles() reads it
  return muscle;
}

bool is_among(const std::vector<Muscle>& others, const std::string& name) {
  const WholeMuscle* whole = find_whole_muscle(name);
  return std::ranges::any_of(others, [&](const Muscle& other) {
    return whole ? find_whole_muscle(other.name) == whole : matching_name(other.name) == matching_name(name);
  });
}

// Takes a muscle to rest space, on the half's own side or on the other.
Muscle to_rest(Muscle muscle, const HalfBody& body, bool is_other_side, const std::vector<int>& counterparts) {
  const Eigen::Affine3d rest = body.from_rest.inverse();
  for (MusclePoint& point : muscle.path) {
    Vector3d place(point.position.data());
    if (is_other_side) place.x() *= -1;
    place = rest * place;
    point.position = {place.x(), place.y(), place.z()};
    const int other = counterparts[point.joint];
    if (is_other_side && other >= 0) point.joint = static_cast<std::uint32_t>(other);
  }
  return muscle;
}

}  // namespace

double belly_section(const HalfMuscle& muscle, double along) {
  const double belly = (along - muscle.belly_from) / (muscle.belly_to - muscle.belly_from);
  return belly > 0 && belly < 1 ? std::sin(std::numbers::pi * belly) : 0;
}

MuscleCandidates::MuscleCandidates(const LeanSamples& lean, const std::vector<HalfMuscle>& muscles,
                                   const std::vector<double>& reach)
    : begin_(lean.size() + 1, 0), of_muscle_(muscles.size()) {
  std::vector<std::vector<Found>> found(muscles.size());
  parallel_for(muscles.size(), [&](std::size_t m) { found[m] = samples_near(lean, muscles, m, reach[m]); });
  for (const auto& of_muscle : found) {
    for (const Found& one : of_muscle) ++begin_[static_cast<std::size_t>(one.sample) + 1];
  }
  for (std::size_t i = 0; i < lean.size(); ++i) begin_[i + 1] += begin_[i];
  muscle_.resize(begin_.back());
  to_path_.resize(begin_.back());
  thickness_.resize(begin_.back());
  along_.resize(begin_.back());
  std::vector<std::size_t> next(begin_.begin(), begin_.end() - 1);
  for (std::size_t m = 0; m < muscles.size(); ++m) {
    for (const Found& one : found[m]) {
      const std::size_t entry = next[static_cast<std::size_t>(one.sample)]++;
      muscle_[entry] = static_cast<std::uint16_t>(m);
      to_path_[entry] = static_cast<float>(std::sqrt(one.place.squared));
      along_[entry] = static_cast<float>(one.place.along);
      thickness_[entry] = static_cast<float>(std::sqrt(belly_section(muscles[m], one.place.along)));
      of_muscle_[m].emplace_back(one.sample, entry);
    }
  }
}

void MuscleCandidates::update(const LeanSamples& lean, const std::vector<HalfMuscle>& muscles) {
  constexpr Index kWindow = 5;
  parallel_for(muscles.size(), [&](std::size_t m) {
    const PathFan fan(muscles, m);
    for (const auto& [sample, entry] : of_muscle_[m]) {
      const auto at = static_cast<Index>(std::lround(along_[entry] * (kPathPoints - 1)));
      const PlaceOnPath place = fan.nearest(lean.points.row(sample), std::max<Index>(at - kWindow, 0),
                                            std::min<Index>(at + kWindow, kPathPoints - 1));
      to_path_[entry] = static_cast<float>(std::sqrt(place.squared));
      along_[entry] = static_cast<float>(place.along);
      thickness_[entry] = static_cast<float>(std::sqrt(belly_section(muscles[m], place.along)));
    }
  });
}

std::size_t MuscleCandidates::find(std::size_t lean_sample, int muscle) const {
  std::size_t entry = begin_[lean_sample];
  while (entry < begin_[lean_sample + 1] && muscle_[entry] != muscle) ++entry;
  return entry;
}

TrunkMuscles trunk_muscles(const Character& character, const std::vector<Muscle>& others, double body_fat) {
  TrunkMuscles result;
  const std::vector<int> counterparts = mirrored_joints(character);
  for (const HalfBody& body : halves_of(character)) {
    const BodyGrid grid = sample_body(body, default_cell(character));
    const InnerTissue tissue = find_inner_tissue(body, grid, {body_fat, recognise_kind(character).kind});
    const LeanSamples lean(grid, tissue);
    const LandmarkPlaces landmarks(body, lean);
    const BoneSurface bones(body, grid, tissue);
    const bool is_left = body.from_rest.linear()(0, 0) > 0;
    for (const TrunkMuscleRow& row : trunk_muscle_rows()) {
      if (is_among(others, row.name)) continue;
      const Muscle laid = lay(row, landmarks, bones);
      if (laid.path.empty()) {
        result.notes.push_back("'" + row.name + "' is not laid: the skeleton lacks a landmark that it needs");
        continue;
      }
      for (const bool is_other_side : {false, true}) {
        if (is_other_side && !body.is_own_mirror) continue;
        Muscle muscle = to_rest(laid, body, is_other_side, counterparts);
        muscle.name = row.name + (is_left != is_other_side ? "_l" : "_r");
        result.muscles.push_back(muscle);
      }
    }
  }
  if (result.muscles.empty() && !result.notes.empty()) {
    throw Error(ErrorKind::mismatch, "muscles of the trunk: the character '", character.name,
                "' has none of the landmarks that they are laid by: expected a human with a "
                "pelvis, a neck and shoulders");
  }
  return result;
}

}  // namespace bodyopt::trainer
