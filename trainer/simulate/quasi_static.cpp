#include "trainer/simulate/quasi_static.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "base/content_hash.h"
#include "geometry/mesh.h"
#include "runtime/core/error.h"
#include "runtime/core/stopwatch.h"
#include "runtime/host/rig.h"
#include "trainer/simulate/body_hash.h"
#include "trainer/simulate/node_weights.h"
#include "trainer/tets/second_order.h"

namespace bodyopt::trainer {
namespace {

constexpr double kTolerance = 1e-4;
constexpr int kMaxIterations = 1500;  // each time that a shape is settled: more have hardly ever helped
// A shape only has to stay near the path while it is under way.
constexpr double kPathTolerance = 1e-2;
constexpr int kPathIterations = 8;
constexpr double kMaxTurn = 20 * std::numbers::pi / 180;  // a step, of the joint that turns most
constexpr double kMaxFlex = 0.25;                         // a step, of full activation
// A step that turns more than this share of the body inside out is halved, or folds would tangle. Tets too small to
// matter recover by themselves.
constexpr double kMostInverted = 1e-6;
constexpr double kShortestStep = 1.0 / 32;  // of a full step
// Tets of second order start at the shape in linear tets. They do not if its skin lies deeper in skin than this,
// metres, or if more of them would be inside out.
constexpr double kDeepFold = 3e-3, kMostTangled = 1e-4;
// A part that has slipped into another so deep, metres, in steps too long for contact to stop it, takes shorter ones.
constexpr double kTooDeep = 5e-3;
constexpr double kMinWeight = 1e-3;
// Parts nearer than this, metres, may come into contact while a shape is relaxed.
constexpr double kContactMargin = 5e-3;
// Contact is held for so many iterations; from this round on for twice as many each time. A shape that has converged
// then is taken as it is: some nodes never come to rest on their planes.
constexpr int kContactIterations = 20, kContactRounds = 16;
// A step of the solver moves no node further than this part of the body's longest extent.
constexpr double kMaxMove = 0.01;
// A cage's few large linear tets lock at the lambda that finer ones bear. With a quarter of it they come nearest to the
// shapes of finer ones.
constexpr double kCoarseLambda = 0.25;
// The share of lambda that keeps the eighths of tets of second order upright where they have turned over.
constexpr double kEighthsLambda = 0.05;
constexpr double kLeastFilled = 0.1;  // of a cage's tet: emptier ones would have next to no stiffness
// A strain that counts as none: residuals are relative to the forces of this strain at least. The energy at rest is not
// zero, and its rounding hides the last digits of smaller strains: a body at rest could never converge.
constexpr double kStrainFloor = 1e-4;

void require_flex(std::span<const double> flex, std::size_t muscles) {
  if (!flex.empty() && flex.size() != muscles) {
    throw Error(ErrorKind::mismatch,
                std::to_string(flex.size()) + " muscles are flexed, the body has " + std::to_string(muscles));
  }
  for (const double f : flex) {
    if (!(f >= 0 && f <= 1)) throw Error(ErrorKind::mismatch, "muscles flex by 0 to 1, not by " + std::to_string(f));
  }
}

// A lattice's tets reach beyond the skin: they are as stiff as the share of them that is tissue.
std::vector<TetMaterial> materials_in(const Cage& cage, std::vector<TissueShares> shares, const Materials& of) {
  for (TissueShares& share : shares) share.fat += std::max(kLeastFilled - share.sum(), 0.0);
  std::vector<TetMaterial> materials = tet_materials(shares, of);
  if (cage.mesh.is_second_order || cage.is_own_skin) return materials;
  for (TetMaterial& material : materials) material.lambda *= kCoarseLambda;
  return materials;
}

// A skin that the anatomy finds nothing in, a sheet, has bones where tets go with one joint.
std::vector<BonePart> bones_by_weights(const TetMesh& mesh, const NodeWeights& weights) {
  constexpr double kLeast = 0.9;
  const Eigen::Matrix4d moments = (Eigen::Matrix4d::Ones() + Eigen::Matrix4d::Identity()) / 20;
  std::vector<BonePart> bones;
  for (int t = 0; t < mesh.tets.rows(); ++t) {
    Eigen::RowVectorXd mean = Eigen::RowVectorXd::Zero(weights.cols());
    for (int a = 0; a < 4; ++a) mean += 0.25 * weights.row(mesh.tets(t, a));
    Eigen::Index joint = 0;
    if (mean.maxCoeff(&joint) < kLeast) continue;
    bones.push_back({t, static_cast<int>(joint), tet_edges(mesh, t).determinant() / 6 * moments});
  }
  return bones;
}

std::unique_ptr<Tissue> eighths_of(TetMesh mesh, std::vector<TetMaterial> tets) {
  mesh.is_second_order = false;
  for (TetMaterial& material : tets) material = {0, kEighthsLambda * material.lambda};
  return std::make_unique<Tissue>(mesh, tets, std::vector<FibreTet>());
}

// The only root, or -1: the joint whose motion moves the whole body.
int single_root(const Skeleton& skeleton) {
  int roots = 0;
  for (const Joint& joint : skeleton.joints) roots += joint.parent < 0 ? 1 : 0;
  return roots == 1 ? 0 : -1;
}

using LocalTransforms = std::vector<JointTransform>;

// The straight path in joint angles, u = 0 at one pose, 1 at the other.
LocalTransforms between(const LocalTransforms& from, const LocalTransforms& to, double u) {
  LocalTransforms local(from.size());
  for (std::size_t j = 0; j < from.size(); ++j) {
    for (std::size_t i = 0; i < 3; ++i) {
      local[j].translation[i] = std::lerp(from[j].translation[i], to[j].translation[i], u);
      local[j].scale[i] = std::lerp(from[j].scale[i], to[j].scale[i], u);
    }
    local[j].rotation = slerp(normalized(from[j].rotation), normalized(to[j].rotation), u);
  }
  return local;
}

double widest_turn(const LocalTransforms& from, const LocalTransforms& to) {
  double widest = 0;
  for (std::size_t j = 0; j < from.size(); ++j) {
    widest = std::max(widest, angle_between(normalized(from[j].rotation), normalized(to[j].rotation)));
  }
  return widest;
}

std::vector<double> scaled(std::span<const double> values, double by) {
  std::vector<double> result(values.begin(), values.end());
  for (double& value : result) value *= by;
  return result;
}

Eigen::Vector3d turned(const Quat& rotation, const Eigen::Vector3d& v) {
  const Vec3 result = rotate(rotation, {v[0], v[1], v[2]});
  return {result[0], result[1], result[2]};
}

// The place of a point by linear blending, and the blend of the rotations of its joints.
struct BlendedFrame {
  Eigen::Vector3d position;
  Quat rotation;
};

struct JointFrames {
  std::vector<Affine> skinning;
  std::vector<Quat> rotation;

