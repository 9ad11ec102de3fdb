#include "trainer/dynamics/jiggle_fields.h"

#include <Eigen/LU>
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/parallel.h"
#include "base/wording.h"
#include "geometry/mesh.h"
#include "geometry/thickness.h"
#include "runtime/basis/dynamics.h"
#include "runtime/core/error.h"
#include "trainer/dynamics/block_inverse.h"
#include "trainer/factor/factor_panels.h"
#include "trainer/simulate/metric.h"
#include "trainer/simulate/muscle_fibres.h"
#include "trainer/simulate/node_weights.h"

namespace bodyopt::trainer {
namespace {

SparseMatrix laplacian_of(const TetMesh& mesh) {
  return tet_laplacian(mesh, std::vector<double>(static_cast<std::size_t>(mesh.tets.rows()), 1));
}

// A share of the body's volume. A larger part is no end of a limb, though no joint comes after it (half a worm). A
// person's head is a fourteenth.
constexpr double kLargestEnd = 1.0 / 8;

// Joints that move skin, with such above them and none below.
std::vector<bool> ends_of_limbs(const Character& character, const Eigen::VectorXd& volume_shares) {
  const std::vector<Joint>& joints = character.skeleton.joints;
  std::vector<bool> moves(joints.size(), false), moves_above(joints.size(), false), moves_below(joints.size(), false);
  for (const std::vector<JointWeight>& weights : character.weights) {
    for (const JointWeight& w : weights) moves[w.joint] = moves[w.joint] || w.weight > 0;
  }
  const auto parent = [&](std::size_t j) { return static_cast<std::size_t>(joints[j].parent); };
  for (std::size_t j = 0; j < joints.size(); ++j) {
    if (joints[j].parent >= 0) moves_above[j] = moves[parent(j)] || moves_above[parent(j)];
  }
  for (std::size_t j = joints.size(); j-- > 0;) {
    if (joints[j].parent >= 0 && (moves[j] || moves_below[j])) moves_below[parent(j)] = true;
  }
  std::vector<bool> ends(joints.size());
  for (std::size_t j = 0; j < joints.size(); ++j) {
    ends[j] =
        moves[j] && moves_above[j] && !moves_below[j] && volume_shares[static_cast<Eigen::Index>(j)] < kLargestEnd;
  }
  return ends;
}

// Skin that takes less than this of the motion is held.
constexpr double kLeastAmount = 1e-3;
// Thickness is averaged within about this part of the extent: an ear is thin, though the head beside it is not.
constexpr double kNearby = 0.01;
constexpr double kThin = 0.9;  // of the body's flesh: joints with less get their own

// How much of every node and skin vertex is in a region, 0 to 1.
struct Share {
  Eigen::VectorXd nodes, skin;
};

// Indices of the names that a pattern means.
std::vector<std::size_t> matches(const std::vector<std::string>& names, const JiggleRegion& region, const char* kind,
                                 const JiggleSettings& settings) {
  std::vector<std::size_t> found;
  for (std::size_t k = 0; k < names.size(); ++k) {
    if (matches_pattern(region.name, names[k])) found.push_back(k);
  }
  if (!found.empty()) return found;
  throw Error(ErrorKind::mismatch, settings.origin, ": names the ", kind, " '", region.name,
              "', which is not there; there are ", list_names(names), ": misspelt, or made for another character?");
}

// Returns the joints, muscles or painted regions that the region names.
std::vector<std::size_t> named_by(const JiggleRegion& region, const Character& character,
                                  const std::vector<Muscle>& muscles, const std::vector<RegionWeights>& painted,
                                  const JiggleSettings& settings) {
  if (region.by == JiggleRegion::By::joint)
    return matches(names_of(character.skeleton.joints), region, "joint", settings);
  if (region.by == JiggleRegion::By::muscle) return matches(names_of(muscles), region, "muscle", settings);
  return matches(names_of(painted), region, "painted region", settings);
}

// V values of the skin -> N, as diffuse carries positions.
Eigen::VectorXd carried_inwards(const DynamicsTets& tets, const Eigen::VectorXd& of_skin) {
  Eigen::VectorXd on_surface = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(tets.surface.size()));
  for (std::size_t n = 0; n < tets.surface.size(); ++n) {
    on_surface[static_cast<Eigen::Index>(n)] = at_point(of_skin, tets.surface[n]);
  }
  return diffuse(tets.cage.mesh, on_surface);
}

class ShareFinder {
 public:
  ShareFinder(const JiggleSettings& settings, const Character& character, const std::vector<Muscle>& muscles,
              const std::vector<RegionWeights>& painted, const DynamicsTets& tets, const JiggleAnatomy& anatomy)
      : settings_(settings),
        character_(character),
        muscles_(muscles),
        painted_(painted),
        tets_(tets),
        anatomy_(anatomy) {}

