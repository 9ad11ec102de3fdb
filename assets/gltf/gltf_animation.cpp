#include "assets/gltf/gltf_animation.h"

#include <algorithm>
#include <set>

#include "base/wording.h"
#include "runtime/core/transform.h"

namespace bodyopt {
namespace {

std::size_t components(ChannelPath path) { return path == ChannelPath::rotation ? 4 : 3; }

Interpolation interpolation_of(const GltfFile& file, const std::string& name, const std::string& what) {
  if (name == "LINEAR") return Interpolation::linear;
  if (name == "STEP") return Interpolation::step;
  if (name == "CUBICSPLINE") return Interpolation::cubic;
  file.fail(what, ": unknown interpolation '", name, "'");
}

AnimationChannel read_channel(const GltfFile& file, const tinygltf::AnimationSampler& sampler, std::size_t node,
                              ChannelPath path, const std::string& what) {
  AnimationChannel channel{node, path, interpolation_of(file, sampler.interpolation, what), {}, {}};
  channel.times = file.numbers(sampler.input, TINYGLTF_TYPE_SCALAR, what + " times");
  const bool is_rotation = path == ChannelPath::rotation;
  channel.values =
      file.numbers(sampler.output, is_rotation ? TINYGLTF_TYPE_VEC4 : TINYGLTF_TYPE_VEC3, what + " values");
  if (!std::ranges::is_sorted(channel.times)) file.fail(what, ": its times decrease");
  const std::size_t per_key = components(path) * (channel.interpolation == Interpolation::cubic ? 3 : 1);
  if (channel.values.size() != per_key * channel.times.size()) {
    file.fail(what, ": ", channel.times.size(), " times but ", channel.values.size() / components(path), " values");
  }
  return channel;
}

// Tangents may be zero.
bool has_turnless_key(const AnimationChannel& channel) {
  if (channel.path != ChannelPath::rotation) return false;
  const bool is_cubic = channel.interpolation == Interpolation::cubic;
  for (std::size_t k = 0; k < channel.times.size(); ++k) {
    const double* key = channel.values.data() + 4 * (is_cubic ? 3 * k + 1 : k);
    if (!has_length({key[0], key[1], key[2], key[3]})) return true;
  }
  return false;
}

std::array<double, 4> unit_length(const std::array<double, 4>& value, ChannelPath path) {
  return path == ChannelPath::rotation ? normalized(value) : value;
}

}  // namespace

std::array<double, 4> AnimationChannel::sample(double seconds) const {
  const std::size_t n = components(path), last = times.size() - 1;
  const bool is_cubic = interpolation == Interpolation::cubic;
  // part: of a cubic key, 0 in-tangent, 1 value, 2 out-tangent
  const auto key = [&](std::size_t k, std::size_t part) {
    std::array<double, 4> value{};
    const std::size_t row = is_cubic ? 3 * k + part : k;
    std::copy_n(values.begin() + static_cast<std::ptrdiff_t>(n * row), n, value.begin());
    return value;
  };
  if (!(seconds > times.front())) return unit_length(key(0, 1), path);
  if (seconds >= times.back()) return unit_length(key(last, 1), path);
  const auto after = static_cast<std::size_t>(std::upper_bound(times.begin(), times.end(), seconds) - times.begin());
  const std::size_t k = after - 1;
  if (interpolation == Interpolation::step) return unit_length(key(k, 1), path);

  const double span = times[after] - times[k], t = (seconds - times[k]) / span;
  const std::array<double, 4> a = key(k, 1), b = key(after, 1);
  std::array<double, 4> value{};
  if (is_cubic) {
    const std::array<double, 4> out = key(k, 2), in = key(after, 0);
    const double t2 = t * t, t3 = t2 * t;
    for (std::size_t i = 0; i < n; ++i) {
      value[i] = (2 * t3 - 3 * t2 + 1) * a[i] + span * (t3 - 2 * t2 + t) * out[i] + (3 * t2 - 2 * t3) * b[i] +
                 span * (t3 - t2) * in[i];
    }
    return unit_length(value, path);
  }
  if (path == ChannelPath::rotation) return slerp(normalized(a), normalized(b), t);
  for (std::size_t i = 0; i < n; ++i) value[i] = (1 - t) * a[i] + t * b[i];
  return value;
}

std::vector<AnimationChannel> read_channels(const GltfFile& file, std::size_t animation,
                                            std::vector<std::string>& notes) {
  const tinygltf::Animation& source = file.model().animations[animation];
  std::vector<AnimationChannel> channels;
  std::set<std::pair<int, std::string>> seen;
  std::vector<std::string> turnless;
  bool morphs = false;
  for (std::size_t c = 0; c < source.channels.size(); ++c) {
    const tinygltf::AnimationChannel& target = source.channels[c];
    const std::string what = "animation " + std::to_string(animation) + " channel " + std::to_string(c);
    if (target.target_node < 0) continue;  // the specification says to ignore such channels
    if (target.target_path == "weights") {
      morphs = true;
      continue;
    }
    const bool is_translation = target.target_path == "translation", is_rotation = target.target_path == "rotation";
    if (!is_translation && !is_rotation && target.target_path != "scale") {
      file.fail(what, ": unknown path '", target.target_path, "'");
    }
    if (target.target_node >= std::ssize(file.model().nodes)) file.fail(what, ": animates a node that does not exist");
    if (target.sampler < 0 || target.sampler >= std::ssize(source.samplers)) file.fail(what, ": has no sampler");
    if (!seen.insert({target.target_node, target.target_path}).second) {
      file.fail(what, ": animates the ", target.target_path, " of a node for the second time");
    }
    channels.push_back(read_channel(
        file, source.samplers[static_cast<std::size_t>(target.sampler)], static_cast<std::size_t>(target.target_node),
        is_translation ? ChannelPath::translation : (is_rotation ? ChannelPath::rotation : ChannelPath::scale), what));
    if (!has_turnless_key(channels.back())) continue;
    const std::string& name = file.model().nodes[channels.back().node].name;
    turnless.push_back(name.empty() ? "node " + std::to_string(channels.back().node) : name);
  }
  if (morphs) notes.push_back("Morph target weights in the clip are left out.");
  note_names("Rotations in the clip are quaternions of length zero, taken as none: ", turnless, notes);
  return channels;
}

}  // namespace bodyopt
