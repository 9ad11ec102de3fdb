#include <algorithm>

#include "runtime/cpu/kernels.h"
#include "shaders/include/fold.h"

namespace bodyopt::cpu {
namespace {

using Point = float[3];

const Point& point(std::span<const float> positions, std::size_t vertex) {
  return *reinterpret_cast<const Point*>(positions.data() + 3 * vertex);
}

void way_between(const Point& from, const Point& to, Point& way) {
  for (std::size_t i = 0; i < 3; ++i) way[i] = to[i] - from[i];
}

// Twice the area of the polygon around a vertex long.
void ring_normal(std::span<const float> current, const FoldVertex& fold, const Point& own, Point& normal) {
  std::fill_n(normal, 3, 0.0f);
  Point last, next;
  way_between(own, point(current, fold.ring[kFoldRing - 1]), last);
  for (const std::uint32_t vertex : fold.ring) {
    way_between(own, point(current, vertex), next);
    add_fold_cross(last, next, normal);
    std::copy_n(next, 3, last);
  }
}

// The pull of one triangle on a vertex and its normal.
void add_pull(std::span<const float> current, const std::uint32_t* triangle, const Point& own, const Point& normal,
              float reach, float (&pull)[4]) {
  Point corners[3];
  for (std::size_t c = 0; c < 3; ++c) way_between(own, point(current, triangle[c]), corners[c]);
  add_fold_pull(normal, corners[0], corners[1], corners[2], reach, pull);
}

}  // namespace

void separate_part(const MeshTable& mesh, const FoldTable& folds, const OutputSeparatePush& push,
                   std::span<const float> weights, std::span<const float> posed, std::span<const float> current,
                   std::size_t first_vertex, std::span<float> separated) {
  for (std::size_t at = 0; at < separated.size(); at += 3) {
    const std::size_t vertex = first_vertex + at / 3;
    const Point& own = point(current, vertex);
    float shown = 0, reach = 0, pull[4] = {};
    const FoldVertex& fold = folds.vertices[vertex];
    Point normal;
    ring_normal(current, fold, own, normal);
    for (std::uint32_t l = fold.first_list; l < folds.vertices[vertex + 1].first_list; ++l) {
      const FoldList& list = folds.lists[l];
      const float weight = weights[list.component];
      if (!(weight > 0)) continue;
      shown = std::max(shown, std::min(weight, 1.0f));
      reach = std::max(reach, list.reach);
      for (std::uint32_t k = list.first; k < folds.lists[l + 1].first; ++k) {
        add_pull(current, &mesh.triangles[std::size_t{3} * folds.triangles[k]], own, normal, list.reach, pull);
      }
    }
    Point moved;
    fold_step(pull, point(posed, vertex), own, reach, push.last == 1 ? shown : -1.0f, moved);
    std::copy_n(moved, 3, &separated[at]);
  }
}

void output_separate(const MeshTable& mesh, const FoldTable& folds, const OutputSeparatePush& push,
                     std::span<const float> weights, std::span<const float> posed, std::span<const float> current,
                     std::span<float> separated) {
  const std::size_t numbers = std::size_t{3} * push.vertex_count;
  for (std::size_t f = 0; f * numbers < separated.size(); ++f) {
    separate_part(mesh, folds, push, weights.subspan(f * push.component_count, push.component_count),
                  posed.subspan(f * numbers, numbers), current.subspan(f * numbers, numbers), 0,
                  separated.subspan(f * numbers, numbers));
  }
}

}  // namespace bodyopt::cpu
