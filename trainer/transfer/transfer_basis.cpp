#include "trainer/transfer/transfer_basis.h"

#include <map>
#include <nlohmann/json.hpp>

#include "assets/matched_joints.h"
#include "geometry/table_rows.h"
#include "trainer/train/features/features.h"
#include "trainer/transfer/transfer_columns.h"
#include "trainer/transfer/transfer_pair.h"

namespace bodyopt {
namespace {

// Gives the fibres' points places on the target's skin.
class FibreCarrier {
 public:
  FibreCarrier(const TransferPair& pair, const StrainTable& source)
      : pair_(pair),
        source_(source),
        triangles_(rows_of(pair.target.mesh.triangles)),
        places_on_target_(sure_places(pair)),
        nearest_(pair.correspondence.target, triangles_) {
    target_vertex_.resize(pair.source.mesh.vertex_count());
    if (!pair.correspondence.same_topology) return;
    const MeshTable &from = pair.source.mesh, &to = pair.target.mesh;
    for (std::uint32_t o = 0; o < from.output_count(); ++o) target_vertex_[from.output_vertex[o]] = to.output_vertex[o];
  }

  StrainTable carry() {
    StrainTable result = source_;
    result.vertices.clear();
    if (pair_.correspondence.same_topology) {
      for (const std::uint32_t vertex : source_.vertices) result.vertices.push_back(target_vertex_[vertex]);
      return result;
    }
    for (FibrePoint& point : result.points) point = carried(point, result.vertices);
    return result;
  }

 private:
  FibrePoint carried(const FibrePoint& point, std::vector<std::uint32_t>& vertices) {
    const auto corner = [&](std::uint32_t k) -> Eigen::Vector3d { return places_on_target_.row(source_.vertices[k]); };
    const SkinPoint at = nearest_(double{point.wa} * corner(point.a) + double{point.wb} * corner(point.b) +
                                  double{point.wc} * corner(point.c));
    std::uint32_t place[3];
    for (std::size_t k = 0; k < 3; ++k) place[k] = place_of(at.vertices[k], vertices);
    return {place[0],
            place[1],
            place[2],
            static_cast<float>(at.weights[0]),
            static_cast<float>(at.weights[1]),
            static_cast<float>(at.weights[2])};
  }

  std::uint32_t place_of(std::uint32_t vertex, std::vector<std::uint32_t>& vertices) {
    const auto [entry, added] = places_.emplace(vertex, static_cast<std::uint32_t>(vertices.size()));
    if (added) vertices.push_back(vertex);
    return entry->second;
  }

  const TransferPair& pair_;
  const StrainTable& source_;
  const Triangles triangles_;
  const Positions places_on_target_;  // of the source's vertices
  const NearestSkin nearest_;
  std::vector<std::uint32_t> target_vertex_;       // of each source vertex, for the same topology
  std::map<std::uint32_t, std::uint32_t> places_;  // of the target's vertices in the table's list
};

std::vector<float> strains_at_target_rest(const TransferPair& pair) {
  if (!pair.match.is_aligned()) return std::vector<float>(pair.source.strain.fibre_count(), 0.0f);
  return measure_strains(pair.source, pose_at_target_rest(pair.match, pair.source.skeleton));
}

// At the target's rest its fibres are strained as the source's are where it stands so. Lengths are what the run-time
// kernels measure: with a rest length of 1 m the strain is the length less one. A fibre that has collapsed to a point
// keeps 1 m.
void measure_rest_lengths(const TransferPair& pair, Basis& basis) {
  const std::vector<float> strain_at_rest = strains_at_target_rest(pair);
  basis.strain.rest_length.assign(basis.strain.rest_length.size(), 1.0f);
  for (std::size_t k = 0; const float strain : measure_strains(basis, bind_pose(basis.skeleton))) {
    const float length = (1 + strain) / (1 + strain_at_rest[k]);
    basis.strain.rest_length[k++] = length > 1e-6f ? length : 1;
  }
}

// With the target's joints and number of vertices; the errors are those of the source.
CoverageTable carried_coverage(const TransferPair& pair) {
  const CoverageTable& source = pair.source.coverage;
  CoverageTable carried = source;
  if (source.empty()) return carried;
  const float share =
      static_cast<float>(pair.target.mesh.vertex_count()) / static_cast<float>(pair.source.mesh.vertex_count());
  for (float& size : carried.sizes) size *= share;
  for (float& growth : carried.growth) growth *= share;
  carried.joint_begin = {0};
  carried.joints.clear();
  for (std::size_t r = 0; r < source.sizes.size(); ++r) {
    for (std::uint32_t k = source.joint_begin[r]; k < source.joint_begin[r + 1]; ++k) {
      const int joint = pair.match.target_joint[source.joints[k]];
      if (joint >= 0) carried.joints.push_back(static_cast<std::uint32_t>(joint));
    }
    if (carried.joints.size() == carried.joint_begin.back()) carried.joints.push_back(0);  // the root moves all
    carried.joint_begin.push_back(static_cast<std::uint32_t>(carried.joints.size()));
  }
  return carried;
}

void carry_metadata(const TransferPair& pair, Basis& basis) {
  const auto parse = [](const Metadata& metadata, const char* key) {
    const auto text = metadata.find(key);
    return text == metadata.end() ? Json() : Json::parse(text->second, nullptr, false);
  };
  Json provenance = parse(basis.metadata, "provenance");
  const Json source = parse(pair.source.metadata, "provenance");
  if (!source.is_discarded()) provenance["transferred_from"] = source;
  basis.metadata["provenance"] = provenance.dump(-1, ' ', false, Json::error_handler_t::replace);
  basis.metadata[kMatchedJoints] = to_json(pair.match, pair.source.skeleton, pair.target.skeleton)
                                       .dump(-1, ' ', false, Json::error_handler_t::replace);
  basis.coverage = carried_coverage(pair);
  const auto report = pair.source.metadata.find("report");
  if (report != pair.source.metadata.end()) basis.metadata["report"] = report->second;
}

}  // namespace

Basis transfer_basis(const TransferPair& pair, const TransferOptions& options, std::vector<std::string>& notes) {
  Basis result = pair.target;
  result.strain = FibreCarrier(pair, pair.source.strain).carry();
  result.residual = pair.source.residual;
  result.skeleton.features = carried_features(pair.source.skeleton, pair.target.skeleton, pair.match);
  measure_rest_lengths(pair, result);
  ResidualTable columns = pair.source.residual;
  transfer_columns(pair.skin, pair.source.mesh.vertex_count(), pair.target.mesh.vertex_count(), options.tolerance,
                   columns);
  result.residual.blend = std::move(columns.blend);
  result.residual.blend_begin = std::move(columns.blend_begin);
  carry_metadata(pair, result);
  if (!pair.source.modifiers.empty()) {
    notes.emplace_back(
        "the modifiers of the source are left out: they were made of its body; 'bodyopt modifiers' makes them of the "
        "target's");
  }
  validate(result, "the transferred basis");
  return result;
}

}  // namespace bodyopt
