#include <Eigen/Core>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <map>

#include "runtime/cpu/kernels.h"
#include "runtime/host/skin_tables.h"
#include "runtime/vulkan/kernels/kernels.h"
#include "shaders/include/tangent.h"
#include "tests/support/kernel_cases.h"
#include "tests/support/random_tables.h"

namespace bodyopt::testing {
namespace output_tangents_test {

// A crumpled sheet. Its texture has two charts: on the left one, that is mirrored in the middle; on the right, with
// vertices of its own along the seam, one that is turned. Some corners have vertices of their own without a seam.
struct Sheet {
  Sheet(Random& random, std::uint32_t vertices)
      : width(std::max(2u, static_cast<std::uint32_t>(std::sqrt(vertices)))), seam(width / 2) {
    for (std::uint32_t v = 0; v < vertices; ++v) {
      for (const std::uint32_t at : {v % width, v / width, 0u}) {
        mesh.rest.push_back(static_cast<float>(at + random.uniform(-0.2, 0.2)));
      }
      add_output(random, v, v % width > seam);
    }
    for (std::uint32_t v = 0; v + width + 1 < vertices; ++v) {
      if (v % width + 1 == width) continue;
      add_triangle(random, v, {v, v + 1, v + width});
      add_triangle(random, v, {v + 1, v + width + 1, v + width});
    }
  }

  void add_output(Random& random, std::uint32_t vertex, bool is_right) {
    mesh.output_vertex.push_back(vertex);
    const double x = mesh.rest[3 * vertex], y = mesh.rest[3 * vertex + 1];
    const double u = is_right ? 0.1 * y + 3 : 0.1 * std::abs(x - width / 4), v = is_right ? 0.1 * x : 0.1 * y;
    texture.push_back(static_cast<float>(u + random.uniform(-0.01, 0.01)));
    texture.push_back(static_cast<float>(v + random.uniform(-0.01, 0.01)));
  }

  void add_triangle(Random& random, std::uint32_t cell, const std::array<std::uint32_t, 3>& corners) {
    const bool is_right = cell % width >= seam;
    for (const std::uint32_t v : corners) {
      mesh.triangles.push_back(v);
      std::uint32_t output = v;
      if (is_right && v % width == seam) {
        const auto [found, is_new] = along_seam.try_emplace(v, mesh.output_count());
        if (is_new) add_output(random, v, true);
        output = found->second;
      }
      if (random.below(7) == 0) {
        const std::array<float, 2> at = {texture[2 * output], texture[2 * output + 1]};
        output = mesh.output_count();
        mesh.output_vertex.push_back(v);
        texture.insert(texture.end(), at.begin(), at.end());
      }
      mesh.output_triangles.push_back(output);
    }
  }

  std::uint32_t width, seam;
  MeshTable mesh;
  std::vector<float> texture;
  std::map<std::uint32_t, std::uint32_t> along_seam;
};

struct Case {
  Case(std::uint32_t seed, std::uint32_t vertices, std::uint32_t frame_count)
      : random(seed), frames(frame_count), sheet(random, vertices), tables(tangent_tables(sheet.mesh, sheet.texture)) {
    for (std::uint32_t f = 0; f < frames; ++f) {
      for (const float x : sheet.mesh.rest) positions.push_back(x + static_cast<float>(random.uniform(-0.2, 0.2)));
      for (std::uint32_t v = 0; v < vertices; ++v) {
        const Eigen::Vector3d n(random.uniform(-0.3, 0.3), random.uniform(-0.3, 0.3), 1);
        for (int i = 0; i < 3; ++i) normals.push_back(static_cast<float>(n.normalized()[i]));
      }
    }
    tangents = reference();
  }

  std::vector<float> reference() const {
    std::vector<float> all(std::size_t{4} * outputs() * frames);
    for (std::uint32_t f = 0; f < frames; ++f) {
      cpu::output_tangents(tables, of_frame(positions, f), of_frame(normals, f), 0,
                           std::span(all).subspan(std::size_t{4} * outputs() * f, std::size_t{4} * outputs()));
    }
    return all;
  }

  // How far the reference moves where positions and normals are a rounding off: much, where triangles' tangents nearly
  // cancel out or stand along the normal.
  std::vector<float> moved_by_roundings() const {
    std::vector<float> moved(tangents.size());
    Case off = *this;
    for (int k = 0; k < 4; ++k) {
      for (auto [values, exact] : {std::pair(&off.positions, &positions), std::pair(&off.normals, &normals)}) {
        for (std::size_t i = 0; i < values->size(); ++i) {
          (*values)[i] = std::nextafter((*exact)[i], off.random.below(2) == 0 ? -10.0f : 10.0f);
        }
      }
      const std::vector<float> tried = off.reference();
      for (std::size_t i = 0; i < moved.size(); ++i) moved[i] = std::max(moved[i], std::abs(tried[i] - tangents[i]));
    }
    return moved;
  }

