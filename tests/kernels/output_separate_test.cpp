#include <Eigen/Dense>

#include "runtime/cpu/kernels.h"
#include "runtime/vulkan/kernels/kernels.h"
#include "tests/support/gpu_fixture.h"
#include "tests/support/random_tables.h"

namespace bodyopt::testing {
namespace output_separate_test {

using Eigen::Vector3d;

constexpr std::uint32_t kComponents = 5;

// Of a vertex in four, none; of the others up to three lists of up to four triangles.
FoldTable random_folds(Random& random, const MeshTable& mesh) {
  FoldTable folds;
  const auto triangles = static_cast<std::uint32_t>(mesh.triangles.size() / 3);
  const auto end = [&] { return static_cast<std::uint32_t>(folds.triangles.size()); };
  const std::uint32_t vertices = mesh.vertex_count();
  for (std::uint32_t v = 0; v < vertices; ++v) {
    folds.vertices.push_back({static_cast<std::uint32_t>(folds.lists.size()), random.below(vertices),
                              random.below(vertices), random.below(vertices)});
    for (std::uint32_t l = v % 4 == 0 || triangles == 0 ? 0 : random.below(4); l > 0; --l) {
      folds.lists.push_back({random.below(kComponents), end(), static_cast<float>(random.uniform(0.2, 0.8))});
      for (std::uint32_t k = random.below(5); k > 0; --k) folds.triangles.push_back(random.below(triangles));
    }
  }
  folds.vertices.push_back({static_cast<std::uint32_t>(folds.lists.size()), 0, 0, 0});
  folds.lists.push_back({0, end(), 0});
  return folds;
}

struct Case {
  Case(std::uint32_t vertices, std::uint32_t frame_count, bool last)
      : random(vertices + 31 * frame_count),
        frames(frame_count),
        mesh(random_mesh(random, vertices)),
        folds(random_folds(random, mesh)),
        weights(random.floats(std::size_t{kComponents} * frames, -0.3, 1.3)),
        posed(random.floats(std::size_t{3} * vertices * frames, -0.5, 0.5)),
        current(posed),
        separated(posed.size()) {
    push = {vertices, kComponents, last ? 1u : 0u};
    for (float& x : current) x += static_cast<float>(random.uniform(-0.1, 0.1));
    cpu::output_separate(mesh, folds, push, weights, posed, current, separated);
  }

  Vector3d at(const std::vector<float>& positions, std::size_t frame, std::size_t vertex) const {
    return Eigen::Map<const Eigen::Vector3f>(&positions[3 * (frame * push.vertex_count + vertex)]).cast<double>();
  }

