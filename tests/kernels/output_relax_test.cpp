#include <Eigen/Core>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <functional>

#include "runtime/cpu/kernels.h"
#include "runtime/vulkan/kernels/windows.h"
#include "tests/support/fan_windows.h"
#include "tests/support/random_tables.h"

namespace bodyopt::testing {
namespace output_relax_test {

using Eigen::Vector3d;

constexpr std::uint32_t kComponents = 3, kComponent = 2;

struct Case {
  Case(std::uint32_t vertices, std::uint32_t frame_count)
      : random(vertices + 31 * frame_count),
        frames(frame_count),
        mesh(random_mesh(random, vertices)),
        weights(random.floats(std::size_t{kComponents} * frames, 0.3, 1.3)),
        current(random.floats(std::size_t{3} * vertices * frames, -0.9, 0.9)),
        relaxed(current.size()) {
    push = {vertices, kComponents, kComponent, 0, vertices, 0};
    cpu::output_relax(mesh, push, weights, current, relaxed);
  }

  Vector3d at(const std::vector<float>& positions, std::size_t frame, std::size_t vertex) const {
    return Eigen::Map<const Eigen::Vector3f>(&positions[3 * (frame * push.vertex_count + vertex)]).cast<double>();
  }

  KernelRun on(KernelSet& kernels, const vulkan::DeviceInfo& limits) const {
    const vulkan::Device& device = kernels.device();
    struct Bound {
      vulkan::FanBuffers fans;
      vulkan::Buffer rest, weights, current;
    };
    const auto bound = std::make_shared<const Bound>(Bound{
        vulkan::upload_together<vulkan::FanBuffers>(device, mesh, limits), vulkan::upload(device, mesh.rest, "rest"),
        vulkan::upload(device, weights, "weights"), vulkan::upload(device, current, "current")});
    return {{{relaxed}},
            [&kernel = kernels.get<vulkan::OutputRelax>(), bound, push = push, frames = frames](
                vulkan::Commands& commands, const auto& outputs) {
              const auto& [fans, rest, w, x] = *bound;
              vulkan::record_output_relax(commands, kernel, {fans, rest, w, x, outputs[0]}, push, frames);
            }};
  }

  Random random;
  std::uint32_t frames;
  MeshTable mesh;
  std::vector<float> weights, current, relaxed;  // the last by the reference
  OutputRelaxPush push{};
};

class OutputRelax : public GpuTest {};

const bool added = add_kernel_cases_of_frames("output_relax", "vertices", [](KernelSet& kernels, const Trial& trial) {
  return Case(trial.size, trial.variant).on(kernels, kernels.device().info());
});

TEST_F(OutputRelax, WindowsGiveTheSameBits) { expect_same_bits_through_windows_of_fans(*device_, Case(1237, 2)); }

TEST(OutputRelaxReference, EqualsTheTextbook) {
  const Case c(200, 2);
  std::size_t moved = 0;
  for (std::size_t f = 0; f < 2; ++f) {
    for (std::size_t v = 0; v < 200; ++v) {
      Vector3d way = Vector3d::Zero(), normal = Vector3d::Zero();
      double sum = 0, area = 0, rest_area = 0;  // areas doubled
      const Vector3d x = c.at(c.current, f, v), rest = c.at(c.mesh.rest, 0, v);
      for (std::uint32_t k = c.mesh.vertex_triangle_begin[v]; k < c.mesh.vertex_triangle_begin[v + 1]; ++k) {
        const std::uint32_t* t = &c.mesh.triangles[3 * std::size_t{c.mesh.vertex_triangles[k]}];
        const std::size_t corner = t[0] == v ? 0 : t[1] == v ? 1 : 2;
        const std::uint32_t p = t[(corner + 1) % 3], q = t[(corner + 2) % 3];
        const Vector3d at_p = c.at(c.current, f, p) - x, at_q = c.at(c.current, f, q) - x;
        const Vector3d rest_p = c.at(c.mesh.rest, 0, p) - rest, rest_q = c.at(c.mesh.rest, 0, q) - rest;
        const Vector3d edge = at_q - at_p, doubled = at_p.cross(at_q);
        const double lost = rest_p.cross(rest_q).norm() - doubled.norm();
        const double whole = std::min(1.0, 4 * doubled.norm() / rest_p.cross(rest_q).norm());
        way += whole * lost * doubled.normalized().cross(edge);  // along the gradient of the area
        sum += edge.squaredNorm();
        normal += at_p.cross(at_q);
        area += at_p.cross(at_q).norm();
        rest_area += rest_p.cross(rest_q).norm();
      }
      const double shown = std::clamp(double{c.weights[f * kComponents + kComponent]}, 0.0, 1.0);
      const double flat = normal.squaredNorm() / (area * area);
      const double amount = area > 0 ? shown * flat * std::clamp(5 * (0.9 - area / rest_area), 0.0, 1.0) : 0;
      Vector3d expected = x;
      if (amount > 0 && sum > 0) {
        const Vector3d unit = normal.normalized();
        way = way / sum - (way / sum).dot(unit) * unit;
        if (way.squaredNorm() > 0.04 * sum) way *= 0.2 * std::sqrt(sum) / way.norm();
        expected += amount / 2 * way;
      }
      ASSERT_LT((c.at(c.relaxed, f, v) - expected).norm(), 3e-6) << "vertex " << v;
      moved += (expected - x).norm() > 1e-3;
    }
  }
  EXPECT_GT(moved, 50u);
  EXPECT_LT(moved, 350u);  // some are not compressed
}

// A plane of three by three vertices, column by x and row by y.
MeshTable plane() {
  MeshTable mesh;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      for (const int x : {column, row, 0}) mesh.rest.push_back(static_cast<float>(x));
    }
  }
  std::vector<std::vector<std::uint32_t>> around(9);
  for (std::uint32_t corner : {0u, 1u, 3u, 4u}) {
    mesh.triangles.insert(mesh.triangles.end(), {corner, corner + 1, corner + 4, corner, corner + 4, corner + 3});
  }
  for (std::uint32_t c = 0; c < mesh.triangles.size(); ++c) around[mesh.triangles[c]].push_back(c / 3);
  mesh.vertex_triangle_begin = {0};
  for (const auto& list : around) {
    mesh.vertex_triangles.insert(mesh.vertex_triangles.end(), list.begin(), list.end());
    mesh.vertex_triangle_begin.push_back(static_cast<std::uint32_t>(mesh.vertex_triangles.size()));
  }
  return mesh;
}

