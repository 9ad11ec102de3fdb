#include "trainer/train/fit/groundwork.h"

#include <algorithm>

#include "base/spread_evenly.h"
#include "geometry/mesh.h"
#include "runtime/host/rig.h"
#include "trainer/train/pack/trade_off.h"

namespace bodyopt::trainer {
namespace {

using Support = Method::Support;

// Radii within which a region sees features, as parts of the character's longest extent.
constexpr double kRadii[] = {0.06, 0.12, 0.2, 0.35};

// The character in runtime order, its skeleton with the features that it is learned by.
Character to_learn(const SampleSet& set, const std::vector<std::uint32_t>& order) {
  Character ordered = in_order(set.character, order);
  ordered.skeleton.features = learned_features(set.character, poses_of(set.train));
  return ordered;
}

// Sum of the squared un-posed displacements of some training frames, spread evenly.
double left_to_learn(const SampleSet& set, const Character& ordered, const Basis& basis,
                     const std::vector<std::uint32_t>& order, Method::Unposing unposing) {
  const std::vector<std::size_t> probes = spread_evenly(set.train.size(), 24);
  const UnposedShapes shapes(set, ordered, basis, order, unposing);
  return shapes("train: smoothing radius", probes, all_vertices(ordered.vertices.rows()))
      .displacements.cast<double>()
      .squaredNorm();
}

// The radius given; or the default or twice that, whichever leaves less to learn: parts of bodies need more. Where
// linear blending leaves less than either, smaller ones: the smaller, the more Direct Delta Mush is like it.
DdmBase choose_base(const SampleSet& set, const Character& ordered, const std::vector<std::uint32_t>& order,
                    const TrainOptions& options) {
  constexpr double kLeastRadius = 1.0 / 16;  // of the default
  if (options.smoothing_radius > 0) return make_ddm_base(ordered, options.smoothing_radius, options);
  const double radius = default_smoothing_radius(ordered.vertices);
  DdmBase best = make_ddm_base(ordered, radius, options);
  const auto left = [&](const DdmBase& base, Method::Unposing unposing) {
    return left_to_learn(set, ordered, base.basis, order, unposing);
  };
  double least = left(best, Method::Unposing::ddm);
  const auto try_radius = [&](double other_radius) {
    DdmBase other = make_ddm_base(ordered, other_radius, options);
    if (options.budget > 0 && bytes_per_vertex(other.basis) > options.budget) return;
    const double others = left(other, Method::Unposing::ddm);
    if (!(others < least)) return;
    least = others;
    best = std::move(other);
  };
  try_radius(2 * radius);
  const double linear = left(best, Method::Unposing::lbs);
  for (double part = 0.5; least > linear && part >= kLeastRadius; part /= 2) try_radius(part * radius);
  return best;
}

DdmBase base_with_fibres(const SampleSet& set, const Character& ordered, const std::vector<std::uint32_t>& order,
                         const TrainOptions& options, const std::vector<Muscle>& muscles) {
  DdmBase base = choose_base(set, ordered, order, options);
  const double bytes = bytes_per_vertex(base.basis);
  if (options.budget > 0 && bytes > options.budget) refuse_budget(options.budget, bytes, "Direct Delta Mush alone");
  if (options.method.strains) base.basis.strain = make_strain_table(base.basis, muscles);
  return base;
}

FeatureSamples features_of(const SampleSet& set, const DdmBase& base, const EarlierFeatures& earlier) {
  const bool same_base = earlier.smoothing_radius == base.radius;
  return measure_features(base.basis, poses_of(set.train), same_base ? earlier.features : KnownFeatures{});
}

// Influences are measured on some frames, spread evenly.
std::vector<FeatureGroup> feature_groups(const Groundwork& ground, const std::vector<Muscle>& muscles) {
  constexpr std::size_t kMostFrames = 800;
  const Eigen::MatrixXd& values = ground.features.values;
  const std::vector<std::size_t> frames = spread_evenly(static_cast<std::size_t>(values.rows()), kMostFrames);
  return make_feature_groups(
      ground.base.basis, ground.base.moments, muscles, values(frames, Eigen::all),
      ground.shapes("train: influences", frames, all_vertices(ground.ordered.vertices.rows())).displacements);
}

// Joints come first; controls are everywhere.
std::vector<FeatureGroup> without_muscles(const Skeleton& skeleton, std::vector<FeatureGroup> groups) {
  const auto joints = static_cast<std::ptrdiff_t>(feature_joints(skeleton).size());
  const auto end = std::remove_if(groups.begin() + joints, groups.end(),
                                  [](const FeatureGroup& group) { return group.points.rows() > 0; });
  groups.erase(end, groups.end());
  return groups;
}

// Static regions: groups begin with the joints.
std::vector<RegionWeights> regions_of(const Character& character, const std::vector<FeatureGroup>& groups,
                                      const std::vector<RegionWeights>& painted, Support support) {
  const std::size_t joints = feature_joints(character.skeleton).size();
  switch (support) {
    case Support::dynamic_regions:
      return make_regions(character, groups, painted);
    case Support::static_regions:
      return make_regions(character, {groups.begin(), groups.begin() + static_cast<std::ptrdiff_t>(joints)}, painted);
    case Support::whole_skin:
      break;
  }
  RegionWeights whole{"skin", all_vertices(character.vertices.rows()), {}};
  whole.weights.assign(whole.vertices.size(), 1.0);
  return {whole};
}

// Choices of features, by rising reach.
FeatureChoices near_features(const Character& character, const RegionWeights& region,
                             const std::vector<FeatureGroup>& groups) {
  FeatureChoices choices;
  for (const double radius : kRadii) {
    choices.push_back(region_features(character, region, groups, radius * longest_extent(character.vertices)));
  }
  return choices;
}

std::vector<std::uint32_t> all_features(const std::vector<FeatureGroup>& groups) {
  std::vector<std::uint32_t> all;
  for (const FeatureGroup& group : groups) all.insert(all.end(), group.features.begin(), group.features.end());
  return all;
}

// A linear map may well see everything, having little to get wrong; of few frames, all may, and do without `muscles`.
FeatureChoices feature_choices(const Character& character, const RegionWeights& region,
                               const std::vector<FeatureGroup>& groups, const std::vector<FeatureGroup>& others,
                               const Method& method, bool few_frames) {
  const bool whole = method.support == Support::whole_skin;
  FeatureChoices choices;
  if (!whole) choices = near_features(character, region, groups);
  if (!whole && few_frames && others.size() < groups.size()) {
    for (std::vector<std::uint32_t>& choice : near_features(character, region, others))
      choices.push_back(std::move(choice));
  }
  if (whole || few_frames || !method.kernels) choices.push_back(all_features(whole || !few_frames ? groups : others));
  std::sort(choices.begin(), choices.end());
  choices.erase(std::unique(choices.begin(), choices.end()), choices.end());
  std::stable_sort(choices.begin(), choices.end(), [](const auto& a, const auto& b) { return a.size() < b.size(); });
  return choices;
}

std::vector<Muscle> with_curves(std::vector<Muscle> muscles, const std::vector<Muscle>& curves) {
  muscles.insert(muscles.end(), curves.begin(), curves.end());
  return muscles;
}

}  // namespace

Groundwork::Groundwork(const SampleSet& set, const TrainOptions& options, const std::vector<Muscle>& curves,
                       const EarlierFeatures& earlier)
    : muscles(with_curves(set.muscles, curves)),
      curve_count(curves.size()),
      order(morton_order(set.character.vertices)),
      ordered(to_learn(set, order)),
      base(base_with_fibres(set, ordered, order, options, muscles)),
      shapes(set, ordered, base.basis, order, options.method.unposing),
      features(features_of(set, base, earlier)) {}

Layout make_layout(const SampleSet& set, const Groundwork& ground, const Method& method) {
  const std::vector<Muscle> muscles = method.strains ? ground.muscles : std::vector<Muscle>{};
  const std::vector<FeatureGroup> groups = feature_groups(ground, muscles);
  const std::vector<FeatureGroup> others = without_muscles(ground.ordered.skeleton, groups);
  Layout layout;
  layout.regions = regions_of(ground.ordered, ground.curve_count == muscles.size() ? others : groups,
                              renumbered(set.regions, inverse_of(ground.order)), method.support);
  const bool few_frames = set.train.size() <= kFewFrames;
  for (const RegionWeights& region : layout.regions) {
    layout.choices.push_back(feature_choices(ground.ordered, region, groups, others, method, few_frames));
  }
  return layout;
}

}  // namespace bodyopt::trainer