  Share operator()(const JiggleRegion& region) const {
    Share share{Eigen::VectorXd::Zero(tets_.cage.mesh.nodes.rows()), Eigen::VectorXd::Zero(character_.vertices.rows())};
    const std::vector<std::size_t> named = named_by(region, character_, muscles_, painted_, settings_);
    if (region.by == JiggleRegion::By::joint) add_joints(named, share);
    if (region.by == JiggleRegion::By::muscle) add_muscles(named, share);
    if (region.by == JiggleRegion::By::painted) add_painted(named, share);
    share.nodes = share.nodes.cwiseMax(0).cwiseMin(1);
    share.skin = share.skin.cwiseMax(0).cwiseMin(1);
    return share;
  }

 private:
  void add_joints(const std::vector<std::size_t>& named, Share& share) const {
    std::vector<bool> wanted(character_.skeleton.size(), false);
    for (const std::size_t j : named) {
      wanted[j] = true;
      share.nodes += anatomy_.joint_share.col(static_cast<Eigen::Index>(j));
    }
    for (std::size_t v = 0; v < character_.weights.size(); ++v) {
      for (const JointWeight& w : character_.weights[v]) {
        if (wanted[w.joint]) share.skin[static_cast<Eigen::Index>(v)] += w.weight;
      }
    }
  }

  void add_muscles(const std::vector<std::size_t>& named, Share& share) const {
    for (const std::size_t m : named) {
      share.nodes += anatomy_.muscle_share.col(static_cast<Eigen::Index>(m));
    }
    for (std::size_t v = 0; v < tets_.cage.skin.size(); ++v) {
      const EmbeddedPoint& point = tets_.cage.skin[v];
      for (int a = 0; a < 4; ++a) {
        share.skin[static_cast<Eigen::Index>(v)] += point.weights[a] * share.nodes[tets_.cage.mesh.tets(point.tet, a)];
      }
    }
  }

  void add_painted(const std::vector<std::size_t>& named, Share& share) const {
    for (const std::size_t r : named) {
      for (std::size_t k = 0; k < painted_[r].vertices.size(); ++k) {
        share.skin[painted_[r].vertices[k]] += painted_[r].weights[k];
      }
    }
    share.nodes = carried_inwards(tets_, share.skin);
  }

  const JiggleSettings& settings_;
  const Character& character_;
  const std::vector<Muscle>& muscles_;
  const std::vector<RegionWeights>& painted_;
  const DynamicsTets& tets_;
  const JiggleAnatomy& anatomy_;
};

Eigen::VectorXd default_flesh(const JiggleSettings& settings, const Character& character, const DynamicsTets& tets,
                              const JiggleAnatomy& anatomy, const Eigen::VectorXd& thick) {
  if (settings.flesh > 0) return Eigen::VectorXd::Constant(tets.cage.mesh.nodes.rows(), settings.flesh);
  const double of_size = kFleshOfSize * longest_extent(character.vertices);
  // Between the skin's least and largest, whatever the Laplacian of bad tets overshoots by.
  const Eigen::VectorXd flesh = (kFleshOfThickness * carried_inwards(tets, thick))
                                    .cwiseMax(kFleshOfThickness * thick.minCoeff())
                                    .cwiseMin(of_size);
  Eigen::ArrayXd of_ends = Eigen::ArrayXd::Zero(flesh.size());
  for (std::size_t j = 0; j < anatomy.is_end.size(); ++j) {
    if (anatomy.is_end[j]) of_ends += anatomy.joint_share.col(static_cast<Eigen::Index>(j)).array();
  }
  return flesh.array() * (std::log(kFleshOfEnds) * of_ends.max(0).min(1)).exp();
}

bool names_joint(const JiggleSettings& settings, const std::string& joint) {
  return std::ranges::any_of(settings.regions, [&](const JiggleRegion& region) {
    return region.by == JiggleRegion::By::joint && (region.flesh || region.flesh_factor) &&
           matches_pattern(region.name, joint);
  });
}

void blend(Eigen::VectorXd& values, double value, const Eigen::VectorXd& share) {
  values += share.cwiseProduct(Eigen::VectorXd::Constant(values.size(), value) - values);
}

}  // namespace

