#include "trainer/simulate/contact.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "geometry/nearest_skin.h"
#include "geometry/point_grid.h"
#include "geometry/vertex_normals.h"

namespace bodyopt {
namespace {

// A node counts as near to a tet when its barycentric weights in it are not below this.
constexpr double kMostOutside = -0.3;
// Tissue as near at rest as this many edges of the skin is the same part and does not collide; twice as far it does.
constexpr double kSamePartEdges = 1;
// A tet pressed to less of its volume at rest has no depth to speak of: its slope would be steep and point anywhere.
constexpr double kFlat = 0.05, kNotFlat = 0.15;
// Cosine between skin and the way into the tissue touched, from which it faces it fully.
constexpr double kFacing = 0.3;
constexpr double kContactReach = 2e-3;  // m: a depth at which the pressure has doubled its slope

// Metres: planes that are wrong by more about the depth of their node are joined by a new one.
constexpr double kPlaneError = 3e-4;

Eigen::Vector3d row(const Positions& nodes, Eigen::Index n) { return nodes.row(n).transpose(); }

// From 0 at `from` to 1 at `to`.
double ramp(double x, double from, double to) { return std::clamp((x - from) / (to - from), 0.0, 1.0); }

Eigen::Matrix3d edges_of(const Tets& tets, int tet, const Positions& nodes) {
  Eigen::Matrix3d edges;
  for (int a = 0; a < 3; ++a) edges.col(a) = row(nodes, tets(tet, a + 1)) - row(nodes, tets(tet, 0));
  return edges;
}

}  // namespace

SkinContact::SkinContact(const TetMesh& mesh, const Materials& materials)
    : tets_(mesh.tets),
      rest_(mesh.nodes),
      surface_(surface_of(mesh.tets)),
      area_(static_cast<std::size_t>(mesh.nodes.rows()), 0.0),
      stiffness_(materials.contact) {
  const Positions& nodes = mesh.nodes;
  for (Eigen::Index t = 0; t < surface_.rows(); ++t) {
    const Eigen::Vector3d a = row(nodes, surface_(t, 0));
    const double area = (row(nodes, surface_(t, 1)) - a).cross(row(nodes, surface_(t, 2)) - a).norm() / 2;
    for (int k = 0; k < 3; ++k) area_[surface_(t, k)] += area / 3;
  }
  for (std::size_t n = 0; n < area_.size(); ++n) {
    if (area_[n] > 0) skin_.push_back(static_cast<int>(n));
  }
  double area = 0;
  for (const double a : area_) area += a;
  cell_ = 0.9 * std::sqrt(area / static_cast<double>(skin_.size()));
  depth_.assign(area_.size(), 0.0);
  const NearestSkin skin(nodes, surface_);
  for (std::size_t n = 0; n < depth_.size(); ++n) {
    const Eigen::Vector3d place = row(nodes, static_cast<Eigen::Index>(n));
    if (!(area_[n] > 0)) depth_[n] = (skin(place).position - place).norm();
  }
  for (const double around : area_) edge_.push_back(std::sqrt(2 / std::sqrt(3.0) * around));  // six regular triangles
  for (Eigen::Index t = 0; t < tets_.rows(); ++t) {
    volume_.push_back(edges_of(tets_, static_cast<int>(t), nodes).determinant() / 6);
    const auto has_depth = [&](int n) { return depth_[static_cast<std::size_t>(n)] > 0; };
    if (std::any_of(tets_.row(t).begin(), tets_.row(t).end(), has_depth)) deep_.push_back(static_cast<int>(t));
  }
}

SkinContact::Box SkinContact::box_of(int tet, const Positions& nodes, double margin) const {
  const auto corner = [&](int a) { return nodes.row(tets_(tet, a)); };
  return {corner(0).cwiseMin(corner(1)).cwiseMin(corner(2)).cwiseMin(corner(3)).array() - margin,
          corner(0).cwiseMax(corner(1)).cwiseMax(corner(2)).cwiseMax(corner(3)).array() + margin};
}

Eigen::Vector3d SkinContact::way_in(int tet, const Positions& nodes) const {
  const Eigen::Matrix3d edges = edges_of(tets_, tet, nodes);
  const auto depth = [&](int corner) { return depth_[static_cast<std::size_t>(tets_(tet, corner))]; };
  Eigen::Vector3d way = Eigen::Vector3d::Zero();
  for (int a = 0; a < 3; ++a) {
    way += (depth(a + 1) - depth(0)) * edges.col((a + 1) % 3).cross(edges.col((a + 2) % 3));
  }
  return edges.determinant() < 0 ? Eigen::Vector3d(-way) : way;
}

SkinContact::DepthField SkinContact::depth_field(int tet, const Positions& nodes) const {
  DepthField field;
  field.origin = row(nodes, tets_(tet, 0));
  const Eigen::Matrix3d edges = edges_of(tets_, tet, nodes);
  field.volume = edges.determinant() / 6 / volume_[static_cast<std::size_t>(tet)];
  field.inverse = edges.inverse();
  for (int a = 0; a < 4; ++a) field.depth[a] = depth_[static_cast<std::size_t>(tets_(tet, a))];
  field.slope = field.inverse.transpose() * (field.depth.tail<3>().array() - field.depth[0]).matrix();
  field.steepness[0] = field.inverse.colwise().sum().norm();
  for (int a = 0; a < 3; ++a) field.steepness[a + 1] = field.inverse.row(a).norm();
  return field;
}

ContactPlane SkinContact::plane(int node, int tet, const DepthField& field, const Positions& nodes) const {
  ContactPlane plane{node, tet, {}, field.slope, 0, 0};
  plane.weights.tail<3>() = field.inverse * (row(nodes, node) - field.origin);
  plane.weights[0] = 1 - plane.weights.tail<3>().sum();
  plane.offset = plane.weights.dot(field.depth);  // where it is found, node and weighted corners are one point
  // What is outside has not passed through the skin, whatever the depth inside extrapolates to: it is at least as far
  // away as the tet.
  for (int a = 0; a < 4; ++a) {
    if (plane.weights[a] < 0) plane.offset = std::min(plane.offset, plane.weights[a] / field.steepness[a]);
  }
  return plane;
}

double SkinContact::share(const ContactPlane& plane, const DepthField& field, const Eigen::RowVector3d& normal) const {
  Eigen::RowVector3d apart = rest_.row(plane.node);  // at rest, from the tissue touched
  for (int a = 0; a < 4; ++a) apart -= plane.weights[a] * rest_.row(tets_(plane.tet, a));
  const double same_part = kSamePartEdges * edge_[static_cast<std::size_t>(plane.node)];
  // The skin around a node faces out of its own tissue, and into tissue that it collides with.
  const double cosine = normal.dot(field.slope.transpose()) / (normal.norm() * field.slope.norm() + 1e-300);
  return ramp(apart.norm(), same_part, 2 * same_part) * ramp(cosine, 0, kFacing) * ramp(field.volume, kFlat, kNotFlat);
}

// Whether a node never collides with a tet, wherever it is in it.
bool SkinContact::is_same_part(int node, int tet) const {
  const double part = kSamePartEdges * edge_[static_cast<std::size_t>(node)];
  for (int a = 0; a < 4; ++a) {
    if ((rest_.row(tets_(tet, a)) - rest_.row(node)).squaredNorm() > part * part) return false;
  }
  return true;
}

std::vector<ContactPlane> SkinContact::find(const Positions& nodes, double margin) const {
  const Positions normals = vertex_normals(nodes, surface_);
  const PointGrid grid(nodes, skin_, cell_);
  std::map<int, ContactPlane> best;  // of each node: the tet it is inside of, or the nearest
  for (const int t : deep_) {
    const auto [low, high] = box_of(t, nodes, margin);
    std::optional<Eigen::RowVector3d> way;
    std::optional<DepthField> field;
    grid.visit(low, high, [&](int n) {
      if (!way) way = way_in(t, nodes).transpose();
      // Nearly all that lie near are neighbours, whose skin faces the other way: that is told soonest.
      if (!(normals.row(n).dot(*way) > 0) || is_same_part(n, t)) return;
      if (!field) field = depth_field(t, nodes);
      ContactPlane candidate = plane(n, t, *field, nodes);
      if (candidate.weights.minCoeff() < kMostOutside || candidate.offset < -margin) return;
      candidate.share = share(candidate, *field, normals.row(n));
      if (!(candidate.share > 0)) return;
      const auto [place, is_new] = best.try_emplace(n, candidate);
      if (!is_new && place->second.weights.minCoeff() < candidate.weights.minCoeff()) place->second = candidate;
    });
  }
  std::vector<ContactPlane> planes;
  for (const auto& [node, plane] : best) planes.push_back(plane);
  return planes;
}

double SkinContact::depth(const ContactPlane& plane, const Positions& nodes) const {
  Eigen::RowVector3d offset = nodes.row(plane.node);
  for (int a = 0; a < 4; ++a) offset -= plane.weights[a] * nodes.row(tets_(plane.tet, a));
  return plane.offset + offset.dot(plane.slope.transpose());
}

double SkinContact::add_gradient(std::span<const ContactPlane> planes, const Positions& nodes,
                                 Positions& gradient) const {
  double energy = 0;
  for (const ContactPlane& plane : planes) {
    const double depth = this->depth(plane, nodes);
    if (!(depth > 0)) continue;
    const double stiffness = stiffness_ * plane.share * area_[static_cast<std::size_t>(plane.node)];
    energy += stiffness * depth * depth * (0.5 + depth / (3 * kContactReach));
    const Eigen::RowVector3d force = stiffness * depth * (1 + depth / kContactReach) * plane.slope.transpose();
    gradient.row(plane.node) += force;
    for (int a = 0; a < 4; ++a) gradient.row(tets_(plane.tet, a)) -= plane.weights[a] * force;
  }
  return energy;
}

HeldContact::HeldContact(const SkinContact& contact, double margin, const Positions& nodes)
    : contact_(contact), margin_(margin) {
  renew(nodes);
}

double HeldContact::told_depth(const std::vector<ContactPlane>& planes, const Positions& nodes) const {
  double sum = 0;
  for (const ContactPlane& plane : planes) sum += std::max(contact_.depth(plane, nodes), 0.0);
  return planes.empty() ? 0 : sum / static_cast<double>(planes.size());
}

bool HeldContact::renew(const Positions& nodes) {
  bool planes_fit = true;
  std::map<int, std::vector<ContactPlane>> before;
  before.swap(of_node_);
  for (const ContactPlane& found : contact_.find(nodes, margin_)) {
    std::vector<ContactPlane>& planes = of_node_[found.node];
    if (const auto held = before.find(found.node); held != before.end()) {
      planes = std::move(held->second);
      before.erase(held);
    }
    const bool fits = std::abs(told_depth(planes, nodes) - std::max(found.offset, 0.0)) <= kPlaneError;
    if (planes.empty() || !fits) planes.push_back(found);
    for (ContactPlane& plane : planes) plane.share = found.share;
    planes_fit = planes_fit && fits;
  }
  for (const auto& [node, planes] : before) {  // what touches no more
    planes_fit = planes_fit && told_depth(planes, nodes) <= kPlaneError;
  }
  planes_.clear();
  for (const auto& [node, planes] : of_node_) {
    for (const ContactPlane& plane : planes) {
      planes_.push_back(plane);
      planes_.back().share /= static_cast<double>(planes.size());
    }
  }
  return planes_fit;
}

}  // namespace bodyopt
