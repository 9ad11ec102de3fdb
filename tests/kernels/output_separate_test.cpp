#include <Eigen/Core>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>
#include <numbers>

#include "runtime/cpu/kernels.h"
#include "runtime/host/skin_tables.h"
#include "runtime/vulkan/kernels/kernels.h"
#include "shaders/include/fold.h"
#include "tests/support/kernel_cases.h"
#include "tests/support/random_tables.h"

namespace bodyopt::testing {
namespace output_separate_test {

using Eigen::Vector3d;

constexpr std::uint32_t kFolds = 34, kComponent = 2, kComponents = kComponent + 3 * kFolds, kWords = 2;

// A skin of which some folds are bent.
struct Skin {
  MeshTable mesh;
  std::vector<float> weights, posed;  // of all frames
  std::vector<std::uint32_t> sides;   // of vertices
};

void straighten_most(std::vector<float>& weights) {
  for (std::size_t k = 0; k < weights.size() / kComponents * kFolds; ++k) {
    if (k % 4 != 3) std::fill_n(&weights[kComponents * (k / kFolds) + kComponent + 3 * (k % kFolds)], 3, 0.0f);
  }
}

// A soup of triangles, each of which reaches through all of it.
Skin soup(Random& random, std::uint32_t vertices, std::uint32_t frames) {
  Skin skin{random_mesh(random, vertices),
            random.floats(std::size_t{kComponents} * frames, -0.6, 0.6),
            random.floats(std::size_t{3} * vertices * frames, -0.9, 0.9),
            {}};
  for (std::uint32_t k = 0; k < 2 * kWords * vertices; ++k) {
    skin.sides.push_back(random.below(0x10000) << 16 | random.below(0x10000));
  }
  straighten_most(skin.weights);
  return skin;
}

void find_triangles_of_vertices(MeshTable& mesh) {
  std::vector<std::vector<std::uint32_t>> around(mesh.rest.size() / 3);
  for (std::uint32_t c = 0; c < mesh.triangles.size(); ++c) around[mesh.triangles[c]].push_back(c / 3);
  mesh.vertex_triangle_begin = {0};
  for (const auto& list : around) {
    mesh.vertex_triangles.insert(mesh.vertex_triangles.end(), list.begin(), list.end());
    mesh.vertex_triangle_begin.push_back(static_cast<std::uint32_t>(mesh.vertex_triangles.size()));
  }
}

constexpr std::uint32_t kAround = 12, kAcross = 8, kRing = kAround * kAcross, kRingPair = 2 * kRing;

// A ring around the axis z, its triangles as seen from outside.
void add_ring(double x, double z, MeshTable& mesh) {
  const auto first = static_cast<std::uint32_t>(mesh.rest.size() / 3);
  const auto corner = [&](std::uint32_t i, std::uint32_t j) { return first + i % kAround * kAcross + j % kAcross; };
  for (std::uint32_t k = 0; k < kRing; ++k) {
    const std::uint32_t i = k / kAcross, j = k % kAcross;
    const double a = 2 * std::numbers::pi * i / kAround, b = 2 * std::numbers::pi * j / kAcross;
    const double far = 0.25 + 0.1 * std::cos(b);
    for (const double place : {x + far * std::cos(a), far * std::sin(a), z + 0.1 * std::sin(b)}) {
      mesh.rest.push_back(static_cast<float>(place));
    }
    mesh.triangles.insert(mesh.triangles.end(), {corner(i, j), corner(i + 1, j), corner(i + 1, j + 1)});
    mesh.triangles.insert(mesh.triangles.end(), {corner(i, j), corner(i + 1, j + 1), corner(i, j + 1)});
  }
}

// Pairs of rings beside each other, of which the upper one has sunk into the lower; it is the child's side of the
// folds of the pair. So boxes are small, and most of one side.
Skin ring_pairs(Random& random, std::uint32_t pairs, std::uint32_t frames) {
  Skin skin;
  for (std::uint32_t pair = 0; pair < pairs; ++pair) {
    add_ring(0.8 * pair, 0, skin.mesh);
    add_ring(0.8 * pair, 0.12, skin.mesh);
  }
  find_triangles_of_vertices(skin.mesh);
  skin.sides.assign(std::size_t{2} * kWords * kRingPair * pairs, 0);
  for (std::uint32_t fold = 0; fold < kFolds; ++fold) {
    const std::uint32_t first = kRingPair * (pairs - 1 - fold % pairs);
    for (std::uint32_t v = 0; v < kRingPair; ++v) {
      std::uint32_t* own = &skin.sides[std::size_t{2} * kWords * (first + v) + fold / 32];
      own[0] |= 1u << fold % 32;
      if (v >= kRing) own[kWords] |= 1u << fold % 32;
    }
  }
  for (std::uint32_t f = 0; f < frames; ++f) {
    for (const float x : skin.mesh.rest) skin.posed.push_back(x + static_cast<float>(random.uniform(-0.01, 0.01)));
  }
  skin.weights = random.floats(std::size_t{kComponents} * frames, -0.2, 0.2);
  for (std::size_t k = 0; k < kFolds * frames; ++k) {  // their normals point up
    skin.weights[kComponents * (k / kFolds) + kComponent + 3 * (k % kFolds) + 2] += 0.8f;
  }
  straighten_most(skin.weights);
  return skin;
}

struct Case : Skin {
  Case(Random random, Skin skin, std::uint32_t frame_count, std::uint32_t step, float limit)
      : Skin(std::move(skin)),
        frames(frame_count),
        push{mesh.vertex_count(),
             static_cast<std::uint32_t>(mesh.triangles.size() / 3),
             box_count(static_cast<std::uint32_t>(mesh.triangles.size() / 3)),
             kComponents,
             kComponent,
             kFolds,
             step,
             limit},
        tables{boxed_triangles(mesh), sides},
        current(posed),
        normals(posed.size()),
        boxes(std::size_t{6} * push.box_count * frames) {
    for (std::size_t k = 0; k < current.size(); ++k) {  // every other vertex was moved by a step before
      if (k / 3 % 2 == 1) current[k] += static_cast<float>(random.uniform(-0.05, 0.05));
    }
    add_box_sides(kWords, tables);
    cpu::output_normals(mesh, posed, normals);
    cpu::output_bound(tables.triangles, {push.vertex_count, push.triangle_count, push.box_count}, current, boxes);
  }

