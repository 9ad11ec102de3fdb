#include "trainer/attach/bind_mesh.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <map>
#include <numeric>

#include "base/parallel.h"
#include "base/wording.h"
#include "geometry/mesh.h"
#include "geometry/surface_topology.h"
#include "runtime/basis/joint_omegas.h"
#include "runtime/core/error.h"

namespace bodyopt::trainer {
namespace {

// These are parts of the character's diagonal.
constexpr double kSmall = 1.0 / 20, kAlong = 1.0 / 40, kFar = 1.0 / 4, kWeld = 1e-6;
constexpr double kTiniest = 1.0 / 200, kLargest = 2;  // of what is attached, corner to corner
constexpr double kMostAlong = 0.9;                    // of a piece's vertices
constexpr double kOneWay = 0.7;       // length of the mean of normals: 1 on a plane, 0.5 on a hemisphere, 0 all around
constexpr double kOneJoint = 0.999;   // of the weights of a piece
constexpr std::size_t kNearPart = 5;  // a piece is fixed to the skin by its nearest fifth,
constexpr std::size_t kFewest = 3, kMost = 64;  // of so many vertices

using Indices = std::vector<std::uint32_t>;

// Welded vertices of each connected piece, by their first vertex.
std::vector<Indices> connected_pieces(const Triangles& triangles, std::size_t count) {
  const SurfacePieces pieces = surface_pieces(static_cast<Eigen::Index>(count), triangles);
  std::vector<Indices> list(static_cast<std::size_t>(pieces.count));
  for (std::uint32_t v = 0; v < count; ++v) list[static_cast<std::size_t>(pieces.of_vertex[v])].push_back(v);
  return list;
}

class MeshBinder {
 public:
  MeshBinder(const LooseMesh& mesh, const RestSkin& skin, const AttachOptions& options)
      : mesh_(mesh), skin_(skin), options_(options) {
    weld();
    nearest_.resize(first_.size());
    parallel_for(first_.size(), [&](std::size_t v) { nearest_[v] = skin_.nearest(vertex(v)); });
  }

  AttachedMesh bind() {
    if (mesh_.joint < 0) expect_near();
    anchor_of_.resize(first_.size());
    bound_.point_begin.push_back(0);
    for (const Indices& piece : connected_pieces(triangles_, first_.size())) bind_piece(piece);
    fill();
    return std::move(bound_);
  }

 private:
  Eigen::Vector3d vertex(std::size_t v) const { return vertices_.row(static_cast<Eigen::Index>(v)); }
  double distance(std::size_t v) const { return (nearest_[v].position - vertex(v)).norm(); }

  void weld() {
    const std::vector<std::vector<JointWeight>> none(mesh_.vertices.size());
    std::optional<Weld> weld = weld_vertices(mesh_.vertices, none, kWeld * skin_.diagonal());
    if (!weld) {
      throw Error(ErrorKind::file, "mesh '", mesh_.name,
                  "': thousands of different vertices lie at one point, the character measures ",
                  rounded(skin_.diagonal()), " m: is it in another unit (--unit)?");
    }
    welded_of_ = std::move(weld->welded_of);
    first_ = std::move(weld->first);
    vertices_.resize(static_cast<Eigen::Index>(first_.size()), 3);
    for (std::size_t v = 0; v < first_.size(); ++v) {
      const Vec3& p = mesh_.vertices[first_[v]];
      vertices_.row(static_cast<Eigen::Index>(v)) << p[0], p[1], p[2];
    }
    triangles_.resize(static_cast<Eigen::Index>(mesh_.triangles.size()), 3);
    for (std::size_t t = 0; t < mesh_.triangles.size(); ++t) {
      const auto& [a, b, c] = mesh_.triangles[t];
      triangles_.row(static_cast<Eigen::Index>(t)) << welded_of_[a], welded_of_[b], welded_of_[c];
    }
    normals_ = vertex_normals(vertices_, triangles_);
    size_ = box_diagonal(vertices_);
  }

  // Has it a size that goes with the character's? Metres.
  bool can_be_worn(double size) const {
    return size >= kTiniest * skin_.diagonal() && size <= kLargest * skin_.diagonal();
  }

  void expect_near() const {
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t v = 0; v < first_.size(); ++v) least = std::min(least, distance(v));
    if (least <= kFar * skin_.diagonal()) return;
    std::string cause = "is it elsewhere, of another character, or in another unit (--unit)?";
    for (const double factor : {0.01, 0.001, 0.0254, 0.1, 10.0, 100.0}) {
      // Anything comes near when it shrinks onto the origin.
      if (can_be_worn(size_) || !can_be_worn(factor * size_)) continue;
      double scaled = std::numeric_limits<double>::infinity();
      for (std::size_t v = 0; v < first_.size(); ++v) {
        const Eigen::Vector3d point = factor * vertex(v);
        scaled = std::min(scaled, (skin_.nearest(point).position - point).norm());
      }
      if (scaled > kAlong * skin_.diagonal()) continue;
      cause = "is it in another unit? With --unit " + rounded(factor * options_.unit) + " it is " +
              rounded(1000 * scaled) + " mm from it";
      break;
    }
    throw Error(ErrorKind::mismatch, "mesh '", mesh_.name, "' is ", rounded(least),
                " m from the skin where it is nearest, and the character measures ", rounded(skin_.diagonal()),
                " m: ", cause);
  }

