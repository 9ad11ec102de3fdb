// The constant data of a character: shared by all that evaluate it.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "runtime/basis/basis.h"
#include "runtime/basis/dynamics.h"
#include "runtime/host/skin_tables.h"

namespace bodyopt {

// A skin's triangles in the order of its vertices. Results of a triangle stand near those of its vertices, so that
// threads which share a frame read little that another one wrote.
struct NearTriangles {
  std::vector<std::uint32_t> triangles;  // T x 3, vertices of the skin, those with the lowest first
  // MeshTable's, in these numbers; those of a vertex stay in the mesh's order: a sum over them has the same bits.
  std::vector<std::uint32_t> vertex_triangles;
};

NearTriangles near_triangles(const MeshTable& mesh);

struct CharacterModel {
  CharacterModel(Basis of, std::optional<Dynamics> jiggling, std::span<const float> texture = {})
      : basis(std::move(of)),
        dynamics(std::move(jiggling)),
        folds(fold_tables(basis)),
        near(near_triangles(basis.mesh)),
        tangents(tangent_tables(basis.mesh, texture)) {}

  Basis basis;
  std::optional<Dynamics> dynamics;  // of the basis; none: nothing jiggles
  FoldTables folds;                  // of the basis
  NearTriangles near;                // of the basis
  TangentTables tangents;            // of the basis, and texture coordinates for it
};

// Validates both. Throws Error(file). texture: O x 2, finite; empty: tangents cannot be asked for.
std::shared_ptr<const CharacterModel> make_character_model(Basis basis, std::optional<Dynamics> dynamics = std::nullopt,
                                                           std::span<const float> texture = {});

}  // namespace bodyopt