  std::vector<float> moved() const {  // by the reference
    std::vector<float> to(posed.size());
    cpu::output_separate(mesh, tables, push, boxes, weights, {posed, current}, to);
    return to;
  }
  KernelRun run(KernelSet& kernels) const {
    return run_on<vulkan::OutputSeparate>(kernels, push, frames, {{moved()}}, tables.triangles, tables.sides, boxes,
                                          weights, normals, posed, current);
  }

  Vector3d at(const std::vector<float>& values, std::size_t frame, std::size_t vertex) const {
    return Eigen::Map<const Eigen::Vector3f>(&values[3 * (frame * push.vertex_count + vertex)]).cast<double>();
  }
  bool is_near(std::size_t v, std::uint32_t fold) const { return tables.sides[4 * v + fold / 32] >> fold % 32 & 1u; }
  bool is_child(std::size_t v, std::uint32_t fold) const {
    return tables.sides[4 * v + 2 + fold / 32] >> fold % 32 & 1u;
  }

  // How deep a vertex lies in the other side, along the unit n, by all triangles; 0 where it does not.
  double depth(std::size_t f, std::size_t v, std::uint32_t fold, const Vector3d& n) const {
    const bool child = is_child(v, fold);
    const Vector3d own = at(current, f, v), point = own + 1e-5 * at(normals, f, v);
    int above = 0, below = 0, other_above = 0, other_below = 0;
    double left = 1e9, entered = -1e9;
    bool left_near = false, entered_near = false;
    for (std::size_t t = 0; t < push.triangle_count; ++t) {
      const std::uint32_t* corners = &mesh.triangles[3 * t];
      Eigen::Matrix3d edges;  // of a + s (b - a) + r (c - a) = point + h n
      const Vector3d a = at(current, f, corners[0]);
      edges << at(current, f, corners[1]) - a, at(current, f, corners[2]) - a, -n;
      if (std::abs(edges.determinant()) < 1e-12) continue;
      const Vector3d solved = edges.inverse() * (point - a);
      if (solved[0] < 0 || solved[1] < 0 || solved[0] + solved[1] > 1) continue;
      const int leaves = edges.col(0).cross(edges.col(1)).dot(n) > 0 ? 1 : -1;
      const bool other = is_child(corners[0], fold) != child || is_child(corners[1], fold) != child ||
                         is_child(corners[2], fold) != child;
      const double h = solved[2];
      (h > 0 ? above : below) += h > 0 ? leaves : -leaves;
      if (!other) continue;
      (h > 0 ? other_above : other_below) += h > 0 ? leaves : -leaves;
      const bool near = is_near(corners[0], fold) || is_near(corners[1], fold) || is_near(corners[2], fold);
      if (h > 0 && leaves > 0 && h < left) {
        left = h;
        left_near = near;
      }
      if (h <= 0 && leaves < 0 && h > entered) {
        entered = h;
        entered_near = near;
      }
    }
    if (std::min({above, below, other_above, other_below}) < 1 || !(child ? left_near : entered_near)) return 0;
    const double offset = 1e-5 * at(normals, f, v).dot(n);
    return std::max(0.0, child ? left + offset : -entered - offset);
  }