  // The vertices of a piece that are nearest to the skin, nearest first.
  Indices nearest_part(const Indices& piece) const {
    Indices order = piece;
    std::ranges::stable_sort(order, [&](std::uint32_t a, std::uint32_t b) { return distance(a) < distance(b); });
    order.resize(std::min(order.size(), std::clamp(order.size() / kNearPart, kFewest, kMost)));
    return order;
  }

  // How much each joint has of a piece: by its own weights, or by those of the skin it is nearest to. Sum 1.
  std::vector<double> joint_shares(const Indices& piece) const {
    std::vector<double> shares(skin_.skeleton().size(), 0.0);
    if (!mesh_.weights.empty()) {
      for (const std::uint32_t v : piece) {
        for (const JointWeight& w : mesh_.weights[first_[v]]) shares[w.joint] += w.weight;
      }
    } else {
      for (const std::uint32_t v : nearest_part(piece)) {
        const std::vector<double> weights = skin_.joint_weights(nearest_[v]);
        for (std::size_t j = 0; j < shares.size(); ++j) shares[j] += weights[j];
      }
    }
    const double sum = std::accumulate(shares.begin(), shares.end(), 0.0);
    for (double& share : shares) share /= sum;
    return shares;
  }

  // Does the piece lie on the skin's outside, and not in a hollow, or around a limb?
  bool is_on_outside(const Indices& piece) const {
    Eigen::Vector3d normals = Eigen::Vector3d::Zero();
    double outwards = 0;
    for (const std::uint32_t v : piece) {
      const Eigen::Vector3d normal = skin_.normal(nearest_[v]);
      normals += normal;
      outwards += normal.dot(vertex(v) - nearest_[v].position);
    }
    return outwards >= 0 && normals.norm() >= kOneWay * static_cast<double>(piece.size());
  }

  AttachMode automatic_mode(const Indices& piece) const {
    if (mesh_.joint >= 0) return AttachMode::joint;
    Eigen::AlignedBox3d box;
    std::size_t along = 0;
    for (const std::uint32_t v : piece) {
      box.extend(vertex(v));
      along += distance(v) <= kAlong * skin_.diagonal() ? 1 : 0;
    }
    if (box.diagonal().norm() <= kSmall * skin_.diagonal()) {
      return is_on_outside(piece) ? AttachMode::piece : AttachMode::joint;
    }
    if (static_cast<double>(along) >= kMostAlong * static_cast<double>(piece.size())) return AttachMode::skin;
    const std::vector<double> shares = joint_shares(piece);
    const bool several = *std::ranges::max_element(shares) < kOneJoint;
    return !mesh_.weights.empty() && several ? AttachMode::skin : AttachMode::joint;
  }

  void bind_piece(const Indices& piece) {
    const AttachMode mode = options_.mode == AttachMode::automatic ? automatic_mode(piece) : options_.mode;
    switch (mode) {
      case AttachMode::skin:
        for (const std::uint32_t v : piece) anchor_of_[v] = add_anchor({skin_.facing(vertex(v), normal(v))});
        return count("following the skin");
      case AttachMode::piece: {
        std::vector<SkinPoint> points;
        for (const std::uint32_t v : nearest_part(piece)) points.push_back(nearest_[v]);
        const std::uint32_t anchor = add_anchor(points);
        for (const std::uint32_t v : piece) anchor_of_[v] = anchor;
        return count("fixed to the skin");
      }
      default: {
        const std::uint32_t joint = joint_of(piece), anchor = joint_anchor(joint);
        for (const std::uint32_t v : piece) anchor_of_[v] = anchor;
        return count("fixed to joint '" + skin_.skeleton().joints[joint].name + "'");
      }
    }
  }

  Eigen::Vector3d normal(std::size_t v) const { return normals_.row(static_cast<Eigen::Index>(v)); }

  std::uint32_t joint_of(const Indices& piece) const {
    if (options_.joint >= 0) return static_cast<std::uint32_t>(options_.joint);
    if (mesh_.joint >= 0) return static_cast<std::uint32_t>(mesh_.joint);
    const std::vector<double> shares = joint_shares(piece);
    return static_cast<std::uint32_t>(std::ranges::max_element(shares) - shares.begin());
  }

  // One for all pieces on that joint.
  std::uint32_t joint_anchor(std::uint32_t joint) {
    const auto [known, is_new] = joint_anchors_.emplace(joint, static_cast<std::uint32_t>(bound_.anchors.size()));
    if (is_new) {
      bound_.anchors.push_back({joint, 0, 0, 0});
      bound_.point_begin.push_back(static_cast<std::uint32_t>(bound_.points.size()));
    }
    return known->second;
  }

