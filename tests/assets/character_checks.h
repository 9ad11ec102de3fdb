// What the tests of characters share.
#pragma once

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "assets/characters/character.h"
#include "runtime/core/json.h"
#include "tests/assets/gltf_blob.h"

namespace bodyopt {

inline Character read(const GltfBlob& blob, const TemporaryFolder& folder, double unit = 0) {
  put_bytes(folder / "c.glb", blob.glb());
  return read_character(folder / "c.glb", unit);
}

inline Json& primitive(GltfBlob& blob) { return blob.root["meshes"][0]["primitives"][0]; }

inline void expect_valid(const Character& c) {
  ASSERT_GT(c.vertices.rows(), 0);
  EXPECT_TRUE(c.vertices.allFinite());
  ASSERT_EQ(c.weights.size(), static_cast<std::size_t>(c.vertices.rows()));
  for (const auto& weights : c.weights) {
    double sum = 0;
    for (std::size_t k = 0; k < weights.size(); ++k) {
      ASSERT_LT(weights[k].joint, c.skeleton.size());
      ASSERT_LE(weights[k].weight, weights[k == 0 ? 0 : k - 1].weight);
      sum += weights[k].weight;
    }
    ASSERT_NEAR(sum, 1, 1e-12);
  }
  for (std::size_t j = 0; j < c.skeleton.size(); ++j) {
    ASSERT_LT(c.skeleton.joints[j].parent, static_cast<int>(j));
    ASSERT_EQ(c.skeleton.find(c.skeleton.joints[j].name), static_cast<int>(j));
  }
  for (const std::uint32_t v : c.output_vertex) ASSERT_LT(v, static_cast<std::uint32_t>(c.vertices.rows()));
  ASSERT_LT(c.triangles.maxCoeff(), static_cast<std::uint32_t>(c.vertices.rows()));
  ASSERT_LT(c.output_triangles.maxCoeff(), c.output_count());
}

}  // namespace bodyopt
