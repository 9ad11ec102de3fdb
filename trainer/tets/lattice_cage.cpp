#include "trainer/tets/lattice_cage.h"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "base/disjoint_sets.h"
#include "base/parallel.h"
#include "geometry/mesh.h"
#include "geometry/nearest_skin.h"
#include "runtime/core/error.h"
#include "trainer/tets/voxels.h"

namespace bodyopt::trainer {
namespace {

// Calls visit(cube, axis, its index, that of the next cube along the axis) for neighbours that are filled.
template <typename Visit>
void for_neighbours(const VoxelGrid& grid, const std::vector<Voxel>& voxels, const Visit& visit) {
  for_each_cube(Eigen::Vector3i::Zero(), grid.count, [&](const Eigen::Vector3i& cube) {
    const std::size_t index = grid.index(cube);
    if (voxels[index] == Voxel::outside) return;
    for (int axis = 0; axis < 3; ++axis) {
      const Eigen::Vector3i next = cube + Eigen::Vector3i::Unit(axis);
      if (next[axis] == grid.count[axis] || voxels[grid.index(next)] == Voxel::outside) continue;
      visit(cube, axis, index, grid.index(next));
    }
  });
}

struct Neighbours {
  Eigen::Vector3i cube;
  int axis;
  std::size_t index, next;
};

// Pairs of neighbours between which skin may lie.
std::vector<Neighbours> neighbours_at_skin(const VoxelGrid& grid, const std::vector<Voxel>& voxels) {
  std::vector<Neighbours> result;
  for_neighbours(grid, voxels, [&](const Eigen::Vector3i& cube, int axis, std::size_t index, std::size_t next) {
    if (voxels[index] != Voxel::surface && voxels[next] != Voxel::surface) return;
    result.push_back({cube, axis, index, next});
  });
  return result;
}

std::uint32_t main_joint(const SkinPoint& point, const SkinWeights& weights) {
  Eigen::Index corner = 0;
  point.weights.maxCoeff(&corner);
  return weights[point.vertices[static_cast<std::size_t>(corner)]].front().joint;
}

std::uint8_t bit(int axis) { return static_cast<std::uint8_t>(1 << axis); }

// A contact of two parts: their lowest cubes, and the joints of the skin on either side.
using Contact = std::array<std::size_t, 4>;

// Takes back cuts where things hang together by nothing else, each part's contact with the one joint's skin that it
// touches most. This is a maximum spanning forest (Kruskal 1956): a tooth between two jaws does not join them.
// `joint_at(index)`: the main joint of the skin at a cube of `neighbours`.
void keep_whole(const VoxelGrid& grid, const std::vector<Voxel>& voxels, const std::vector<Neighbours>& neighbours,
                const std::function<std::uint32_t(std::size_t)>& joint_at, std::vector<std::uint8_t>& cuts) {
  DisjointSets parts(grid.total());
  for_neighbours(grid, voxels, [&](const Eigen::Vector3i&, int axis, std::size_t index, std::size_t next) {
    if ((cuts[index] & bit(axis)) == 0) parts.join(index, next);
  });
  const auto contact_at = [&](const Neighbours& faces) -> Contact {
    using Side = std::pair<std::size_t, std::uint32_t>;
    const auto [a, b] = std::minmax(
        {Side(parts.lowest(faces.index), joint_at(faces.index)), Side(parts.lowest(faces.next), joint_at(faces.next))});
    return {a.first, b.first, a.second, b.second};
  };
  std::map<Contact, std::size_t> touching;  // in so many faces
  for (const Neighbours& faces : neighbours) {
    if ((cuts[faces.index] & bit(faces.axis)) != 0) ++touching[contact_at(faces)];
  }
  std::vector<std::pair<Contact, std::size_t>> most_first(touching.begin(), touching.end());
  std::ranges::stable_sort(most_first, [](const auto& a, const auto& b) { return a.second > b.second; });
  DisjointSets whole = parts;
  std::set<Contact> held;
  for (const auto& [contact, count] : most_first) {
    if (whole.lowest(contact[0]) == whole.lowest(contact[1])) continue;
    whole.join(contact[0], contact[1]);
    held.insert(contact);
  }
  for (const Neighbours& faces : neighbours) {
    if ((cuts[faces.index] & bit(faces.axis)) == 0 || !held.contains(contact_at(faces))) continue;
    cuts[faces.index] = static_cast<std::uint8_t>(cuts[faces.index] & ~bit(faces.axis));
  }
}

constexpr int kSubdivision = 8;  // cubes along a cell's edge: parts closer than about two cubes may be glued
constexpr double kMostVoxels = 1 << 25;
constexpr double kSurfaceShare = 0.5;  // of a cube that the skin passes through

// Five tets of a cell by its corners; corner bits: 1 along x, 2 along y, 4 along z. The first lies in the middle. The
// two ways mirror each other: neighbours take turns, so that the diagonals of a common face are the same.
constexpr int kSplit[2][5][4] = {{{0, 3, 6, 5}, {1, 0, 5, 3}, {2, 0, 3, 6}, {4, 0, 6, 5}, {7, 3, 5, 6}},
                                 {{1, 2, 4, 7}, {0, 1, 2, 4}, {3, 1, 7, 2}, {5, 1, 4, 7}, {6, 2, 7, 4}}};

using Barycentric = Eigen::Matrix4d;  // (x, y, z, 1) in a unit cell to the four weights

std::array<std::array<Barycentric, 5>, 2> make_barycentric() {
  std::array<std::array<Barycentric, 5>, 2> result;
  for (std::size_t parity = 0; parity < 2; ++parity) {
    for (std::size_t k = 0; k < 5; ++k) {
      Eigen::Matrix4d corners;
      for (int a = 0; a < 4; ++a) {
        const int corner = kSplit[parity][k][a];
        corners.col(a) << (corner & 1), (corner >> 1 & 1), (corner >> 2), 1;
      }
      result[parity][k] = corners.inverse();
    }
  }
  return result;
}

void require_mesh(const Positions& vertices, const Triangles& triangles, const SkinWeights& weights) {
  const auto refuse = [](const std::string& defect, ErrorCause cause = ErrorCause::damaged) {
    throw Error(ErrorKind::mismatch, "no cage can be made around the skin: " + defect + " (a damaged file)", cause);
  };
  if (vertices.rows() == 0 || triangles.rows() == 0) refuse("it has no triangles", ErrorCause::no_faces);
  if (!vertices.allFinite()) refuse("a vertex is not a finite number");
  if ((vertices.rowwise() - vertices.row(0)).isZero(0)) refuse("all vertices are in one place");
  if (static_cast<Eigen::Index>(triangles.maxCoeff()) >= vertices.rows()) refuse("a triangle names a missing vertex");
  const auto is_bound = [](const std::vector<JointWeight>& vertex) { return !vertex.empty(); };
  if (static_cast<Eigen::Index>(weights.size()) != vertices.rows() || !std::ranges::all_of(weights, is_bound))
    refuse("not every vertex has joint weights");
}

// Cuts a solid of cubes where skin of parts touches that the joints move apart.
class CubeCuts {
 public:
  // The skin: rest, metres; weights: V. The arrays must outlive this.
  CubeCuts(const Positions& vertices, const Triangles& triangles, const SkinWeights& weights)
      : weights_(weights), nearest_(vertices, triangles), apart_(vertices, triangles, weights) {}

