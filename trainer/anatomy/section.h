// A flat section of a body: what tissue lies at every pixel of it.
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "geometry/tet_mesh.h"
#include "runtime/core/transform.h"
#include "trainer/anatomy/field.h"

namespace bodyopt::trainer {

// Pixels in space, row by row from the top left.
struct SectionPlane {
  Eigen::Vector3d corner;       // of the picture, top left, metres
  Eigen::Vector3d right, down;  // unit, at right angles
  double pixel = 0.001;         // metres, an edge of a pixel
  int width = 0, height = 0;    // pixels

  int size() const { return width * height; }
  Eigen::Vector3d middle(int pixel_number) const;  // of a pixel
};

// A plane whose pictures have `middle` in the middle and `sides` (to the right, down; metres), at least a pixel each.
SectionPlane plane_around(const Eigen::Vector3d& middle, const Eigen::Vector3d& right, const Eigen::Vector3d& down,
                          const std::array<double, 2>& sides, double pixel);

struct RestPoint {
  Eigen::Vector3d position;
  Eigen::Index tet = -1;  // that it lies in, of tets that were moved
};
// The places of a plane's pixels at rest, width x height; nothing: in no tissue.
using RestPoints = std::vector<std::optional<RestPoint>>;

// In moved tets (nodes, N x 3; further rows are not looked at), a pixel goes back with the tet that it lies in. Tets of
// a lattice may overlap and reach beyond the skin: the first counts whose point at rest `is_tissue`, or else the first.
RestPoints rest_points(const SectionPlane& plane, const TetMesh& rest, const Positions& moved,
                       const std::function<bool(const Eigen::Vector3d&)>& is_tissue);

// width x height: where the crossings of the skin (V x 3, at rest or posed) along a row do not sum to none.
std::vector<bool> pixels_inside(const SectionPlane& plane, const Positions& skin, const Triangles& triangles);

// In a body at rest, the pixels inside of its skin stay where they are.
RestPoints rest_points(const SectionPlane& plane, const Positions& skin, const Triangles& triangles);

// A body in a pose, by its skin and its joints. All must outlive it.
struct PosedBody {
  const Character& character;
  const Positions& skin;                // V x 3, posed, metres
  const std::vector<Affine>& skinning;  // J, rest space to posed
};

// In a posed body no tets tell how the inside moved. A pixel inside of the skin goes back by the inverse of the linear
// blend of the joints that hold the nearest skin. It also moves as the skin there differs from that blend, less the
// deeper it lies. This is a picture, not mechanics: at sharp bends tissues of both sides meet at a seam.
RestPoints rest_points(const SectionPlane& plane, const PosedBody& body);

// The plane where a joint takes it.
SectionPlane moved_plane(const SectionPlane& plane, const Affine& joint);

struct TissueSection {
  int width = 0, height = 0;
  std::vector<TissueAt> tissue;  // width x height, row by row from the top
};

// All points lie inside of a skin: a field reads between samples, and what it leaves out next to the skin is fat.
TissueSection section_of(const SectionPlane& plane, const RestPoints& rest,
                         const std::function<TissueAt(const Eigen::Vector3d&)>& tissue_at);

// "thigh", and the plane through it at rest.
struct NamedPlane {
  std::string name;
  SectionPlane plane;
  std::size_t joint = 0;  // that holds most of the skin there, and would take the plane along
};

// Human bodies and limbs have thigh, calf, hip, loin (L3), chest, upper arm and forearm, those whose joints are named.
// With fewer than three of these, a body has five planes across its longest side, evenly spaced, and one along its
// middle. At most `pixels` to the longer side.
std::vector<NamedPlane> telling_planes(const AnatomyField& field, int pixels);

}  // namespace bodyopt::trainer
