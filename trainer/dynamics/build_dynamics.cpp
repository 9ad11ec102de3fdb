#include "trainer/dynamics/build_dynamics.h"

#include <algorithm>
#include <iomanip>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>
#include <vector>

#include "base/json_file.h"
#include "base/progress.h"
#include "geometry/mesh.h"
#include "geometry/self_intersections.h"
#include "geometry/surface_topology.h"
#include "runtime/basis/output_order.h"
#include "runtime/core/error.h"
#include "runtime/core/json.h"
#include "runtime/core/text.h"
#include "runtime/deformer/deformer.h"
#include "runtime/host/device_choice.h"
#include "trainer/dynamics/jiggle.h"
#include "trainer/dynamics/jiggle_fields.h"
#include "trainer/train/skinning/ddm.h"

namespace bodyopt::trainer {
namespace {

constexpr std::size_t kShown = 3;  // joints

using VertexList = std::vector<std::uint32_t>;

VertexList first_vertices(const std::vector<VertexPair>& edges) {
  VertexList vertices;
  for (const VertexPair& edge : edges) vertices.push_back(edge.first);
  return vertices;
}

// The first of every joint's.
std::string places_of(const Character& character, const std::string& defect, const VertexList& vertices) {
  std::map<std::uint32_t, std::uint32_t> first;
  for (const std::uint32_t v : vertices) first.try_emplace(character.weights[v].front().joint, v);
  std::ostringstream text;
  text << std::fixed << std::setprecision(3);
  std::size_t shown = 0;
  for (const auto& [joint, vertex] : first) {
    if (shown++ == kShown) break;
    text << (shown == 1 ? "; the skin " + defect + " at '" : ", '") << character.skeleton.joints[joint].name << "' ("
         << character.vertices.row(vertex) << " m)";
  }
  if (first.size() > kShown) text << " and " << first.size() - kShown << " more";
  return text.str();
}

// Poses whose skins are held in memory at once, and the bytes of these at most.
constexpr std::size_t kMostPoses = 800, kMostBytes = std::size_t{4} << 30;

// The quasi-static skin, V x 3 in runtime order, in poses spread over those given.
std::vector<Positions> posed_skins(const Basis& basis, const std::vector<Pose>& poses) {
  const std::size_t skin = std::size_t{3} * sizeof(double) * std::max(1u, basis.mesh.vertex_count());
  const std::size_t count = std::min({kMostPoses, poses.size(), std::max<std::size_t>(1, kMostBytes / skin)});
  if (count == 0) return {};
  Deformer deformer(basis, {.name = "cpu"});
  std::vector<Positions> skins;
  for (std::size_t k = 0; k < count; ++k) {
    const Evaluation frame = deformer.evaluate({&poses[k * poses.size() / count], 1});
    skins.push_back(rows_of(vertices_of(basis.mesh, frame.positions)));
  }
  return skins;
}

// A refusal says where the skin is amiss.
DynamicsTets tets_of(const Character& character, const Basis& basis, const DynamicsOptions& options) {
  const std::vector<Positions> poses = posed_skins(basis, options.poses);
  try {
    return make_dynamics_tets(character.vertices, character.triangles, character.weights, options.resolution, poses);
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::mismatch) throw;
    throw Error(error.kind(), error.what() + defect_places(character), error.cause());
  }
}

DynamicsReport report_of(const Dynamics& dynamics, const DynamicsTets& tets, const JiggleAnatomy& anatomy,
                         std::vector<std::string> notes) {
  std::set<int> joints;
  for (const BonePart& bone : anatomy.tissue.bones) joints.insert(bone.joint);
  return {dynamics.tets.tet_count(),
          dynamics.tets.node_count(),
          dynamics.tets.surface_count(),
          tet_quality(tets.cage.mesh),
          tets.unfolding,
          anatomy.tissue.bones.size(),
          joints.size(),
          std::move(notes)};
}

Json provenance_of(const Character& character, const DynamicsOptions& options) {
  Json json = {{"character", character.name}, {"resolution", options.resolution}, {"jiggle", options.settings.origin}};
  Json settings = jiggle_json(options.settings);
  settings.erase("schema");
  json.update(settings);
  return json;
}

}  // namespace

std::string defect_places(const Character& character) {
  if (!character.vertices.allFinite()) return "";
  const BadEdges bad = find_bad_edges(character.triangles);
  return places_of(character, "is open", first_vertices(bad.open)) +
         places_of(character, "is fused along an edge", first_vertices(bad.shared)) +
         places_of(character, "turns inside out", first_vertices(bad.flipped)) +
         places_of(character, "passes through itself",
                   corners_of(self_intersections(character.vertices, character.triangles), character.triangles));
}