  Random random;
  std::uint32_t frames;
  MeshTable mesh;
  FoldTable folds;
  std::vector<float> weights, posed, current, separated;  // the last by the reference
  OutputSeparatePush push{};
};

class OutputSeparate : public GpuTest {};

TEST_F(OutputSeparate, EqualsTheReference) {
  const vulkan::OutputSeparate kernel(*device_);
  for (const std::uint32_t vertices : kSizes) {
    for (const std::uint32_t frames : kFrames) {
      SCOPED_TRACE(std::to_string(vertices) + " vertices, " + std::to_string(frames) + " frames");
      const Case c(vertices, frames, vertices % 2 == 0);
      const auto begin = vulkan::upload(*device_, c.folds.vertices, "vertices"),
                 lists = vulkan::upload(*device_, c.folds.lists, "lists"),
                 met = vulkan::upload(*device_, c.folds.triangles, "folds"),
                 triangles = vulkan::upload(*device_, c.mesh.triangles, "triangles"),
                 weights = vulkan::upload(*device_, c.weights, "weights"),
                 posed = vulkan::upload(*device_, c.posed, "posed"),
                 current = vulkan::upload(*device_, c.current, "current");
      const auto outputs = run_kernel(*device_, {c.separated.size()}, [&](auto& commands, const auto& out) {
        kernel.record(commands, {begin, lists, met, triangles, weights, posed, current, out[0]}, c.push, frames);
      });
      // Of a box of 1.7 m a millionth: devices round roots and quotients by themselves.
      expect_close(outputs[0], c.separated, 1.7e-6);
    }
  }
}

// By its plane, or else by its edges.
Vector3d nearest_point(const std::array<Vector3d, 3>& corners, const Vector3d& x) {
  const auto& [a, b, c] = corners;
  Eigen::Matrix<double, 3, 2> edges;
  edges << b - a, c - a;
  const Eigen::Vector2d inside = (edges.transpose() * edges).ldlt().solve(edges.transpose() * (x - a));
  if (inside.minCoeff() >= 0 && inside.sum() <= 1) return a + edges * inside;
  Vector3d best = a;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vector3d &from = corners[k], edge = corners[(k + 1) % 3] - from;
    const Vector3d point = from + std::clamp((x - from).dot(edge) / edge.squaredNorm(), 0.0, 1.0) * edge;
    if ((point - x).norm() < (best - x).norm()) best = point;
  }
  return best;
}

Vector3d textbook(const Case& c, std::size_t frame, std::size_t vertex) {
  const Vector3d x = c.at(c.current, frame, vertex), posed = c.at(c.posed, frame, vertex);
  std::vector<std::pair<std::uint32_t, double>> met;  // and the reach
  double shown = 0, furthest = 0;
  const FoldVertex& fold = c.folds.vertices[vertex];
  const Vector3d a = c.at(c.current, frame, fold.a);
  const Vector3d own = (c.at(c.current, frame, fold.b) - a).cross(c.at(c.current, frame, fold.c) - a).normalized();
  for (std::uint32_t l = fold.first_list; l < c.folds.vertices[vertex + 1].first_list; ++l) {
    const double weight = double{c.weights[frame * kComponents + c.folds.lists[l].component]};
    if (weight <= 0) continue;
    shown = std::max(shown, std::min(weight, 1.0));
    furthest = std::max(furthest, double{c.folds.lists[l].reach});
    for (std::uint32_t k = c.folds.lists[l].first; k < c.folds.lists[l + 1].first; ++k) {
      met.emplace_back(c.folds.triangles[k], double{c.folds.lists[l].reach});
    }
  }
  Vector3d pull = Vector3d::Zero();
  double sum = 0;
  for (const auto& [triangle, reach] : met) {
    const std::uint32_t* t = &c.mesh.triangles[3 * std::size_t{triangle}];
    const std::array<Vector3d, 3> corners = {c.at(c.current, frame, t[0]), c.at(c.current, frame, t[1]),
                                             c.at(c.current, frame, t[2])};
    const Vector3d normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
    if (!(normal.norm() > 1e-9)) continue;  // of a corner that is there twice
    const Vector3d way = nearest_point(corners, x) - x;
    const double distance = way.norm();
    if (distance >= reach) continue;
    const double height = (corners[0] - x).dot(normal.normalized());
    const double cosine = (std::abs(height) + 1e-5) / (distance + 1e-5);
    const double share = std::clamp(2.5 * (cosine - 0.5), 0.0, 1.0) * std::min(4 * (1 - distance / reach), 1.0) *
                         std::clamp(2.5 * (0.1 - own.dot(normal.normalized())), 0.0, 1.0);
    const double weight = std::pow(share / (distance * distance + 1e-10), 2);
    if (height > 0) pull += weight * share * way;
    sum += weight;
  }
  const Vector3d moved = sum > 0 ? Vector3d(x + 0.5 / sum * pull) : x;
  if (c.push.last == 0) return moved;
  const double length = (moved - posed).norm(), reaches = length / furthest;
  const double share = length > 0 && reaches > 0.5 ? (1 - 0.25 / reaches) / reaches : 1;
  return posed + shown * share * (moved - posed);
}

TEST_F(OutputSeparate, ReferenceEqualsTheTextbook) {
  for (const bool last : {false, true}) {
    const Case c(200, 2, last);
    std::size_t pushed = 0;
    for (std::size_t f = 0; f < 2; ++f) {
      for (std::size_t v = 0; v < 200; ++v) {
        const Vector3d expected = textbook(c, f, v), found = c.at(c.separated, f, v);
        ASSERT_LT((found - expected).norm(), 2e-6) << "vertex " << v;
        pushed += (c.at(c.current, f, v) - found).norm() > 1e-4;
      }
    }
    EXPECT_GT(pushed, 100u);  // or nothing was compared
  }
}

// Two sheets that face each other, 4 cm into each other, meet half way; what is in front of the other sheet stays.
TEST_F(OutputSeparate, SheetsThatCrossMeet) {
  for (const float depth : {0.04f, -0.04f}) {
    MeshTable mesh;
    mesh.rest = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0.2f, 0.2f, -depth, 0.2f, 0.4f, -depth, 0.4f, 0.2f, -depth};
    mesh.triangles = {0, 1, 2, 3, 4, 5};  // up, and down
    const FoldTable folds{
        {{0, 0, 1, 2}, {0, 0, 1, 2}, {0, 0, 1, 2}, {0, 3, 4, 5}, {1, 3, 4, 5}, {2, 3, 4, 5}, {3, 0, 0, 0}},
        {{0, 0, 0.2f}, {0, 1, 0.2f}, {0, 2, 0.2f}, {0, 3, 0}},
        {0, 0, 0}};
    const OutputSeparatePush push{6, 1, 0};
    std::vector<float> separated(18);
    cpu::output_separate(mesh, folds, push, std::vector<float>{1.0f}, mesh.rest, mesh.rest, separated);
    std::vector<float> expected = mesh.rest;
    for (std::size_t v = 3; v < 6; ++v) expected[3 * v + 2] = depth > 0 ? -depth / 2 : -depth;
    if (depth < 0) {
      EXPECT_EQ(separated, expected);
    } else {
      expect_close(separated, expected, 1e-7);
    }
  }
}

TEST_F(OutputSeparate, AWeightOfZeroChangesNoBit) {
  Case c(1237, 1, true);
  std::fill(c.weights.begin(), c.weights.end(), 0.0f);
  cpu::output_separate(c.mesh, c.folds, c.push, c.weights, c.posed, c.posed, c.separated);
  EXPECT_EQ(c.separated, c.posed);
}

}  // namespace output_separate_test
}  // namespace bodyopt::testing
