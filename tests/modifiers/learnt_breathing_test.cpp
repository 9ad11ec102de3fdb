// A breath that is known, and learnt of the take it was put into.
#include <gtest/gtest.h>

#include <fstream>

#include "assets/caches/pc2.h"
#include "assets/clips/clip.h"
#include "dataset/dataset.h"
#include "dataset/modifier.h"
#include "geometry/mesh.h"
#include "runtime/modifiers/drive_modifiers.h"
#include "tests/support/capsule_limb.h"
#include "tests/support/error_kind.h"
#include "tests/support/temporary_folder.h"
#include "trainer/modifiers/bake_modifier.h"
#include "trainer/modifiers/bake_stack.h"
#include "trainer/modifiers/measure_modifiers.h"
#include "trainer/train/skinning/ddm.h"

namespace bodyopt::testing {
namespace learnt_breathing_test {

using namespace trainer;

constexpr int kFrames = 48;  // two breaths: a third in, the rest out
constexpr double kGirth = 0.02;

double known_filled(int frame) {
  const int phase = frame % 24;
  return phase < 8 ? phase / 8.0 : 1 - (phase - 8) / 16.0;
}
bool known_in(int frame) { return frame % 24 < 8; }

// The limb's girth grows, and its skin slides up on the way in, and down on the way out.
Positions known_breath(const Positions& rest, double filled, bool comes_in) {
  Positions offset = Positions::Zero(rest.rows(), 3);
  for (Eigen::Index v = 0; v < rest.rows(); ++v) {
    const double there = std::exp(-std::pow((rest(v, 2) - 0.2) / 0.06, 2));
    offset.row(v).head<2>() = kGirth * filled * there * rest.row(v).head<2>();
    offset(v, 2) = (comes_in ? 2e-3 : -1e-3) * there * (1 - std::abs(2 * filled - 1));
  }
  return offset;
}

// A dataset whose limb breathes, in its bind pose.
class BreathingLimb {
 public:
  explicit BreathingLimb(int frames) {
    Character character = limb_character();
    write_character(character, folder_ / "limb.glb");
    Dataset dataset;
    dataset.folder = folder_.path();
    dataset.character = "limb.glb";
    DatasetTake take;
    take.name = "breathing";
    take.clip = "still.glb";
    take.shapes = "breathing.pc2";
    Clip clip;
    clip.name = "still";
    Pc2Writer writer(folder_ / take.shapes, character.output_count(), static_cast<std::uint32_t>(frames));
    for (int f = 0; f < frames; ++f) {
      take.frames.push_back(f + 1);
      clip.poses.push_back(bind_pose(character.skeleton));
      const Positions skin = character.vertices + known_breath(character.vertices, known_filled(f), known_in(f));
      writer.append(output_from_welded(character, skin));
    }
    writer.close();
    write_clip(clip, character.skeleton, folder_ / take.clip);
    dataset.takes.push_back(take);
    write_dataset(dataset, folder_ / "dataset.json");
  }

  Basis learnt(const std::string& take = "breathing") const {
    std::ofstream(folder_ / "stack.json") << R"({"schema": "bodyopt-modifiers-1", "modifiers": [
      {"name": "breath", "type": "breathing", "dataset": "dataset.json", "controls": {"irregularity": 0}, "take": ")"
                                          << take << "\"}]}";
    Basis basis = build_ddm_basis(limb_character(), {});
    std::vector<std::string> notes;
    basis.modifiers = bake_stack(folder_ / "stack.json", basis, notes);
    validate(basis, "the test's basis");
    return basis;
  }

 private:
  TemporaryFolder folder_;
};

// Where in a breath a pose is, by its weights: those of the full breath and of the quarters on either way.
struct Place {
  explicit Place(const Pose& pose) {
    const auto weight = [&](std::size_t k) { return static_cast<double>(pose.modifiers.at(k)); };
    const double in = 0.25 * weight(1) + 0.5 * weight(2) + 0.75 * weight(3);
    const double out = 0.25 * weight(4) + 0.5 * weight(5) + 0.75 * weight(6);
    filled = weight(0) + in + out;
    comes_in = in > 0;
  }
  double filled;
  bool comes_in;
};

TEST(LearntBreathing, IsThatOfTheTake) {
  const Basis basis = BreathingLimb(kFrames).learnt();
  const Positions rest = rows_of(basis.mesh.rest);
  std::vector<Pose> poses(100, bind_pose(basis.skeleton));
  drive_modifiers(basis, {}, 24, poses);
  const std::vector<Positions> shown = EvaluatedSkin(basis)(poses);
  const double size = known_breath(rest, 1, true).rowwise().norm().maxCoeff();
  ASSERT_GT(size, 5e-4);
  double fullest = 0, ways[2] = {0, 0};
  for (std::size_t f = 0; f < poses.size(); ++f) {
    const Place place(poses[f]);
    const Positions expected = known_breath(rest, place.filled, place.comes_in);
    EXPECT_LT((shown[f] - rest - expected).rowwise().norm().maxCoeff(), 0.06 * size) << "frame " << f;
    fullest = std::max(fullest, place.filled);
    ways[place.comes_in ? 0 : 1] = std::max(ways[place.comes_in ? 0 : 1], 1 - std::abs(2 * place.filled - 1));
  }
  EXPECT_NEAR(fullest, 1, 0.01);
  EXPECT_GT(ways[0], 0.8);
  EXPECT_GT(ways[1], 0.8);
}

TEST(LearntBreathing, GoesDeeperAndSwitchesOff) {
  Basis basis = BreathingLimb(kFrames).learnt();
  std::vector<Pose> usual(60, bind_pose(basis.skeleton)), deep = usual, off = usual;
  drive_modifiers(basis, {}, 24, usual);
  basis.modifiers.stack[0].constants["depth"] = 1.2f;
  drive_modifiers(basis, {}, 24, deep);
  basis.modifiers.stack[0].constants["strength"] = 0;
  drive_modifiers(basis, {}, 24, off);
  for (std::size_t f = 0; f < 60; ++f) {
    for (std::size_t k = 0; k < 7; ++k) {
      EXPECT_NEAR(deep[f].modifiers[k], 2 * usual[f].modifiers[k], 1e-6);
      EXPECT_EQ(off[f].modifiers[k], 0);
    }
  }
}

TEST(LearntBreathing, RefusesWhatIsNoBreath) {
  EXPECT_EQ(kind_of([] { BreathingLimb(1).learnt(); }), ErrorKind::mismatch);   // gains nothing
  EXPECT_EQ(kind_of([] { BreathingLimb(10).learnt(); }), ErrorKind::mismatch);  // in only
  EXPECT_EQ(kind_of([] { BreathingLimb(kFrames).learnt("other"); }), ErrorKind::file);
}

}  // namespace learnt_breathing_test
}  // namespace bodyopt::testing
