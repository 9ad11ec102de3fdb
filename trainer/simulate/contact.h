// Skin against skin in deep folds.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "trainer/simulate/materials.h"
#include "trainer/tets/tets.h"

namespace bodyopt {

// A node of the skin against a tet that it is inside of or near to: how deep it has passed through the skin, to first
// order around the shape it was found in,
//   depth = offset + slope . (x_node - sum over corners of weight x_corner).
struct ContactPlane {
  int node, tet;
  Eigen::Vector4d weights;  // barycentric, of the node in the tet
  Eigen::Vector3d slope;    // of the depth, posed space
  double offset;            // metres
};

// Every tet carries the depth below the skin at rest of its nodes (0 on the skin), linear in between: the material
// depth of Hirota, Fisher, Lin et al. 2001. A skin node inside a tet that it is no corner of has passed through the
// skin by that depth, and is pushed out by
//   energy = k area d^2 (1/2 + d / (3 reach)),  d = max(depth, 0),
// with equal and opposite forces on node and tet. With the planes of the shape itself the gradient is exact, but jumps
// where a node passes from tet to tet; planes that are held make the energy smooth, and true near that shape only.
class SkinContact {
 public:
  explicit SkinContact(const TetMesh& mesh, const Materials& materials = {});

  // One plane for every node that faces skin of another part within `margin` (metres) or has passed through it. What
  // is as near at rest is the same part.
  std::vector<ContactPlane> find(const Positions& nodes, double margin) const { return find(skin_, nodes, margin); }
  // The same of some nodes of the skin only.
  std::vector<ContactPlane> find(const std::vector<int>& among, const Positions& nodes, double margin) const;

  // Nodes of the skin that face skin of another part within `reach`, metres, ascending.
  std::vector<int> facing(const Positions& nodes, double reach) const;

  // Adds the gradient (J/m, N x 3) at `nodes` to `gradient`; returns the energy, joules.
  double add_gradient(std::span<const ContactPlane> planes, const Positions& nodes, Positions& gradient) const;

  // The largest material depth of a skin node inside another part of the body, metres; 0 without contact.
  double deepest(const Positions& nodes) const;

 private:
  double depth_of(const Eigen::Vector3d& point, const Positions& nodes, double longest) const;
  // The material depth inside a posed tet.
  struct DepthField {
    Eigen::Vector3d origin, slope;  // of corner 0; of the depth
    Eigen::Matrix3d inverse;        // of the edges from corner 0: from positions to barycentric weights
    Eigen::Vector4d depth;          // at the corners
    Eigen::Vector4d steepness;      // of the barycentric weights, 1/m
    double volume;                  // relative to rest; below 0 inside out
  };
  DepthField depth_field(int tet, const Positions& nodes) const;
  // Calls visit(plane) for nodes that face a tet of another part and lie in its box, widened by `margin`.
  template <typename Visit>
  void visit_near(const std::vector<int>& among, const Positions& nodes, double margin, Visit visit) const;
  static ContactPlane plane(int node, int tet, const DepthField& field, const Positions& nodes);

  Tets tets_;
  std::vector<double> volume_;      // per tet, at rest, cubic metres
  Positions rest_;                  // N x 3, metres
  Positions part_low_, part_high_;  // per tet: the box at rest whose nodes are of the same part
  Triangles surface_;               // faces of one tet only, outwards
  std::vector<int> skin_;           // nodes of the surface, ascending
  std::vector<int> deep_;           // tets that have any depth
  std::vector<double> depth_;       // per node, metres
  std::vector<double> area_;        // per node, a third of the surface around it, square metres
  double cell_ = 0;                 // of the grid that finds nodes, metres
  double stiffness_;                // Pa/m
};

// Contact found again and again while a shape moves: nodes far from skin of other parts are looked at only when
// something has moved far.
class ContactSearch {
 public:
  // contact must outlive it.
  explicit ContactSearch(const SkinContact& contact) : contact_(contact) {}

  // Planes of the nodes that have passed through skin.
  std::vector<ContactPlane> find(const Positions& nodes);

 private:
  const SkinContact& contact_;
  Positions found_at_;
  std::vector<int> facing_;
};

}  // namespace bodyopt