  // A bit for each axis (1: x, 2: y, 4: z) of every cube by index, set between it and the next along that axis. Both
  // are filled, one of them holds skin, and the skin nearest to either is of parts that move apart (ApartSkin). What
  // would fall off is held by what it touches most: an eye by its socket.
  std::vector<std::uint8_t> in(const VoxelGrid& grid, const std::vector<Voxel>& voxels) const {
    const std::vector<Neighbours> neighbours = neighbours_at_skin(grid, voxels);
    std::vector<int> place(grid.total(), -1);
    std::vector<Eigen::Vector3i> cubes;
    const auto add = [&](const Eigen::Vector3i& cube) {
      int& at = place[grid.index(cube)];
      if (at >= 0) return;
      at = static_cast<int>(cubes.size());
      cubes.push_back(cube);
    };
    for (const Neighbours& pair : neighbours) {
      add(pair.cube);
      add(pair.cube + Eigen::Vector3i::Unit(pair.axis));
    }
    std::vector<SkinPoint> skin(cubes.size());
    parallel_for(cubes.size(), [&](std::size_t k) { skin[k] = nearest_(grid.centre(cubes[k])); });
    const auto skin_at = [&](std::size_t index) -> const SkinPoint& {
      return skin[static_cast<std::size_t>(place[index])];
    };

    std::vector<std::uint8_t> is_apart(neighbours.size());
    parallel_for(neighbours.size(), [&](std::size_t k) {
      is_apart[k] = apart_(skin_at(neighbours[k].index), skin_at(neighbours[k].next), grid.size) ? 1 : 0;
    });
    std::vector<std::uint8_t> cuts(grid.total(), 0);
    for (std::size_t k = 0; k < neighbours.size(); ++k) {
      if (is_apart[k] != 0) cuts[neighbours[k].index] |= bit(neighbours[k].axis);
    }
    keep_whole(
        grid, voxels, neighbours, [&](std::size_t index) { return main_joint(skin_at(index), weights_); }, cuts);
    return cuts;
  }

