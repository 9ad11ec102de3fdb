// Strains on skin that no muscle lies under.
#include <gtest/gtest.h>

#include <set>

#include "geometry/mesh.h"
#include "runtime/core/error.h"
#include "runtime/deformer/deformer.h"
#include "runtime/host/device_choice.h"
#include "tests/support/capsule_limb.h"
#include "tests/support/trained_basis.h"
#include "trainer/train/features/features.h"
#include "trainer/train/fit/choose_map.h"
#include "trainer/train/fit/train.h"
#include "trainer/train/judge/test_errors.h"
#include "trainer/train/skinning/ddm.h"
#include "trainer/train/skinning/unpose.h"

namespace bodyopt::trainer {
namespace {

const SampleSet& without_muscles() {
  static const SampleSet set = [] {
    SampleSet limb = limb_samples(160, 60);
    limb.muscles.clear();
    return limb;
  }();
  return set;
}

const std::vector<Muscle>& curves() {
  static const std::vector<Muscle> made = surface_curves(without_muscles(), {.surface_curves = 6});
  return made;
}

double distance(const Vec3& a, const Vec3& b) { return length(a - b); }

// The limb's muscles bulge at 0.18 m, 0.08 wide, in front and behind.
TEST(SurfaceCurves, BeginWhereTheSkinMovesMost) {
  ASSERT_GE(curves().size(), 4u);
  for (std::size_t k = 0; k < 4; ++k) {
    const Vec3& middle = curves()[k].path[2].position;
    EXPECT_NEAR(middle[2], 0.18, 0.1) << curves()[k].name;
    EXPECT_GT(std::abs(middle[1]), 0.5 * kLimbRadius) << curves()[k].name;
  }
}

TEST(SurfaceCurves, LieOnTheSkinAlongAndAcrossTheBone) {
  const Character& character = without_muscles().character;
  const double length = 0.11 * longest_extent(character.vertices);
  std::set<std::string> names;
  for (const Muscle& curve : curves()) {
    names.insert(curve.name);
    ASSERT_EQ(curve.path.size(), 5u);
    EXPECT_EQ(curve.fibre_count, 1);
    for (const MusclePoint& point : curve.path) {
      const double radius = std::hypot(point.position[0], point.position[1]);
      EXPECT_LE(radius, kLimbRadius * 1.0001);
    }
    const Vec3 span = curve.path[4].position - curve.path[0].position;
    if (std::abs(curve.path[2].position[2] - 0.3) > 0.2) continue;  // at the caps the skin turns
    if (curve.name.ends_with("along")) {
      EXPECT_NEAR(std::abs(span[2]), length, 0.1 * length) << curve.name;
    } else {
      EXPECT_NEAR(span[2], 0, 0.1 * length) << curve.name;
      EXPECT_GT(bodyopt::length(span), 0.3 * length) << curve.name;
    }
  }
  EXPECT_EQ(names.size(), curves().size());
}

TEST(SurfaceCurves, AreApart) {
  for (std::size_t a = 0; a < curves().size(); a += 2) {
    EXPECT_EQ(distance(curves()[a].path[2].position, curves()[a + 1].path[2].position), 0);
    for (std::size_t b = 0; b < a; b += 2) {
      EXPECT_GT(distance(curves()[a].path[2].position, curves()[b].path[2].position), 0.01);
    }
  }
}

// A skin that swells as it is drawn together over the elbow, whatever draws it.
const Muscle kHidden{"hidden", {{0, {0, kLimbRadius, 0.25}}, {1, {0, kLimbRadius, 0.35}}}, 0, 1, 1};

SampleSet swelling_limb() {
  SampleSet set = without_muscles();
  Basis basis = build_ddm_basis(set.character, {});
  basis.strain = make_strain_table(basis, {kHidden});
  for (std::vector<Sample>* samples : {&set.train, &set.heldout}) {
    for (Sample& sample : *samples) {
      const double strain = measure_strains(basis, sample.pose)[0];
      Character swollen = set.character;
      for (Eigen::Index v = 0; v < swollen.vertices.rows(); ++v) {
        const Eigen::RowVector3d p = set.character.vertices.row(v);
        const double along = (p.z() - 0.3) / 0.05, side = std::max(0.0, p.y() / kLimbRadius);
        swollen.vertices(v, 1) += 0.03 * std::pow(strain, 2) * side * std::exp(-along * along);
      }
      sample.shape = skin_linear(swollen, sample.pose);
    }
  }
  return set;
}

TEST(SurfaceCurves, TellWhatMusclesWouldHave) {
  const SampleSet set = swelling_limb();
  const auto rms = [&](int count) {
    Deformer deformer(trained_basis(set, {.components = 8, .method = {.kernels = false}, .surface_curves = count}),
                      {.name = "cpu"});
    return heldout_errors(set.heldout, heldout_by_basis(set, deformer)).rms;
  };
  const double before = rms(0), after = rms(6);
  RecordProperty("mm", std::to_string(before) + " without, " + std::to_string(after) + " with");
  EXPECT_LT(after, 0.7 * before);
}

// Of few frames: of many the joints tell it, too.
TEST(SurfaceCurves, StrainsTellMoreThanJoints) {
  SampleSet set = swelling_limb();
  set.muscles = {kHidden};
  set.train.resize(40);
  const auto rms = [&](bool strains) {
    Deformer deformer(trained_basis(set, {.components = 8, .centres = 40, .method = {.strains = strains}}),
                      {.name = "cpu"});
    return heldout_errors(set.heldout, heldout_by_basis(set, deformer)).rms;
  };
  const double joints = rms(false), strains = rms(true);
  RecordProperty("mm", std::to_string(joints) + " joints, " + std::to_string(strains) + " strains");
  EXPECT_LT(strains, 0.9 * joints);
}

TEST(SurfaceCurves, NeedFrames) {
  SampleSet none = without_muscles();
  none.train.clear();
  EXPECT_THROW(surface_curves(none, {.surface_curves = 2}), Error);
}

// Shapes that joints do not explain, and shapes of which Direct Delta Mush leaves nothing to explain.
TEST(SurfaceCurves, AreNeededWhereJointsDoNotTellTheMotion) {
  SampleSet set = without_muscles();
  Deformer bare(build_ddm_basis(set.character, {}), {.name = "cpu"});
  std::vector<Sample> frames = set.train;
  std::swap(frames, set.heldout);
  const std::vector<Positions> skinned = heldout_by_basis(set, bare);
  for (std::size_t k = 0; k < set.train.size(); ++k) set.train[k].shape = skinned[k];
  EXPECT_EQ(needed_surface_curves(set, {.smoothing_radius = default_smoothing_radius(set.character.vertices)}), 0);
  for (std::size_t k = 0; k < set.train.size(); ++k) {
    Positions breathing = skinned[k];
    breathing.rowwise() += Eigen::RowVector3d(0.02 * std::sin(static_cast<double>(k * k)), 0, 0);
    set.train[k].shape = breathing;
  }
  EXPECT_EQ(needed_surface_curves(set, {}), 40);
  set.muscles = {kHidden};
  EXPECT_EQ(needed_surface_curves(set, {}), 0);
}

}  // namespace
}  // namespace bodyopt::trainer
