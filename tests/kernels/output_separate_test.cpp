#include <Eigen/Dense>

#include "runtime/cpu/kernels.h"
#include "runtime/host/fold_tables.h"
#include "runtime/vulkan/kernels/kernels.h"
#include "shaders/include/fold.h"
#include "tests/support/kernel_cases.h"
#include "tests/support/random_tables.h"

namespace bodyopt::testing {
namespace output_separate_test {

using Eigen::Vector3d;

constexpr std::uint32_t kFolds = 34, kComponent = 2, kComponents = kComponent + 3 * kFolds, kWords = 2;
constexpr float kLimit = 0.1f;

// A soup of triangles, of which some folds are bent.
struct Case {
  Case(std::uint32_t vertices, std::uint32_t frame_count, std::uint32_t step)
      : random(vertices + 31 * frame_count + 97 * step),
        frames(frame_count),
        mesh(random_mesh(random, vertices)),
        push{vertices,
             static_cast<std::uint32_t>(mesh.triangles.size() / 3),
             box_count(static_cast<std::uint32_t>(mesh.triangles.size() / 3)),
             kComponents,
             kComponent,
             kFolds,
             step,
             kLimit},
        weights(random.floats(std::size_t{kComponents} * frames, -0.6, 0.6)),
        posed(random.floats(std::size_t{3} * vertices * frames, -0.9, 0.9)),
        current(posed),
        normals(posed.size()),
        boxes(std::size_t{6} * push.box_count * frames),
        moved(posed.size()) {
    for (std::uint32_t k = 0; k < 2 * kWords * vertices; ++k) {
      tables.sides.push_back(random.below(0x10000) << 16 | random.below(0x10000));
    }
    for (std::size_t k = 0; k < kFolds * frames; ++k) {  // most folds are straight
      if (k % 4 != 3) std::fill_n(&weights[kComponents * (k / kFolds) + kComponent + 3 * (k % kFolds)], 3, 0.0f);
    }
    for (std::size_t k = 0; k < current.size(); ++k) {  // every other vertex was moved by a step before
      if (k / 3 % 2 == 1) current[k] += static_cast<float>(random.uniform(-0.05, 0.05));
    }
    tables.triangles = boxed_triangles(mesh);
    add_box_sides(kWords, tables);
    cpu::output_normals(mesh, posed, normals);
    cpu::output_bound(tables.triangles, bound_push(), current, boxes);
    cpu::output_separate(mesh, tables, push, {boxes, weights, posed, current}, moved);
  }

  OutputBoundPush bound_push() const { return {push.vertex_count, push.triangle_count, push.box_count}; }
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
      if (h > 0 && leaves > 0) left = std::min(left, h);
      if (h <= 0 && leaves < 0) entered = std::max(entered, h);
    }
    if (std::min({above, below, other_above, other_below}) < 1) return 0;
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
    const double limit{kLimit};
    Vector3d whole = own + way - before;
    if (whole.norm() > limit) whole *= limit / whole.norm();
    return before + whole;
  }

  Random random;
  std::uint32_t frames;
  MeshTable mesh;
  OutputSeparatePush push;
  FoldTables tables;
  std::vector<float> weights, posed, current, normals, boxes, moved;  // the last by the reference
};

const bool added =
    add_kernel_cases_of_frames("output_separate", "vertices", [](KernelSet& kernels, const Trial& trial) {
      const Case c(trial.size, trial.variant, trial.variant % 2);
      return run_on<vulkan::OutputSeparate>(kernels, c.push, c.frames, {{c.moved}}, c.tables.triangles, c.tables.sides,
                                            c.boxes, c.weights, c.normals, c.posed, c.current);
    });

TEST(OutputSeparateReference, EqualsTheTextbook) {
  for (const std::uint32_t step : {0u, 1u}) {
    const Case c(300, 3, step);
    std::size_t moved = 0, limited = 0;
    for (std::size_t f = 0; f < 3; ++f) {
      for (std::size_t v = 0; v < 300; ++v) {
        const Vector3d expected = c.expected(f, v);
        ASSERT_LT((c.at(c.moved, f, v) - expected).norm(), 1e-5) << "vertex " << v << " of frame " << f;
        if (expected == c.at(c.current, f, v)) continue;
        ++moved;
        limited += (expected - c.at(c.posed, f, v)).norm() > 0.0999;
      }
    }
    EXPECT_GT(moved, 30u);
    EXPECT_LT(moved, 800u);
    EXPECT_GT(limited, 2u);
    EXPECT_LT(limited + 10, moved);
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
  std::vector<std::vector<std::uint32_t>> around(16);
  for (std::uint32_t c = 0; c < mesh.triangles.size(); ++c) around[mesh.triangles[c]].push_back(c / 3);
  mesh.vertex_triangle_begin = {0};
  for (const auto& list : around) {
    mesh.vertex_triangles.insert(mesh.vertex_triangles.end(), list.begin(), list.end());
    mesh.vertex_triangle_begin.push_back(static_cast<std::uint32_t>(mesh.vertex_triangles.size()));
  }
  std::vector<float> boxes(24), moved(48);
  tables.triangles = mesh.triangles;
  add_box_sides(1, tables);
  const auto separated = [&](const std::vector<float>& weights, float limit) {
    cpu::output_bound(tables.triangles, {16, 24, 4}, current, boxes);
    cpu::output_separate(mesh, tables, {16, 24, 4, 3, 0, 1, 0, limit}, {boxes, weights, current, current}, moved);
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
