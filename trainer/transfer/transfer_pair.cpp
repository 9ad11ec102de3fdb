#include "trainer/transfer/transfer_pair.h"

#include <nlohmann/json.hpp>

#include "trainer/train/skinning/ddm_basis.h"

namespace bodyopt {
namespace {

// As the source was smoothed, where it says so; otherwise the defaults.
TrainOptions smoothing_of(const Basis& source, double size) {
  TrainOptions options;
  const auto text = source.metadata.find("provenance");
  if (text == source.metadata.end()) return options;
  const Json told = Json::parse(text->second, nullptr, false);
  if (!told.is_object()) return options;
  const auto radius = told.find("smoothing_radius_m"), steps = told.find("smoothing_steps");
  if (radius != told.end() && radius->is_number() && radius->get<double>() > 0) {
    options.smoothing_radius = size * radius->get<double>();
  }
  if (steps != told.end() && steps->is_number_integer() && steps->get<int>() > 0 && steps->get<int>() <= 1000) {
    options.smoothing_steps = steps->get<int>();
  }
  return options;
}

}  // namespace

TransferPair::TransferPair(const Basis& from, const Character& target_character, const TransferOptions& options)
    : source(from),
      match(match_skeletons(from.skeleton, target_character.skeleton, options.joint_map)),
      target(build_ddm_basis(target_character, smoothing_of(from, match.size))),
      correspondence(match_skins(from, target, match, options.markers)),
      skin(from, target, correspondence, options.size) {}

}  // namespace bodyopt