  Vector3d expected(std::size_t f, std::size_t v) const {
    const Vector3d own = at(current, f, v), before = at(posed, f, v);
    if (push.step > 0 && own == before) return own;
    double least = 1e9;
    Vector3d way = Vector3d::Zero();
    for (std::uint32_t fold = 0; fold < kFolds; ++fold) {
      const Vector3d weight =
          Eigen::Map<const Eigen::Vector3f>(&weights[kComponents * f + kComponent + 3 * fold]).cast<double>();
      const double facing = at(normals, f, v).dot(weight) * (is_child(v, fold) ? -1 : 1);
      if (!is_near(v, fold) || weight.isZero() || !(facing > 0)) continue;
      const double deep = depth(f, v, fold, weight.normalized());
      if (!(deep > 0) || deep >= least) continue;
      least = deep;
      way = (is_child(v, fold) ? 0.5 : -0.5) * deep * std::min(1.0, weight.norm()) * weight.normalized();
    }
    if (least == 1e9) return own;
    const double limit{push.limit};
    Vector3d whole = own + way - before;
    if (whole.norm() > limit) whole *= limit / whole.norm();
    return before + whole;
  }

  std::uint32_t frames;
  OutputSeparatePush push;
  FoldTables tables;
  std::vector<float> current, normals, boxes;
};

Case soup_case(std::uint32_t vertices, std::uint32_t frames, std::uint32_t step) {
  Random random(vertices + 31 * frames + 97 * step);
  Skin skin = soup(random, vertices, frames);
  return {random, std::move(skin), frames, step, 0.08f};
}

Case ring_case(std::uint32_t pairs, std::uint32_t frames, std::uint32_t step) {
  Random random(pairs + 97 * step);
  Skin skin = ring_pairs(random, pairs, frames);
  return {random, std::move(skin), frames, step, 0.06f};
}

const bool added =
    add_kernel_cases_of_frames("output_separate", "vertices", [](KernelSet& kernels, const Trial& trial) {
      return soup_case(trial.size, trial.variant, trial.variant % 2).run(kernels);
    });

class OutputSeparate : public GpuTest {};

// So many pairs that there are more large boxes than a workgroup has lanes.
TEST_F(OutputSeparate, OfCompactPatchesEqualsTheReference) {
  KernelSet kernels(*device_);
  for (const std::uint32_t step : {0u, 1u}) {
    const Case c = ring_case(23, 2, step);
    ASSERT_GT(large_box_count(c.push.triangle_count), kWorkgroupSize);
    expect_reference(*device_, "output_separate", c.run(kernels));
  }
}

// What boxes are said to hold saves time and changes nothing, so here it is not the truth: where none has skin of a
// side, that of the other side stays.
TEST_F(OutputSeparate, SeeksTheOtherSideInBoxesThatHaveIt) {
  KernelSet kernels(*device_);
  for (const std::uint32_t list : {0u, 1u}) {
    Case c = ring_case(5, 2, 0);
    for (std::size_t k = c.sides.size(); k < c.tables.sides.size(); ++k) {
      if (k / kWords % 2 == list) c.tables.sides[k] = 0;
    }
    expect_reference(*device_, "output_separate", c.run(kernels));
    const std::vector<float> moved = c.moved();
    std::size_t of_side[2] = {0, 0};
    for (std::size_t k = 0; k < moved.size(); ++k) of_side[k / 3 % kRingPair / kRing] += moved[k] != c.current[k];
    EXPECT_GT(of_side[list], 100u);
    EXPECT_EQ(of_side[1 - list], 0u);
  }
}

void expect_textbook(const Case& c, std::size_t least_moved) {
  const std::vector<float> found = c.moved();
  std::size_t moved = 0, limited = 0;
  for (std::size_t f = 0; f < c.frames; ++f) {
    for (std::size_t v = 0; v < c.push.vertex_count; ++v) {
      const Vector3d expected = c.expected(f, v);
      ASSERT_LT((c.at(found, f, v) - expected).norm(), 1e-5) << "vertex " << v << " of frame " << f;
      if (expected == c.at(c.current, f, v)) continue;
      ++moved;
      limited += (expected - c.at(c.posed, f, v)).norm() > 0.999 * double{c.push.limit};
    }
  }
  EXPECT_GT(moved, least_moved);
  EXPECT_LT(moved, c.frames * c.push.vertex_count - 100);
  EXPECT_GT(limited, 2u);
  EXPECT_LT(limited + 10, moved);
}

TEST(OutputSeparateReference, EqualsTheTextbook) {
  for (const std::uint32_t step : {0u, 1u}) {
    expect_textbook(soup_case(300, 3, step), 30);
    expect_textbook(ring_case(5, 2, step), 100);
  }
}

// Two boxes, one of either side, of which the upper one has sunk a tenth into the lower: their sides meet half-way, and
// nothing else has moved.
TEST(OutputSeparateReference, SidesMeetHalfWay) {
  MeshTable mesh;
  std::vector<float> current;
  FoldTables tables;
  const std::uint32_t corners[12][3] = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                                        {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  for (std::uint32_t box = 0; box < 2; ++box) {
    for (std::uint32_t k = 0; k < 8; ++k) {
      // The upper one is larger, so that none of its corners lies in the lower one.
      const float size = box == 0 ? 1 : 3, x = static_cast<float>(k & 1) - 0.5f, y = static_cast<float>(k >> 1 & 1);
      current.insert(current.end(),
                     {size * x, size * (y - 0.5f), static_cast<float>(k >> 2) + 0.9f * static_cast<float>(box)});
      tables.sides.insert(tables.sides.end(), {1, box});
    }
    for (const auto& triangle : corners) {
      for (const std::uint32_t corner : triangle) mesh.triangles.push_back(corner + 8 * box);
    }
  }
  mesh.rest = current;
  find_triangles_of_vertices(mesh);
  std::vector<float> boxes(24), moved(48);
  tables.triangles = mesh.triangles;
  add_box_sides(1, tables);
  const auto separated = [&](const std::vector<float>& weights, float limit) {
    cpu::output_bound(tables.triangles, {16, 24, 4}, current, boxes);
    cpu::output_separate(mesh, tables, {16, 24, 4, 3, 0, 1, 0, limit}, boxes, weights, {current, current}, moved);
    return moved;
  };
  const std::vector<float> whole = separated({0, 0, 1}, 1), half = separated({0, 0, 0.5f}, 1),
                           little = separated({0, 0, 1}, 0.01f);
  for (std::size_t v = 0; v < 16; ++v) {
    const bool sunk = v >= 4 && v < 8;  // the lower one's upper corners
    EXPECT_NEAR(whole[3 * v + 2] - current[3 * v + 2], sunk ? -0.05 : 0, 1e-6) << v;
    EXPECT_NEAR(half[3 * v + 2] - current[3 * v + 2], sunk ? -0.025 : 0, 1e-6) << v;
    EXPECT_NEAR(little[3 * v + 2] - current[3 * v + 2], sunk ? -0.01 : 0, 1e-6) << v;
  }
  EXPECT_EQ(separated({0, 0, 0}, 1), current);
  EXPECT_EQ(separated({0, 0, -1}, 1), current);  // towards each other: the sides do not face
}

}  // namespace output_separate_test
}  // namespace bodyopt::testing
