// Which point of the lead is which of the second of the cast, as a transfer from the one to the other would have it.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "proxy_viewer/commands/controls.h"
#include "proxy_viewer/panels/snapshot.h"
#include "proxy_viewer/scene/scene.h"

namespace bodyopt {

class Matching {
 public:
  // All must outlive it.
  Matching(std::shared_ptr<const vulkan::Device> device, Scene& scene, Controls& controls)
      : device_(std::move(device)), scene_(scene), controls_(controls) {}

  // Where the settings ask for it, matches the two as `transfer` does, with the markers that are set, and gives the
  // scene what to colour them by; again only where the markers are others. Takes seconds. Then what their skins enclose
  // at the frame, unless it plays, and what is worth simulating of the second's clip, each again only where it is
  // another. Throws as match_skeletons() and match_skins(); nothing is asked for then.
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

}  // namespace bodyopt
