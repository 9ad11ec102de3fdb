// Where bones hold the flesh: see attach_bones in tissue.h.
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <nanoflann.hpp>
#include <numbers>
#include <optional>

#include "trainer/simulate/tissue.h"

namespace bodyopt {
namespace {

// Distance from a point to the nearest skin vertex.
class SkinDistance {
 public:
  explicit SkinDistance(const Positions& vertices) : cloud_{vertices}, tree_(3, cloud_) {}

  double operator()(const Eigen::Vector3d& x) const {
    std::size_t index = 0;
    double distance2 = 0;
    nanoflann::KNNResultSet<double> result(1);
    result.init(&index, &distance2);
    tree_.findNeighbors(result, x.data(), nanoflann::SearchParams());
    return std::sqrt(distance2);
  }

 private:
  struct Cloud {
    const Positions& points;
    std::size_t kdtree_get_point_count() const { return static_cast<std::size_t>(points.rows()); }
    double kdtree_get_pt(std::size_t index, std::size_t axis) const {
      return points(static_cast<Eigen::Index>(index), static_cast<Eigen::Index>(axis));
    }
    template <typename Box>
    bool kdtree_get_bbox(Box&) const {
      return false;
    }
  };
  Cloud cloud_;
  nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, Cloud>, Cloud, 3> tree_;
};

// Finds the tet that holds a point.
class TetLocator {
 public:
  explicit TetLocator(const TetMesh& mesh) : mesh_(mesh) {
    for (Eigen::Index e = 0; e < mesh.tets.rows(); ++e) {
      Eigen::AlignedBox3d box;
      for (int k = 0; k < 4; ++k) box.extend(mesh.nodes.row(mesh.tets(e, k)).transpose());
      boxes_.push_back(box);
    }
  }

  struct Place {
    int tet;
    Eigen::Vector4d weights;
  };
  std::optional<Place> find(const Eigen::Vector3d& x) const {
    for (std::size_t e = 0; e < boxes_.size(); ++e) {
      if (!boxes_[e].contains(x)) continue;
      const Eigen::Vector4d weights = barycentric(static_cast<Eigen::Index>(e), x);
      if (weights.minCoeff() >= -1e-9) return Place{static_cast<int>(e), weights};
    }
    return std::nullopt;
  }

 private:
  Eigen::Vector4d barycentric(Eigen::Index tet, const Eigen::Vector3d& x) const {
    const Eigen::Vector3d origin = mesh_.nodes.row(mesh_.tets(tet, 0));
    Eigen::Matrix3d edges;
    for (int k = 0; k < 3; ++k) edges.col(k) = mesh_.nodes.row(mesh_.tets(tet, k + 1)).transpose() - origin;
    const Eigen::Vector3d w = edges.inverse() * (x - origin);
    return {1 - w.sum(), w(0), w(1), w(2)};
  }

  const TetMesh& mesh_;
  std::vector<Eigen::AlignedBox3d> boxes_;
};

struct BoneSegment {
  std::uint32_t joint;
  Eigen::Vector3d begin, end;
  bool open_end;  // no hinge at its end
};

Eigen::Vector3d bind_position(const Joint& joint) {
  const Affine bind = inverse(joint.inverse_bind);
  return {bind.m[0][3], bind.m[1][3], bind.m[2][3]};
}

// The mean of the vertices that a joint carries alone, or nothing.
std::optional<Eigen::Vector3d> carried_centre(const Character& character, std::uint32_t joint) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double total = 0;
  for (Eigen::Index v = 0; v < character.vertices.rows(); ++v) {
    const auto& weights = character.weights[static_cast<std::size_t>(v)];
    if (weights.empty() || weights[0].joint != joint) continue;
    sum += weights[0].weight * character.vertices.row(v).transpose();
    total += weights[0].weight;
  }
  if (total == 0) return std::nullopt;
  return sum / total;
}

std::vector<BoneSegment> bone_segments(const Character& character) {
  std::vector<BoneSegment> segments;
  const auto& joints = character.skeleton.joints;
  for (std::uint32_t j = 0; j < joints.size(); ++j) {
    const Eigen::Vector3d begin = bind_position(joints[j]);
    bool has_child = false;
    for (const Joint& child : joints) {
      if (child.parent != static_cast<int>(j)) continue;
      has_child = true;
      segments.push_back({j, begin, bind_position(child), false});
    }
    if (has_child) continue;
    // An end joint: as far beyond the centre of what it carries as the centre is from the joint.
    if (const auto centre = carried_centre(character, j)) {
      segments.push_back({j, begin, begin + 1.6 * (*centre - begin), true});
    }
  }
  return segments;
}

class BoneAttacher {
 public:
  BoneAttacher(const TetMesh& mesh, const Character& character, const Eigen::MatrixXd& node_weights)
      : mesh_(mesh),
        character_(character),
        node_weights_(node_weights),
        skin_distance_(character.vertices),
        locator_(mesh),
        size_((character.vertices.colwise().maxCoeff() - character.vertices.colwise().minCoeff()).maxCoeff()) {}