  std::uint32_t outputs() const { return sheet.mesh.output_count(); }
  std::span<const float> of_frame(const std::vector<float>& values, std::size_t f) const {
    const std::size_t count = sheet.mesh.rest.size();
    return std::span(values).subspan(f * count, count);
  }

  Random random;
  std::uint32_t frames;
  Sheet sheet;
  TangentTables tables;
  std::vector<float> positions, normals;
  std::vector<float> tangents;  // by the reference
};

// Between an element's four numbers and the next's, and between frames, are numbers of others.
struct Layout {
  std::uint32_t first, element, frame_gap;
};
constexpr Layout kLayouts[] = {{0, 4, 0}, {5, 9, 7}};

const bool added = add_kernel_cases(
    {"output_tangents",
     "vertices",
     "layout",
     {kSizes.begin(), kSizes.end()},
     {0, 1, 2, 3, 4, 5},
     [](KernelSet& kernels, const Trial& trial) {
       const Layout& layout = kLayouts[trial.variant % std::size(kLayouts)];
       Case c(trial.seed(), trial.size, kFrames[trial.variant / std::size(kLayouts)]);
       const std::uint32_t frame = layout.element * c.outputs() + layout.frame_gap;
       const std::vector<float> before = c.random.floats(layout.first + std::size_t{frame} * c.frames, -1, 1);
       const auto at = [=, outputs = c.outputs()](std::size_t k) {
         const std::size_t output = k / 4;
         return layout.first + output / outputs * frame + output % outputs * layout.element + k % 4;
       };
       std::vector<float> placed = before, moved(before.size());
       const std::vector<float> by_roundings = c.moved_by_roundings();
       for (std::size_t k = 0; k < c.tangents.size(); ++k) {
         placed[at(k)] = c.tangents[k];
         moved[at(k)] = by_roundings[k];
       }
       EXPECT_LE(std::ranges::count_if(by_roundings, [](float by) { return by > 1e-4f; }),
                 1 + by_roundings.size() / 200);
       // A kernel rounds a dozen times on the way: roots and quotients of a device are off by three units in the last
       // place.
       const auto compare = [placed, moved](const std::vector<float>& found, double tolerance) {
         ASSERT_EQ(found.size(), placed.size());
         for (std::size_t i = 0; i < placed.size(); ++i) {
           ASSERT_NEAR(found[i], placed[i], tolerance + 8 * moved[i]) << "at " << i;
         }
       };
       return run_on<vulkan::OutputTangents>(kernels, {c.outputs(), trial.size, layout.first, layout.element, frame},
                                             c.frames, {{.values = placed, .before = before, .compare = compare}},
                                             c.tables.vertices, c.tables.corners, c.positions, c.normals);
     }});

// What triangles give to a place on the skin and on the texture, in double precision; [1] where they are mirrored.
struct Sums {
  Eigen::Vector3d tangent[2] = {Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
  double angle_at_rest[2] = {};
};
using Place = std::array<float, 3>;

Eigen::Vector3d point(std::span<const float> values, std::size_t v) {
  return {values[3 * v], values[3 * v + 1], values[3 * v + 2]};
}

double angle(const Eigen::Vector3d& a, const Eigen::Vector3d& b) { return std::atan2(a.cross(b).norm(), a.dot(b)); }

// Scattered from triangles: the derivative of the place by the first texture coordinate.
std::map<Place, Sums> textbook_sums(const Case& c, std::size_t f) {
  const MeshTable& mesh = c.sheet.mesh;
  std::map<Place, Sums> sums;
  for (std::size_t t = 0; t < mesh.output_triangles.size(); t += 3) {
    Eigen::Vector3d x[3], rest[3];
    Eigen::Vector2d uv[3];
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t output = mesh.output_triangles[t + k], v = mesh.output_vertex[output];
      x[k] = point(c.of_frame(c.positions, f), v);
      rest[k] = point(mesh.rest, v);
      uv[k] = {c.sheet.texture[2 * output], c.sheet.texture[2 * output + 1]};
    }
    Eigen::Matrix2d texture;
    texture << uv[1] - uv[0], uv[2] - uv[0];
    Eigen::Matrix<double, 3, 2> edges;
    edges << x[1] - x[0], x[2] - x[0];
    const Eigen::Vector3d along = (edges * texture.inverse()).col(0);
    const std::size_t mirrored = texture.determinant() < 0 ? 1 : 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t output = mesh.output_triangles[t + k], v = mesh.output_vertex[output];
      const Eigen::Vector3d n = point(c.of_frame(c.normals, f), v);
      const auto across = [&](const Eigen::Vector3d& d) { return (d - d.dot(n) / n.squaredNorm() * n).normalized(); };
      const std::size_t b = (k + 1) % 3, d = (k + 2) % 3;
      Sums& own = sums[{static_cast<float>(v), c.sheet.texture[2 * output], c.sheet.texture[2 * output + 1]}];
      own.tangent[mirrored] += angle(across(x[b] - x[k]), across(x[d] - x[k])) * across(along);
      own.angle_at_rest[mirrored] += angle(rest[b] - rest[k], rest[d] - rest[k]);
    }
  }
  return sums;
}

TEST(OutputTangentsReference, EqualsTheTextbook) {
  const Case c(3, 400, 2);
  std::size_t mirrored_count = 0, mixed_count = 0;
  for (std::size_t f = 0; f < c.frames; ++f) {
    const std::map<Place, Sums> sums = textbook_sums(c, f);
    for (std::size_t o = 0; o < c.outputs(); ++o) {
      const std::uint32_t v = c.sheet.mesh.output_vertex[o];
      const auto found = sums.find({static_cast<float>(v), c.sheet.texture[2 * o], c.sheet.texture[2 * o + 1]});
      const Sums own = found == sums.end() ? Sums() : found->second;
      const std::size_t mirrored = own.angle_at_rest[1] > own.angle_at_rest[0] ? 1 : 0;
      const double length = own.tangent[mirrored].norm();
      const Eigen::Vector3d expected = length > 0 ? own.tangent[mirrored] / length : own.tangent[mirrored];
      const float* tangent = &c.tangents[4 * (f * c.outputs() + o)];
      for (int i = 0; i < 3; ++i) ASSERT_NEAR(tangent[i], expected[i], 5e-6) << "output " << o;
      ASSERT_EQ(tangent[3], mirrored == 1 ? -1 : 1) << "output " << o;
      mirrored_count += mirrored;
      mixed_count += own.angle_at_rest[0] > 0 && own.angle_at_rest[1] > 0;
    }
  }
  EXPECT_GT(mirrored_count, 100u);
  EXPECT_GT(mixed_count, 20u);
}

TEST(OutputTangentsReference, PartsAreThoseOfTheWhole) {
  const Case c(5, 100, 1);
  std::vector<float> parts(c.tangents.size());
  for (std::size_t first = 0; first < c.outputs(); first += 7) {
    const std::size_t count = std::min<std::size_t>(7, c.outputs() - first);
    cpu::output_tangents(c.tables, c.positions, c.normals, first, std::span(parts).subspan(4 * first, 4 * count));
  }
  EXPECT_EQ(parts, c.tangents);
}

// A square of two triangles on its texture as it is, mirrored, turned, and without an area.
TEST(OutputTangentsReference, PointToWhereTheTextureGrows) {
  MeshTable mesh;
  mesh.rest = {0, 0, 0, 2, 0, 0, 2, 1, 0, 0, 1, 0};
  mesh.output_vertex = {0, 1, 2, 3};
  mesh.triangles = mesh.output_triangles = {0, 1, 2, 0, 2, 3};
  const std::vector<float> normals = {0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1};
  struct Texture {
    std::array<float, 3> to_u, to_v;  // of x, y and 1
    std::array<float, 4> tangent;
  };
  for (const Texture& texture :
       {Texture{{1, 0, 0}, {0, 1, 0}, {1, 0, 0, 1}}, Texture{{-1, 0, 1}, {0, 1, 0}, {-1, 0, 0, -1}},
        Texture{{1, 0, 0}, {0, -1, 1}, {1, 0, 0, -1}}, Texture{{0, 1, 0}, {-1, 0, 0}, {0, 1, 0, 1}},
        Texture{{0, 0, 0.5f}, {1, 2, 0}, {0, 0, 0, 1}}}) {
    std::vector<float> uv;
    for (std::size_t v = 0; v < 4; ++v) {
      for (const auto& to : {texture.to_u, texture.to_v}) {
        uv.push_back(to[0] * mesh.rest[3 * v] + to[1] * mesh.rest[3 * v + 1] + to[2]);
      }
    }
    std::vector<float> tangents(16);
    cpu::output_tangents(tangent_tables(mesh, uv), mesh.rest, normals, 0, tangents);
    for (std::size_t k = 0; k < 16; ++k) EXPECT_EQ(tangents[k], texture.tangent[k % 4]) << k;
  }
}

// A square, turned on its texture, and a triangle of which two corners are one vertex of the skin: it changes no
// tangent, and has none where it is alone.
TEST(OutputTangentsReference, CollapsedTrianglesHaveNoPart) {
  MeshTable mesh;
  mesh.rest = {0, 0, 0, 2, 0, 0, 2, 1, 0, 0, 1, 0};
  mesh.output_vertex = {0, 1, 2, 3, 1};
  mesh.triangles = {0, 1, 2, 0, 2, 3};
  const std::vector<float> normals = {0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1}, texture = {0, 0, 0, -2, 1, -2, 1, 0, 3, -4};
  for (const std::array<std::uint32_t, 3>& collapsed : {std::array{0u, 1u, 4u}, {1u, 4u, 0u}, {4u, 0u, 1u}}) {
    mesh.output_triangles = {0, 1, 2, 0, 2, 3};
    mesh.output_triangles.insert(mesh.output_triangles.end(), collapsed.begin(), collapsed.end());
    std::vector<float> tangents(20);
    cpu::output_tangents(tangent_tables(mesh, texture), mesh.rest, normals, 0, tangents);
    for (std::size_t output = 0; output < 5; ++output) {
      const std::array<float, 3> expected = {0, output < 4 ? 1.0f : 0.0f, 0};
      for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(tangents[4 * output + i], expected[i]) << output;
      EXPECT_EQ(tangents[4 * output + 3], 1) << output;
    }
  }
}

// A regular fan whose centre has one coordinate on the texture, from which it grows in all directions alike: roundings
// would make up a tangent, and those of a device another one.
TEST(OutputTangentsReference, AreZeroWhereTheyCancelOut) {
  constexpr std::uint32_t kSides = 7;
  for (const double moved : {0.0, 1e-7, 1e-3}) {
    MeshTable mesh;
    mesh.rest = {0, 0, 0};
    mesh.output_vertex = {0};
    std::vector<float> texture = {0, 0}, normals = {0, 0, 1};
    for (std::uint32_t k = 0; k < kSides; ++k) {
      const double angle = 2 * M_PI * k / kSides, length = k == 2 ? 1 + moved : 1, turn = k == 3 ? moved : 0;
      for (const double x : {length * std::cos(angle + turn), length * std::sin(angle + turn), 0.0}) {
        mesh.rest.push_back(static_cast<float>(x));
      }
      normals.insert(normals.end(), {0, 0, 1});
      mesh.output_triangles.insert(mesh.output_triangles.end(), {0, 2 * k + 1, 2 * k + 2});
      mesh.output_vertex.insert(mesh.output_vertex.end(), {k + 1, (k + 1) % kSides + 1});
      texture.insert(texture.end(), {1, 0, 1, 1});
    }
    std::vector<float> tangents(4 * mesh.output_vertex.size());
    cpu::output_tangents(tangent_tables(mesh, texture), mesh.rest, normals, 0, tangents);
    const float length = std::hypot(tangents[0], tangents[1], tangents[2]);
    if (moved < 1e-6) {
      EXPECT_EQ(length, 0) << moved;
    } else {
      EXPECT_NEAR(length, 1, 1e-6) << moved;
    }
    for (std::size_t k = 4; k < tangents.size(); k += 4) {
      EXPECT_NEAR(std::hypot(tangents[k], tangents[k + 1], tangents[k + 2]), 1, 1e-6) << k / 4;
    }
  }
}

// A square whose second triangle is mirrored, with vertices of its own that differ in one texture coordinate alone.
TEST(OutputTangentsReference, SidesOfASeamHaveTheirOwn) {
  MeshTable mesh;
  mesh.rest = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};
  mesh.output_vertex = {0, 1, 2, 0, 2, 3};
  mesh.triangles = {0, 1, 2, 0, 2, 3};
  mesh.output_triangles = {0, 1, 2, 3, 4, 5};
  const std::vector<float> normals = {0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1};
  for (const bool is_first : {true, false}) {
    std::vector<float> texture;
    for (std::size_t output = 0; output < 6; ++output) {
      const float *x = &mesh.rest[3 * mesh.output_vertex[output]], u = x[0], v = x[1];
      const bool is_mirrored = output >= 3;
      texture.push_back(is_mirrored && is_first ? 5 - u : u);
      texture.push_back(is_mirrored && !is_first ? 5 - v : v);
    }
    std::vector<float> tangents(24);
    cpu::output_tangents(tangent_tables(mesh, texture), mesh.rest, normals, 0, tangents);
    for (std::size_t output = 0; output < 6; ++output) {
      EXPECT_EQ(tangents[4 * output], output >= 3 && is_first ? -1 : 1) << output;
      EXPECT_EQ(tangents[4 * output + 3], output >= 3 ? -1 : 1) << output;
    }
  }
}

TEST(OutputTangentsReference, AnglesAreThoseOfTheirCosines) {
  for (int k = -1000; k <= 1000; ++k) {
    const float cosine = static_cast<float>(k) / 1000;
    EXPECT_NEAR(angle_of_cosine(cosine), std::acos(double{cosine}), 4e-7) << cosine;
  }
}

}  // namespace output_tangents_test
}  // namespace bodyopt::testing
