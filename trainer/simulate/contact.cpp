#include "trainer/simulate/contact.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

#include "geometry/mesh.h"
#include "geometry/spatial_search.h"

namespace bodyopt::trainer {
namespace {

// A point counts as near to a tet when its barycentric weights in it are not below this.
constexpr double kMostOutside = -0.3;
// Tissue at rest so many times as far as what is the same part collides in full.
constexpr double kFullyApart = 2;
constexpr double kMeasuredApart = 1.5;  // edges of the skin, where depth is only measured
// A tet pressed to less of its volume at rest has no depth to speak of: its slope would be steep and point anywhere.
constexpr double kFlat = 0.05, kNotFlat = 0.15;
// Cosine between skin and the way into the tissue touched, from which it faces it fully.
constexpr double kFacing = 0.3;
// Metres, on a body of two metres or less: a depth at which the pressure has doubled its slope.
constexpr double kContactReach = 2e-3, kMan = 2;
// Metres, on such a body: planes that are wrong by more about the depth of their point are joined by a new one.
constexpr double kPlaneError = 6e-4;
constexpr double kCellEdges = 1;  // of the grid that finds points

// Rises from 0 at `from` to 1 at `to`.
double ramp(double x, double from, double to) { return std::clamp((x - from) / (to - from), 0.0, 1.0); }

Triangles without_loose_pieces(const Triangles& triangles, const LoosePieces& loose_pieces, Eigen::Index vertex_count) {
  std::vector<char> rides(static_cast<std::size_t>(vertex_count), 0);
  for (const std::uint32_t v : loose_pieces.vertices()) rides[v] = 1;
  std::vector<Eigen::Index> kept;
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    const auto row = triangles.row(t);
    if (std::none_of(row.begin(), row.end(), [&](std::uint32_t v) { return rides[v]; })) kept.push_back(t);
  }
  return triangles(kept, Eigen::all);
}

}  // namespace

SkinContact::SkinContact(const Positions& skin, const Triangles& triangles, const Cage& cage,
                         const Materials& materials)
    : mesh_(cage.mesh),
      body_(without_loose_pieces(triangles, cage.loose_pieces, skin.rows())),
      rest_depth_(skin, body_),
      points_(contact_points(skin, body_, cage)),
      cell_(kCellEdges * points_.edge.sum() / static_cast<double>(points_.touching.size())),
      stiffness_(materials.contact),
      scale_(std::max(longest_extent(skin) / kMan, 1.0)) {
  rest_determinants_.resize(mesh_.tets.rows());
  for (int t = 0; t < mesh_.tets.rows(); ++t) rest_determinants_[t] = tet_edges(mesh_, t).determinant();
  if (!cage.is_lattice) return;
  tissue_.resize(static_cast<std::size_t>(mesh_.tets.rows()));
  double cube = 0;  // cubic metres
  for (const CageSample& sample : cage.samples) {
    tissue_[static_cast<std::size_t>(sample.point.tet)].push_back(rest_position(cage.mesh, sample.point).transpose());
    cube = std::max(cube, sample.volume);
  }
  sample_reach_ = std::cbrt(cube);
}

SkinContact::PosedTet SkinContact::posed(int tet, const Positions& nodes) const {
  Eigen::Matrix3d edges;
  for (int a = 0; a < 3; ++a)
    edges.col(a) = (nodes.row(mesh_.tets(tet, a + 1)) - nodes.row(mesh_.tets(tet, 0))).transpose();
  const Eigen::Matrix3d inverse = edges.inverse();
  return {nodes.row(mesh_.tets(tet, 0)),
          inverse,
          edges.determinant() / rest_determinants_[tet],
          {inverse.colwise().sum().norm(), inverse.row(0).norm(), inverse.row(1).norm(), inverse.row(2).norm()}};
}