DiffuseTable make_diffuse_table(const TetMesh& mesh, Eigen::Index surface_count) {
  const Eigen::Index nodes = mesh.nodes.rows(), inside = nodes - surface_count;
  const SparseMatrix laplacian = laplacian_of(mesh);
  DiffuseTable table;
  table.row_begin.assign(static_cast<std::size_t>(surface_count) + 1, 0);
  const Eigen::SparseMatrix<double, Eigen::RowMajor> to_surface = laplacian.bottomLeftCorner(inside, surface_count);
  for (Eigen::Index row = 0; row < inside; ++row) {
    for (Eigen::SparseMatrix<double, Eigen::RowMajor>::InnerIterator entry(to_surface, row); entry; ++entry) {
      table.columns.push_back(static_cast<std::uint32_t>(entry.col()));
      table.values.push_back(static_cast<float>(-entry.value()));
    }
    table.row_begin.push_back(static_cast<std::uint32_t>(table.columns.size()));
  }
  if (inside == 0) {
    table.inverse.unknown_count = static_cast<std::uint32_t>(nodes);
    return table;
  }
  const Positions points = mesh.nodes.bottomRows(inside);
  InverseNodes inner{points, std::vector<int>(static_cast<std::size_t>(inside)), static_cast<int>(nodes)};
  std::iota(inner.nodes.begin(), inner.nodes.end(), static_cast<int>(surface_count));
  table.inverse = invert(laplacian.bottomRightCorner(inside, inside), inner, 1);
  return table;
}

NodeValues diffuse(const TetMesh& mesh, const NodeValues& on_surface) {
  const Eigen::Index surface = on_surface.rows(), inside = mesh.nodes.rows() - surface, columns = on_surface.cols();
  NodeValues values(mesh.nodes.rows(), columns);
  values.topRows(surface) = on_surface;
  if (inside == 0) return values;
  const SparseMatrix laplacian = laplacian_of(mesh), to_surface = laplacian.bottomLeftCorner(inside, surface);
  const Eigen::SimplicialLLT<SparseMatrix> factor(SparseMatrix(laplacian.bottomRightCorner(inside, inside)));
  if (factor.info() != Eigen::Success) {
    throw Error(ErrorKind::mismatch, "the tetrahedra are too flat to carry values inwards");
  }
  const FactorPanels<double> panels = factor_panels<double>(factor.matrixL());
  std::vector<int> all(panels.panels.size());
  std::iota(all.begin(), all.end(), 0);
  constexpr Eigen::Index kSides = 10;
  parallel_for(static_cast<std::size_t>((columns + kSides - 1) / kSides), [&](std::size_t part) {
    const Eigen::Index first = kSides * static_cast<Eigen::Index>(part), count = std::min(kSides, columns - first);
    Eigen::Matrix<double, Eigen::Dynamic, kSides, Eigen::RowMajor> sides(inside, kSides);
    sides.rightCols(kSides - count).setZero();
    sides.leftCols(count) = factor.permutationP() * -(to_surface * on_surface.middleCols(first, count));
    solve_ten_in(panels, all, sides.data());
    values.block(surface, first, inside, count) = factor.permutationPinv() * sides.leftCols(count);
  });
  return values;
}

JiggleAnatomy find_anatomy(const Character& character, const AnatomyField& field, std::size_t muscle_count,
                           const Cage& cage, const Materials& materials) {
  const TetMesh& mesh = cage.mesh;
  const Eigen::Index nodes = mesh.nodes.rows();
  const auto joints = static_cast<Eigen::Index>(character.skeleton.size());
  const auto tets = static_cast<std::size_t>(mesh.tets.rows());
  const SparseMatrix laplacian = tet_laplacian(mesh, std::vector<double>(tets, 1)), no_springs(nodes, nodes);
  JiggleAnatomy anatomy;
  anatomy.joint_share = carry_through(character, cage, laplacian, no_springs, NodeWeights::Zero(nodes, joints));
  anatomy.tissue = find_tissue(cage, field);
  anatomy.bone_springs =
      BoneSprings(mesh, anatomy.tissue.bones, bone_stiffness(materials, mesh), character.skeleton.size()).stiffness();

  anatomy.muscle_share = Eigen::MatrixXd::Zero(nodes, static_cast<Eigen::Index>(muscle_count));
  Eigen::VectorXd volume = Eigen::VectorXd::Zero(nodes);  // around each node
  std::vector<double> of_tet(tets);
  for (std::size_t t = 0; t < tets; ++t) {
    const auto tet = static_cast<Eigen::Index>(t);
    of_tet[t] = tet_edges(mesh, tet).determinant() / 6;
    for (int a = 0; a < 4; ++a) volume[mesh.tets(tet, a)] += of_tet[t];
  }
  anatomy.is_end = ends_of_limbs(character, anatomy.joint_share.transpose() * volume / volume.sum());
  for (const FibreTet& fibre : anatomy.tissue.fibres) {
    const auto t = static_cast<std::size_t>(fibre.tet);
    for (int a = 0; a < 4; ++a) {
      const int node = mesh.tets(fibre.tet, a);
      anatomy.muscle_share(node, fibre.muscle) += fibre.share * of_tet[t] / volume[node];
    }
  }
  return anatomy;
}

