#include "trainer/curate/sculpted_frames.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "assets/json_file.h"
#include "runtime/core/error.h"
#include "trainer/curate/pose_space.h"

namespace bodyopt {
namespace {

constexpr double kWidestSpread = 1e4;  // degrees

double falloff(double distance, double spread) {
  if (!(distance < spread)) return distance > 0 ? 0 : 1;
  const double near = 1 - distance / spread;
  return near * near * (3 - 2 * near);
}

SculptedFrame read_sculpt(const PoseDatabase& database, const JsonObject& sculpt, const std::string& place) {
  sculpt.allow({"take", "frame", "offsets"});
  const Character& character = database.character;
  const std::filesystem::path path = database.dataset.folder / sculpt.name("offsets");
  const ShapeReader reader(path);
  if (reader.point_count() != character.output_count() || reader.sample_count() != 1) {
    throw Error(ErrorKind::mismatch, place + ": " + path.string() + " has " + std::to_string(reader.point_count()) +
                                         " points, the character " + std::to_string(character.output_count()) +
                                         " vertices: it was sculpted on another mesh");
  }
  return {database.find(sculpt.name("take"), sculpt.integer("frame"), place),
          welded_from_output(character, reader.sample(0).data())};
}

}  // namespace

SculptedFrames::SculptedFrames(const PoseDatabase& database, const JsonObject& parameters, const std::string& place)
    : database_(database),
      spread_(parameters.has("spread_degrees") ? parameters.number("spread_degrees", 0, kWidestSpread) : 0) {
  const std::filesystem::path path = database.dataset.folder / "dataset.json";
  for (const Json& sculpt : parameters.array("sculpts")) {
    sculpts_.push_back(read_sculpt(database, JsonObject(sculpt, path, place + ": a sculpt"), place));
  }
  if (parameters.has("joints")) {
    named_joints_ = joints_named(database.character.skeleton, parameters.names("joints"), place);
  }
  choose_joints();
}

void SculptedFrames::choose_joints() {
  joints_ = named_joints_;
  if (!joints_.empty()) return;
  const Character& character = database_.character;
  Eigen::VectorXd sculpted = Eigen::VectorXd::Zero(character.vertices.rows());
  for (const SculptedFrame& sculpt : sculpts_) sculpted += sculpt.delta.rowwise().norm();
  if (!(sculpted.maxCoeff() > 0)) sculpted.setOnes();
  joints_ = joints_moving(character, sculpted);
}

void SculptedFrames::put(SculptedFrame sculpt) {
  const auto same = std::ranges::find(sculpts_, sculpt.frame, &SculptedFrame::frame);
  if (same == sculpts_.end()) {
    sculpts_.push_back(std::move(sculpt));
  } else {
    *same = std::move(sculpt);
  }
  choose_joints();
}

std::vector<double> SculptedFrames::weights(std::size_t frame) const {
  std::vector<double> weights(sculpts_.size(), 0.0), distances;
  double sum = 0;
  for (std::size_t k = 0; k < sculpts_.size(); ++k) {
    if (sculpts_[k].frame == frame) {
      std::fill(weights.begin(), weights.end(), 0.0);
      weights[k] = 1;
      return weights;
    }
    const Pose &sculpted = database_.frames[sculpts_[k].frame].pose, &own = database_.frames[frame].pose;
    distances.push_back(std::max(pose_distance(sculpted, own, joints_), 1e-6));
    sum += 1 / (distances[k] * distances[k]);
  }
  for (std::size_t k = 0; k < weights.size(); ++k) {
    weights[k] = falloff(distances[k], spread_) / (distances[k] * distances[k] * sum);
  }
  return weights;
}

Positions SculptedFrames::sum(std::size_t frame) const {
  const std::vector<double> shares = weights(frame);
  Positions sum = Positions::Zero(database_.character.vertices.rows(), 3);
  for (std::size_t k = 0; k < shares.size(); ++k) {
    if (shares[k] > 0) sum += shares[k] * sculpts_[k].delta;
  }
  return sum;
}

}  // namespace bodyopt