Eigen::Vector4d SkinContact::PosedTet::weights(const Eigen::RowVector3d& place) const {
  Eigen::Vector4d weights;
  weights.tail<3>() = inverse * (place - origin).transpose();
  weights[0] = 1 - weights.tail<3>().sum();
  return weights;
}

bool SkinContact::is_tissue(int tet, const Eigen::RowVector3d& place) const {
  if (tissue_.empty()) return true;
  const std::vector<Eigen::RowVector3d>& samples = tissue_[static_cast<std::size_t>(tet)];
  return std::any_of(samples.begin(), samples.end(), [&](const Eigen::RowVector3d& sample) {
    return (sample - place).cwiseAbs().maxCoeff() < sample_reach_;
  });
}

template <typename Visit>
void SkinContact::visit_near(const Positions& places, const Positions& nodes, double margin, Visit visit) const {
  const PointGrid grid(places, points_.touching, cell_);
  for (int t = 0; t < mesh_.tets.rows(); ++t) {
    Eigen::RowVector3d low = nodes.row(mesh_.tets(t, 0)), high = low;
    for (int a = 1; a < 4; ++a) {
      low = low.cwiseMin(nodes.row(mesh_.tets(t, a)));
      high = high.cwiseMax(nodes.row(mesh_.tets(t, a)));
    }
    std::optional<PosedTet> here;
    grid.visit(low.array() - margin, high.array() + margin, [&](int p) {
      if (!here) here = posed(t, nodes);
      if (!(here->volume > kFlat)) return;
      visit(p, t, *here, here->weights(places.row(p)));
    });
  }
}

double SkinContact::PosedTet::inside(const Eigen::Vector4d& weights) const {
  double inside = std::numeric_limits<double>::max();
  for (int a = 0; a < 4; ++a) {
    if (weights[a] < 0) inside = std::min(inside, weights[a] / steepness[a]);
  }
  return inside;
}

// A point outside of a tet has not passed through its skin, whatever lies there at rest. It is at least as far away as
// the tet.
ContactPlane SkinContact::plane(int point, int tet, const PosedTet& posed, const Eigen::Vector4d& weights) const {
  const Depth depth = rest_depth_(rest_position(mesh_, {tet, weights}));
  const Eigen::Vector3d slope = posed.inverse.transpose() * (tet_edges(mesh_, tet).transpose() * depth.inwards);
  return {point, tet, weights, slope, std::min(depth.depth, posed.inside(weights)), 0};
}

std::vector<ContactPlane> SkinContact::find(const Positions& nodes, double margin) const {
  const Positions places = embed(points_.embedded, mesh_.tets, nodes),
                  normals = vertex_normals(places, points_.triangles);
  std::map<int, ContactPlane> best;  // of each point: the tet it is inside of, or the nearest
  visit_near(places, nodes, margin, [&](int p, int t, const PosedTet& posed, const Eigen::Vector4d& weights) {
    const double inside = weights.minCoeff();
    if (inside < kMostOutside || posed.inside(weights) < -margin) return;
    const Eigen::RowVector3d place = rest_position(mesh_, {t, weights}).transpose();
    const double apart = ramp((place - points_.rest.row(p)).norm() / points_.same_part[p], 1, kFullyApart);
    if (!(apart > 0) || !is_tissue(t, place)) return;
    const auto held = best.find(p);
    if (held != best.end() && held->second.weights.minCoeff() >= inside) return;
    ContactPlane candidate = plane(p, t, posed, weights);
    if (candidate.offset < -margin) return;
    // The skin around a point faces out of its own tissue, and into tissue that it collides with.
    const Eigen::Vector3d normal = normals.row(p).transpose();
    const double cosine = normal.dot(candidate.slope) / (normal.norm() * candidate.slope.norm() + 1e-300);
    candidate.share = apart * ramp(cosine, 0, kFacing) * ramp(posed.volume, kFlat, kNotFlat);
    if (candidate.share > 0) best.insert_or_assign(p, candidate);
  });
  std::vector<ContactPlane> planes;
  for (auto& [point, plane] : best) {
    plane.offset -= depth(plane, nodes) - plane.offset;  // the point is held elsewhere than it lies
    planes.push_back(plane);
  }
  return planes;
}

