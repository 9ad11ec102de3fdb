// Skin against skin in deep folds.
#pragma once

#include <map>
#include <span>
#include <vector>

#include "geometry/tet_mesh.h"
#include "trainer/simulate/materials.h"

namespace bodyopt {

// A node of the skin against a tet that it is inside of or near to: how deep it has passed through the skin, to first
// order around the shape it was found in,
//   depth = offset + slope . (x_node - sum over corners of weight x_corner).
struct ContactPlane {
  int node, tet;
  Eigen::Vector4d weights;  // barycentric, of the node in the tet
  Eigen::Vector3d slope;    // of the depth, posed space
  double offset;            // metres
  double share;             // 0 to 1, of the energy: less where it is in doubt whether this is contact at all
};

// Every tet carries the depth below the skin at rest of its nodes (0 on the skin), linear in between: the material
// depth of Hirota, Fisher, Lin et al. 2001. A skin node inside a tet that it is no corner of has passed through the
// skin by that depth, and is pushed out by
//   energy = k share area d^2 (1/2 + d / (3 reach)),  d = max(depth, 0),
// with equal and opposite forces on node and tet. share grows from 0 to 1 as the tissue touched is further away at rest
// than a few edges of the skin, as the skin faces it, and as the tet is not pressed flat. The energy is that of planes
// that are held: smooth, and true near the shape they were found in.
class SkinContact {
 public:
  explicit SkinContact(const TetMesh& mesh, const Materials& materials = {});

  // One plane for every node that has passed through skin of another part that it faces, or is nearer to it than
  // `margin`, metres, and than a part of the tet behind that skin; ascending in nodes.
  std::vector<ContactPlane> find(const Positions& nodes, double margin) const;

  // How deep a plane takes its node to be, metres; below 0 outside.
  double depth(const ContactPlane& plane, const Positions& nodes) const;

  // Adds the gradient (J/m, N x 3) at `nodes` to `gradient`; returns the energy, joules.
  double add_gradient(std::span<const ContactPlane> planes, const Positions& nodes, Positions& gradient) const;

 private:
  // The material depth inside a posed tet.
  struct DepthField {
    Eigen::Vector3d origin, slope;  // of corner 0; of the depth
    Eigen::Matrix3d inverse;        // of the edges from corner 0: from positions to barycentric weights
    Eigen::Vector4d depth;          // at the corners
    Eigen::Vector4d steepness;      // of the barycentric weights, 1/m
    double volume;                  // relative to rest; below 0 inside out
  };
  struct Box {
    Eigen::RowVector3d low, high;
  };
  Box box_of(int tet, const Positions& nodes, double margin) const;
  // Along the slope of the depth in a posed tet, of any length.
  Eigen::Vector3d way_in(int tet, const Positions& nodes) const;
  DepthField depth_field(int tet, const Positions& nodes) const;
  bool is_same_part(int node, int tet) const;
  ContactPlane plane(int node, int tet, const DepthField& field, const Positions& nodes) const;
  double share(const ContactPlane& plane, const DepthField& field, const Eigen::RowVector3d& normal) const;

  Tets tets_;
  std::vector<double> volume_;  // per tet, at rest, cubic metres
  Positions rest_;              // N x 3, metres
  std::vector<double> edge_;    // per node, of the skin around it, metres
  Triangles surface_;           // faces of one tet only, outwards
  std::vector<int> skin_;       // nodes of the surface, ascending
  std::vector<int> deep_;       // tets that have any depth
  std::vector<double> depth_;   // per node, metres
  std::vector<double> area_;    // per node, a third of the surface around it, square metres
  double cell_ = 0;             // of the grid that finds nodes, metres
  double stiffness_;            // Pa/m
};

// Contact as planes that are held while a shape is relaxed and renewed in between. A node keeps its planes while they
// tell its depth to 0.3 mm; where they do not, the plane of the new shape joins them, and all of them share its
// force. Where two slopes meet a node comes to rest between them: with the last plane alone it would jump from one to
// the other for ever.
class HeldContact {
 public:
  // contact must outlive it. margin: metres, of skin that may come into contact before planes are renewed.
  HeldContact(const SkinContact& contact, double margin, const Positions& nodes);

  const std::vector<ContactPlane>& planes() const { return planes_; }

  // Returns whether the planes told the depth of every node.
  bool renew(const Positions& nodes);

 private:
  double told_depth(const std::vector<ContactPlane>& planes, const Positions& nodes) const;

  const SkinContact& contact_;
  double margin_;
  std::map<int, std::vector<ContactPlane>> of_node_;
  std::vector<ContactPlane> planes_;
};

}  // namespace bodyopt
