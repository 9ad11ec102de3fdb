#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <optional>

#include "base/parallel.h"
#include "trainer/anatomy/division.h"
#include "trainer/anatomy/human_frame.h"
#include "trainer/anatomy/human_tables.h"

namespace bodyopt::trainer {
namespace {

using Eigen::Index;
using Eigen::Vector3d;

constexpr double kNarrowest = 0.05;  // sine of the least angle of an elbow that tells where its flexors are
constexpr double kOverlap = 0.04;    // of a limb's length: model points so near to a table's rows are left out
constexpr double kBesidePlane = 0.0015;
constexpr double kRayStep = 0.001;                       // metres
constexpr double kBoneReach = 0.05, kLimbRadius = 0.12;  // metres, of a man of 1.75 m

// One muscle's belly in one section of a limb.
struct SectionPlace {
  double along;  // from the limb's upper joint, 0, to its lower, 1
  double angle;  // radians, from the front towards the outside
  double share;  // of the way from the section's origin to the fascia
};

struct LimbSections {
  BodyPart from, to;   // joints
  bool is_about_bone;  // the section's origin is its bone, otherwise its middle
  struct OfMuscle {
    std::vector<std::string> names;  // of matching_name()
    std::vector<SectionPlace> places;
  };
  std::vector<OfMuscle> muscles;
};

// A whole path by landmarks, from one end to the other; what is none is the model's own end.
struct LandmarkPath {
  std::vector<std::string> names;
  std::vector<std::optional<LandmarkPoint>> points;
};

// rigs/human/muscle_sections.json.
struct SectionTable {
  std::vector<LimbSections> limbs;
  std::vector<LandmarkPath> paths;
};

constexpr std::pair<const char*, BodyPart> kLimbJoints[] = {
    {"thigh", BodyPart::thigh},         {"shin", BodyPart::shin},       {"foot", BodyPart::foot},
    {"upper_arm", BodyPart::upper_arm}, {"forearm", BodyPart::forearm}, {"hand", BodyPart::hand}};

BodyPart read_joint(const JsonObject& json, const char* key) {
  const std::string name = json.name(key);
  for (const auto& [known, part] : kLimbJoints) {
    if (name == known) return part;
  }
  json.refuse("'", name, "' is no joint of a limb");
}

std::vector<std::string> read_matching_names(const JsonObject& json) {
  std::vector<std::string> names;
  for (const std::string& name : json.names("names")) names.push_back(matching_name(name));
  return names;
}

LimbSections read_limb(const JsonObject& json) {
  json.allow({"from", "to", "about", "source", "muscles"});
  LimbSections limb{read_joint(json, "from"), read_joint(json, "to"), json.name("about") == "bone", {}};
  for (const JsonObject& row : json.objects("muscles")) {
    row.allow({"names", "at"});
    LimbSections::OfMuscle muscle{read_matching_names(row), {}};
    for (const Json& place : row.array("at")) {
      if (!place.is_array() || place.size() != 3) row.refuse("'at' holds something else than [along, angle, share]");
      muscle.places.push_back(
          {place[0].get<double>(), place[1].get<double>() * std::numbers::pi / 180, place[2].get<double>()});
    }
    if (muscle.places.size() < 2) row.refuse("'at' has fewer than two places");
    limb.muscles.push_back(std::move(muscle));
  }
  return limb;
}

LandmarkPath read_path(const JsonObject& json) {
  json.allow({"names", "points"});
  LandmarkPath path{read_matching_names(json), {}};
  for (const Json& point : json.array("points")) {
    path.points.emplace_back();
    if (point != "own") path.points.back() = read_landmark_point(JsonObject(point, json.path(), json.place()));
  }
  if (path.points.size() < 2) json.refuse("'points' are fewer than two");
  return path;
}

const SectionTable& section_table() {
  static const SectionTable table = [] {
    const std::filesystem::path path = "rigs/human/muscle_sections.json";
    const Json json = parse_json(kMuscleSections, path, "bodyopt-muscle-sections-1");
    const JsonObject top(json, path, "the file");
    SectionTable read;
    for (const JsonObject& limb : top.objects("limbs")) read.limbs.push_back(read_limb(limb));
    for (const JsonObject& one : top.objects("paths")) read.paths.push_back(read_path(one));
    return read;
  }();
  return table;
}

Vector3d perpendicular(const Vector3d& direction, const Vector3d& axis) {
  return (direction - direction.dot(axis) * axis).stableNormalized();
}

// A limb between two joints as its sections see it.
class SectionedLimb {
 public:
  SectionedLimb(const HalfBody& body, const LeanSamples& lean, const LimbSections& sections, double millimetre)
      : body_(body), lean_(lean), is_about_bone_(sections.is_about_bone), unit_(1000 * millimetre) {
    from_ = body.find(sections.from);
    const int to = body.find(sections.to);
    if (from_ < 0 || to < 0) return;
    start_ = body.places[static_cast<std::size_t>(from_)];
    const Vector3d way = body.places[static_cast<std::size_t>(to)] - start_;
    length_ = way.norm();
    if (!(length_ > 0)) return;
    axis_ = way / length_;
    outwards_[0] = outwards_[1] = perpendicular(Vector3d::UnitX(), axis_);
    if (sections.from == BodyPart::upper_arm || sections.from == BodyPart::forearm) turn_as_arm();
    for (int s = 0; s < lean.grid.size(); ++s) {
      const double along = along_of(lean.grid.points.row(s));
      if (along > -0.3 && along < 1.3) near_.push_back(s);
    }
  }

