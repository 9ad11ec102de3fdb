#include <algorithm>
#include <limits>
#include <vector>

#include "runtime/cpu/kernels.h"
#include "runtime/host/skin_tables.h"
#include "shaders/include/fold.h"

namespace bodyopt::cpu {
namespace {

using Vector = float[3];

// A box's spans along u, w and n, or those of all of some points.
struct Spans {
  float from[3], to[3];

  void add(const Spans& other) {
    for (std::size_t k = 0; k < 3; ++k) {
      from[k] = std::min(from[k], other.from[k]);
      to[k] = std::max(to[k], other.to[k]);
    }
  }
};

Spans spans_of(const Vector& middle, const Vector& half_edge, const BentFold& fold) {
  Spans spans;
  const Vector* axes[] = {&fold.u, &fold.w, &fold.n};
  for (std::size_t k = 0; k < 3; ++k) {
    float span[2];
    fold_span(middle, half_edge, *axes[k], span);
    spans.from[k] = span[0];
    spans.to[k] = span[1];
  }
  return spans;
}

// Finds the spans of boxes, from and to along each axis.
void find_spans(std::span<const float> boxes, std::span<float> found, BentFold& fold) {
  const std::size_t count = boxes.size() / 6;
  for (std::size_t box = 0; box < count; ++box) {
    Vector middle, half_edge;
    for (std::size_t i = 0; i < 3; ++i) {
      middle[i] = 0.5f * (boxes[6 * box + i] + boxes[6 * box + 3 + i]);
      half_edge[i] = 0.5f * (boxes[6 * box + 3 + i] - boxes[6 * box + i]);
    }
    const Spans spans = spans_of(middle, half_edge, fold);
    for (std::size_t k = 0; k < 3; ++k) {
      found[2 * count * k + box] = spans.from[k];
      found[count * (2 * k + 1) + box] = spans.to[k];
    }
  }
  for (std::size_t k = 0; k < 3; ++k) {
    fold.from[k] = found.subspan(2 * count * k, count);
    fold.to[k] = found.subspan(count * (2 * k + 1), count);
  }
}

// A step of one frame, as many vertices at a time as a device takes. What it leaves out has no part in what is found.
struct Movable {
  std::size_t vertex;
  float least = std::numeric_limits<float>::max();  // of all folds so far
  Vector way{};
};

struct Member {
  Movable* movable;
  Spans spans;
};

// A thread keeps its memory from part to part.
struct Scratch {
  std::vector<Movable> movable;
  std::vector<Member> members;       // of the fold that is looked at
  std::vector<std::uint32_t> boxes;  // that lines through members may meet
};

class Separation {
 public:
  Separation(const MeshTable& mesh, const FoldTables& tables, const OutputSeparatePush& push,
             const SeparateFrame& frame)
      : mesh_(mesh), tables_(tables), push_(push), frame_(frame), words_((push.fold_count + 31) / 32) {
    movable_.reserve(kWorkgroupSize);  // members point into it
  }

  // The vertices from `first` on, as many as moved holds. Did any move?
  bool separate(std::span<const BentFold> folds, std::size_t first, std::span<float> moved) {
    std::ranges::copy(frame_.current.subspan(3 * first, moved.size()), moved.begin());
    movable_.clear();
    for (std::size_t vertex = first; vertex < first + moved.size() / 3; ++vertex) {
      const float *own = &frame_.current[3 * vertex], *before = &frame_.posed[3 * vertex];
      if (push_.step == 0 || !std::equal(own, own + 3, before)) movable_.push_back({vertex});
    }
    for (const BentFold& fold : folds) look_at(fold);
    return move(first, moved);
  }

 private:
  static Scratch& scratch() {
    static thread_local Scratch own;
    return own;
  }

  void look_at(const BentFold& fold) {
    members_.clear();
    for (Movable& movable : movable_) {
      if (is_near(movable.vertex, fold.fold)) members_.push_back({&movable, point_spans(movable.vertex, fold)});
    }
    if (members_.empty()) return;
    Spans all = members_[0].spans;
    for (const Member& member : members_) all.add(member.spans);
    find_boxes(fold, all);
    for (const bool child : {false, true}) {
      if (!may_lie_between(fold, all, child)) continue;
      for (const Member& member : members_) {
        if (is_child(member.movable->vertex, fold.fold) != child) continue;
        if (may_lie_between(fold, member.spans, child)) look_at(fold, member, child);
      }
    }
  }

