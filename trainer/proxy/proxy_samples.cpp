#include "trainer/proxy/proxy_samples.h"

#include <algorithm>
#include <numeric>

#include "base/progress.h"
#include "runtime/deformer/deformer.h"
#include "trainer/train/skinning/mesh_table.h"

namespace bodyopt {
namespace {

// Empty where the region keeps no vertex.
RegionWeights region_at(const RegionWeights& region, const VertexRows& rows) {
  RegionWeights result{region.name, {}, {}};
  for (std::size_t k = 0; k < region.vertices.size(); ++k) {
    const auto row = std::lower_bound(rows.begin(), rows.end(), region.vertices[k]);
    if (row == rows.end() || *row != region.vertices[k]) continue;
    result.vertices.push_back(static_cast<std::uint32_t>(row - rows.begin()));
    result.weights.push_back(region.weights[k]);
  }
  return result;
}

constexpr std::size_t kBlock = 10, kHeldoutEvery = 5;

}  // namespace

Character proxy_character(const Character& character, const SimplifiedSkin& skin) {
  Character proxy;
  proxy.name = character.name;
  proxy.skeleton = character.skeleton;
  proxy.vertices.resize(static_cast<Eigen::Index>(skin.vertices.size()), 3);
  for (std::size_t v = 0; v < skin.vertices.size(); ++v) {
    proxy.vertices.row(static_cast<Eigen::Index>(v)) = character.vertices.row(skin.vertices[v]);
    proxy.weights.push_back(character.weights[skin.vertices[v]]);
  }
  proxy.triangles = proxy.output_triangles = skin.triangles;
  proxy.output_vertex.resize(skin.vertices.size());
  std::iota(proxy.output_vertex.begin(), proxy.output_vertex.end(), 0u);
  return proxy;
}

SampleSet proxy_samples(const SampleSet& set, const SimplifiedSkin& skin) {
  SampleSet proxy;
  proxy.character = proxy_character(set.character, skin);
  proxy.muscles = set.muscles;
  proxy.takes = set.takes;
  proxy.controls = set.controls;
  proxy.unconverged = set.unconverged;
  proxy.sparse = true;
  for (const RegionWeights& region : set.regions) {
    RegionWeights kept = region_at(region, skin.vertices);
    if (kept.vertices.empty()) {
      proxy.notes.push_back("region '" + region.name + "' keeps no vertex of the skin, and is left out");
    } else {
      proxy.regions.push_back(std::move(kept));
    }
  }
  const auto rows = std::make_shared<const VertexRows>(skin.vertices);
  for (const auto& [from, to] : {std::pair(&set.train, &proxy.train), std::pair(&set.heldout, &proxy.heldout)}) {
    for (const Sample& sample : *from) to->push_back({sample.take, sample.frame, sample.pose, sample.shape.at(rows)});
  }
  return proxy;
}

SampleSet taught_samples(const Character& character, const std::vector<Muscle>& muscles, const Basis& teacher,
                         std::span<const Pose> poses, std::span<const int> frames) {
  require_same_character(make_mesh_table(in_order(character, morton_order(character.vertices))), character.skeleton,
                         teacher);
  SampleSet set;
  set.character = character;
  set.muscles = muscles;
  set.takes = {"clip"};
  set.controls = teacher.residual.controls;
  Deformer deformer(teacher, {.name = "cpu"});
  Progress progress("proxy: shapes of the basis", poses.size());
  for (std::size_t k = 0; k < poses.size(); ++k) {
    const Evaluation frame = deformer.evaluate(poses.subspan(k, 1));
    const bool heldout = k / kBlock % kHeldoutEvery == kHeldoutEvery - 1;
    (heldout ? set.heldout : set.train)
        .push_back({0, frames[k], poses[k], SampleShape(welded_from_output(character, frame.positions.data()))});
    progress.advance();
  }
  return set;
}

}  // namespace bodyopt
