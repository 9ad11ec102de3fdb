#include "trainer/transfer/transfer_dynamics.h"

#include <algorithm>
#include <iterator>

#include "assets/wording.h"
#include "trainer/simulate/muscle_fibres.h"
#include "trainer/transfer/carry_anatomy.h"

namespace bodyopt {
namespace {

// The joints of the target that are those of the source that a region names: a region for each.
std::vector<JiggleRegion> on_target_joints(const JiggleRegion& region, const TransferPair& pair) {
  std::vector<JiggleRegion> result;
  const std::vector<Joint>& joints = pair.source.skeleton.joints;
  for (std::size_t j = 0; j < joints.size(); ++j) {
    const int target = pair.match.target_joint[j];
    if (target < 0 || !matches_pattern(region.name, joints[j].name)) continue;
    result.push_back(region);
    result.back().name = pair.target.skeleton.joints[static_cast<std::size_t>(target)].name;
  }
  return result;
}

// Empty: there is nothing on the target that it names.
std::vector<JiggleRegion> on_target(const JiggleRegion& region, const TransferPair& pair,
                                    const std::vector<Muscle>& muscles) {
  if (region.by == JiggleRegion::By::joint) return on_target_joints(region, pair);
  const bool is_there = region.by == JiggleRegion::By::muscle && std::ranges::any_of(muscles, [&](const Muscle& m) {
                          return matches_pattern(region.name, m.name);
                        });
  return is_there ? std::vector{region} : std::vector<JiggleRegion>();
}

JiggleSettings carried_settings(const JiggleSettings& source, const TransferPair& pair,
                                const std::vector<Muscle>& muscles, std::vector<std::string>& notes) {
  JiggleSettings result = source;
  result.regions.clear();
  std::vector<std::string> lost;
  for (const JiggleRegion& region : source.regions) {
    const std::vector<JiggleRegion> carried = on_target(region, pair, muscles);
    if (carried.empty()) lost.push_back(region.name);
    std::ranges::copy(carried, std::back_inserter(result.regions));
  }
  result.flesh *= pair.match.size;
  for (JiggleRegion& region : result.regions) {
    if (region.flesh) *region.flesh *= pair.match.size;
  }
  if (!lost.empty()) {
    notes.push_back(
        "the jiggle's settings name what the target is not known to have, which is left out: " + list_names(lost) +
        ". Of muscles --muscles knows; of painted regions 'transfer dataset', then 'dynamics' of that");
  }
  return result;
}

bool tenses(const Dynamics& dynamics) {
  return std::ranges::any_of(dynamics.jiggle.nodes, [](const JiggleNode& node) { return node.stiffening > 0; });
}

}  // namespace

Dynamics transfer_dynamics(const TransferPair& pair, const Character& target, const Basis& basis,
                           const Dynamics& source, const std::vector<Muscle>& muscles,
                           std::vector<std::string>& notes) {
  const std::vector<Muscle> carried = carried_muscles(pair, muscles, notes);
  DynamicsOptions options = asked_options(source);
  options.settings = carried_settings(options.settings, pair, carried, notes);
  if (carried.empty() && tenses(source)) {
    notes.push_back("the source's tissue tenses with its muscles, the target's does not: they come with --muscles");
  }
  return build_dynamics(target, carried, basis, options).dynamics;
}

}  // namespace bodyopt
