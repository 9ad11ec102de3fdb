// The types of modifiers that act on one frame at a time.
#include <algorithm>
#include <array>
#include <map>

#include "base/content_hash.h"
#include "base/frame_range.h"
#include "base/json_file.h"
#include "geometry/mend_surface.h"
#include "geometry/mesh.h"
#include "geometry/surface_distance.h"
#include "runtime/core/error.h"
#include "trainer/curate/modifier_types.h"
#include "trainer/curate/offset_cache.h"

namespace bodyopt::trainer {
namespace {

using Eigen::Index;

constexpr double kFar = 5;  // times as far as the frames around it are spread, too: fast motion is no spike
constexpr std::array<int, 4> kAround = {-2, -1, 1, 2};
constexpr std::size_t kFewest = 3;  // of these

// The frames of one take around one of it that are there.
std::vector<std::size_t> frames_around(const PoseDatabase& database, std::size_t frame) {
  std::vector<std::size_t> around;
  for (const int step : kAround) {
    const std::size_t other = frame + static_cast<std::size_t>(step);
    if (other < database.frames.size() && database.frames[other].take == database.frames[frame].take) {
      around.push_back(other);
    }
  }
  return around;
}

// Puts the vertices of a frame that are further than the limit from where those around it have them on their median.
void put_back(const std::vector<Positions>& around, double limit, Positions& own) {
  std::vector<double> values(around.size());
  const auto middle = [&](auto&& value) {
    for (std::size_t k = 0; k < around.size(); ++k) values[k] = value(around[k]);
    std::ranges::sort(values);
    return 0.5 * (values[(values.size() - 1) / 2] + values[values.size() / 2]);
  };
  for (Index v = 0; v < own.rows(); ++v) {
    Eigen::RowVector3d median;
    for (Index i = 0; i < 3; ++i) median[i] = middle([&](const Positions& there) { return there(v, i); });
    const double apart = (own.row(v) - median).norm();
    if (!(apart > limit)) continue;
    const double spread = middle([&](const Positions& there) { return (there.row(v) - median).norm(); });
    if (apart > kFar * spread) own.row(v) = median;
  }
}

}  // namespace

// despike: puts a vertex on the median of the frames just before and after, where it is far from these and they agree.

ShapeModifier prepare_despike(const ModifierInput& input) {
  const double limit = 1e-3 * parameter(input, "limit_mm", 5, 0.01, 1e4);  // metres
  const auto around = [&database = input.database](std::size_t frame) { return frames_around(database, frame); };
  return {.cause = [=, key_below = input.key_below](std::size_t frame) -> std::optional<std::uint64_t> {
            const std::vector<std::size_t> others = around(frame);
            if (others.size() < kFewest) return std::nullopt;
            ContentHash hash;
            hash.add(limit);
            for (const std::size_t other : others) hash.add(key_below(other));
            return hash.value();
          },
          .apply =
              [=, below = input.below](const FrameInHand& frame, Positions& offsets) {
                const std::vector<std::size_t> others = around(frame.number);
                if (others.size() < kFewest) return;
                std::vector<Positions> shapes;
                for (const std::size_t other : others) shapes.push_back(below(other));
                put_back(shapes, limit, offsets);
              }};
}

// blend: towards the shapes that another cache has of some frames of a take.

ShapeModifier prepare_blend(const ModifierInput& input) {
  const std::filesystem::path path = input.database.dataset.folder / input.parameters.name("cache");
  const auto reader = std::make_shared<const ShapeReader>(path);
  const std::vector<int> frames = parse_frame_range(input.parameters.name("frames"));
  if (reader->sample_count() != frames.size() || reader->point_count() != input.database.character.output_count()) {
    throw Error(ErrorKind::mismatch, input.place, ": ", path, " has ", reader->sample_count(), " samples of ",
                reader->point_count(), " points, expected ", frames.size(), " (its 'frames') of ",
                input.database.character.output_count(),
                " (the character's vertices): made from another mesh, or of other frames");
  }
  std::map<std::size_t, std::uint32_t> samples;  // of the cache, by frame of the database
  const std::string take = input.parameters.name("take");
  for (std::size_t n = 0; n < input.database.frames.size(); ++n) {
    if (input.database.take_of(n) != take) continue;
    for (std::uint32_t k = 0; k < frames.size(); ++k) {
      if (frames[k] == input.database.frames[n].frame) samples[n] = k;
    }
  }
  if (samples.empty()) {
    throw Error(ErrorKind::mismatch, input.place, ": the dataset has no solved frame ", input.parameters.name("frames"),
                " of a take '", take, "'");
  }
  const auto shape_of = [reader, samples, &character = input.database.character](std::size_t frame) {
    const auto sample = samples.find(frame);
    if (sample == samples.end()) return std::optional<Positions>();
    return std::optional(welded_from_output(character, reader->sample(sample->second).data()));
  };
  return {.cause = [=](std::size_t frame) -> std::optional<std::uint64_t> {
            const std::optional<Positions> shape = shape_of(frame);
            if (!shape) return std::nullopt;
            return hash_of(*shape);
          },
          .apply =
              [=](const FrameInHand& frame, Positions& offsets) {
                if (const auto shape = shape_of(frame.number)) offsets = frame.space.offsets(*shape);
              }};
}

// smooth: the displacement, evened out over the skin by a Gaussian. What the rest skin has of detail stays.

ShapeModifier prepare_smooth(const ModifierInput& input) {
  const Character& character = input.database.character;
  const double radius = 1e-3 * parameter(input, "radius_mm", 10, 0.01, 1000);  // metres
  const auto smoother = std::make_shared<const SkinSmoother>(character.vertices, character.triangles, radius);
  return {.cause = [=](std::size_t) { return hash_of(radius); },
          .apply = [=](const FrameInHand&, Positions& offsets) { offsets = (*smoother)(offsets); }};
}

// relax: evens out how vertices have slid along the skin, and leaves how far they stand off it.

ShapeModifier prepare_relax(const ModifierInput& input) {
  const Character& character = input.database.character;
  const double radius = 1e-3 * parameter(input, "radius_mm", 10, 0.01, 1000);  // metres
  const auto smoother = std::make_shared<const SkinSmoother>(character.vertices, character.triangles, radius);
  // V x 3, at rest, unit or zero.
  const Positions normals = vertex_normals(character.vertices, character.triangles).rowwise().normalized();
  return {.cause = [=](std::size_t) { return hash_of(radius); },
          .apply =
              [=](const FrameInHand&, Positions& offsets) {
                const Positions change = (*smoother)(offsets)-offsets;
                const Eigen::VectorXd off_skin = change.cwiseProduct(normals).rowwise().sum();
                offsets += change - Positions(off_skin.asDiagonal() * normals);
              }};
}

// detail: what smoothing takes from one frame, in the place of what it takes from others.

ShapeModifier prepare_detail(const ModifierInput& input) {
  const Character& character = input.database.character;
  const std::size_t source =
      input.database.find(input.parameters.name("take"), input.parameters.integer("frame"), input.place);
  const double radius = 1e-3 * parameter(input, "radius_mm", 20, 0.01, 1000);  // metres
  const Positions whole = input.below(source);
  const auto smoother = std::make_shared<const SkinSmoother>(character.vertices, character.triangles, radius);
  const Positions fine = whole - Positions((*smoother)(whole));
  ContentHash hash;
  hash.add(radius);
  hash.add(hash_of(fine));
  return {.cause = [value = hash.value()](std::size_t) { return value; },
          .apply = [=](const FrameInHand&, Positions& offsets) { offsets = (*smoother)(offsets) + fine; }};
}

// inflate: the skin along its normals, outwards or (below 0) inwards.

ShapeModifier prepare_inflate(const ModifierInput& input) {
  const double distance = 1e-3 * parameter(input, "distance_mm", 1, -1000, 1000);  // metres
  return {
      .cause = [=](std::size_t) { return hash_of(distance); },
      .apply =
          [distance, &triangles = input.database.character.triangles](const FrameInHand& frame, Positions& offsets) {
            Positions skin = frame.space.shape(offsets);
            skin += distance * Positions(vertex_normals(skin, triangles).rowwise().normalized());
            offsets = frame.space.offsets(skin);
          }};
}

// volume: gives back, where the mask says, what the closed skin lost of its volume at rest. It moves along the normals,
// by the same distance everywhere (times the mask).

ShapeModifier prepare_volume(const ModifierInput& input) {
  const Character& character = input.database.character;
  const double cap = 1e-3 * parameter(input, "cap_mm", 10, 0, 1000);             // metres
  const double rest = enclosed_volume(character.vertices, character.triangles);  // cubic metres
  return {.cause = [=](std::size_t) { return hash_of(cap); },
          .apply =
              [cap, rest, mask = input.mask, &triangles = character.triangles](const FrameInHand& frame,
                                                                               Positions& offsets) {
                Positions skin = frame.space.shape(offsets);
                // A sixth of the sum of the normals of a vertex's triangles, each twice its area long: what the volume
                // grows by.
                const Positions growth = vertex_normals(skin, triangles) / 6;
                const Positions direction = growth.rowwise().normalized();
                const double per_metre = growth.cwiseProduct(direction).rowwise().sum().dot(mask);
                const double lost = rest - enclosed_volume(skin, triangles);
                if (!(per_metre > 0) || !(lost > 0)) return;
                skin += std::min(lost / per_metre, cap) * direction;
                offsets = frame.space.offsets(skin);
              }};
}

}  // namespace bodyopt::trainer