  bool exists() const { return !near_.empty(); }
  double along_of(const Vector3d& point) const { return (point - start_).dot(axis_) / length_; }

  Vector3d place_of(const SectionPlace& place) const {
    const Vector3d outwards = perpendicular((1 - place.along) * outwards_[0] + place.along * outwards_[1], axis_);
    const Vector3d front = axis_.cross(outwards);
    const Vector3d direction = std::cos(place.angle) * front + std::sin(place.angle) * outwards;
    const Vector3d centre = is_about_bone_ ? bone_at(place.along) : middle_at(place.along);
    double bone = 0.01 * unit_, fascia = 0;
    for (double r = 0; r < 0.16 * unit_; r += kRayStep * unit_) {
      const int s = lean_.grid.sample_at(Vector3d(centre + r * direction));
      const TissueKind kind = s < 0 ? TissueKind::outside : lean_.tissue.kind(s);
      if (kind == TissueKind::bone && r < kBoneReach * unit_) bone = r;
      if (r > 0.004 * unit_ && (kind == TissueKind::outside || kind == TissueKind::fat)) break;
      fascia = r;
    }
    if (!is_about_bone_ || bone > fascia) bone = 0;
    return centre + (bone + place.share * (fascia - bone)) * direction;
  }

 private:
  // The outside of an arm is the elbow's, where it bends, and at the wrist the thumb's.
  void turn_as_arm() {
    const int shoulder = body_.find(BodyPart::upper_arm), elbow = body_.find(BodyPart::forearm),
              hand = body_.find(BodyPart::hand);
    if (shoulder < 0 || elbow < 0 || hand < 0) return;
    const auto place = [&](int joint) { return body_.places[static_cast<std::size_t>(joint)]; };
    const Vector3d upper = (place(elbow) - place(shoulder)).normalized(),
                   lower = (place(hand) - place(elbow)).normalized();
    const bool is_bent = upper.cross(lower).norm() > kNarrowest;
    const Vector3d hinge = is_bent ? upper.cross(lower) : upper.cross(Vector3d::UnitZ());
    outwards_[0] = outwards_[1] = perpendicular(-hinge, axis_);
    if (from_ != elbow) return;
    Vector3d thumb = Vector3d::Zero();
    double sum = 0;
    for (std::size_t v = 0; v < body_.weights.size(); ++v) {
      for (const JointWeight& weight : body_.weights[v]) {
        const auto& role = body_.roles[weight.joint];
        if (!role || role->part != BodyPart::thumb || role->side != BodySide::left) continue;
        thumb += weight.weight * body_.vertices.row(static_cast<Index>(v)).transpose();
        sum += weight.weight;
      }
    }
    if (sum > 0) outwards_[1] = perpendicular(thumb / sum - place(hand), axis_);
  }

