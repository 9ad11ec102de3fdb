#include "trainer/curate/modifier_scope.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>

#include "assets/characters/joints_with_skin.h"
#include "base/frame_range.h"
#include "base/wording.h"
#include "dataset/modifier.h"
#include "runtime/core/error.h"
#include "trainer/curate/pose_space.h"

namespace bodyopt::trainer {
namespace {

using Eigen::Index;

std::vector<std::string> names_in(const JsonObject& object, const char* key) {
  return object.has(key) ? object.names(key) : std::vector<std::string>{};
}

// Adds the frames of selections to `selected`. `open`: lists that are being read.
class Selector {
 public:
  Selector(const PoseDatabase& database, std::string place)
      : database_(database), path_(database.dataset.folder / "dataset.json"), place_(std::move(place)) {
    selected_.assign(database.frames.size(), false);
  }

  void add_all(const Json& selections) {
    for (const Json& selection : selections) add(JsonObject(selection, path_, place_ + ": a selection"));
  }
  std::vector<char> take() { return std::move(selected_); }

 private:
  void add(const JsonObject& selection) {
    selection.allow({"take", "frames", "near", "list"});
    if (selection.has("list")) {
      add_list(selection.name("list"));
    } else if (selection.has("near")) {
      add_near(JsonObject(selection.json()["near"], path_, place_ + ": 'near'"));
    } else {
      add_frames(selection);
    }
  }

  void add_list(const std::string& name) {
    const std::vector<NamedSelection>& lists = database_.dataset.selections;
    const auto list = std::ranges::find(lists, name, &NamedSelection::name);
    if (list == lists.end() || !list->frames.is_array()) {
      throw Error(ErrorKind::mismatch, place_, ": the dataset has no selection '", name, "'");
    }
    if (!open_.insert(name).second) {
      throw Error(ErrorKind::mismatch, place_, ": the selection '", name, "' names itself");
    }
    add_all(list->frames);
    open_.erase(name);
  }

  void add_near(const JsonObject& near) {
    near.allow({"take", "frame", "degrees", "joints"});
    const Skeleton& skeleton = database_.character.skeleton;
    const std::size_t centre = database_.find(near.name("take"), near.integer("frame"), place_);
    const double reach = near.number("degrees", 0, 1e4);
    const std::vector<std::string> names = names_in(near, "joints");
    const std::vector<std::uint32_t> joints =
        names.empty() ? joints_that_bend(database_.character) : joints_named(skeleton, names, place_);
    for (std::size_t n = 0; n < selected_.size(); ++n) {
      const double distance = pose_distance(database_.frames[centre].pose, database_.frames[n].pose, joints);
      if (distance <= reach) selected_[n] = true;
    }
  }

  void add_frames(const JsonObject& selection) {
    const int take = selection.has("take") ? database_.take_named(selection.name("take"), place_) : -1;
    std::set<int> numbers;
    if (selection.has("frames")) {
      for (const int frame : parse_frame_range(selection.name("frames"))) numbers.insert(frame);
    }
    for (std::size_t n = 0; n < selected_.size(); ++n) {
      const DatabaseFrame& frame = database_.frames[n];
      if ((take < 0 || frame.take == take) && (numbers.empty() || numbers.contains(frame.frame))) selected_[n] = true;
    }
  }

  const PoseDatabase& database_;
  std::filesystem::path path_;
  std::string place_;
  std::set<std::string> open_;
  std::vector<char> selected_;
};

double distance_to_segment(const Eigen::Vector3d& point, const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  const double along = (point - a).dot(b - a) / std::max((b - a).squaredNorm(), 1e-18);
  return (a + std::clamp(along, 0.0, 1.0) * (b - a) - point).norm();
}

// 1 within 1.5 radii of the muscle's path at rest, falling to 0 at 3.
void add_muscle(const Muscle& muscle, const Character& character, Eigen::VectorXd& mask) {
  for (Index v = 0; v < mask.size(); ++v) {
    double nearest = 1e300;
    for (std::size_t k = 1; k < muscle.path.size(); ++k) {
      const Eigen::Vector3d a(muscle.path[k - 1].position.data()), b(muscle.path[k].position.data());
      nearest = std::min(nearest, distance_to_segment(character.vertices.row(v).transpose(), a, b));
    }
    mask[v] = std::max(mask[v], std::clamp(2 - nearest / (1.5 * muscle.radius), 0.0, 1.0));
  }
}

template <typename Named>
const Named& find_named(const std::vector<Named>& all, const std::string& name, const char* what,
                        const std::string& place) {
  const auto found = std::ranges::find(all, name, &Named::name);
  if (found != all.end()) return *found;
  throw Error(ErrorKind::mismatch, place, ": the dataset has no ", what, " '", name, "'; it has ",
              list_names(names_of(all)));
}

}  // namespace

std::vector<char> selected_frames(const PoseDatabase& database, const Json& selections, const std::string& place) {
  if (selections.empty()) return std::vector<char>(database.frames.size(), true);
  Selector selector(database, place);
  selector.add_all(selections);
  std::vector<char> selected = selector.take();
  if (std::ranges::find(selected, true) == selected.end()) {
    throw Error(ErrorKind::mismatch, place, ": it selects no frame of the dataset");
  }
  return selected;
}

Eigen::VectorXd skin_mask(const PoseDatabase& database, const Json& json, const std::string& place) {
  const Character& character = database.character;
  const std::filesystem::path path = database.dataset.folder / "dataset.json";
  const JsonObject object(json, path, place + ": 'mask'");
  object.allow({"joints", "muscles", "regions"});
  if (json.empty()) return Eigen::VectorXd::Ones(character.vertices.rows());
  Eigen::VectorXd mask = Eigen::VectorXd::Zero(character.vertices.rows());
  for (const std::uint32_t joint : joints_named(character.skeleton, names_in(object, "joints"), place)) {
    for (std::size_t v = 0; v < character.weights.size(); ++v) {
      for (const JointWeight& weight : character.weights[v]) {
        if (weight.joint == joint) mask[static_cast<Index>(v)] += weight.weight;
      }
    }
  }
  for (const std::string& name : names_in(object, "muscles")) {
    add_muscle(find_named(database.muscles, name, "muscle", place), character, mask);
  }
  for (const std::string& name : names_in(object, "regions")) {
    const RegionWeights& region = find_named(database.regions, name, "painted region", place);
    for (std::size_t k = 0; k < region.vertices.size(); ++k) {
      double& there = mask[static_cast<Index>(region.vertices[k])];
      there = std::max(there, region.weights[k]);
    }
  }
  if (!(mask.maxCoeff() > 0)) throw Error(ErrorKind::mismatch, place, ": its mask is of no vertex");
  return mask.cwiseMin(1.0);
}

}  // namespace bodyopt::trainer