  std::uint32_t add_anchor(const std::vector<SkinPoint>& points) {
    Eigen::Vector3d centre = Eigen::Vector3d::Zero();
    std::vector<double> shares(skin_.skeleton().size(), 0.0);
    for (const SkinPoint& point : points) {
      const auto wa = static_cast<float>(point.weights[0]), wb = static_cast<float>(point.weights[1]);
      bound_.points.push_back(
          {point.vertices[0], point.vertices[1], point.vertices[2], wa, wb, std::max(0.0f, 1.0f - wa - wb)});
      centre += point.position / static_cast<double>(points.size());
      const std::vector<double> weights = skin_.joint_weights(point);
      for (std::size_t j = 0; j < shares.size(); ++j) shares[j] += weights[j];
    }
    bound_.point_begin.push_back(static_cast<std::uint32_t>(bound_.points.size()));
    bound_.anchors.push_back({static_cast<std::uint32_t>(std::ranges::max_element(shares) - shares.begin()),
                              static_cast<float>(centre.x()), static_cast<float>(centre.y()),
                              static_cast<float>(centre.z())});
    return static_cast<std::uint32_t>(bound_.anchors.size() - 1);
  }

  void count(const std::string& how) { ++pieces_[how]; }

  void fill() {
    bound_.name = mesh_.name;
    double least = std::numeric_limits<double>::infinity(), most = 0;
    for (std::size_t v = 0; v < first_.size(); ++v) {
      least = std::min(least, distance(v));
      most = std::max(most, distance(v));
    }
    for (const auto& [how, pieces] : pieces_) bound_.bound += count_of(pieces, "piece ", "pieces ") + how + ", ";
    bound_.bound += rounded(1000 * least) + " to " + rounded(1000 * most) + " mm from the skin";
    for (const Vec3& p : mesh_.vertices) {
      for (const double x : p) bound_.rest.push_back(static_cast<float>(x));
    }
    for (const auto& triangle : mesh_.triangles) {
      bound_.triangles.insert(bound_.triangles.end(), triangle.begin(), triangle.end());
    }
    for (const std::uint32_t v : welded_of_) bound_.vertex_anchor.push_back(anchor_of_[v]);
  }

  const LooseMesh& mesh_;
  const RestSkin& skin_;
  const AttachOptions& options_;
  Positions vertices_, normals_;  // welded
  Triangles triangles_;           // welded
  double size_ = 0;               // metres, corner to corner
  Indices welded_of_, first_;     // per vertex of the mesh; per welded vertex
  std::vector<SkinPoint> nearest_;
  Indices anchor_of_;  // per welded vertex
  std::map<std::uint32_t, std::uint32_t> joint_anchors_;
  std::map<std::string, std::size_t> pieces_;  // by how they are bound
  AttachedMesh bound_;
};

}  // namespace

AttachedMesh bind_mesh(const LooseMesh& mesh, const RestSkin& skin, const AttachOptions& options) {
  return MeshBinder(mesh, skin, options).bind();
}

std::vector<AttachedMesh> bind_own_meshes(const std::vector<LooseMesh>& meshes, const Basis& basis,
                                          std::vector<std::string>& notes) {
  std::vector<AttachedMesh> bound;
  if (meshes.empty()) return bound;
  const RestSkin skin(basis);
  for (const LooseMesh& mesh : meshes) {
    try {
      bound.push_back(bind_mesh(mesh, skin, {}));
    } catch (const Error& error) {
      notes.push_back(std::string("Not attached: ") + error.what());
    }
  }
  return bound;
}

RestSkin::RestSkin(const Basis& basis)
    : skeleton_(basis.skeleton),
      ddm_(basis.ddm),
      vertices_(rows_of(basis.mesh.rest)),
      triangles_(rows_of(basis.mesh.triangles)),
      diagonal_(box_diagonal(vertices_)),
      search_(vertices_, triangles_) {
  normals_ = vertex_normals(vertices_, triangles_);
  normals_.rowwise().normalize();
}

SkinPoint RestSkin::facing(const Eigen::Vector3d& point, const Eigen::Vector3d& normal) const {
  const SkinPoint nearest = search_(point), facing = search_.facing(point, normal);
  if (facing.triangle < 0) return nearest;
  return (facing.position - point).norm() <= 2 * (nearest.position - point).norm() ? facing : nearest;
}

Eigen::Vector3d RestSkin::normal(const SkinPoint& point) const { return at_point(normals_, point).normalized(); }

std::vector<double> RestSkin::joint_weights(const SkinPoint& point) const {
  std::vector<double> weights(skeleton_.size(), 0.0);
  for (Eigen::Index k = 0; k < 3; ++k) {
    for_each_omega(ddm_, point.vertices[static_cast<std::size_t>(k)],
                   [&](std::uint32_t joint, double omega) { weights[joint] += point.weights[k] * omega; });
  }
  return weights;
}

}  // namespace bodyopt::trainer
