// Matches the lead's points with those of the second of the cast, as a transfer from the one to the other would.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "viewport/commands/controls.h"
#include "viewport/panels/snapshot.h"
#include "viewport/scene/scene.h"

namespace bodyopt::viewport {

class Matching {
 public:
  // All must outlive it.
  Matching(std::shared_ptr<const vulkan::Device> device, Scene& scene, Controls& controls)
      : device_(std::move(device)), scene_(scene), controls_(controls) {}

  // Matches the two as `transfer` does, with the markers that are set, where the settings ask for it. That takes
  // seconds, is done again only for other markers, and gives the scene the colours. Then measures what their skins
  // enclose at the frame, unless it plays, and what of the second's clip is worth simulating. Each is done again only
  // where it changed. Throws as match_skeletons() and match_skins(), and then turns the match off.
  void look();
  void forget();  // the two may be others
  void describe(Snapshot& snapshot) const;

 private:
  void match();
  void measure_volumes();
  void look_through_clip();

  std::shared_ptr<const vulkan::Device> device_;
  Scene& scene_;
  Controls& controls_;
  std::optional<MatchRow> row_;                // none: not matched
  std::vector<MarkedPair> markers_;            // that it was matched with
  std::array<std::vector<Pose>, 2> measured_;  // whose volumes the row has: one each, or none
  std::optional<std::string> looked_through_;  // the clip whose frames the row has
};

}  // namespace bodyopt::viewport
