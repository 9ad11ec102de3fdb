#include "trainer/curate/frame_sculpting.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include "base/json_file.h"
#include "dataset/modifier.h"
#include "runtime/core/error.h"
#include "trainer/curate/edit_stack.h"
#include "trainer/curate/modifier_scope.h"
#include "trainer/curate/modifier_types.h"
#include "trainer/curate/offset_cache.h"
#include "trainer/curate/pose_space.h"

namespace bodyopt::trainer {
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
    throw Error(ErrorKind::mismatch, place, ": ", path, " has ", reader.point_count(), " points, the character ",
                character.output_count(), " vertices: it was sculpted on another mesh");
  }
  return {database.find(sculpt.name("take"), sculpt.integer("frame"), place),
          welded_from_output(character, reader.sample(0).data())};
}

constexpr double kUsualSpread = 30;  // degrees
constexpr double kAlike = 0.05;      // of the character's size, that the sides of a body differ by at most

SculptedFrames sculpts_of(const PoseDatabase& database, const std::string& name, std::size_t frame,
                          std::optional<double> spread) {
  const Modifier* modifier = find_modifier(database.dataset.modifiers, name);
  const std::string why = why_not_shown(database, name, frame);
  if (!why.empty()) {
    throw Error(ErrorKind::usage, "the modifier '", name, "' ", why,
                ": what is brushed would not be what is seen (brush-modifier gives another name)");
  }
  Json parameters = modifier ? modifier->parameters : Json{{"sculpts", Json::array()}};
  if (spread || !parameters.contains("spread_degrees")) parameters["spread_degrees"] = spread.value_or(kUsualSpread);
  return {database, JsonObject(parameters, database.dataset.folder / "dataset.json", "modifier '" + name + "'"),
          "modifier '" + name + "'"};
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
      std::ranges::fill(weights, 0.0);
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

std::string why_not_shown(const PoseDatabase& database, const std::string& name, std::size_t frame) {
  const Modifier* modifier = find_modifier(database.dataset.modifiers, name);
  if (!modifier) return "";
  if (modifier->type != "sculpt") return "is of the type " + modifier->type + ", not sculpt";
  if (!modifier->enabled) return "is switched off";
  if (modifier->strength != 1) return "has a strength below 1";
  if (!modifier->mask.empty()) return "acts on a part of the skin alone";
  if (!selected_frames(database, modifier->frames, "modifier '" + name + "'")[frame]) return "leaves this frame out";
  return "";
}

FrameSculpting::FrameSculpting(std::shared_ptr<const ShapeStack> stack, std::size_t frame, std::string name,
                               std::optional<double> spread_degrees)
    : stack_(std::move(stack)),
      frame_(frame),
      name_(std::move(name)),
      space_(stack_->space().frame(stack_->database().frames[frame].pose)),
      sculpted_(sculpts_of(stack_->database(), name_, frame, spread_degrees)),
      own_(sculpted_.sum(frame)),
      begun_(character().vertices + stack_->offsets(frame, stack_->database().dataset.modifiers.size())),
      surface_(begun_),
      paths_(begun_.rows(), character().triangles) {
  show();
}

void FrameSculpting::show() { skin_ = space_.shape(surface_ - character().vertices); }

void FrameSculpting::begin(const Brush& brush, bool mirrored) {
  stroke_.emplace(paths_, character().triangles, surface_, begun_ - own_, brush);
  is_mirrored_ = mirrored;
}

void FrameSculpting::touch(const SkinPoint& at) {
  at_ = at;
  at_.position = at_point(surface_, at);
  std::vector<SkinPoint> hands{at_};
  if (is_mirrored_) hands.push_back(mirror_image(at_));
  stroke_->touch(hands);
  surface_ = stroke_->surface();
  show();
}

void FrameSculpting::pull(const Eigen::Vector3d& way) {
  Eigen::Vector3d unposed = Eigen::Vector3d::Zero();
  for (int k = 0; k < 3; ++k) {
    unposed += at_.weights[k] * (space_.rotation(at_.vertices[static_cast<std::size_t>(k)]).transpose() * way);
  }
  std::vector<Eigen::Vector3d> ways{unposed};
  if (is_mirrored_) ways.emplace_back(-unposed.x(), unposed.y(), unposed.z());
  stroke_->pull(ways);
  surface_ = stroke_->surface();
  show();
}

// Across the middle of the rest skin, which un-posed skins lie near.
SkinPoint FrameSculpting::mirror_image(const SkinPoint& at) {
  const Positions& rest = character().vertices;
  if (!rest_) rest_ = std::make_unique<NearestSkin>(rest, character().triangles);
  const Eigen::RowVector3d low = rest.colwise().minCoeff(), high = rest.colwise().maxCoeff();
  Eigen::Vector3d image = at_point(rest, at);
  image.x() = low.x() + high.x() - image.x();
  SkinPoint found = (*rest_)(image);
  const double apart = (found.position - image).norm();
  if (apart > kAlike * (high - low).norm()) {
    throw Error(ErrorKind::mismatch, "the mirror image of this point is ", std::lround(1e3 * apart),
                " mm from the skin: the character is not symmetric here (brush-symmetry off)");
  }
  found.position = at_point(surface_, found);
  return found;
}

bool FrameSculpting::is_sculpted() const {
  return has_change() ||
         std::ranges::find(sculpted_.sculpts(), frame_, &SculptedFrame::frame) != sculpted_.sculpts().end();
}

// They are others only where what was sculpted is moved by other joints.
const std::vector<double>& FrameSculpting::weights() {
  SculptedFrames with_strokes = sculpted_;
  with_strokes.put({frame_, own_ + surface_ - begun_});
  if (!weights_.empty() && with_strokes.joints() == weighed_joints_) return weights_;
  weighed_joints_ = with_strokes.joints();
  weights_.clear();
  const auto place = std::ranges::find(with_strokes.sculpts(), frame_, &SculptedFrame::frame);
  const auto own = static_cast<std::size_t>(place - with_strokes.sculpts().begin());
  for (std::size_t n = 0; n < stack_->database().frames.size(); ++n) {
    weights_.push_back(with_strokes.weights(n)[own]);
  }
  return weights_;
}

std::vector<std::string> FrameSculpting::put_into(std::vector<Modifier>& modifiers, const Positions& strokes) const {
  const Positions without = begun_ - own_;
  return put_sculpt(stack_->database(), modifiers, name_, frame_, without, begun_ + strokes, sculpted_.spread());
}

std::vector<std::string> FrameSculpting::keep(std::chrono::milliseconds patience) const {
  const PoseDatabase& database = stack_->database();
  const std::string& take = database.take_of(frame_);
  const int number = database.frames[frame_].frame;
  const Positions strokes = surface_ - begun_;
  std::vector<std::string> notes;
  if (stack_->is_frozen(frame_)) {
    notes.push_back(take + " " + std::to_string(number) +
                    " is frozen: automatic modifiers leave it alone, what is brushed is kept");
  }
  const auto edit = [&](const Dataset& dataset, std::vector<Modifier>& modifiers) {
    if (modifiers == database.dataset.modifiers) return put_into(modifiers, strokes);
    auto stack = std::make_shared<const ShapeStack>(read_pose_database(dataset), stack_->made_space());
    if (stack->database().character.vertices.rows() != strokes.rows()) {
      throw Error(ErrorKind::mismatch, "the dataset is of another character by now: what was brushed does not fit it");
    }
    const std::size_t frame = stack->database().find(take, number, "what was brushed");
    return FrameSculpting(std::move(stack), frame, name_, sculpted_.spread()).put_into(modifiers, strokes);
  };
  edit_modifiers(
      database.dataset.folder / "dataset.json",
      [&](const Dataset& dataset, std::vector<Modifier>& modifiers) {
        const std::vector<std::string> said = edit(dataset, modifiers);
        notes.insert(notes.end(), said.begin(), said.end());
      },
      patience);
  return notes;
}

// sculpt: what an artist made of single frames, as un-posed offsets, spread to poses nearby (frame_sculpting.h).

ShapeModifier prepare_sculpt(const ModifierInput& input) {
  const auto sculpted = std::make_shared<const SculptedFrames>(input.database, input.parameters, input.place);
  return {.cause = [=](std::size_t frame) -> std::optional<std::uint64_t> {
            const Positions sum = sculpted->sum(frame);
            if (sum.isZero(0)) return std::nullopt;
            return hash_of(sum);
          },
          .apply = [=](const FrameInHand& frame, Positions& offsets) { offsets += sculpted->sum(frame.number); }};
}

}  // namespace bodyopt::trainer
