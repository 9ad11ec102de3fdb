#include "trainer/check/foresee.h"

#include <algorithm>
#include <initializer_list>
#include <map>
#include <numeric>
#include <optional>
#include <set>
#include <utility>

#include "base/progress.h"
#include "base/spread_evenly.h"
#include "base/wording.h"
#include "geometry/mend_surface.h"
#include "geometry/mesh.h"
#include "geometry/self_intersections.h"
#include "geometry/spatial_search.h"
#include "geometry/surface_topology.h"
#include "runtime/core/error.h"
#include "trainer/dynamics/build_dynamics.h"
#include "trainer/dynamics/dynamics_tets.h"
#include "trainer/proxy/level_skins.h"
#include "trainer/simulate/simulate.h"
#include "trainer/tets/fillable_skin.h"
#include "trainer/train/data/unposed_shapes.h"
#include "trainer/train/skinning/ddm.h"
#include "trainer/train/skinning/unpose.h"

namespace bodyopt::trainer {
namespace {

constexpr double kTallest = 4, kSmallest = 0.3;  // metres, of the longest extent of most bodies
constexpr double kPerson = 2;                    // metres
constexpr double kOtherJoints = 0.3;             // of the weights in common at most
constexpr double kFacing = -0.3;                 // cosine of the normals of skin face to face
constexpr std::size_t kFewest = 3;               // vertices that make a part

constexpr const char* kNoDraft = "leave out --draft: 'simulate' fills the skin";

// Empty: the error's own sentence says all there is.
std::string remedy_for(ErrorCause cause) {
  switch (cause) {
    case ErrorCause::open_edges:
      return "fill its holes, give sheets a thickness (Blender: Fill Holes, Solidify); --picture shows them";
    case ErrorCause::crowded_edges:
      return "part the faces that are fused along an edge (Blender: select Non Manifold, split)";
    case ErrorCause::flipped_edges:
      return "turn its faces the same way (Blender: Recalculate Outside); --picture shows where";
    case ErrorCause::crossing:
      return "move apart, at rest, what passes through itself; --picture shows where";
    case ErrorCause::unfillable:
      return "dissolve slivers, and part sheets that lie close at rest (Blender: Degenerate Dissolve); where it passes "
             "through itself is listed, if it does";
    case ErrorCause::loose_vertices:
      return "delete its loose vertices (Blender: Delete Loose)";
    case ErrorCause::no_faces:
      return "export the skin with its faces";
    case ErrorCause::flat:
      return "give it a thickness (Blender: Solidify)";
    case ErrorCause::large_piece:
      return "join that piece to the body, or give it the weights of the skin that it is to follow";
    case ErrorCause::several_pieces:
      return "join the pieces to one skin";
    case ErrorCause::damaged:
      return "export it again from where it was made";
    case ErrorCause::unweighted:
      return "give every vertex skin weights (Blender: Armature Deform, With Automatic Weights)";
    case ErrorCause::too_few_vertices:
      return "none is needed: so few vertices are as fast as a proxy of them";
    case ErrorCause::too_few_frames:
      return "simulate more motion: 'bodyopt rom' makes some that shows all a character can do";
    case ErrorCause::other:
      break;
  }
  return "";
}

std::uint32_t main_joint(const Character& character, std::uint32_t vertex) {
  return character.weights[vertex].front().joint;
}

using JointPair = std::pair<std::uint32_t, std::uint32_t>;
using VerticesOfJoints = std::map<JointPair, std::vector<std::uint32_t>>;

// Places by the joints of their vertices, the largest first.
std::vector<RestPlace> places_of(const Character& character, const VerticesOfJoints& found, std::size_t fewest) {
  std::vector<RestPlace> places;
  for (const auto& [joints, vertices] : found) {
    if (vertices.size() < fewest) continue;
    const std::uint32_t first = vertices.front();
    places.push_back({character.skeleton.joints[joints.first].name, character.skeleton.joints[joints.second].name,
                      vertices, character.first_output(first), character.vertices.row(first)});
  }
  std::stable_sort(places.begin(), places.end(),
                   [](const RestPlace& a, const RestPlace& b) { return a.vertices.size() > b.vertices.size(); });
  return places;
}

// Sorts vertices into places by their own joints.
template <typename Vertices>
std::vector<RestPlace> places_of(const Character& character, const Vertices& vertices) {
  VerticesOfJoints found;
  for (const std::uint32_t v : vertices) {
    const std::uint32_t joint = main_joint(character, v);
    found[{joint, joint}].push_back(v);
  }
  return places_of(character, found, 1);
}

std::set<std::uint32_t> vertices_of(const std::vector<VertexPair>& edges) {
  std::set<std::uint32_t> vertices;
  for (const auto& [a, b] : edges) vertices.insert({a, b});
  return vertices;
}

std::vector<std::uint32_t> vertices_of_loose_pieces(const FillableSkin& fillable) {
  std::vector<std::uint32_t> vertices;
  for (std::uint32_t v = 0; v < fillable.host.size(); ++v) {
    if (fillable.host[v] < 0) vertices.push_back(v);
  }
  return vertices;
}

// Skin that looks at skin of other joints across less air than an edge.
std::vector<RestPlace> near_parts_of(const Character& character) {
  const Positions normals = vertex_normals(character.vertices, character.triangles).rowwise().normalized();
  std::vector<int> all(static_cast<std::size_t>(character.vertices.rows()));
  std::iota(all.begin(), all.end(), 0);
  const double near = mean_edge(character.vertices, character.triangles);
  if (!(near > 0)) return {};
  const PointGrid grid(character.vertices, all, near);
  const double side = enclosed_volume(character.vertices, character.triangles) < 0 ? -1 : 1;
  VerticesOfJoints found;
  for (const int v : all) {
    const Eigen::RowVector3d place = character.vertices.row(v), normal = side * normals.row(v);
    const auto faces = [&](int other) {
      const Eigen::RowVector3d between = character.vertices.row(other) - place;
      return between.norm() < near && between.dot(normal) > 0.5 * between.norm() &&
             side * normal.dot(normals.row(other)) < kFacing &&
             shared_weight(character.weights[static_cast<std::size_t>(v)],
                           character.weights[static_cast<std::size_t>(other)]) < kOtherJoints;
    };
    std::optional<std::uint32_t> opposite;
    grid.visit(place.array() - near, place.array() + near, [&](int other) {
      if (!opposite && faces(other)) opposite = static_cast<std::uint32_t>(other);
    });
    if (!opposite) continue;
    const std::uint32_t a = main_joint(character, static_cast<std::uint32_t>(v)), b = main_joint(character, *opposite);
    if (a != b) found[std::minmax(a, b)].push_back(static_cast<std::uint32_t>(v));
  }
  return places_of(character, found, kFewest);
}

VerbForecast refusal(const std::string& verb, const Error& error) {
  if (error.kind() == ErrorKind::interrupted) throw error;
  return {verb, BodyFill::refused, 0, false, error.what(), remedy_for(error.cause()), "", error.cause()};
}

void add_glued(const Character& character, const Cage& cage, VerticesOfJoints& glued) {
  for (const GluedVertex& at : cage.glued) {
    std::vector<std::uint32_t>& vertices = glued[std::minmax(main_joint(character, at.vertex), at.joint)];
    if (std::find(vertices.begin(), vertices.end(), at.vertex) == vertices.end()) vertices.push_back(at.vertex);
  }
}

// glued: gets what its cage holds together.
VerbForecast foresee_simulate(const Character& character, bool draft, VerticesOfJoints& glued) {
  const std::string verb = draft ? "simulate --draft" : "simulate";
  try {
    const Cage cage = choose_cage(character, {.draft = draft});
    const Eigen::Index nodes = cage.mesh.nodes.rows();
    const std::string parts = glued_parts(cage, character);
    add_glued(character, cage, glued);
    if (cage.why_lattice) {
      const Error& why = *cage.why_lattice;
      return {verb, BodyFill::lattice, nodes, true, why.what(), remedy_for(why.cause()), parts, why.cause()};
    }
    const BodyFill fill = !cage.is_own_skin      ? BodyFill::coarser
                          : cage.mending.empty() ? BodyFill::skin
                                                 : BodyFill::mended;
    return {verb, fill, nodes, true, cage.mending, "", parts};
  } catch (const Error& error) {
    return refusal(verb, error);
  }
}

VerbForecast foresee_dynamics(const Character& character) {
  try {
    // They are made in this order: another one may be filled where this is not.
    const Character ordered = in_order(character, morton_order(character.vertices));
    const DynamicsTets tets =
        make_dynamics_tets(ordered.vertices, ordered.triangles, ordered.weights, DynamicsOptions{}.resolution);
    const std::string& mending = tets.cage.mending;
    return {
        "dynamics", mending.empty() ? BodyFill::skin : BodyFill::mended, tets.cage.mesh.nodes.rows(), false, mending,
        ""};
  } catch (const Error& error) {
    return refusal("dynamics", error);
  }
}

// Training starts from this basis.
VerbForecast foresee_train(const Character& character) {
  try {
    build_ddm_basis(character, {});
    return {"train", BodyFill::works, character.vertices.rows(), false, "", ""};
  } catch (const Error& error) {
    return refusal("train", error);
  }
}

// `shapes`: as simplify_skin().
VerbForecast foresee_proxy(const Character& character, const std::vector<Positions>& shapes) {
  try {
    std::vector<std::string> notes;
    const std::vector<LevelSkin> skins = level_skins(character, shapes, {}, notes);
    return {"proxy",
            BodyFill::works,
            static_cast<Eigen::Index>(skins.back().skin.vertices.size()),
            false,
            notes.empty() ? "" : notes.front(),
            ""};
  } catch (const Error& error) {
    return refusal("proxy", error);
  }
}

// The rest skin, then some of the poses by linear blending.
std::vector<Positions> skinned_shapes(const Character& character, const std::vector<Pose>& poses) {
  constexpr std::size_t kShapes = 16;
  std::vector<Positions> shapes = {character.vertices};
  for (const std::size_t n : spread_evenly(poses.size(), kShapes)) shapes.push_back(skin_linear(character, poses[n]));
  return shapes;
}

bool turns(const std::vector<Pose>& poses, std::size_t joint) {
  constexpr double kTurned = 1e-5;  // of the cosine of half the angle: half a degree
  const Quat& first = poses.front().joints[joint].rotation;
  return std::any_of(poses.begin(), poses.end(), [&](const Pose& pose) {
    const Quat& now = pose.joints[joint].rotation;
    return 1 - std::abs(std::inner_product(first.begin(), first.end(), now.begin(), 0.0)) > kTurned;
  });
}

// `moves`: of every joint, whether skin follows it.
std::string still_joints(const Skeleton& skeleton, const std::vector<bool>& moves, const std::vector<Pose>& poses) {
  std::vector<std::string> still;
  for (std::size_t j = 0; j < skeleton.size() && !poses.empty(); ++j) {
    if (moves[j] && skeleton.joints[j].parent >= 0 && !turns(poses, j)) still.push_back(skeleton.joints[j].name);
  }
  if (still.empty()) return "";
  return "the clips of its file never turn " + list_names(still) +
         ": trained on them alone, nothing is known of these joints ('bodyopt rom' turns all)";
}

// The error of simulate for a clip that scales a joint; empty: there is none.
std::string refusal_of(const Clip& clip, const Skeleton& skeleton) {
  try {
    for (int frame = clip.first_frame; frame <= clip.last_frame(); ++frame) require_unscaled(skeleton, clip, frame);
    return "";
  } catch (const Error& error) {
    return error.what();
  }
}

// Clips that simulate refuses: no motion of their file is left to `simulations`, or a remark.
void foresee_scaled_clips(const std::vector<Clip>& clips, const Skeleton& skeleton,
                          std::initializer_list<VerbForecast*> simulations, std::vector<std::string>& remarks) {
  std::vector<std::string> scaled, reasons;
  for (const Clip& clip : clips) {
    std::string reason = refusal_of(clip, skeleton);
    if (reason.empty()) continue;
    scaled.push_back(clip.name);
    reasons.push_back(std::move(reason));
  }
  if (scaled.empty()) return;
  const std::string which = (scaled.size() == 1 ? "clip " : "clips ") + list_names(scaled);
  if (scaled.size() < clips.size()) {
    remarks.push_back("simulate refuses the " + which + ", which " + (scaled.size() == 1 ? "scales" : "scale") +
                      " joints: remove the scale, or simulate the others");
    return;
  }
  for (VerbForecast* simulation : simulations) {
    *simulation = {simulation->verb, BodyFill::refused, 0, false, reasons.front(), "remove the scale in " + which};
  }
}

std::vector<Pose> poses_of(const std::vector<Clip>& clips) {
  std::vector<Pose> poses;
  for (const Clip& clip : clips) poses.insert(poses.end(), clip.poses.begin(), clip.poses.end());
  return poses;
}

// `unit`: metres per unit of the file that the character was read with.
std::vector<std::string> remarks_on(const Character& character, const std::vector<Pose>& poses, double unit) {
  std::vector<std::string> remarks;
  const double extent = longest_extent(character.vertices);
  if (extent > kTallest || extent < kSmallest) {
    remarks.push_back("it measures " + rounded(extent) + " m at its longest: if it is not so " +
                      (extent > kTallest ? "large" : "small") + ", say what a unit of its file is (--unit " +
                      rounded(unit * kPerson / extent) + " makes it " + rounded(kPerson) + " m)");
  }
  std::vector<bool> moves(character.skeleton.size(), false);
  for (const std::vector<JointWeight>& vertex : character.weights) {
    for (const JointWeight& w : vertex) moves[w.joint] = true;
  }
  std::vector<std::string> idle;
  for (std::size_t j = moves.size(); j-- > 0;) {  // children come after their parents
    const int parent = character.skeleton.joints[j].parent;
    if (moves[j] && parent >= 0) moves[static_cast<std::size_t>(parent)] = true;
    if (!moves[j]) idle.push_back(character.skeleton.joints[j].name);
  }
  std::reverse(idle.begin(), idle.end());
  if (!idle.empty()) {
    remarks.push_back(count_of(idle.size(), "joint moves", "joints move") + " no skin: " + list_names(idle) +
                      " (harmless, unless skin was meant to follow: then paint weights)");
  }
  if (const std::string still = still_joints(character.skeleton, moves, poses); !still.empty()) {
    remarks.push_back(still);
  }
  if (!poses.empty() && poses.size() < kFewestFrames) {
    remarks.push_back("the clips of its file have " + count_of(poses.size(), "frame", "frames") + ", training needs " +
                      std::to_string(kFewestFrames) +
                      " at least: simulate a longer clip, or one that 'bodyopt rom' makes");
  }
  return remarks;
}

}  // namespace

const char* name_of(BodyFill fill) {
  constexpr const char* names[] = {"skin", "mended skin", "coarser skin", "lattice", "refused", "works"};
  return names[static_cast<std::size_t>(fill)];
}

CharacterForecast foresee(const Character& character, const std::vector<Clip>& clips, double unit) {
  CharacterForecast result;
  constexpr std::size_t kVerbs = 5;
  Progress progress("check", kVerbs + 2);
  const auto counted = [&](VerbForecast verb) {
    progress.advance();
    return verb;
  };
  const std::vector<Pose> poses = poses_of(clips);
  result.remarks = remarks_on(character, poses, unit > 0 ? unit : 1);
  VerticesOfJoints glued;
  VerbForecast full = counted(foresee_simulate(character, false, glued)),
               draft = counted(foresee_simulate(character, true, glued));
  if (draft.fill == BodyFill::lattice && full.has_contact && full.fill != BodyFill::lattice) draft.remedy = kNoDraft;
  foresee_scaled_clips(clips, character.skeleton, {&full, &draft}, result.remarks);
  result.verbs = {std::move(full), std::move(draft), counted(foresee_dynamics(character)),
                  counted(foresee_train(character)),
                  counted(foresee_proxy(character, skinned_shapes(character, poses)))};
  result.glued = places_of(character, glued, kFewest);
  try {
    const FillableSkin fillable = fillable_skin(character.vertices, character.triangles, character.weights);
    result.intersections = places_of(character, fillable.tangled);
    result.loose_pieces = places_of(character, vertices_of_loose_pieces(fillable));
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::mismatch) throw;  // the verbs say why
    result.intersections = places_of(
        character, corners_of(self_intersections(character.vertices, character.triangles), character.triangles));
  }
  const BadEdges bad = find_bad_edges(each_once(character.triangles));
  result.holes = places_of(character, vertices_of(bad.open));
  result.flipped = places_of(character, vertices_of(bad.flipped));
  progress.advance();
  result.near_parts = near_parts_of(character);
  progress.advance();
  return result;
}

std::vector<VerbForecast> foresee_training(const SampleSet& set) {
  try {
    check_samples(set);
  } catch (const Error& error) {
    return {refusal("train", error), refusal("proxy", error)};
  }
  return {foresee_train(set.character), foresee_proxy(set.character, shapes_of_skin(set))};
}

}  // namespace bodyopt::trainer