  // The mean of samples in a slice of the limb about a point of its axis.
  template <typename Wanted>
  Vector3d mean_in_slice(double along, double radius, const Wanted& wanted) const {
    const Vector3d centre = start_ + along * length_ * axis_;
    Vector3d sum = Vector3d::Zero();
    int count = 0;
    for (const int s : near_) {
      const Vector3d away = lean_.grid.points.row(s).transpose() - centre;
      if (std::abs(away.dot(axis_)) > lean_.grid.cell || away.norm() > radius || !wanted(s)) continue;
      sum += away;
      ++count;
    }
    if (count == 0) return centre;
    return centre + off_axis(sum / count);
  }
  Vector3d off_axis(const Vector3d& away) const { return away - away.dot(axis_) * axis_; }

  Vector3d bone_at(double along) const {
    if (along <= 0.15 || along >= 0.9) return start_ + along * length_ * axis_;
    return mean_in_slice(along, kBoneReach * unit_, [&](int s) {
      return lean_.tissue.kind(s) == TissueKind::bone && lean_.tissue.bone_joint[static_cast<std::size_t>(s)] == from_;
    });
  }
  Vector3d middle_at(double along) const {
    return mean_in_slice(along, kLimbRadius * unit_, [&](int s) {
      const BodyRegion region = lean_.tissue.region[static_cast<std::size_t>(s)];
      return region != BodyRegion::trunk && region != BodyRegion::hip;
    });
  }