  bool move(std::size_t first, std::span<float> moved) const {
    bool moves = false;
    for (const Movable& movable : movable_) {
      if (movable.least == std::numeric_limits<float>::max()) continue;
      Vector own, before, to;
      std::copy_n(&frame_.current[3 * movable.vertex], 3, own);
      std::copy_n(&frame_.posed[3 * movable.vertex], 3, before);
      fold_step(movable.way, before, own, push_.limit, to);
      std::copy_n(to, 3, &moved[3 * (movable.vertex - first)]);
      moves = true;
    }
    return moves;
  }

  bool is_near(std::size_t vertex, std::uint32_t fold) const {
    return tables_.sides[2 * words_ * vertex + fold / 32] >> fold % 32 & 1u;
  }
  bool is_child(std::size_t vertex, std::uint32_t fold) const {
    return tables_.sides[2 * words_ * vertex + words_ + fold / 32] >> fold % 32 & 1u;
  }
  // Is some of a box's skin of the side that is not the child's, or the parent's?
  bool has_other(std::size_t box, std::uint32_t fold, bool child) const {
    const std::size_t at = 2 * words_ * (push_.vertex_count + box) + (child ? 0 : words_);
    return tables_.sides[at + fold / 32] >> fold % 32 & 1u;
  }

  Spans point_spans(std::size_t vertex, const BentFold& fold) const {
    Vector point;
    std::copy_n(&frame_.current[3 * vertex], 3, point);
    return spans_of(point, {0, 0, 0}, fold);
  }

  static bool meets(const BentFold& fold, std::size_t box, const Spans& spans) {
    // No branches: none could be predicted.
    const int along_first = int{fold.from[0][box] <= spans.to[0]} & int{fold.to[0][box] >= spans.from[0]};
    const int along_second = int{fold.from[1][box] <= spans.to[1]} & int{fold.to[1][box] >= spans.from[1]};
    return along_first & along_second;
  }

  void find_boxes(const BentFold& fold, const Spans& spans) {
    boxes_.clear();
    const std::uint32_t small = small_box_count(push_.triangle_count);
    for (std::uint32_t large = 0; small + large < push_.box_count; ++large) {
      if (!meets(fold, small + large, spans)) continue;
      const std::uint32_t end = std::min(kLargeBox * (large + 1), small);
      for (std::uint32_t box = kLargeBox * large; box < end; ++box) {
        if (meets(fold, box, spans)) boxes_.push_back(box);
      }
    }
  }

  // Is there skin of the other side above and below?
  bool may_lie_between(const BentFold& fold, const Spans& spans, bool child) const {
    bool above = false, below = false;
    for (const std::uint32_t box : boxes_) {
      if (!has_other(box, fold.fold, child) || !meets(fold, box, spans)) continue;
      above = above || fold.to[2][box] >= spans.from[2];
      below = below || fold.from[2][box] <= spans.to[2];
      if (above && below) return true;
    }
    return false;
  }

  void look_at(const BentFold& fold, const Member& member, bool child) {
    Vector normal;
    vertex_normal(mesh_, frame_.posed, member.movable->vertex, normal);
    const float facing = dot_product(normal, fold.n), squared = dot_product(fold.n, fold.n);
    if (!(child ? facing < 0 : facing > 0)) return;
    const float depth = depth_of(fold, member, normal, child, kFoldOffset * facing), size = std::sqrt(squared);
    Movable& movable = *member.movable;
    if (!(depth > 0) || !(depth / size < movable.least)) return;
    movable.least = depth / size;
    const float share = (child ? 0.5f : -0.5f) * std::min(size, 1.0f) * depth / squared;
    for (std::size_t i = 0; i < 3; ++i) movable.way[i] = share * fold.n[i];
  }

  float depth_of(const BentFold& fold, const Member& member, const Vector& normal, bool child, float offset) const {
    Vector point;
    for (std::size_t i = 0; i < 3; ++i) {
      point[i] = frame_.current[3 * member.movable->vertex + i] + kFoldOffset * normal[i];
    }
    constexpr float kFar = std::numeric_limits<float>::max();
    float found[8] = {0, 0, 0, 0, kFar, -kFar, kFar, -kFar};
    const auto add_boxes = [&](bool with_other) {
      for (const std::uint32_t box : boxes_) {
        if (has_other(box, fold.fold, child) == with_other && meets(fold, box, member.spans)) {
          add_box(box, point, fold, child, found);
        }
      }
    };
    add_boxes(true);
    if (!(std::min(found[kFoldOtherAbove], found[kFoldOtherBelow]) > 0)) return 0;
    add_boxes(false);
    return fold_depth(found, child, offset);
  }

