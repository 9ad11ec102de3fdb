#include "trainer/anatomy/trunk_muscles.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "runtime/core/error.h"
#include "trainer/anatomy/human_tables.h"
#include "trainer/anatomy/landmark_points.h"
#include "trainer/anatomy/muscle_ends.h"

namespace bodyopt {
namespace {

using Eigen::Index;
using Eigen::Vector3d;

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

// In half space; without a path where a landmark is missing.
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
  return std::any_of(others.begin(), others.end(), [&](const Muscle& other) {
    return whole ? find_whole_muscle(other.name) == whole : matching_name(other.name) == matching_name(name);
  });
}

// To rest space, on the half's own side or on the other.
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
    throw Error(ErrorKind::mismatch, "muscles of the trunk: the character '" + character.name +
                                         "' has none of the landmarks that they are laid by: expected a human with a "
                                         "pelvis, a neck and shoulders");
  }
  return result;
}

}  // namespace bodyopt
