// Loose pieces that follow a body, as hair cards, fins, eyes, teeth and buttons do.
#pragma once

#include <Eigen/SparseCore>
#include <memory>
#include <vector>

#include "geometry/tet_mesh.h"
#include "trainer/tets/fillable_skin.h"

namespace bodyopt {
class SparseSolver;
}

namespace bodyopt::trainer {

// Skin that coarse tets carry, kept apart where it follows different joints.

// Some vertices are carried by tets that follow other joints than they do, as one lip or tooth by the other jaw. The
// tet that holds them best of those that follow the same joints carries them instead. A tet follows the joints of the
// vertices that its nodes carry. If it follows theirs as well, they stay, unless skin of other joints in it is far from
// them along the skin. About a joint one tet may follow both bones, between the jaws none may.
//
// `vertices` (V x 3, rest, metres), `triangles`, `weights`: of the skin; `skin`: V, what carries each vertex.
void carry_by_own_joints(const Positions& vertices, const Triangles& triangles, const SkinWeights& weights,
                         const TetMesh& mesh, std::vector<EmbeddedPoint>& skin);

// A vertex that a tet of other joints carries because skin of theirs is next to it.
struct GluedVertex {
  std::uint32_t vertex;
  std::uint32_t joint;  // of the others, the one that the tet follows most
};

// The vertices that moves of the joints would part, but the tets do not, by vertex. Skin that follows other joints and
// is far from them along the skin shares their tet, which follows less than four fifths of their weights.
std::vector<GluedVertex> glued_vertices(const Positions& vertices, const Triangles& triangles,
                                        const SkinWeights& weights, const TetMesh& mesh,
                                        const std::vector<EmbeddedPoint>& skin);

// A loose piece has no tets. It takes the displacement of the body where it touches it, spread along its own surface.
// It moves as one piece of stuff, whatever other part of the body happens to be near. A sheet that shares edges with
// the body is held there, any other piece where it comes nearest to skin that follows the same joints. From there every
// value is the mean of those around it, weighted by one over the length of the edges (a harmonic map).
class LoosePieces {
 public:
  LoosePieces() = default;  // there are none
  // `vertices` (V x 3, rest, metres), `triangles`, `weights`: of the whole skin that was mended.
  LoosePieces(const FillableSkin& fillable, const Positions& vertices, const Triangles& triangles,
              const SkinWeights& weights);

  const std::vector<std::uint32_t>& vertices() const { return vertices_; }  // R, of the skin, ascending
  bool empty() const { return vertices_.empty(); }

  // Values at the vertices of the skin (V x 3; those of loose pieces are not looked at) spread to these, R x 3. A
  // constant stays constant.
  Positions spread(const Positions& values) const;

 private:
  using Matrix = Eigen::SparseMatrix<double>;
  std::vector<std::uint32_t> vertices_;
  std::vector<int> unknown_;                    // R: vertices merged with another share its unknown
  Matrix held_;                                 // unknowns x V: what holds each
  std::shared_ptr<const SparseSolver> solver_;  // null without loose pieces
};

}  // namespace bodyopt::trainer
