// How frames of a clip are played, as a session keeps it.
#pragma once

#include <optional>

namespace bodyopt {

enum class PlayMode { loop, ping_pong, once };

struct PlaySettings {
  static constexpr double kSlowest = 0.1, kFastest = 2;  // speeds

  PlayMode mode = PlayMode::loop;
  double speed = 1;
  bool backwards = false, real_time = true;
  std::optional<int> in, out;  // frames; the clip's first and last where they are left out
  bool operator==(const PlaySettings&) const = default;
};

}  // namespace bodyopt
