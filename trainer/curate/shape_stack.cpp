#include "trainer/curate/shape_stack.h"

#include <algorithm>

#include "assets/characters/character_hash.h"
#include "base/content_hash.h"
#include "base/wording.h"
#include "dataset/modifier.h"
#include "runtime/core/error.h"
#include "trainer/curate/mirror_image.h"
#include "trainer/curate/modifier_scope.h"

namespace bodyopt::trainer {

// A modifier, ready.
struct ShapeStack::Layer {
  std::size_t place = 0;  // in the dataset's list
  std::string name;       // "modifier 'elbow'"
  const Modifier* modifier = nullptr;
  bool automatic = false;
  bool kept = false;
  std::vector<char> selected;
  Eigen::VectorXd mask;
  ShapeModifier shape{};
  std::uint64_t identity = 0;  // a hash of its type, strength and mask
};

// A layer's effect on a frame.
struct ShapeStack::Change {
  const Layer* layer;
  std::uint64_t cause;  // see ShapeModifier::cause
};

namespace {

// Raised whenever a modifier, or un-posing, makes something else of the same shape.
constexpr std::uint64_t kStackVersion = 1;

using KeptOffsets = Eigen::Matrix<float, Eigen::Dynamic, 3, Eigen::RowMajor>;  // V x 3, metres

std::uint64_t identity_of(const Character& character) {
  ContentHash hash;
  hash.add(kStackVersion);
  add(hash, character);
  return hash.value();
}

std::uint64_t identity_of(const Modifier& modifier, const Eigen::VectorXd& mask) {
  ContentHash hash;
  hash.add(modifier.type);
  hash.add(modifier.strength);
  hash.append(mask.data(), static_cast<std::size_t>(mask.size()) * sizeof(double));
  return hash.value();
}

void require_known_parameters(const Modifier& modifier, const ModifierType& type, const std::string& name) {
  for (const auto& [key, value] : modifier.parameters.items()) {
    const bool known = std::ranges::any_of(type.parameters, [&k = key](const char* there) { return k == there; });
    if (known) continue;
    const std::vector<std::string> names(type.parameters.begin(), type.parameters.end());
    throw Error(ErrorKind::mismatch, name, " has no parameter '", key, "': misspelt? ",
                (names.empty() ? "Its type has none" : "Its type has " + list_names(names)));
  }
}

std::string modifier_name(const Modifier& modifier) { return "modifier '" + modifier.name + "'"; }

}  // namespace

ShapeStack::ShapeStack(PoseDatabase database, std::shared_ptr<const UnposedSpace> space)
    : database_(std::move(database)),
      space_(std::move(space)),
      cache_(database_.dataset.folder / "modifiers" / "cache"),
      identity_(identity_of(database_.character)),
      raw_frames_(database_.frames.size()) {
  dropped_.assign(raw_frames_, false);
  weights_.assign(raw_frames_, 1);
  const std::vector<Modifier>& modifiers = database_.dataset.modifiers;
  // Frozen parts count for the whole stack, so freezes come first.
  for (const bool freeze : {true, false}) {
    for (std::size_t k = 0; k < modifiers.size(); ++k) {
      const ModifierType* type = find_modifier_type(modifiers[k].type);
      if (!type) {
        if (freeze) {
          notes_.push_back("modifier '" + modifiers[k].name + "' is of the type '" + modifiers[k].type +
                           "', which this version does not know: it is kept, and not applied");
        }
      } else if (modifiers[k].enabled && (type->effect == ModifierType::Effect::freeze) == freeze) {
        add(k, modifiers[k], *type);
      }
    }
  }
}

ShapeStack::~ShapeStack() = default;

const UnposedSpace& ShapeStack::space() const {
  std::call_once(space_made_, [this] {
    if (!space_) space_ = std::make_shared<const UnposedSpace>(database_.character);
  });
  return *space_;
}

void ShapeStack::check_scope(const PoseDatabase& database, const Modifier& modifier) {
  require_known_parameters(modifier, *find_modifier_type(modifier.type), modifier_name(modifier));
  selected_frames(database, modifier.frames, modifier_name(modifier));
  skin_mask(database, modifier.mask, modifier_name(modifier));
}

void ShapeStack::add(std::size_t place, const Modifier& modifier, const ModifierType& type) {
  Layer layer{place, modifier_name(modifier), &modifier, type.automatic, type.kept, {}, {}};
  require_known_parameters(modifier, type, layer.name);
  layer.selected = selected_frames(database_, modifier.frames, layer.name);
  layer.mask = skin_mask(database_, modifier.mask, layer.name);
  layer.identity = identity_of(modifier, layer.mask);
  switch (type.effect) {
    case ModifierType::Effect::shape:
      return add_shape(place, std::move(layer), type);
    case ModifierType::Effect::drop:
      for (std::size_t n = 0; n < dropped_.size(); ++n) dropped_[n] |= layer.selected[n];
      return;
    case ModifierType::Effect::weight:
      return add_weight(layer);
    case ModifierType::Effect::freeze:
      freezes_.push_back(std::move(layer));
      return;
    case ModifierType::Effect::mirror:
      return add_mirror_images(place);
  }
}

void ShapeStack::add_shape(std::size_t place, Layer layer, const ModifierType& type) {
  space();
  std::vector<char> frozen(database_.frames.size(), false);
  for (std::size_t n = 0; n < frozen.size(); ++n) frozen[n] = frozen_part(n).minCoeff() >= 1;
  const std::filesystem::path path = database_.dataset.folder / "dataset.json";
  const JsonObject parameters(layer.modifier->parameters, path, layer.name);
  layer.shape = type.prepare({database_, *space_, parameters, layer.name, layer.selected, frozen, layer.mask,
                              [this, place](std::size_t frame) { return offsets(frame, place); },
                              [this, place](std::size_t frame) { return key(frame, place); }, cache_});
  if (!layer.shape.note.empty()) notes_.push_back(layer.name + " " + layer.shape.note);
  layers_.push_back(std::move(layer));
}

void ShapeStack::add_weight(const Layer& layer) {
  constexpr double kLargestWeight = 1000;
  const Modifier& modifier = *layer.modifier;
  if (!modifier.mask.empty()) {
    throw Error(ErrorKind::mismatch, layer.name, " has a mask: frames count as a whole");
  }
  const std::filesystem::path path = database_.dataset.folder / "dataset.json";
  const JsonObject parameters(modifier.parameters, path, layer.name);
  const double weight = parameters.number("weight", 0, kLargestWeight);
  for (std::size_t n = 0; n < weights_.size(); ++n) {
    if (layer.selected[n]) weights_[n] *= 1 + modifier.strength * (weight - 1);
  }
}

void ShapeStack::add_mirror_images(std::size_t place) {
  if (mirror_) throw Error(ErrorKind::mismatch, "the stack has two symmetry modifiers; expected one at most");
  mirror_ = std::make_unique<MirrorImage>(database_.character, database_.controls);
  mirror_place_ = place;
  const auto takes = static_cast<int>(database_.takes.size());
  for (int k = 0; k < takes; ++k) {
    database_.takes.push_back(database_.takes[static_cast<std::size_t>(k)] + " mirrored");
    database_.readers.push_back(database_.readers[static_cast<std::size_t>(k)]);
  }
  for (std::size_t n = 0; n < raw_frames_; ++n) {
    DatabaseFrame frame = database_.frames[n];
    frame.image_of = frame.take;
    frame.take += takes;
    frame.pose = mirror_->pose(frame.pose);
    database_.frames.push_back(std::move(frame));
    dropped_.push_back(dropped_[n]);
    weights_.push_back(weights_[n]);
  }
  // Earlier layers act on the images through the frames that these are images of.
  for (std::vector<Layer>* layers : {&layers_, &freezes_}) {
    for (Layer& layer : *layers) layer.selected.resize(database_.frames.size(), false);
  }
}

bool ShapeStack::is_changed(std::size_t frame) const {
  if (frame >= raw_frames_) return true;
  return std::ranges::any_of(layers_, [&](const Layer& layer) { return layer.selected[frame]; });
}

Positions ShapeStack::shape(std::size_t frame) const { return posed(frame, database_.dataset.modifiers.size()); }

// The posed shape that the first modifiers leave.
Positions ShapeStack::posed(std::size_t frame, std::size_t count) const {
  const std::vector<Change> changes = changes_of(frame, count);
  if (changes.empty()) return begun(frame);
  const UnposedSpace::Frame space = space_->frame(database_.frames[frame].pose);
  return space.shape(through(changes, {frame, space}));
}

Positions ShapeStack::offsets(std::size_t frame, std::size_t count) const {
  const UnposedSpace::Frame in = space().frame(database_.frames[frame].pose);
  return through(changes_of(frame, count), {frame, in});
}

// The changes by those of the first modifiers that change a frame.
std::vector<ShapeStack::Change> ShapeStack::changes_of(std::size_t frame, std::size_t count) const {
  const bool stays = !freezes_.empty() && frozen_part(frame).minCoeff() >= 1;
  std::vector<Change> changes;
  for (const Layer& layer : layers_) {
    const bool acts = layer.place < count && layer.selected[frame] && !(stays && layer.automatic);
    if (!acts) continue;
    if (const std::optional<std::uint64_t> cause = layer.shape.cause(frame)) changes.push_back({&layer, *cause});
  }
  return changes;
}

// The offsets that layers leave of a frame, from the topmost on whose work is kept. It is kept in single precision, as
// raw shapes are. Where it was not there, it goes on rounded, too, so that either way gives the same bits.
Positions ShapeStack::through(const std::vector<Change>& changes, const FrameInHand& frame) const {
  const Positions start = begun(frame.number);
  const auto top =
      std::find_if(changes.rbegin(), changes.rend(), [](const Change& change) { return change.layer->kept; });
  const std::span<const Change> below(changes.begin(), top.base());
  std::vector<std::uint64_t> keys;
  if (!below.empty()) keys = keys_after(below, frame.number, start);
  KeptOffsets kept(start.rows(), 3);
  const std::span<float> numbers(kept.data(), static_cast<std::size_t>(kept.size()));
  std::size_t next = below.size();
  while (next > 0 && !(changes[next - 1].layer->kept && cache_.find(keys[next], numbers))) --next;
  Positions offsets = next > 0 ? Positions(kept.cast<double>()) : frame.space.offsets(start);
  for (; next < changes.size(); ++next) {
    apply(*changes[next].layer, frame, offsets);
    if (!changes[next].layer->kept) continue;
    kept = offsets.cast<float>();
    cache_.keep(keys[next + 1], numbers);
    offsets = kept.cast<double>();
  }
  return offsets;
}

// Hashes of all that a frame comes from: as it begins, and as every layer leaves it.
std::vector<std::uint64_t> ShapeStack::keys_after(std::span<const Change> changes, std::size_t frame,
                                                  const Positions& start) const {
  ContentHash first;
  first.add(identity_);
  for (const JointTransform& joint : database_.frames[frame].pose.joints) first.add(joint);
  first.add(hash_of(start));
  std::vector<std::uint64_t> keys{first.value()};
  for (const Change& change : changes) keys.push_back(key_after(change, frame, keys.back()));
  return keys;
}

std::uint64_t ShapeStack::key(std::size_t frame, std::size_t count) const {
  return keys_after(changes_of(frame, count), frame, begun(frame)).back();
}

std::uint64_t ShapeStack::key_after(const Change& change, std::size_t frame, std::uint64_t before) const {
  const Layer& layer = *change.layer;
  ContentHash hash;
  hash.add(before);
  hash.add(layer.identity);
  hash.add(change.cause);
  if (layer.automatic && !freezes_.empty()) {
    const Eigen::VectorXd frozen = frozen_part(frame);
    if (!frozen.isZero(0)) hash.append(frozen.data(), static_cast<std::size_t>(frozen.size()) * sizeof(double));
  }
  return hash.value();
}

Positions ShapeStack::begun(std::size_t frame) const {
  if (frame < raw_frames_) return database_.raw_shape(frame);
  return mirror_->shape(posed(frame - raw_frames_, mirror_place_));
}

void ShapeStack::apply(const Layer& layer, const FrameInHand& frame, Positions& offsets) const {
  Positions changed = offsets;
  layer.shape.apply(frame, changed);
  Eigen::VectorXd share = layer.modifier->strength * layer.mask;
  if (layer.automatic && !freezes_.empty()) share.array() *= 1 - frozen_part(frame.number).array();
  const Positions change = changed - offsets;
  offsets += Positions(share.asDiagonal() * change);
}

// V: how much of every vertex is frozen.
Eigen::VectorXd ShapeStack::frozen_part(std::size_t frame) const {
  Eigen::VectorXd frozen = Eigen::VectorXd::Zero(database_.character.vertices.rows());
  for (const Layer& freeze : freezes_) {
    if (freeze.selected[frame]) frozen = frozen.cwiseMax(freeze.modifier->strength * freeze.mask);
  }
  return frozen;
}

}  // namespace bodyopt::trainer