 private:
  const SkinWeights& weights_;
  NearestSkin nearest_;
  ApartSkin apart_;
};

// A connected part of a cell.
struct Part {
  Eigen::Vector3i cell;
  int piece;           // of the whole skin, 0 the largest
  std::size_t voxels;  // in it
};

class CageMaker {
 public:
  CageMaker(const Positions& vertices, const Triangles& triangles, const CubeCuts& cuts, double cell)
      : vertices_(vertices), cell_(cell) {
    const Eigen::Vector3d low = vertices.colwise().minCoeff(), high = vertices.colwise().maxCoeff();
    const double cube = cell / kSubdivision, margin = cube / 2;
    const Eigen::Vector3d cells = ((high - low).array() + 2 * margin).matrix() / cell;
    cells_ = cells.array().ceil().cwiseMax(1).cast<int>();
    grid_ = {low - Eigen::Vector3d::Constant(margin), cube, kSubdivision * cells_};
    voxels_ = voxelise(vertices, triangles, grid_);
    const std::vector<int> piece = label_pieces(grid_, voxels_);
    cuts_ = cuts.in(grid_, voxels_);
    part_.assign(grid_.total(), -1);
    for_each_cube(Eigen::Vector3i::Zero(), cells_, [&](const Eigen::Vector3i& at) { split_cell(at, piece); });
    number_nodes();
  }

  Eigen::Index node_count() const { return node_count_; }

  Cage make() const {
    Cage cage;
    cage.is_lattice = true;
    cage.mesh.nodes.resize(node_count_, 3);
    std::vector<std::array<int, 5>> tet_of(parts_.size());  // -1 where there is no tissue
    std::vector<Eigen::Vector4i> tets;
    for (std::size_t p = 0; p < parts_.size(); ++p) {
      for (std::size_t k = 0; k < 5; ++k) {
        tet_of[p][k] = used_[p][k] ? static_cast<int>(tets.size()) : -1;
        if (!used_[p][k]) continue;
        Eigen::Vector4i corners;
        for (int a = 0; a < 4; ++a) {
          const int corner = split_of(p)[k][a];
          corners[a] = node_[8 * p + static_cast<std::size_t>(corner)];
          const Eigen::Vector3i lattice = parts_[p].cell + Eigen::Vector3i(corner & 1, corner >> 1 & 1, corner >> 2);
          cage.mesh.nodes.row(corners[a]) = grid_.origin + cell_ * lattice.cast<double>();
        }
        tets.push_back(corners);
      }
    }
    cage.mesh.tets.resize(static_cast<Eigen::Index>(tets.size()), 4);
    for (std::size_t t = 0; t < tets.size(); ++t) cage.mesh.tets.row(static_cast<Eigen::Index>(t)) = tets[t];
    for (Eigen::Index v = 0; v < vertices_.rows(); ++v) {
      const Eigen::Vector3d point = vertices_.row(v);
      cage.skin.push_back(place(point, part_at(grid_.cube_at(point)), tet_of));
    }
    for_voxels([&](const Eigen::Vector3i& cube, std::size_t index) {
      const double share = voxels_[index] == Voxel::surface ? kSurfaceShare : 1;
      cage.samples.push_back({place(grid_.centre(cube), part_at(cube), tet_of), share * std::pow(grid_.size, 3)});
    });
    orient(cage.mesh);
    return cage;
  }

 private:
  static const std::array<std::array<Barycentric, 5>, 2>& barycentric() {
    static const auto table = make_barycentric();
    return table;
  }
  std::size_t parity(std::size_t part) const { return static_cast<std::size_t>(parts_[part].cell.sum() % 2); }
  const int (&split_of(std::size_t part) const)[5][4] { return kSplit[parity(part)]; }
  bool is_cut(const Eigen::Vector3i& cube, int axis) const { return cuts_[grid_.index(cube)] >> axis & 1; }
  std::size_t part_at(const Eigen::Vector3i& cube) const { return static_cast<std::size_t>(part_[grid_.index(cube)]); }