void require_names(const JiggleSettings& settings, const Character& character, const std::vector<Muscle>& muscles,
                   const std::vector<RegionWeights>& painted) {
  for (const JiggleRegion& region : settings.regions) named_by(region, character, muscles, painted, settings);
}

JiggleFields spread_settings(const JiggleSettings& settings, const Character& character,
                             const std::vector<Muscle>& muscles, const std::vector<RegionWeights>& painted,
                             const DynamicsTets& tets, const JiggleAnatomy& anatomy) {
  require_possible(settings);
  const Eigen::Index nodes = tets.cage.mesh.nodes.rows();
  Eigen::VectorXd log_softness = Eigen::VectorXd::Constant(nodes, std::log(settings.softness));
  const Eigen::VectorXd thick = thickness(character.vertices, character.triangles, kNearby);
  Eigen::VectorXd log_flesh = default_flesh(settings, character, tets, anatomy, thick).array().log();
  Eigen::VectorXd skin_amount = Eigen::VectorXd::Constant(character.vertices.rows(), settings.amount);
  JiggleFields fields;
  fields.damping = Eigen::VectorXd::Constant(nodes, settings.damping);
  fields.amount = Eigen::VectorXd::Constant(nodes, settings.amount);
  const ShareFinder share_of(settings, character, muscles, painted, tets, anatomy);
  for (const JiggleRegion& region : settings.regions) {
    const Share share = share_of(region);
    if (region.softness) blend(log_softness, std::log(*region.softness), share.nodes);
    if (region.flesh) blend(log_flesh, std::log(*region.flesh), share.nodes);
    if (region.flesh_factor) log_flesh += std::log(*region.flesh_factor) * share.nodes;
    if (region.damping) blend(fields.damping, *region.damping, share.nodes);
    if (region.amount) {
      blend(fields.amount, *region.amount, share.nodes);
      blend(skin_amount, *region.amount, share.skin);
    }
  }
  fields.softness = log_softness.array().exp();
  fields.flesh = log_flesh.array().exp();
  for (const double amount : skin_amount) fields.skin_amount.push_back(amount < kLeastAmount ? 0 : amount);
  for (const double t : thick) fields.skin_limit.push_back(settings.limit * t);
  return fields;
}

JiggleSettings chosen_settings(const JiggleSettings& settings, const JiggleFields& fields, const Character& character,
                               const JiggleAnatomy& anatomy) {
  if (settings.flesh > 0) return settings;
  JiggleSettings chosen = settings;
  const double of_size = kFleshOfSize * longest_extent(character.vertices);
  if (chosen.comment.empty()) {
    chosen.comment = "flesh, left open: " + rounded(of_size) + " m, " + rounded(kFleshOfSize) +
                     " of the longest extent, as 5 cm are of a person, and less where the body is thin, a "
                     "flesh_factor of 1 being what was chosen; all else, where nobody has said otherwise: the "
                     "defaults of jiggle.json";
  }
  std::vector<JiggleRegion> thin;
  for (std::size_t j = 0; j < character.skeleton.size(); ++j) {
    const Eigen::VectorXd share = anatomy.joint_share.col(static_cast<Eigen::Index>(j));
    const double mean = share.dot(fields.flesh) / share.sum();
    const std::string& name = character.skeleton.joints[j].name;
    if (!(mean < kThin * of_size) || names_joint(settings, name)) continue;
    JiggleRegion region{.name = name, .flesh_factor = 1};
    region.comment = "of " + rounded(mean) + " m in the mean: " +
                     (anatomy.is_end[j] ? "a limb ends there, little lies between skin and bone"
                                        : "a quarter of the thickness there");
    thin.push_back(region);
  }
  chosen.regions.insert(chosen.regions.begin(), thin.begin(), thin.end());
  return chosen;
}

}  // namespace bodyopt::trainer