  const HalfBody& body_;
  const LeanSamples& lean_;
  bool is_about_bone_;
  double unit_;  // metres of this body, of a metre of a man of 1.75 m
  int from_ = -1;
  double length_ = 0;
  Vector3d start_ = Vector3d::Zero(), axis_ = Vector3d::Zero();
  Vector3d outwards_[2];   // at either joint
  std::vector<int> near_;  // samples beside the limb
};

// The rows' places, between what of the model's path lies above and below them.
void guide(const SectionedLimb& limb, const std::vector<SectionPlace>& places, HalfMuscle& muscle) {
  const Index count = muscle.path.rows();
  const bool is_turned = limb.along_of(muscle.path.row(count - 1)) < limb.along_of(muscle.path.row(0));
  if (is_turned) muscle.path = muscle.path.colwise().reverse().eval();
  std::vector<Vector3d> points, after;
  for (Index k = 0; k < count; ++k) {
    const Vector3d point = muscle.path.row(k);
    const double along = limb.along_of(point);
    if (along < places.front().along - kOverlap && k < count / 2 + 8) points.push_back(point);
    if (along > places.back().along + kOverlap && k > 8) after.push_back(point);
  }
  const bool keeps_origin = !points.empty(), keeps_insertion = !after.empty();
  for (const SectionPlace& place : places) points.push_back(limb.place_of(place));
  points.insert(points.end(), after.begin(), after.end());
  Positions path(static_cast<Index>(points.size()), 3);
  for (Index k = 0; k < path.rows(); ++k) path.row(k) = points[static_cast<std::size_t>(k)].transpose();
  path.col(0) = path.col(0).cwiseMax(kBesidePlane);
  const Positions smooth = smoothed_along(resampled(path, 2 * kPathPoints), 3);
  Positions guided = resampled(smooth, kPathPoints);
  if (keeps_origin) guided.row(0) = muscle.path.row(0);
  if (keeps_insertion) guided.bottomRows(1) = muscle.path.bottomRows(1);
  muscle.path = guided;
  if (is_turned) muscle.path = muscle.path.colwise().reverse().eval();
  muscle.is_guided = true;
}

// The row's points from origin to insertion, or the other way round; nothing where a landmark is missing.
std::optional<Positions> laid_out(const LandmarkPlaces& landmarks, const LandmarkPath& row, const Positions& own,
                                  bool is_turned) {
  const auto count = static_cast<Index>(row.points.size());
  Positions path(count, 3);
  for (Index k = 0; k < count; ++k) {
    const auto& point = row.points[static_cast<std::size_t>(is_turned ? count - 1 - k : k)];
    const std::optional<Vector3d> place = point ? landmarks.place(*point) : own.row(k == 0 ? 0 : own.rows() - 1);
    if (!place) return std::nullopt;
    path.row(k) = place->transpose();
  }
  return path;
}

void guide(const LandmarkPlaces& landmarks, const LandmarkPath& row, HalfMuscle& muscle) {
  std::optional<Positions> best;
  double least = 0;
  for (const bool is_turned : {false, true}) {
    const std::optional<Positions> path = laid_out(landmarks, row, muscle.path, is_turned);
    if (!path) return;
    const double detour = path_length(*path) + (path->row(0) - muscle.path.row(0)).norm() +
                          (path->bottomRows(1) - muscle.path.bottomRows(1)).norm();
    if (best && detour >= least) continue;
    least = detour;
    best = path;
  }
  muscle.path = resampled(smoothed_along(resampled(*best, 2 * kPathPoints), 3), kPathPoints);
  muscle.path.row(0) = best->row(0);
  muscle.path.bottomRows(1) = best->bottomRows(1);
  muscle.is_guided = true;
}

// The lean sample nearest to a point, in the grid; -1: there is none.
int nearest_lean(const LeanSamples& lean, const Vector3d& point) {
  Index nearest = -1;
  if (lean.size() > 0) (lean.points.rowwise() - point.transpose()).rowwise().squaredNorm().minCoeff(&nearest);
  return nearest < 0 ? -1 : lean.sample[static_cast<std::size_t>(nearest)];
}

// Moves parts of a belly in bone, fat or a cavity to the nearest lean tissue.
void move_into_lean(const LeanSamples& lean, HalfMuscle& muscle) {
  bool has_moved = false;
  for (Index k = 1; k + 1 < kPathPoints; ++k) {
    const double along = static_cast<double>(k) / (kPathPoints - 1);
    if (along < muscle.belly_from || along > muscle.belly_to) continue;
    const Vector3d point = muscle.path.row(k);
    const int own = lean.grid.sample_at(point);
    if (own >= 0 && lean.tissue.kind(own) == TissueKind::other_lean) continue;
    const int nearest = nearest_lean(lean, point);
    if (nearest < 0) return;
    muscle.path.row(k) = lean.grid.points.row(nearest);
    has_moved = true;
  }
  if (!has_moved) return;
  const Eigen::RowVector3d origin = muscle.path.row(0), insertion = muscle.path.bottomRows(1);
  muscle.path = smoothed_along(muscle.path, 1);
  muscle.path.row(0) = origin;
  muscle.path.bottomRows(1) = insertion;
}

}  // namespace

void guide_paths(const HalfBody& body, const LeanSamples& lean, std::vector<HalfMuscle>& muscles) {
  const LandmarkPlaces landmarks(body, lean);
  for (const LimbSections& sections : section_table().limbs) {
    const SectionedLimb limb(body, lean, sections, landmarks.millimetre());
    if (!limb.exists()) continue;
    parallel_for(muscles.size(), [&](std::size_t m) {
      const LimbSections::OfMuscle* row = longest_match(sections.muscles, muscles[m].name);
      if (row) guide(limb, row->places, muscles[m]);
    });
  }
  parallel_for(muscles.size(), [&](std::size_t m) {
    const LandmarkPath* row = longest_match(section_table().paths, muscles[m].name);
    if (row) guide(landmarks, *row, muscles[m]);
    move_into_lean(lean, muscles[m]);
  });
}

}  // namespace bodyopt::trainer