  template <typename Visit>
  void for_voxels(const Visit& visit) const {
    for_each_cube(Eigen::Vector3i::Zero(), grid_.count, [&](const Eigen::Vector3i& cube) {
      if (const std::size_t index = grid_.index(cube); part_[index] >= 0) visit(cube, index);
    });
  }

  // The parts of one cell; those of smaller pieces of skin join the largest part of the largest piece.
  void split_cell(const Eigen::Vector3i& cell, const std::vector<int>& piece) {
    const std::size_t first = parts_.size();
    const Eigen::Vector3i low = kSubdivision * cell, high = low.array() + kSubdivision;
    const auto within = [&](const Eigen::Vector3i& c) {
      return (c.array() >= low.array()).all() && (c.array() < high.array()).all();
    };
    std::vector<Eigen::Vector3i> open, all;
    for_each_cube(low, high, [&](const Eigen::Vector3i& seed) {
      const std::size_t index = grid_.index(seed);
      if (piece[index] < 0 || part_[index] >= 0) return;
      const int part = static_cast<int>(parts_.size());
      parts_.push_back({cell, piece[index], 0});
      part_[index] = part;
      open.push_back(seed);
      while (!open.empty()) {
        const Eigen::Vector3i at = open.back();
        open.pop_back();
        all.push_back(at);
        ++parts_.back().voxels;
        for (int axis = 0; axis < 3; ++axis) {
          for (const int step : {-1, 1}) {
            const Eigen::Vector3i next = at + step * Eigen::Vector3i::Unit(axis);
            if (!within(next) || is_cut(step < 0 ? next : at, axis)) continue;
            if (piece[grid_.index(next)] < 0 || part_[grid_.index(next)] >= 0) continue;
            part_[grid_.index(next)] = part;
            open.push_back(next);
          }
        }
      }
    });
    if (parts_.size() - first > 1) join_pieces(first, all);
  }

  void join_pieces(std::size_t first, const std::vector<Eigen::Vector3i>& voxels) {
    const auto before = [](const Part& a, const Part& b) {
      return a.piece != b.piece ? a.piece < b.piece : a.voxels > b.voxels;
    };
    const auto begin = parts_.begin() + static_cast<std::ptrdiff_t>(first);
    const auto host = static_cast<std::size_t>(std::min_element(begin, parts_.end(), before) - parts_.begin());
    std::vector<int> renamed(parts_.size() - first);
    std::vector<Part> kept;
    for (std::size_t p = first; p < parts_.size(); ++p) {
      if (parts_[p].piece != parts_[host].piece) continue;
      renamed[p - first] = static_cast<int>(first + kept.size());
      kept.push_back(parts_[p]);
    }
    for (std::size_t p = first; p < parts_.size(); ++p) {
      if (parts_[p].piece != parts_[host].piece) renamed[p - first] = renamed[host - first];
    }
    for (const Eigen::Vector3i& cube : voxels) {
      int& part = part_[grid_.index(cube)];
      part = renamed[static_cast<std::size_t>(part) - first];
    }
    parts_.resize(first);
    parts_.insert(parts_.end(), kept.begin(), kept.end());
  }

  // Corners that are one node, and which of a part's tets hold tissue.
  void number_nodes() {
    DisjointSets corners(8 * parts_.size());
    used_.assign(parts_.size(), {});
    for_voxels([&](const Eigen::Vector3i& cube, std::size_t) {
      const std::size_t part = part_at(cube);
      mark_used(cube, part);
      for (int axis = 0; axis < 3; ++axis) {
        const Eigen::Vector3i next = cube + Eigen::Vector3i::Unit(axis);
        if (next[axis] % kSubdivision != 0 || next[axis] == grid_.count[axis]) continue;
        if (part_[grid_.index(next)] < 0 || is_cut(cube, axis)) continue;
        const std::size_t other = part_at(next), bit = std::size_t{1} << axis;
        for (std::size_t corner = 0; corner < 8; ++corner) {
          if ((corner & bit) == 0) continue;
          corners.join(8 * part + corner, 8 * other + (corner ^ bit));
        }
      }
    });
    std::vector<int> number(8 * parts_.size(), -1);
    node_.assign(8 * parts_.size(), -1);
    for (std::size_t p = 0; p < parts_.size(); ++p) {
      for (std::size_t k = 0; k < 5; ++k) {
        if (!used_[p][k]) continue;
        for (const int corner : split_of(p)[k]) {
          const std::size_t c = 8 * p + static_cast<std::size_t>(corner);
          int& node = number[corners.lowest(c)];
          if (node < 0) node = static_cast<int>(node_count_++);
          node_[c] = node;
        }
      }
    }
  }