Json to_json(const DynamicsReport& report) {
  const TetQuality& quality = report.quality;
  const Unfolding& inverted = report.inverted_tets;
  return {{"tets", report.tets},
          {"nodes", report.nodes},
          {"surface_nodes", report.surface_nodes},
          {"quality",
           {{"worst", quality.worst}, {"first_percentile", quality.first_percentile}, {"median", quality.median}}},
          {"inverted_tets", {{"poses", inverted.poses}, {"before", inverted.before}, {"after", inverted.after}}},
          {"bone_springs", report.bone_springs},
          {"joints_with_bones", report.joints_with_bones},
          {"notes", report.notes}};
}

BuiltDynamics build_dynamics(const Character& character, const std::vector<Muscle>& muscles, const Basis& basis,
                             const DynamicsOptions& options) {
  const std::vector<std::uint32_t> order = morton_order(character.vertices);
  const Character ordered = in_order(character, order);
  require_same_character(make_mesh_table(ordered), ordered.skeleton, basis);
  require_possible(options.settings);
  require_names(options.settings, character, muscles, options.painted);

  Progress progress("dynamics", 4);
  const DynamicsTets tets = tets_of(ordered, basis, options);
  const TetMesh& mesh = tets.cage.mesh;
  progress.advance();
  const AnatomyField field(character, muscles, options.anatomy);
  JiggleAnatomy anatomy = find_anatomy(ordered, field, muscles.size(), tets.cage, options.materials);
  const JiggleFields fields = spread_settings(options.settings, ordered, muscles,
                                              renumbered(options.painted, inverse_of(order)), tets, anatomy);
  anatomy.bone_springs += core_springs(ordered.vertices, ordered.triangles, tets.cage, fields.flesh,
                                       bone_stiffness(options.materials, mesh));
  progress.advance();
  std::vector<std::string> notes;
  if (!tets.cage.mending.empty()) notes.push_back("the skin was mended for the tetrahedra alone: " + tets.cage.mending);
  JiggleSystem system =
      make_jiggle_system(options.settings, fields, ordered.skeleton, mesh, anatomy, options.materials, notes);
  hold_slow_parts(options.settings.lowest_frequency, fields.softness, ordered.skeleton, mesh, anatomy, system, notes);
  BuiltDynamics built;
  Dynamics& dynamics = built.dynamics;
  dynamics.tets = make_tet_table(tets, fields.skin_amount, fields.skin_limit);
  dynamics.diffuse = make_diffuse_table(mesh, static_cast<Eigen::Index>(tets.surface.size()));
  progress.advance();
  dynamics.jiggle = make_jiggle_table(mesh, system, options.step);
  progress.advance();
  set_muscles(anatomy, muscles, basis, options.settings.tension, dynamics.jiggle.nodes);
  dynamics.metadata["topology_hash"] = hexadecimal(topology_hash(basis.mesh));
  dynamics.metadata["skeleton_hash"] = hexadecimal(skeleton_hash(basis.skeleton));
  const auto text = [](const Json& json) { return json.dump(-1, ' ', false, Json::error_handler_t::replace); };
  built.report = report_of(dynamics, tets, anatomy, std::move(notes));
  built.settings = chosen_settings(options.settings, fields, ordered, anatomy);
  dynamics.metadata["report"] = text(to_json(built.report));
  dynamics.metadata["provenance"] = text(provenance_of(character, options));
  dynamics.metadata["jiggle_settings"] = text(jiggle_json(built.settings));
  return built;
}

DynamicsOptions asked_options(const Dynamics& dynamics) {
  const std::string where = "the dynamics' metadata 'provenance'";
  const auto text = dynamics.metadata.find("provenance");
  if (text == dynamics.metadata.end()) throw Error(ErrorKind::file, where, " is missing: made by another program?");
  Json json = parse_strict_json(text->second, where);
  if (!json.is_object()) throw Error(ErrorKind::file, where, " is no object: damaged?");
  constexpr int kMostTets = 1000000;
  DynamicsOptions options;
  options.resolution = JsonObject(json, where, "the top level").integer("resolution", 100, kMostTets);
  options.step = dynamics.jiggle.step;
  for (const char* other : {"character", "resolution", "jiggle"}) json.erase(other);
  options.settings = jiggle_settings(json, where);
  return options;
}

}  // namespace bodyopt::trainer