  void add_box(std::size_t box, const Vector& point, const BentFold& fold, bool child, float (&found)[8]) const {
    const std::size_t end = std::min<std::size_t>(kBoxTriangles * (box + 1), push_.triangle_count);
    for (std::size_t t = kBoxTriangles * box; t < end; ++t) {
      const std::uint32_t* vertices = &tables_.triangles[3 * t];
      Vector corners[3];
      for (std::size_t k = 0; k < 3; ++k) {
        for (std::size_t i = 0; i < 3; ++i) corners[k][i] = frame_.current[3 * std::size_t{vertices[k]} + i] - point[i];
      }
      if (is_beside_fold_line(corners[0], corners[1], corners[2], fold.w)) continue;
      const bool other = std::any_of(vertices, vertices + 3,
                                     [&](std::uint32_t vertex) { return is_child(vertex, fold.fold) != child; });
      const bool near =
          std::any_of(vertices, vertices + 3, [&](std::uint32_t vertex) { return is_near(vertex, fold.fold); });
      add_fold_triangle(corners[0], corners[1], corners[2], fold.n, fold.u, fold.w, other, near, found);
    }
  }

  const MeshTable& mesh_;
  const FoldTables& tables_;
  const OutputSeparatePush& push_;
  const SeparateFrame& frame_;
  const std::size_t words_;
  std::vector<Movable>& movable_ = scratch().movable;
  std::vector<Member>& members_ = scratch().members;
  std::vector<std::uint32_t>& boxes_ = scratch().boxes;
};

}  // namespace

void BentFolds::find(const OutputSeparatePush& push, std::span<const float> weights, std::span<const float> boxes) {
  folds_.clear();
  for (std::uint32_t k = 0; k < push.fold_count; ++k) {
    BentFold fold;
    fold.fold = k;
    std::copy_n(&weights[push.component + 3 * std::size_t{k}], 3, fold.n);
    if (!(dot_product(fold.n, fold.n) > 0)) continue;
    fold_axes(fold.n, fold.u, fold.w);
    folds_.push_back(fold);
  }
  const std::size_t count = boxes.size() / 6;
  spans_.resize(6 * count * folds_.size());
  for (std::size_t k = 0; k < folds_.size(); ++k) {
    find_spans(boxes, std::span(spans_).subspan(6 * count * k, 6 * count), folds_[k]);
  }
}

bool separate_part(const MeshTable& mesh, const FoldTables& tables, const OutputSeparatePush& push,
                   std::span<const BentFold> folds, const SeparateFrame& frame, std::size_t first_vertex,
                   std::span<float> moved) {
  Separation separation(mesh, tables, push, frame);
  bool moves = false;
  for (std::size_t at = 0; at < moved.size(); at += std::size_t{3} * kWorkgroupSize) {
    const std::span<float> some = moved.subspan(at, std::min(moved.size() - at, std::size_t{3} * kWorkgroupSize));
    moves = separation.separate(folds, first_vertex + at / 3, some) || moves;
  }
  return moves;
}

void output_separate(const MeshTable& mesh, const FoldTables& tables, const OutputSeparatePush& push,
                     std::span<const float> boxes, std::span<const float> weights, const SeparateFrame& batch,
                     std::span<float> moved) {
  const std::size_t numbers = std::size_t{3} * push.vertex_count, box_numbers = std::size_t{6} * push.box_count;
  BentFolds folds;
  for (std::size_t f = 0; f * numbers < moved.size(); ++f) {
    folds.find(push, weights.subspan(f * push.component_count, push.component_count),
               boxes.subspan(f * box_numbers, box_numbers));
    separate_part(mesh, tables, push, folds.all(),
                  {batch.posed.subspan(f * numbers, numbers), batch.current.subspan(f * numbers, numbers)}, 0,
                  moved.subspan(f * numbers, numbers));
  }
}

}  // namespace bodyopt::cpu
