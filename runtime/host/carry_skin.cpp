#include "runtime/host/carry_skin.h"

#include <cmath>

namespace bodyopt {
namespace {

float dot(const float* a, const float* b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

void normalise(float* v) {
  const float length = std::sqrt(dot(v, v));
  const float scale = length > 1e-20f ? 1.0f / length : 0.0f;
  for (int i = 0; i < 3; ++i) v[i] *= scale;
}

}  // namespace

CarryFrame carry_frame(const MeshTable& mesh, std::span<const float> positions, std::span<const float> normals,
                       const CarriedPoint& point) {
  const std::uint32_t* corners = mesh.output_triangles.data() + 3 * std::size_t{point.triangle};
  constexpr float kUnit = 1.0f / 255;
  const float weights[] = {1.0f - kUnit * (point.b + point.c), kUnit * point.b, kUnit * point.c};
  CarryFrame frame{};
  for (int k = 0; k < 3; ++k) {
    const float *x = positions.data() + 3 * std::size_t{corners[k]}, *n = normals.data() + 3 * std::size_t{corners[k]};
    for (int i = 0; i < 3; ++i) {
      frame.position[i] += weights[k] * x[i];
      frame.normal[i] += weights[k] * n[i];
    }
  }
  normalise(frame.normal);
  const float *a = positions.data() + 3 * std::size_t{corners[0]}, *b = positions.data() + 3 * std::size_t{corners[1]};
  for (int i = 0; i < 3; ++i) frame.edge[i] = b[i] - a[i];
  const float along = dot(frame.edge, frame.normal);
  for (int i = 0; i < 3; ++i) frame.edge[i] -= along * frame.normal[i];
  normalise(frame.edge);
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    frame.across[i] = frame.normal[j] * frame.edge[k] - frame.normal[k] * frame.edge[j];
  }
  return frame;
}

std::vector<float> carry_skin(const MeshTable& mesh, const CarriedSkin& carried, std::span<const float> positions,
                              std::span<const float> normals, Executor& threads, std::vector<float> full) {
  constexpr std::size_t kLeastPoints = 1024;  // that are worth a thread
  const std::size_t stride = 3 * std::size_t{mesh.output_count()};
  const std::size_t frames = stride == 0 ? 0 : positions.size() / stride;
  full.resize(3 * frames * carried.size());
  parallel_each(threads, frames * carried.size(), kLeastPoints, [&](std::size_t k) {
    const std::size_t f = k / carried.size();
    const CarriedPoint& point = carried.points[k % carried.size()];
    const CarryFrame frame =
        carry_frame(mesh, positions.subspan(f * stride, stride), normals.subspan(f * stride, stride), point);
    const float along_normal = carried.step * point.along_normal, along_edge = carried.step * point.along_edge,
                across = carried.step * point.across;
    for (std::size_t i = 0; i < 3; ++i) {
      full[3 * k + i] =
          frame.position[i] + along_normal * frame.normal[i] + along_edge * frame.edge[i] + across * frame.across[i];
    }
  });
  return full;
}

}  // namespace bodyopt
