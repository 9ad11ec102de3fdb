// sculpt: what an artist made of single frames, as un-posed offsets, spread to poses nearby.
//   offset of a frame = sum_k w_k delta_k,  w_k = f(d_k) (1 / d_k^2) / sum_j (1 / d_j^2)        (Shepard 1968)
// d_k: how far its pose is from that of sculpt k, in the joints that move what was sculpted; f: falls smoothly from 1
// at 0 to 1/2 at half the spread and to 0 at the spread. At the poses sculpted it is exact.
#include <algorithm>
#include <cmath>

#include "runtime/core/error.h"
#include "trainer/curate/modifier_type.h"
#include "trainer/curate/pose_space.h"

namespace bodyopt {
namespace {

struct SculptedFrame {
  std::size_t frame = 0;
  Positions delta;  // V x 3, un-posed, metres
};

double falloff(double distance, double spread) {
  if (!(distance < spread)) return distance > 0 ? 0 : 1;
  const double near = 1 - distance / spread;
  return near * near * (3 - 2 * near);
}

class Sculpt : public ShapeModifier {
 public:
  Sculpt(const PoseDatabase& database, std::vector<SculptedFrame> sculpts, std::vector<std::uint32_t> joints,
         double spread)
      : database_(database), sculpts_(std::move(sculpts)), joints_(std::move(joints)), spread_(spread) {}

  void apply(const FrameInHand& frame, Positions& offsets) const override {
    const std::vector<double> weights = weights_at(frame.number);
    for (std::size_t k = 0; k < sculpts_.size(); ++k) {
      if (weights[k] > 0) offsets += weights[k] * sculpts_[k].delta;
    }
  }

 private:
  std::vector<double> weights_at(std::size_t number) const {
    std::vector<double> weights(sculpts_.size(), 0.0), distances;
    double sum = 0;
    for (std::size_t k = 0; k < sculpts_.size(); ++k) {
      if (sculpts_[k].frame == number) {
        std::fill(weights.begin(), weights.end(), 0.0);
        weights[k] = 1;
        return weights;
      }
      const Pose &sculpted = database_.frames[sculpts_[k].frame].pose, &own = database_.frames[number].pose;
      distances.push_back(std::max(pose_distance(sculpted, own, joints_), 1e-6));
      sum += 1 / (distances[k] * distances[k]);
    }
    for (std::size_t k = 0; k < weights.size(); ++k) {
      weights[k] = falloff(distances[k], spread_) / (distances[k] * distances[k] * sum);
    }
    return weights;
  }

  const PoseDatabase& database_;
  std::vector<SculptedFrame> sculpts_;
  std::vector<std::uint32_t> joints_;
  double spread_;  // degrees
};

SculptedFrame read_sculpt(const ModifierInput& input, const JsonObject& sculpt) {
  sculpt.allow({"take", "frame", "offsets"});
  const Character& character = input.database.character;
  const std::filesystem::path path = input.database.dataset.folder / sculpt.name("offsets");
  const ShapeReader reader(path);
  if (reader.point_count() != character.output_count() || reader.sample_count() != 1) {
    throw Error(ErrorKind::mismatch, input.place + ": " + path.string() + " has " +
                                         std::to_string(reader.point_count()) + " points, the character " +
                                         std::to_string(character.output_count()) +
                                         " vertices: it was sculpted on another mesh");
  }
  return {input.database.find(sculpt.name("take"), sculpt.integer("frame"), input.place),
          welded_from_output(character, reader.sample(0).data())};
}

// Those named, or those that move what was sculpted.
std::vector<std::uint32_t> pose_joints(const ModifierInput& input, const std::vector<SculptedFrame>& sculpts) {
  const Character& character = input.database.character;
  if (input.parameters.has("joints")) {
    std::vector<std::string> names;
    for (const Json& name : input.parameters.array("joints")) {
      if (!name.is_string()) input.parameters.refuse("'joints' is not a list of names");
      names.push_back(name.get<std::string>());
    }
    if (!names.empty()) return joints_named(character.skeleton, names, input.place);
  }
  Eigen::VectorXd sculpted = Eigen::VectorXd::Zero(character.vertices.rows());
  for (const SculptedFrame& sculpt : sculpts) sculpted += sculpt.delta.rowwise().norm();
  if (!(sculpted.maxCoeff() > 0)) sculpted.setOnes();
  return joints_moving(character, sculpted);
}

}  // namespace

std::unique_ptr<ShapeModifier> prepare_sculpt(const ModifierInput& input) {
  const std::filesystem::path path = input.database.dataset.folder / "dataset.json";
  std::vector<SculptedFrame> sculpts;
  for (const Json& sculpt : input.parameters.array("sculpts")) {
    sculpts.push_back(read_sculpt(input, JsonObject(sculpt, path, input.place + ": a sculpt")));
  }
  const double spread = parameter(input, "spread_degrees", 0, 0, 1e4);
  std::vector<std::uint32_t> joints = pose_joints(input, sculpts);
  return std::make_unique<Sculpt>(input.database, std::move(sculpts), std::move(joints), spread);
}

}  // namespace bodyopt
