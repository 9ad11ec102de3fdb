#include "trainer/curate/shape_stack.h"

#include <algorithm>

#include "assets/frame_range.h"
#include "base/content_hash.h"
#include "dataset/file_hashes.h"
#include "runtime/core/error.h"
#include "runtime/core/hexadecimal.h"
#include "trainer/curate/mirror_image.h"
#include "trainer/curate/modifier_scope.h"

namespace bodyopt {

// A modifier, ready.
struct ShapeStack::Layer {
  std::size_t place = 0;  // in the dataset's list
  std::string name;       // "modifier 'elbow'"
  const Modifier* modifier = nullptr;
  bool automatic = false;
  std::vector<char> selected;
  Eigen::VectorXd mask;
  std::unique_ptr<ShapeModifier> shape{};
};

ShapeStack::ShapeStack(PoseDatabase database, std::shared_ptr<const UnposedSpace> space)
    : database_(std::move(database)), space_(std::move(space)), raw_frames_(database_.frames.size()) {
  dropped_.assign(raw_frames_, false);
  weights_.assign(raw_frames_, 1);
  const std::vector<Modifier>& modifiers = database_.dataset.modifiers;
  // What is frozen counts for the whole stack.
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

namespace {

void require_known_parameters(const Modifier& modifier, const ModifierType& type, const std::string& name) {
  for (const auto& [key, value] : modifier.parameters.items()) {
    const bool known = std::any_of(type.parameters.begin(), type.parameters.end(),
                                   [&k = key](const char* there) { return k == there; });
    if (!known) throw Error(ErrorKind::mismatch, name + " has no parameter '" + key + "': misspelt?");
  }
}

std::string modifier_name(const Modifier& modifier) { return "modifier '" + modifier.name + "'"; }

}  // namespace

void ShapeStack::check_scope(const PoseDatabase& database, const Modifier& modifier) {
  require_known_parameters(modifier, *find_modifier_type(modifier.type), modifier_name(modifier));
  selected_frames(database, modifier.frames, modifier_name(modifier));
  skin_mask(database, modifier.mask, modifier_name(modifier));
}

void ShapeStack::add(std::size_t place, const Modifier& modifier, const ModifierType& type) {
  Layer layer{place, modifier_name(modifier), &modifier, type.automatic, {}, {}};
  require_known_parameters(modifier, type, layer.name);
  layer.selected = selected_frames(database_, modifier.frames, layer.name);
  layer.mask = skin_mask(database_, modifier.mask, layer.name);
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
                              type.prepare == prepare_consistency ? cache_name(place) : ""});
  layers_.push_back(std::move(layer));
}

void ShapeStack::add_weight(const Layer& layer) {
  constexpr double kLargestWeight = 1000;
  const Modifier& modifier = *layer.modifier;
  if (!modifier.mask.empty()) {
    throw Error(ErrorKind::mismatch, layer.name + " has a mask: frames count as a whole");
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
    frame.take += takes;
    frame.pose = mirror_->pose(frame.pose);
    database_.frames.push_back(std::move(frame));
    dropped_.push_back(dropped_[n]);
    weights_.push_back(weights_[n]);
  }
  // What came before acts on the images through what they are images of.
  for (std::vector<Layer>* layers : {&layers_, &freezes_}) {
    for (Layer& layer : *layers) layer.selected.resize(database_.frames.size(), false);
  }
}

bool ShapeStack::is_changed(std::size_t frame) const {
  if (frame >= raw_frames_) return true;
  return std::any_of(layers_.begin(), layers_.end(), [&](const Layer& layer) { return layer.selected[frame]; });
}

Positions ShapeStack::shape(std::size_t frame) const { return posed(frame, database_.dataset.modifiers.size()); }

// As the first modifiers leave it, posed.
Positions ShapeStack::posed(std::size_t frame, std::size_t count) const {
  if (!is_changed(frame)) return database_.raw_shape(frame);
  const UnposedSpace::Frame space = space_ ? space_->frame(database_.frames[frame].pose) : UnposedSpace::Frame();
  const Positions start = begun(frame);
  Positions offsets;
  for (const Layer& layer : layers_) {
    if (layer.place >= count || !layer.selected[frame]) continue;
    if (offsets.size() == 0) offsets = space.offsets(start);
    apply(layer, {frame, space}, offsets);
  }
  return offsets.size() == 0 ? start : space.shape(offsets);
}

Positions ShapeStack::offsets(std::size_t frame, std::size_t count) const {
  const UnposedSpace::Frame in = space().frame(database_.frames[frame].pose);
  Positions offsets = in.offsets(begun(frame));
  for (const Layer& layer : layers_) {
    if (layer.place < count && layer.selected[frame]) apply(layer, {frame, in}, offsets);
  }
  return offsets;
}

Positions ShapeStack::begun(std::size_t frame) const {
  if (frame < raw_frames_) return database_.raw_shape(frame);
  return mirror_->shape(posed(frame - raw_frames_, mirror_place_));
}

void ShapeStack::apply(const Layer& layer, const FrameInHand& frame, Positions& offsets) const {
  Positions changed = offsets;
  layer.shape->apply(frame, changed);
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

namespace {

// Raised whenever a modifier that looks at all frames makes something else of them.
constexpr std::uint64_t kCacheVersion = 3;

}  // namespace

// Named by a hash of what the modifier at a place sees: the files of the dataset, the modifiers up to it, and the files
// that these name.
std::string ShapeStack::cache_name(std::size_t place) const {
  const Dataset& dataset = database_.dataset;
  ContentHash hash;
  hash.add(kCacheVersion);
  for (const HashedFile& file : hashed_files(dataset)) hash.add(file.xxh3);
  for (const DatasetTake& take : dataset.takes) {
    hash.add(take.name + ':' + format_frame_range(take.frames) + ':' + format_frame_range(take.heldout));
  }
  hash.add(dataset.selections.dump());
  for (std::size_t k = 0; k < dataset.modifiers.size(); ++k) {
    const Modifier& modifier = dataset.modifiers[k];
    const bool freezes = modifier.type == "freeze";
    if (!modifier.enabled || !(k <= place || freezes)) continue;
    Json json = to_json(modifier);
    json.erase("name");
    if (k == place) json["strength"] = json["mask"] = nullptr;  // the stack sees to them
    hash.add(json.dump());
    if (modifier.parameters.contains("cache") && modifier.parameters["cache"].is_string()) {
      hash.add(file_hash(dataset.folder / modifier.parameters["cache"].get<std::string>()));
    }
  }
  return (dataset.folder / "modifiers" / "cache" / (hexadecimal(hash.value()) + ".pc2")).string();
}

}  // namespace bodyopt
