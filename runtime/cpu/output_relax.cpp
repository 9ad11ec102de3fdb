#include <algorithm>

#include "runtime/cpu/kernels.h"
#include "shaders/include/relax.h"

namespace bodyopt::cpu {
namespace {

using Way = float[3];

void way_between(std::span<const float> points, std::size_t from, std::size_t to, Way& way) {
  for (std::size_t i = 0; i < 3; ++i) way[i] = points[3 * to + i] - points[3 * from + i];
}

void add_corner(const MeshTable& mesh, std::span<const float> current, std::size_t triangle, std::uint32_t vertex,
                float (&sums)[9]) {
  const std::uint32_t* t = &mesh.triangles[3 * triangle];
  const std::size_t corner = t[0] == vertex ? 0 : t[1] == vertex ? 1 : 2;
  const std::uint32_t next = t[(corner + 1) % 3], last = t[(corner + 2) % 3];
  Way p, q, rest_p, rest_q;
  way_between(current, vertex, next, p);
  way_between(current, vertex, last, q);
  way_between(mesh.rest, vertex, next, rest_p);
  way_between(mesh.rest, vertex, last, rest_q);
  add_relax_corner(p, q, rest_p, rest_q, sums);
}

}  // namespace

void relax_part(const MeshTable& mesh, float weight, std::span<const float> current, std::size_t first_vertex,
                std::span<float> relaxed) {
  const float shown = std::clamp(weight, 0.0f, 1.0f);
  for (std::size_t at = 0; at < relaxed.size(); at += 3) {
    const std::size_t vertex = first_vertex + at / 3;
    const std::uint32_t begin = mesh.vertex_triangle_begin[vertex],
                        end = shown > 0 ? mesh.vertex_triangle_begin[vertex + 1] : begin;
    float sums[9] = {};
    for (std::uint32_t k = begin; k < end; ++k) {
      add_corner(mesh, current, mesh.vertex_triangles[k], static_cast<std::uint32_t>(vertex), sums);
    }
    Way own, moved;
    std::copy_n(&current[3 * vertex], 3, own);
    relax_step(sums, own, shown, moved);
    std::copy_n(moved, 3, &relaxed[at]);
  }
}

void output_relax(const MeshTable& mesh, const OutputRelaxPush& push, std::span<const float> weights,
                  std::span<const float> current, std::span<float> relaxed) {
  const std::size_t numbers = std::size_t{3} * push.vertex_count;
  for (std::size_t f = 0; f * numbers < relaxed.size(); ++f) {
    relax_part(mesh, weights[push.component_count * f + push.component], current.subspan(f * numbers, numbers), 0,
               relaxed.subspan(f * numbers, numbers));
  }
}

}  // namespace bodyopt::cpu
