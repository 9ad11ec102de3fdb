// An artist's settings for how tissue jiggles.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "runtime/core/json.h"

namespace bodyopt::trainer {

// A part of the body, and what is different there; what is left out is as elsewhere.
struct JiggleRegion {
  enum class By { joint, muscle, painted };
  By by = By::joint;
  std::string name;  // of a joint, a muscle or a painted region; with '*' at its end all whose names begin like it
  std::optional<double> softness{}, damping{}, amount{}, flesh{};
  std::optional<double> flesh_factor{};  // of the flesh that is there without this region; not with `flesh`
  std::string comment{};                 // for who edits the file
};

// A share of the longest extent of the skin at rest: 5 cm of a person of 1.8 m.
constexpr double kFleshOfSize = 0.028;
// A share of the body's thickness: the inner half of ears, snouts, tails, toes and fingers is held as bone is.
constexpr double kFleshOfThickness = 0.25;
// A factor where a limb ends (heads, hands, feet): little lies between skin and bone there.
constexpr double kFleshOfEnds = 0.1;

struct JiggleSettings {
  double softness = 1;   // divides the stiffness of tissue
  double damping = 0.2;  // damping ratio at 3 Hz
  double amount = 1;     // what the skin takes of the motion; 0: held still
  // Metres under the skin that move; deeper tissue is held. 0: kFleshOfSize x the body's extent, kFleshOfThickness x
  // the thickness where it is thin. Where a limb ends it is kFleshOfEnds x that.
  double flesh = 0;
  double lowest_frequency = 4;  // Hz over the root of the softness: no part swings slower
  double limit = 1.0 / 3;       // of the body's thickness where it is: no displacement of the skin reaches it
  double poisson = 0.45;
  double density = 1000;  // kg/m^3
  double tension = 4;     // Hz that a fully active muscle's tissue gains: its springs alone would swing so fast
  std::vector<JiggleRegion> regions;              // a later one covers the earlier ones where both are
  std::string comment{};                          // as a region's
  std::string origin = "the settings of jiggle";  // the file's name, for messages
};

// Throws Error(usage), naming the number, for settings that no tissue can have.
void require_possible(const JiggleSettings& settings);

// jiggle.json (docs/formats.md). What the file leaves out keeps its default. Throws Error(file).
JiggleSettings read_jiggle(const std::filesystem::path& path);
// Throws Error(file) where a file of that name is there that holds no such settings.
void require_replaceable_jiggle(const std::filesystem::path& path);
// Reads the settings from what such a file holds. Throws Error(file) that names `origin`.
JiggleSettings jiggle_settings(const Json& json, const std::filesystem::path& origin);
// Returns what read_jiggle() reads as these settings.
Json jiggle_json(const JiggleSettings& settings);

}  // namespace bodyopt::trainer
