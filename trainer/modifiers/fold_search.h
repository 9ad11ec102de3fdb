// Which skin may come to lie in which, of poses that fold it.
#pragma once

#include <map>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "geometry/skin_in_skin.h"
#include "trainer/modifiers/bake_modifier.h"
#include "trainer/modifiers/fold_poses.h"
#include "trainer/modifiers/shown_skin.h"

namespace bodyopt {

class FoldSearch {
 public:
  // The basis must outlive it.
  explicit FoldSearch(const Basis& basis);

  // Bends of one joint after the other, all around.
  void bend_all();
  // Any poses: each fold is that of the joint that bends most between its two sides.
  void look(const std::vector<Pose>& poses);

  // What runtime/modifiers/drive_push_out.cpp expects, without what would move skin that had crossed nothing in the
  // poses that were looked at.
  BakedModifier baked();

 private:
  using Way = std::pair<std::uint32_t, std::size_t>;  // a joint, and the number of its direction
  struct Partners {
    double deepest = 0;  // metres
    std::set<std::uint32_t> triangles;
  };
  struct Fold {
    Vec3 axis{};
    double least_bend = 10;  // radians: in which skin lay in skin
    std::map<std::uint32_t, Partners> vertices;
  };
  struct Looked {
    std::vector<Pose> poses;
    std::vector<std::set<std::uint32_t>> buried;  // vertices of each
  };

  void look(const std::vector<Pose>& poses, const std::vector<std::uint32_t>& searched,
            const std::optional<FoldDirection>& direction);
  Fold* fold_of(const FoldDirection& direction, const std::vector<Vec3>& bends);
  FoldDirection bent_most(const std::vector<Vec3>& bends, const BuriedVertex& buried) const;
  void add(const std::vector<BuriedVertex>& found, const Pose& pose, const Positions& skin,
           const std::vector<std::uint32_t>& searched, const std::optional<FoldDirection>& direction);
  void prune(const Looked& looked, const Basis& pushed);
  void prune(std::uint32_t vertex, const Positions& skin, const std::vector<float>& weights, const FoldTable& table);
  template <typename Visit>
  void around(std::uint32_t vertex, const Visit& visit) const;  // visit(t) of the triangles around a vertex
  FoldVertex ring_of(std::uint32_t vertex) const;               // its first_list is 0
  BakedModifier tables() const;

  const Basis& basis_;
  const Triangles triangles_;
  ShownSkin shown_;
  std::vector<char> kept_;     // V: passes through other skin as it was modelled
  Eigen::VectorXd thickness_;  // V: of the body behind the skin, metres
  std::map<Way, Fold> folds_;
  std::vector<Looked> looked_;
};

}  // namespace bodyopt
