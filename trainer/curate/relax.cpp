// relax: evens out how vertices have slid along the skin, and leaves how far they stand off it.
#include "geometry/laplacian.h"
#include "geometry/vertex_normals.h"
#include "trainer/curate/hash_of.h"
#include "trainer/curate/modifier_type.h"

namespace bodyopt {
namespace {

class Relax : public ShapeModifier {
 public:
  Relax(const Character& character, double radius)
      : radius_(radius),
        smoother_(character.vertices, character.triangles, radius),
        normals_(vertex_normals(character.vertices, character.triangles).rowwise().normalized()) {}

  std::optional<std::uint64_t> cause(std::size_t) const override { return hash_of(radius_); }

  void apply(const FrameInHand&, Positions& offsets) const override {
    const Positions change = smoother_(offsets) - offsets;
    const Eigen::VectorXd off_skin = change.cwiseProduct(normals_).rowwise().sum();
    offsets += change - Positions(off_skin.asDiagonal() * normals_);
  }

 private:
  double radius_;  // metres
  SkinSmoother smoother_;
  Positions normals_;  // V x 3, at rest, unit or zero
};

}  // namespace

std::unique_ptr<ShapeModifier> prepare_relax(const ModifierInput& input) {
  return std::make_unique<Relax>(input.database.character, 1e-3 * parameter(input, "radius_mm", 10, 0.01, 1000));
}

}  // namespace bodyopt