  std::vector<Attachment> run() {
    for (const BoneSegment& segment : bone_segments(character_)) attach_rod(segment);
    attach_cores();
    return std::move(attachments_);
  }

 private:
  void attach(const Eigen::Vector3d& x, std::uint32_t joint) {
    if (const auto place = locator_.find(x)) attachments_.push_back({place->tet, place->weights, joint, x});
  }

  // Points on the axis and on a ring around it, every few millimetres, clear of the hinges at both ends.
  void attach_rod(const BoneSegment& segment) {
    const Eigen::Vector3d axis = segment.end - segment.begin;
    const double length = axis.norm();
    if (length < 1e-3 * size_) return;
    const double clearance = std::min(kHingeClearance * size_, 0.3 * length);
    const double last = length - (segment.open_end ? 0 : clearance);
    const Eigen::Vector3d side = axis.unitOrthogonal();
    for (double at = clearance; at <= last; at += kSpacing * size_) {
      const Eigen::Vector3d x = segment.begin + axis * (at / length);
      if (!locator_.find(x)) continue;
      attach(x, segment.joint);
      // Tapered at hinges, so that the rods of a joint bent by 130 degrees do not meet.
      const double hinge = segment.open_end ? at : std::min(at, length - at);
      const double radius = std::min(kThickness * skin_distance_(x), 0.4 * hinge);
      for (int k = 0; k < 6; ++k) {
        const double angle = k * std::numbers::pi / 3;
        attach(x + radius * (Eigen::AngleAxisd(angle, axis / length) * side), segment.joint);
      }
    }
  }

  // Tets far below the skin that follow one joint: ribs, spine, pelvis.
  void attach_cores() {
    for (Eigen::Index e = 0; e < mesh_.tets.rows(); ++e) {
      Eigen::Vector3d x = Eigen::Vector3d::Zero();
      Eigen::RowVectorXd weights = Eigen::RowVectorXd::Zero(node_weights_.cols());
      for (int k = 0; k < 4; ++k) {
        x += 0.25 * mesh_.nodes.row(mesh_.tets(e, k)).transpose();
        weights += 0.25 * node_weights_.row(mesh_.tets(e, k));
      }
      Eigen::Index joint = 0;
      if (weights.maxCoeff(&joint) < 0.85 || skin_distance_(x) < kCoreDepth * size_) continue;
      attachments_.push_back(
          {static_cast<int>(e), Eigen::Vector4d::Constant(0.25), static_cast<std::uint32_t>(joint), x});
    }
  }

  // Shares of the character's size.
  static constexpr double kHingeClearance = 0.02, kSpacing = 0.006, kCoreDepth = 0.035;
  static constexpr double kThickness = 0.35;  // of the distance to the skin

  const TetMesh& mesh_;
  const Character& character_;
  const Eigen::MatrixXd& node_weights_;
  SkinDistance skin_distance_;
  TetLocator locator_;
  double size_;
  std::vector<Attachment> attachments_;
};

}  // namespace

std::vector<Attachment> attach_bones(const TetMesh& mesh, const Character& character,
                                     const Eigen::MatrixXd& node_weights) {
  return BoneAttacher(mesh, character, node_weights).run();
}

}  // namespace bodyopt