double SkinContact::deepest(const Positions& nodes) const {
  double deepest = 0;
  visit_near(embed(points_.embedded, mesh_.tets, nodes), nodes, 0,
             [&](int p, int t, const PosedTet&, const Eigen::Vector4d& weights) {
               if (p >= points_.skin_count || !(weights.minCoeff() >= 0)) return;
               const Eigen::RowVector3d place = rest_position(mesh_, {t, weights}).transpose();
               if ((place - points_.rest.row(p)).norm() < kMeasuredApart * points_.edge[p]) return;
               if (is_tissue(t, place)) deepest = std::max(deepest, rest_depth_(place.transpose()).depth);
             });
  return deepest;
}

double SkinContact::depth(const ContactPlane& plane, const Positions& nodes) const {
  const EmbeddedPoint& own = points_.held[static_cast<std::size_t>(plane.point)];
  Eigen::RowVector3d offset = Eigen::RowVector3d::Zero();
  for (int a = 0; a < 4; ++a) {
    offset +=
        own.weights[a] * nodes.row(mesh_.tets(own.tet, a)) - plane.weights[a] * nodes.row(mesh_.tets(plane.tet, a));
  }
  return plane.offset + offset.dot(plane.slope.transpose());
}

double SkinContact::add_gradient(std::span<const ContactPlane> planes, const Positions& nodes,
                                 Positions& gradient) const {
  double energy = 0;
  for (const ContactPlane& plane : planes) {
    const double depth = this->depth(plane, nodes);
    if (!(depth > 0)) continue;
    const double stiffness = stiffness_ * plane.share * points_.area[plane.point];
    energy += stiffness * depth * depth * (0.5 + depth / (3 * kContactReach * scale_));
    const Eigen::RowVector3d force =
        stiffness * depth * (1 + depth / (kContactReach * scale_)) * plane.slope.transpose();
    const EmbeddedPoint& own = points_.held[static_cast<std::size_t>(plane.point)];
    for (int a = 0; a < 4; ++a) {
      gradient.row(mesh_.tets(own.tet, a)) += own.weights[a] * force;
      gradient.row(mesh_.tets(plane.tet, a)) -= plane.weights[a] * force;
    }
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
  const double near = kPlaneError / 2 * contact_.scale();
  if (found_in_.size() == 0 || !((nodes - found_in_).rowwise().squaredNorm().maxCoeff() <= near * near)) {
    found_ = contact_.find(nodes, margin_);
    found_in_ = nodes;
  }
  bool planes_fit = true;
  std::map<int, std::vector<ContactPlane>> before;
  before.swap(of_point_);
  for (const ContactPlane& found : found_) {
    std::vector<ContactPlane>& planes = of_point_[found.point];
    if (const auto held = before.find(found.point); held != before.end()) {
      planes = std::move(held->second);
      before.erase(held);
    }
    const bool fits = std::abs(told_depth(planes, nodes) - std::max(contact_.depth(found, nodes), 0.0)) <=
                      kPlaneError * contact_.scale();
    if (planes.empty() || !fits) planes.push_back(found);
    for (ContactPlane& plane : planes) plane.share = found.share;
    planes_fit = planes_fit && fits;
  }
  for (const auto& [point, planes] : before) {  // what touches no more
    planes_fit = planes_fit && told_depth(planes, nodes) <= kPlaneError * contact_.scale();
  }
  planes_.clear();
  for (const auto& [point, planes] : of_point_) {
    for (const ContactPlane& plane : planes) {
      planes_.push_back(plane);
      planes_.back().share /= static_cast<double>(planes.size());
    }
  }
  return planes_fit;
}

}  // namespace bodyopt::trainer
