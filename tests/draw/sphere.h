// A sphere with outward normals, of slices x stacks quadrilaterals.
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include "draw/renderer.h"

namespace bodyopt::testing {

struct Sphere {
  std::vector<float> positions, normals, colours;
  std::vector<std::uint32_t> triangles;

  explicit Sphere(float radius, std::uint32_t slices = 48, std::uint32_t stacks = 24) {
    for (std::uint32_t j = 0; j <= stacks; ++j) {
      for (std::uint32_t i = 0; i <= slices; ++i) {
        const double theta = std::numbers::pi * j / stacks, phi = 2 * std::numbers::pi * i / slices;
        const double n[3] = {std::sin(theta) * std::sin(phi), std::cos(theta), std::sin(theta) * std::cos(phi)};
        for (const double x : n) {
          normals.push_back(static_cast<float>(x));
          positions.push_back(radius * static_cast<float>(x));
        }
      }
    }
    for (std::uint32_t j = 0; j < stacks; ++j) {
      for (std::uint32_t i = 0; i < slices; ++i) {
        const std::uint32_t a = j * (slices + 1) + i, b = a + slices + 1;
        for (const std::uint32_t v : {a, b, b + 1, a, b + 1, a + 1}) triangles.push_back(v);
      }
    }
  }

  draw::DrawMesh mesh() const { return {positions, normals, triangles, colours}; }
};

}  // namespace bodyopt::testing