// A plane that is pressed together, its middle more to one side: it goes back to the middle, and stays in the plane.
TEST(OutputRelaxReference, WhatIsPressedTogetherGoesApart) {
  const MeshTable mesh = plane();
  std::vector<float> pressed = mesh.rest, relaxed(pressed.size());
  for (std::size_t k = 0; k < 9; ++k) pressed[3 * k] *= 0.5f;
  pressed[3 * 4] = 0.8f;  // of 0 to 1; the middle is 0.5
  cpu::output_relax(mesh, {9, 1, 0, 0, 9, 0}, std::vector<float>{1}, pressed, relaxed);
  EXPECT_LT(relaxed[12], 0.75f);
  EXPECT_GT(relaxed[12], 0.5f);
  EXPECT_EQ(relaxed[14], 0);
  for (std::size_t k = 0; k < 30; ++k) {
    pressed.swap(relaxed);
    for (std::size_t v = 0; v < 9; ++v) {  // what is around it is held
      for (std::size_t i = 0; i < 2 && v != 4; ++i) pressed[3 * v + i] = mesh.rest[3 * v + i] * (i == 0 ? 0.5f : 1.0f);
    }
    cpu::output_relax(mesh, {9, 1, 0, 0, 9, 0}, std::vector<float>{1}, pressed, relaxed);
  }
  EXPECT_NEAR(relaxed[12], 0.5f, 0.01f);  // in the middle again
  EXPECT_NEAR(relaxed[13], 1, 0.01f);
  cpu::output_relax(mesh, {9, 1, 0, 0, 9, 0}, std::vector<float>{0}, pressed, relaxed);
  EXPECT_EQ(relaxed, pressed);
  cpu::output_relax(mesh, {9, 1, 0, 0, 9, 0}, std::vector<float>{1}, mesh.rest, relaxed);
  EXPECT_EQ(relaxed, mesh.rest);
}

// How much further the middle of a plane goes, at most, than what is posed: from one of a thousand poses to the next.
double steepest(const std::function<void(double, std::vector<float>&)>& pose) {
  const MeshTable mesh = plane();
  std::vector<float> posed = mesh.rest, before, relaxed(posed.size());
  Eigen::Vector3f place, last;
  double steepest = 0;
  for (int k = 0; k <= 1000; ++k) {
    pose(k / 1000.0, posed);
    cpu::output_relax(mesh, {9, 1, 0, 0, 9, 0}, std::vector<float>{1}, posed, relaxed);
    place = Eigen::Map<const Eigen::Vector3f>(&relaxed[3 * 4]);
    if (k > 0) {
      float most = 0;
      for (std::size_t i = 0; i < posed.size(); ++i) most = std::max(most, std::abs(posed[i] - before[i]));
      steepest = std::max(steepest, double{(place - last).norm() / most});
    }
    last = place;
    before = posed;
  }
  return steepest;
}

// The middle is drawn over the edge of a plane that is pressed together, whose triangles turn over there.
TEST(OutputRelaxReference, IsContinuousWhereTrianglesTurnOver) {
  EXPECT_LT(steepest([](double share, std::vector<float>& posed) {
              for (const std::size_t v : {0, 3, 6}) posed[3 * v] = 0.5f;
              posed[3 * 4] = static_cast<float>(1 + 1.5 * share);
            }),
            10);
}

// Half the plane lies on the other, all but a hundredth of a radian, and grows from less than the other to more.
TEST(OutputRelaxReference, IsContinuousWhereNormalsCancel) {
  EXPECT_LT(steepest([](double share, std::vector<float>& posed) {
              const double width = 0.45 + 0.1 * share;
              for (const std::size_t v : {0, 3, 6}) {
                posed[3 * v] = 0.5f;
                posed[3 * (v + 2)] = static_cast<float>(1 - width);
                posed[3 * (v + 2) + 2] = static_cast<float>(0.01 * width);
              }
            }),
            10);
}

}  // namespace output_relax_test
}  // namespace bodyopt::testing
