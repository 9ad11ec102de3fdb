#include <algorithm>
#include <limits>

#include "runtime/cpu/kernels.h"
#include "shaders/include/fold.h"

namespace bodyopt::cpu {
namespace {

using Vector = float[3];

// One frame of a step.
class Separation {
 public:
  Separation(const MeshTable& mesh, std::span<const std::uint32_t> sides, const OutputSeparatePush& push,
             const SeparateFrame& frame)
      : mesh_(mesh), sides_(sides), push_(push), frame_(frame), words_((push.fold_count + 31) / 32) {}

  void move(std::size_t vertex, float* moved) const {
    Vector own, before, way{};
    std::copy_n(&frame_.current[3 * vertex], 3, own);
    std::copy_n(&frame_.posed[3 * vertex], 3, before);
    std::copy_n(own, 3, moved);
    if (push_.step > 0 && std::equal(own, own + 3, before)) return;
    if (!find_way(vertex, way)) return;
    Vector to;
    fold_step(way, before, own, push_.limit, to);
    std::copy_n(to, 3, moved);
  }

 private:
  bool is_near(std::size_t vertex, std::uint32_t fold) const {
    return sides_[2 * words_ * vertex + fold / 32] >> fold % 32 & 1u;
  }
  bool is_child(std::size_t vertex, std::uint32_t fold) const {
    return sides_[2 * words_ * vertex + words_ + fold / 32] >> fold % 32 & 1u;
  }

  // The shortest of all folds; false where the vertex has crossed nothing.
  bool find_way(std::size_t vertex, Vector& way) const {
    float least = std::numeric_limits<float>::max();
    Vector normal;
    std::copy_n(&frame_.normals[3 * vertex], 3, normal);
    for (std::uint32_t fold = 0; fold < push_.fold_count; ++fold) {
      if (!is_near(vertex, fold)) continue;
      Vector n;
      std::copy_n(&frame_.weights[push_.component + 3 * std::size_t{fold}], 3, n);
      const bool child = is_child(vertex, fold);
      const float facing = dot_product(normal, n), squared = dot_product(n, n);
      if (!(squared > 0) || !(child ? facing < 0 : facing > 0)) continue;
      const float depth = depth_of(vertex, fold, n, normal, child, kFoldOffset * facing), size = std::sqrt(squared);
      if (!(depth > 0) || !(depth / size < least)) continue;
      least = depth / size;
      const float share = (child ? 0.5f : -0.5f) * std::min(size, 1.0f) * depth / squared;
      for (std::size_t i = 0; i < 3; ++i) way[i] = share * n[i];
    }
    return least < std::numeric_limits<float>::max();
  }

  float depth_of(std::size_t vertex, std::uint32_t fold, const Vector& n, const Vector& normal, bool child,
                 float offset) const {
    Vector point, u, w;
    for (std::size_t i = 0; i < 3; ++i) point[i] = frame_.current[3 * vertex + i] + kFoldOffset * normal[i];
    fold_axes(n, u, w);
    float found[6] = {0, 0, 0, 0, std::numeric_limits<float>::max(), -std::numeric_limits<float>::max()};
    for (std::size_t box = 0; box < push_.box_count; ++box) {
      Vector middle, half_edge;
      const float* bounds = &frame_.boxes[6 * box];
      for (std::size_t i = 0; i < 3; ++i) {
        middle[i] = 0.5f * (bounds[i] + bounds[3 + i]) - point[i];
        half_edge[i] = 0.5f * (bounds[3 + i] - bounds[i]);
      }
      if (fold_passes_by(middle, half_edge, u) || fold_passes_by(middle, half_edge, w)) continue;
      add_box(box, point, n, u, w, fold, child, found);
    }
    return fold_depth(found, child, offset);
  }

  void add_box(std::size_t box, const Vector& point, const Vector& n, const Vector& u, const Vector& w,
               std::uint32_t fold, bool child, float (&found)[6]) const {
    const std::size_t end = std::min<std::size_t>(kBoxTriangles * (box + 1), push_.triangle_count);
    for (std::size_t t = kBoxTriangles * box; t < end; ++t) {
      Vector corners[3];
      bool other = false;
      for (std::size_t k = 0; k < 3; ++k) {
        const std::size_t vertex = mesh_.triangles[3 * t + k];
        other = other || is_child(vertex, fold) != child;
        for (std::size_t i = 0; i < 3; ++i) corners[k][i] = frame_.current[3 * vertex + i] - point[i];
      }
      add_fold_triangle(corners[0], corners[1], corners[2], n, u, w, other, found);
    }
  }

  const MeshTable& mesh_;
  const std::span<const std::uint32_t> sides_;
  const OutputSeparatePush& push_;
  const SeparateFrame& frame_;
  const std::size_t words_;
};

}  // namespace

void separate_part(const MeshTable& mesh, std::span<const std::uint32_t> sides, const OutputSeparatePush& push,
                   const SeparateFrame& frame, std::size_t first_vertex, std::span<float> moved) {
  const Separation separation(mesh, sides, push, frame);
  for (std::size_t at = 0; at < moved.size(); at += 3) separation.move(first_vertex + at / 3, &moved[at]);
}

void output_separate(const MeshTable& mesh, std::span<const std::uint32_t> sides, const OutputSeparatePush& push,
                     const SeparateFrame& batch, std::span<float> moved) {
  const std::size_t numbers = std::size_t{3} * push.vertex_count, boxes = std::size_t{6} * push.box_count;
  for (std::size_t f = 0; f * numbers < moved.size(); ++f) {
    const SeparateFrame frame = {batch.boxes.subspan(f * boxes, boxes),
                                 batch.weights.subspan(f * push.component_count, push.component_count),
                                 batch.normals.subspan(f * numbers, numbers), batch.posed.subspan(f * numbers, numbers),
                                 batch.current.subspan(f * numbers, numbers)};
    separate_part(mesh, sides, push, frame, 0, moved.subspan(f * numbers, numbers));
  }
}

}  // namespace bodyopt::cpu