  JointFrames(const Skeleton& skeleton, const LocalTransforms& local) : skinning(skinning_matrices(skeleton, local)) {
    for (const Affine& matrix : skinning) rotation.push_back(normalized(decompose(matrix).rotation));
  }

  BlendedFrame blend(const std::vector<JointWeight>& weights, const Eigen::RowVector3d& rest) const {
    const Quat& first = rotation[weights.front().joint];
    Vec3 position{0, 0, 0};
    Quat turn{0, 0, 0, 0};
    for (const JointWeight& w : weights) {
      position = position + w.weight * (skinning[w.joint] * Vec3{rest[0], rest[1], rest[2]});
      const Quat& q = rotation[w.joint];
      double cosine = 0;
      for (std::size_t i = 0; i < 4; ++i) cosine += q[i] * first[i];
      for (std::size_t i = 0; i < 4; ++i) turn[i] += (cosine < 0 ? -w.weight : w.weight) * q[i];
    }
    return {{position[0], position[1], position[2]}, normalized(turn)};
  }
};

void move_all(const Affine& motion, Positions& nodes) {
  for (Eigen::Index n = 0; n < nodes.rows(); ++n) {
    const Vec3 moved = motion * Vec3{nodes(n, 0), nodes(n, 1), nodes(n, 2)};
    nodes.row(n) << moved[0], moved[1], moved[2];
  }
}

}  // namespace

bool is_converged(const FrameStatus& status) { return status.residual < kTolerance && status.inverted_tets == 0; }

QuasiStaticBody::QuasiStaticBody(const Character& character, const std::vector<Muscle>& muscles,
                                 const AnatomyField& anatomy, const Cage& cage, const Materials& materials)
    : skeleton_(character.skeleton),
      muscles_(muscles),
      bellies_(anatomy.belly_lengths()),
      least_slack_(materials.active_slack),
      mesh_(cage.mesh),
      embedding_(cage.skin),
      carriers_(mesh_.tets) {
  const auto tet_count = static_cast<std::size_t>(mesh_.tets.rows());
  const auto joint_count = static_cast<Eigen::Index>(skeleton_.size());

  bellies_.resize(muscles.size());  // a field of nothing has none
  inside_ = find_tissue(cage, anatomy);
  const std::vector<TetMaterial> tets = materials_in(cage, inside_.shares, materials);
  tissue_ = std::make_unique<Tissue>(mesh_, tets, inside_.fibres, materials);
  if (mesh_.is_second_order) eighths_ = eighths_of(mesh_, tets);
  volume_ = std::make_unique<MuscleVolume>(mesh_, inside_.fibres, muscles.size(), materials);

  std::vector<double> muscle;
  for (const TissueShares& shares : inside_.shares) muscle.push_back(shares.muscle);
  const SparseMatrix laplacian = tet_laplacian(mesh_, metric_stiffness(tets, muscle, materials));
  if (inside_.bones.empty()) {
    const SparseMatrix no_springs(laplacian.rows(), laplacian.cols());
    inside_.bones = bones_by_weights(
        mesh_, carry_through(character, cage, laplacian, no_springs, NodeWeights::Zero(laplacian.rows(), joint_count)));
  }
  springs_ = std::make_unique<BoneSprings>(mesh_, inside_.bones, bone_stiffness(materials, mesh_), skeleton_.size());
  weights_ = carry_through(character, cage, laplacian, springs_->stiffness(), springs_->joint_stiffness());
  for (Eigen::Index n = 0; n < weights_.rows(); ++n) {
    std::vector<JointWeight>& entries = node_joints_.emplace_back();
    double sum = 0;
    for (Eigen::Index j = 0; j < joint_count; ++j) {
      if (weights_(n, j) < kMinWeight) continue;
      entries.push_back({static_cast<std::uint32_t>(j), weights_(n, j)});
      sum += weights_(n, j);
    }
    for (JointWeight& entry : entries) entry.weight /= sum;
  }

  SparseMatrix metric = laplacian + springs_->stiffness();
  if (!cage.is_lattice) {
    const Triangles surface = surface_of(mesh_.tets);
    bending_ = std::make_unique<SkinBending>(mesh_.nodes.topRows(surface.maxCoeff() + 1), surface, mesh_.nodes.rows(),
                                             materials);
    metric += bending_->stiffness();
  }
  contact_ = std::make_unique<SkinContact>(character.vertices, character.triangles, cage, materials);
  // A part no bone holds would leave the metric singular; this much holds it without being felt.
  const double diagonal = metric.diagonal().maxCoeff();
  for (Eigen::Index n = 0; n < metric.rows(); ++n) metric.coeffRef(n, n) += 1e-9 * diagonal;
  if (mesh_.is_second_order) from_corners_ = from_corners(mesh_);
  metric_ = mesh_.is_second_order ? std::make_unique<Metric>(metric, from_corners_) : std::make_unique<Metric>(metric);
  for (std::size_t t = 0; t < tet_count; ++t) {
    const double area = std::cbrt(std::pow(tet_edges(mesh_, static_cast<Eigen::Index>(t)).determinant() / 6, 2));
    force_floor_ += std::pow(kStrainFloor * tets[t].mu * area, 2);
  }
  force_floor_ = std::sqrt(force_floor_);
  max_move_ = kMaxMove * longest_extent(mesh_.nodes);
  take_loose_pieces(character, cage.loose_pieces);
  hash_ = body_hash(character, muscles, materials, mesh_, anatomy.hash());
}

void QuasiStaticBody::take_loose_pieces(const Character& whole, const LoosePieces& loose_pieces) {
  if (loose_pieces.empty()) return;
  loose_pieces_ = loose_pieces;
  riding_ = loose_pieces.vertices();
  skin_rest_ = whole.vertices;
  skin_weights_ = whole.weights;
  const auto tets = carriers_.rows(), riding = static_cast<Eigen::Index>(riding_.size());
  carriers_.conservativeResize(tets + riding, 4);
  for (Eigen::Index r = 0; r < riding; ++r) {
    carriers_.row(tets + r).setConstant(static_cast<int>(mesh_.nodes.rows() + r));
    embedding_[riding_[static_cast<std::size_t>(r)]] = {static_cast<int>(tets + r), Eigen::Vector4d::Unit(0)};
  }
}

void QuasiStaticBody::append_loose_pieces(const Pose& pose, Positions& nodes) const {
  if (loose_pieces_.empty()) return;
  const JointFrames frames(skeleton_, pose.joints);
  const Eigen::Index own = nodes.rows();
  nodes.conservativeResize(node_count(), 3);
  nodes.bottomRows(node_count() - own).setZero();
  const Positions skin = embed(embedding_, carriers_, nodes);
  Positions displacement(skin.rows(), 3);  // in the frame of rest; of loose pieces not looked at
  for (Eigen::Index v = 0; v < skin.rows(); ++v) {
    const BlendedFrame at = frames.blend(skin_weights_[static_cast<std::size_t>(v)], skin_rest_.row(v));
    displacement.row(v) = turned(conjugate(at.rotation), skin.row(v).transpose() - at.position).transpose();
  }
  const Positions spread = loose_pieces_.spread(displacement);
  for (Eigen::Index r = 0; r < spread.rows(); ++r) {
    const std::uint32_t v = riding_[static_cast<std::size_t>(r)];
    const BlendedFrame at = frames.blend(skin_weights_[v], skin_rest_.row(v));
    nodes.row(own + r) = (at.position + turned(at.rotation, spread.row(r).transpose())).transpose();
  }
}

QuasiStaticBody::Target QuasiStaticBody::target(const LocalTransforms& local, std::span<const double> flex) const {
  const JointFrames frames(skeleton_, local);
  Target result;
  result.drives = fibre_drives(muscles_, bellies_, frames.skinning, least_slack_);
  for (std::size_t m = 0; m < flex.size(); ++m) {
    double& activation = result.drives[m].activation;
    activation = std::lerp(activation, muscles_[m].max_activation, flex[m]);
  }
  result.springs = springs_->pose(frames.skinning);
  result.skinned.resize(mesh_.nodes.rows(), 3);
  for (std::size_t n = 0; n < node_joints_.size(); ++n) {
    const auto row = static_cast<Eigen::Index>(n);
    const BlendedFrame at = frames.blend(node_joints_[n], mesh_.nodes.row(row));
    result.skinned.row(row) = at.position.transpose();
    result.rotation.push_back(at.rotation);
  }
  if (bending_) result.curvature = bending_->curvature(result.rotation);
  return result;
}

// Skinning of (rest + the un-posed residual of the shape so far).
Positions QuasiStaticBody::carried(const Target& from, const Target& to, const Positions& nodes) const {
  Positions result(nodes.rows(), 3);
  for (Eigen::Index n = 0; n < nodes.rows(); ++n) {
    const auto k = static_cast<std::size_t>(n);
    const Quat change = to.rotation[k] * conjugate(from.rotation[k]);
    const Eigen::Vector3d offset = (nodes.row(n) - from.skinned.row(n)).transpose();
    result.row(n) = to.skinned.row(n) + turned(change, offset).transpose();
  }
  return result;
}

Objective QuasiStaticBody::energy(const Target& at, std::span<const ContactPlane> contact, const Upright& upright,
                                  bool hold_volume) const {
  return [this, &at, contact, upright, hold_volume](const Positions& x, Positions& gradient) {
    gradient.setZero();
    const TissueSum tissue = tissue_->add_gradient(x, at.drives, gradient, upright.barrier);
    double energy = tissue.energy + springs_->add_gradient(at.springs, x, gradient);
    if (upright.eighths && eighths_) energy += eighths_->add_gradient(x, {}, gradient, upright.barrier).energy;
    if (hold_volume) energy += volume_->add_gradient(x, gradient);
    if (bending_) energy += bending_->add_gradient(at.curvature, x, gradient);
    energy += contact_->add_gradient(contact, x, gradient);
    return ObjectiveValue{energy, tissue.force_square};
  };
}

void QuasiStaticBody::follow(const Target& at, const Upright& upright, Positions& nodes, int& spent) const {
  const StiffModes metric(*metric_, nodes.rows(), {}, {});
  Lbfgs lbfgs(metric, force_floor_, max_move_);
  const std::vector<ContactPlane> contact = contact_->find(nodes, kContactMargin * contact_->scale());
  spent += lbfgs.minimise(energy(at, contact, upright, false), kPathTolerance, kPathIterations, nodes).iterations;
}

double QuasiStaticBody::settle(const Target& at, Upright upright, Positions& nodes, int& spent) const {
  const auto [modes, stiffness] = volume_->stiff_modes(nodes);
  const StiffModes metric(*metric_, nodes.rows(), modes, stiffness);
  Lbfgs lbfgs(metric, force_floor_, max_move_);
  MinimiseResult result;
  const auto relax = [&](std::span<const ContactPlane> contact, int iterations) {
    const MinimiseResult last = lbfgs.minimise(energy(at, contact, upright, true), kTolerance, iterations, nodes);
    result = {last.residual, result.iterations + last.iterations};
  };
  HeldContact contact(*contact_, kContactMargin * contact_->scale(), nodes);
  int iterations = kContactIterations;
  const int most = std::clamp(most_iterations_ - spent, 1, kMaxIterations);
  for (int round = 1; result.iterations < most; ++round) {
    const int end = std::min(result.iterations + iterations, most);
    relax(contact.planes(), end - result.iterations);
    const bool has_turned_over = eighths_ && !upright.eighths && eighths_->inverted(nodes).tets > 0;
    upright.eighths = upright.eighths || has_turned_over;
    const bool is_late = round >= kContactRounds, planes_fit = contact.renew(nodes);
    if (has_turned_over) continue;
    if (result.residual < kTolerance && (planes_fit || is_late)) break;
    if (result.iterations < end && planes_fit) break;  // nothing lower can be found
    if (is_late) iterations *= 2;
  }
  spent += result.iterations;
  return result.residual;
}

SolvedPose QuasiStaticBody::solve_along(std::span<const Pose> path, std::span<const double> flex) const {
  const Stopwatch watch;
  require_flex(flex, muscles_.size());
  int spent = 0;
  std::optional<SolvedPose> nested;
  if (linear_ && path.size() == 1) nested = settle_from_linear(path.front(), flex, spent);
  SolvedPose solved = nested ? std::move(*nested) : attempt(path, flex, 1, kAtFirst, spent);
  const bool is_deep = solved.status.contact_depth > kTooDeep * contact_->scale();
  if ((!solved.status.converged || is_deep) && spent < most_iterations_) {
    SolvedPose again = attempt(path, flex, 0.5, kSteep, spent);
    const bool is_shallower = again.status.contact_depth < solved.status.contact_depth;
    if (again.status.converged && (!solved.status.converged || is_shallower)) solved = std::move(again);
  }
  solved.status.iterations = spent;
  if (spent >= most_iterations_) {
    solved.status.converged = false;
    solved.status.residual = std::numeric_limits<double>::infinity();
  }
  put_back_root_motion(path.back(), solved.nodes);
  append_loose_pieces(path.back(), solved.nodes);
  solved.status.seconds = watch.seconds();
  return solved;
}

// Settles; a firmer barrier then turns tets that stay inverted, if it can.
void QuasiStaticBody::settle_upright(const Target& at, const Upright& upright, SolvedPose& solved, int& spent) const {
  solved.status.residual = settle(at, upright, solved.nodes, spent);
  if (!(solved.status.residual < kTolerance) || inverted_tets(solved.nodes) == 0) return;
  Positions firm = solved.nodes;
  const double residual = settle(at, kFirm, firm, spent);
  if (!(residual < kTolerance) || inverted_tets(firm) > 0) return;
  solved.status.residual = residual;
  solved.nodes = std::move(firm);
}

std::vector<JointTransform> QuasiStaticBody::without_root_motion(const Pose& pose) const {
  if (pose.joints.size() != skeleton_.size()) {
    throw Error(ErrorKind::mismatch, "a pose of " + std::to_string(pose.joints.size()) +
                                         " joints was given to a body of " + std::to_string(skeleton_.size()));
  }
  LocalTransforms local = pose.joints;
  if (const int root = single_root(skeleton_); root >= 0) {
    local[static_cast<std::size_t>(root)] = skeleton_.joints[static_cast<std::size_t>(root)].bind;
  }
  return local;
}

void QuasiStaticBody::put_back_root_motion(const Pose& pose, Positions& nodes) const {
  const int root = single_root(skeleton_);
  if (root < 0) return;
  const auto joint = static_cast<std::size_t>(root);
  const Affine& inverse_bind = skeleton_.joints[joint].inverse_bind;
  const Affine moved = affine_from(pose.joints[joint]) * inverse_bind;
  move_all(moved * inverse(affine_from(skeleton_.joints[joint].bind) * inverse_bind), nodes);
}

int QuasiStaticBody::inverted_tets(const Positions& nodes) const {
  return tissue_->inverted(nodes).tets + (eighths_ ? eighths_->inverted(nodes).tets : 0);
}

void QuasiStaticBody::judge(SolvedPose& solved) const {
  solved.status.inverted_tets = inverted_tets(solved.nodes);
  solved.status.contact_depth = contact_->deepest(solved.nodes);
  solved.status.volume_change = volume_->largest_change(solved.nodes);
  solved.status.converged = is_converged(solved.status);
}

// step_size: of the largest steps allowed.
SolvedPose QuasiStaticBody::attempt(std::span<const Pose> path, std::span<const double> flex, double step_size,
                                    const Upright& upright, int& spent) const {
  const double hardest = flex.empty() ? 0 : *std::max_element(flex.begin(), flex.end());
  SolvedPose solved;
  Positions& nodes = solved.nodes;
  nodes = mesh_.nodes;
  LocalTransforms from = bind_pose(skeleton_).joints;
  Target here = target(from, {});
  for (const Pose& pose : path) {
    const bool last = &pose == &path.back();
    LocalTransforms to = without_root_motion(pose);
    const double longest = std::max(widest_turn(from, to) / kMaxTurn, last ? hardest / kMaxFlex : 0);
    const int steps = static_cast<int>(std::ceil(std::max(longest / step_size, 1.0)));
    double at = 0, step = 1.0 / steps;
    while (at < 1) {
      const double next = at + step > 1 - 1e-9 ? 1 : at + step;
      Target there = target(between(from, to, next), scaled(flex, last ? next : 0));
      Positions start = carried(here, there, nodes);
      if (step * steps > kShortestStep && tissue_->inverted(start).share > kMostInverted) {
        step /= 2;
        continue;
      }
      nodes = std::move(start);
      if (next < 1 || !last) {
        follow(there, upright, nodes, spent);
      } else {
        settle_upright(there, upright, solved, spent);
      }
      here = std::move(there);
      at = next;
      step = std::min(2 * step, 1.0 / steps);
    }
    from = std::move(to);
  }
  judge(solved);
  return solved;
}

void QuasiStaticBody::walk_in(std::unique_ptr<const QuasiStaticBody> linear) {
  linear_ = std::move(linear);
  ContentHash hash;
  hash.add(hash_);
  hash.add(linear_->hash_);
  hash_ = hash.value();
}

// Nothing where the linear tets find no rest or are folded deeper than their contact can tell, or what they carry is
// tangled.
std::optional<SolvedPose> QuasiStaticBody::settle_from_linear(const Pose& pose, std::span<const double> flex,
                                                              int& spent) const {
  SolvedPose solved = linear_->attempt(std::span(&pose, 1), flex, 1, kAtFirst, spent);
  if (!solved.status.converged || solved.status.contact_depth > kDeepFold * contact_->scale()) return {};
  solved.nodes = Positions(from_corners_ * solved.nodes);
  if (tissue_->inverted(solved.nodes).share > kMostTangled) return {};
  settle_upright(target(without_root_motion(pose), flex), kAtFirst, solved, spent);
  judge(solved);
  return solved;
}

double QuasiStaticBody::discretisation_error(const Pose& pose, std::span<const double> flex,
                                             const Positions& skin) const {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN(), kLeastLarger = 1.2;
  if (!coarser_) return kNone;
  const SolvedPose coarse = coarser_->solve(pose, flex);
  if (!coarse.status.converged) return kNone;
  const double larger = std::cbrt(static_cast<double>(mesh_.tets.rows()) / coarser_->mesh_.tets.rows());
  const double distance = std::sqrt((coarser_->skin(coarse.nodes) - skin).rowwise().squaredNorm().mean());
  return larger > kLeastLarger ? distance / (larger * larger - 1) : kNone;
}

}  // namespace bodyopt::trainer