  Eigen::Vector4d in_cell(const Eigen::Vector3d& point, std::size_t part) const {
    Eigen::Vector4d local;
    local << (point - grid_.origin) / cell_ - parts_[part].cell.cast<double>(), 1;
    return local;
  }

  void mark_used(const Eigen::Vector3i& cube, std::size_t part) {
    const Eigen::Vector4d centre = in_cell(grid_.centre(cube), part);
    for (std::size_t k = 0; k < 5; ++k) {
      if (used_[part][k]) continue;
      const Barycentric& matrix = barycentric()[parity(part)][k];
      const Eigen::Vector4d reach = 0.5 / kSubdivision * matrix.leftCols<3>().cwiseAbs().rowwise().sum();
      used_[part][k] = (matrix * centre + reach).minCoeff() >= 0;
    }
  }

  // The tet of a part that holds a point best.
  EmbeddedPoint place(const Eigen::Vector3d& point, std::size_t part,
                      const std::vector<std::array<int, 5>>& tet_of) const {
    const Eigen::Vector4d local = in_cell(point, part);
    EmbeddedPoint best{-1, Eigen::Vector4d::Constant(-1e300)};
    for (std::size_t k = 0; k < 5; ++k) {
      if (tet_of[part][k] < 0) continue;
      const Eigen::Vector4d weights = barycentric()[parity(part)][k] * local;
      if (weights.minCoeff() > best.weights.minCoeff()) best = {tet_of[part][k], weights};
    }
    return best;
  }

  const Positions& vertices_;
  double cell_;
  Eigen::Vector3i cells_;
  VoxelGrid grid_;
  std::vector<Voxel> voxels_;
  std::vector<std::uint8_t> cuts_;  // of every voxel, see CubeCuts
  std::vector<int> part_;           // of every voxel, -1 outside
  std::vector<Part> parts_;
  std::vector<std::array<bool, 5>> used_;  // of every part
  std::vector<int> node_;                  // 8 for every part
  Eigen::Index node_count_ = 0;
};

double voxel_count(const Positions& vertices, double cell) {
  const Eigen::RowVector3d box = box_sides(vertices);
  return (box.array() / cell + 1).prod() * std::pow(kSubdivision, 3);
}

}  // namespace

Cage lattice_cage_of_size(const Positions& vertices, const Triangles& triangles, const SkinWeights& weights,
                          double cell) {
  require_mesh(vertices, triangles, weights);
  if (voxel_count(vertices, cell) > kMostVoxels) {
    throw Error(ErrorKind::usage, "a cage with cells of ", cell, " m is too fine for this skin");
  }
  return CageMaker(vertices, triangles, CubeCuts(vertices, triangles, weights), cell).make();
}

Cage lattice_cage(const Positions& vertices, const Triangles& triangles, const SkinWeights& weights,
                  Eigen::Index max_nodes) {
  require_mesh(vertices, triangles, weights);
  const CubeCuts cuts(vertices, triangles, weights);
  constexpr int kAttempts = 12;
  constexpr double kCloseEnough = 0.97, kPower = 1.0 / 2.4;  // nodes fall about with the power -2.4 of the cell
  double cell = box_diagonal(vertices) / 20, coarsest_too_fine = 0;
  std::optional<double> best;
  for (int attempt = 0; attempt < kAttempts || !best; ++attempt) {
    if (voxel_count(vertices, cell) > kMostVoxels) {
      coarsest_too_fine = std::max(coarsest_too_fine, cell);
      cell = best ? (cell + *best) / 2 : 1.2 * cell;
      continue;
    }
    const auto nodes = static_cast<double>(CageMaker(vertices, triangles, cuts, cell).node_count());
    const double share = nodes / static_cast<double>(max_nodes);
    if (share <= 1 && (!best || cell < *best)) best = cell;
    if (share <= 1 && share > kCloseEnough) break;
    if (share > 1) coarsest_too_fine = std::max(coarsest_too_fine, cell);
    cell *= std::pow(share / (0.5 + 0.5 * kCloseEnough), kPower);
    // The next size lies between what is known to be too fine and what is not.
    if (best && coarsest_too_fine > 0 && (cell >= *best || cell <= coarsest_too_fine)) {
      cell = (*best + coarsest_too_fine) / 2;
    }
  }
  return CageMaker(vertices, triangles, cuts, *best).make();
}

}  // namespace bodyopt::trainer
