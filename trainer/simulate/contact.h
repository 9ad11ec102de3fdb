// Skin against skin: in deep folds, and where parts of the body touch.
#pragma once

#include <map>
#include <span>
#include <vector>

#include "trainer/simulate/contact_points.h"
#include "trainer/simulate/materials.h"
#include "trainer/simulate/rest_depth.h"

namespace bodyopt::trainer {

// A point of the skin against a tet that it is inside of or near to. Its depth in the skin is known to first order
// around the shape that it was found in.
//   `depth = offset + slope . (x_held - sum over corners of weight x_corner)`, x_held: where ContactPoints::held is.
struct ContactPlane {
  int point, tet;
  Eigen::Vector4d weights;  // barycentric, of the point in the tet
  Eigen::Vector3d slope;    // of the depth, posed space
  double offset;            // metres
  double share;             // 0 to 1, of the energy: less where it is in doubt whether this is contact at all
};

// Contact of a skin that tets of any kind carry with itself. A point (ContactPoints) in a tet that is not its own
// stands for a point of the body at rest. Its depth in the skin is that of this point (RestDepth): the material depth
// of Hirota, Fisher, Lin et al. 2001. Equal and opposite forces on what carries the point and on the tet push it out.
//   `energy = k share area d^2 (1/2 + d / (3 reach))`, `d = max(depth, 0)`.
// The share grows from 0 to 1 as both are further apart at rest than an edge of skin and tets. It is less where the
// skin does not face the tet or this is pressed flat. In a lattice, whose cells overlap, only tets count that are
// tissue of their own part there. The planes are held: the energy is smooth, and true near the shape they were found
// in. Loose pieces take no part.
//
// nodes: the cage's, N x 3, posed, metres.
class SkinContact {
 public:
  // skin: V x 3, at rest, metres.
  SkinContact(const Positions& skin, const Triangles& triangles, const Cage& cage, const Materials& materials = {});

  // One plane for every point that faces skin of another part and has passed through it, ascending in points. Points
  // nearer than `margin`, metres, and than a part of the tet behind that skin have one, too.
  std::vector<ContactPlane> find(const Positions& nodes, double margin) const;

  // How deep a plane takes its point to be, metres; below 0 outside.
  double depth(const ContactPlane& plane, const Positions& nodes) const;

  // Adds the gradient (J/m, N x 3) at `nodes` to `gradient`; returns the energy, joules.
  double add_gradient(std::span<const ContactPlane> planes, const Positions& nodes, Positions& gradient) const;

  // How deep vertices of the skin lie in skin, whichever way they face, metres; 0 where none does. Points nearer at
  // rest than one and a half edges of the skin are the same part. Skin in skin outside of all tets goes unseen.
  double deepest(const Positions& nodes) const;

  // How much larger the body is than a man, 1 at least: the lengths that contact depends on grow with it.
  double scale() const { return scale_; }

 private:
  // Takes places in a posed tet to places in it at rest.
  struct PosedTet {
    Eigen::RowVector3d origin;  // corner 0
    Eigen::Matrix3d inverse;    // of the edges from it: from positions to barycentric weights
    double volume;              // relative to rest; below 0 inside out
    Eigen::Vector4d steepness;  // of every weight, per metre

    Eigen::Vector4d weights(const Eigen::RowVector3d& place) const;
    // Metres: below 0 of a place outside, and no farther than it is from the tet; the largest number of one inside.
    double inside(const Eigen::Vector4d& weights) const;
  };
  PosedTet posed(int tet, const Positions& nodes) const;
  // Calls visit(point, tet, PosedTet, weights) of the points near every tet that is not pressed flat.
  template <typename Visit>
  void visit_near(const Positions& places, const Positions& nodes, double margin, Visit visit) const;
  bool is_tissue(int tet, const Eigen::RowVector3d& place) const;
  ContactPlane plane(int point, int tet, const PosedTet& posed, const Eigen::Vector4d& weights) const;

  TetMesh mesh_;                       // at rest
  Eigen::VectorXd rest_determinants_;  // of every tet's edges, cubic metres
  Triangles body_;                     // the skin's, without loose pieces
  RestDepth rest_depth_;
  ContactPoints points_;
  double cell_;                                          // of the grid that finds points, metres
  std::vector<std::vector<Eigen::RowVector3d>> tissue_;  // of a lattice, per tet: its samples at rest
  double sample_reach_ = 0;                              // metres around a sample that it stands for
  double stiffness_;                                     // Pa/m
  double scale_;
};

// Contact as planes that are held while a shape is relaxed and renewed in between. A point keeps its planes while they
// give its depth to 0.6 mm. Otherwise the plane of the new shape joins them, and all of them share its force. If two
// slopes meet, a point comes to rest between them: with the last plane alone it would jump to and fro for ever.
class HeldContact {
 public:
  // contact must outlive it. margin: metres, of skin that may come into contact before planes are renewed.
  HeldContact(const SkinContact& contact, double margin, const Positions& nodes);

  const std::vector<ContactPlane>& planes() const { return planes_; }

  // Returns whether the planes gave the depth of every point.
  bool renew(const Positions& nodes);

 private:
  double told_depth(const std::vector<ContactPlane>& planes, const Positions& nodes) const;

  const SkinContact& contact_;
  double margin_;
  // The planes of the last nodes that were looked at, and those nodes: until one moves by half of what planes may be
  // wrong by, these are taken for the planes of the new shape, too.
  std::vector<ContactPlane> found_;
  Positions found_in_;
  std::map<int, std::vector<ContactPlane>> of_point_;
  std::vector<ContactPlane> planes_;
};

}  // namespace bodyopt::trainer
