// What an artist says of how tissue jiggles.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace bodyopt {

// A part of the body, and what is different there; what is left out is as elsewhere.
struct JiggleRegion {
  enum class By { joint, muscle, painted };
  By by = By::joint;
  std::string name;  // of a joint, a muscle or a painted region; with '*' at its end all whose names begin like it
  std::optional<double> softness{}, damping{}, amount{}, flesh{};
};

// Of the longest extent of the skin at rest: 5 cm of a person of 1.8 m.
constexpr double kFleshOfSize = 0.028;

struct JiggleSettings {
  double softness = 1;   // divides the stiffness of tissue
  double damping = 0.2;  // damping ratio at 3 Hz
  double amount = 1;     // what the skin takes of the motion; 0: held still
  double flesh = 0;      // metres under the skin that move; what is deeper is held; 0: kFleshOfSize x the body
  double poisson = 0.45;
  double density = 1000;  // kg/m^3
  double tension = 4;     // Hz that a fully active muscle's tissue gains: its springs alone would swing so fast
  std::vector<JiggleRegion> regions;              // a later one covers the earlier ones where both are
  std::string origin = "the settings of jiggle";  // the file's name, for messages
};

// Throws Error(usage), naming the number, for settings that no tissue can have.
void require_possible(const JiggleSettings& settings);

// jiggle.json (docs/formats.md). What the file leaves out keeps its default. Throws Error(file).
JiggleSettings read_jiggle(const std::filesystem::path& path);

}  // namespace bodyopt
