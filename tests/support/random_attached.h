// What meshes are attached by, of any counts: corners on a skin, anchors on them and on joints, vertices on anchors.
#pragma once

#include <algorithm>

#include "runtime/host/attach_tables.h"
#include "tests/support/random_tables.h"

namespace bodyopt::testing {

struct RandomAttached {
  static constexpr std::uint32_t kSkin = 300, kJoints = 5;

  RandomAttached(std::uint32_t seed, std::uint32_t frame_count, std::uint32_t corners, std::uint32_t anchors,
                 std::uint32_t vertices)
      : random(seed), frames(frame_count), corner_count(corners), anchor_count(anchors) {
    const auto number = [&] { return static_cast<float>(random.uniform(-1, 1)); };
    for (std::uint32_t k = 0; k < corners; ++k) {
      AttachCorner corner{};
      corner.vertex = random.below(kSkin);
      corner.fan_begin = static_cast<std::uint32_t>(tables.fans.size());
      for (std::uint32_t t = random.below(7); t > 0; --t) {
        tables.fans.push_back(
            {random.below(kSkin), random.below(kSkin), number(), number(), number(), number(), number(), number()});
      }
      corner.fan_end = static_cast<std::uint32_t>(tables.fans.size());
      corner.normal_x = number();
      corner.normal_y = number();
      corner.normal_z = number();
      corner.share = 1 / std::max(1.0f, 2.0f * static_cast<float>(corner.fan_end - corner.fan_begin));
      tables.corners.push_back(corner);
    }
    for (std::uint32_t k = 0; k < anchors; ++k) {
      const auto begin = static_cast<std::uint32_t>(tables.points.size());
      const std::uint32_t count = corners == 0 ? 0 : random.below(4);
      for (const double share : random.partition(count)) {
        const std::vector<double> w = random.partition(3);
        tables.points.push_back({random.below(corners), random.below(corners), random.below(corners),
                                 static_cast<float>(share * w[0]), static_cast<float>(share * w[1]),
                                 static_cast<float>(share * w[2])});
      }
      tables.anchors.push_back({random.below(kJoints), begin, begin + count, number(), number(), number()});
    }
    for (std::uint32_t k = 0; k < vertices; ++k) {
      tables.vertices.push_back({random.below(anchors), number(), number(), number()});
    }
    positions = random.floats(std::size_t{3} * kSkin * frames, -1, 1);
    skinning = random_skinning(random, kJoints, frames, 1);
    origins = random.floats(std::size_t{4} * frames, -10, 10);
  }

  // Of a frame, of what has so many numbers in each.
  template <typename Values>
  static auto of_frame(Values& values, std::size_t frame, std::size_t numbers) {
    return std::span(values).subspan(frame * numbers, numbers);
  }

  Random random;
  std::uint32_t frames, corner_count, anchor_count;
  AttachTables tables;
  std::vector<float> positions, skinning, origins;
};

}  // namespace bodyopt::testing
