// A dataset of the capsule limb: its elbow swept to and fro, shapes with a bulge that grows with the angle.
#pragma once

#include <array>
#include <functional>
#include <numbers>

#include "assets/caches/pc2.h"
#include "assets/clips/clip.h"
#include "dataset/dataset.h"
#include "tests/support/capsule_limb.h"
#include "tests/support/temporary_folder.h"
#include "trainer/curate/edit_stack.h"
#include "trainer/curate/shape_stack.h"

namespace bodyopt {

constexpr double kDegree = std::numbers::pi / 180;
constexpr int kSweepFrames = 41;  // to 120 degrees and back, in steps of 6

inline double sweep_angle(int frame) { return 6.0 * (frame <= 21 ? frame - 1 : kSweepFrames - frame); }

// A bulge of 10 mm at the outer side of the elbow.
inline Positions bulge(const Character& character) {
  Positions offsets = Positions::Zero(character.vertices.rows(), 3);
  for (Eigen::Index v = 0; v < offsets.rows(); ++v) {
    const double along = (character.vertices(v, 2) - 0.3) / 0.03, side = character.vertices(v, 1) / kLimbRadius;
    if (side > 0) offsets(v, 1) = 0.01 * side * side * std::exp(-along * along);
  }
  return offsets;
}

class CuratedLimb {
 public:
  // `change`: what is added to the true shape (V x 3, posed) of take 0 or 1 in a frame from 1 on. `twist`: of a take's
  // forearm where the elbow is bent by a right angle, degrees.
  explicit CuratedLimb(
      const std::function<Positions(int take, int frame, const Positions& truth)>& change =
          [](int, int, const Positions& truth) { return truth; },
      std::array<double, 2> twist = {0, 0})
      : twist_(twist) {
    write_character(character_, folder_ / "limb.glb");
    dataset_.folder = folder_.path();
    dataset_.character = "limb.glb";
    for (int take = 0; take < 2; ++take) add_take(take, change);
    write_dataset(dataset_, path());
  }

  std::filesystem::path path() const { return folder_ / "dataset.json"; }
  std::filesystem::path folder() const { return folder_.path(); }
  const Character& character() const { return character_; }
  Pose pose(int take, int frame) const {
    const double bent = kDegree * sweep_angle(frame), twist = twist_[static_cast<std::size_t>(take)];
    return limb_pose(character_.skeleton, bent, kDegree * twist * std::sin(bent), twist == 0 ? 0.02 * take : 0);
  }
  Positions truth(int take, int frame) const { return limb_truth(character_, limb_muscles(), pose(take, frame)); }
  trainer::ShapeStack stack() const { return trainer::ShapeStack(trainer::read_pose_database(read_dataset(path()))); }

 private:
  void add_take(int take, const std::function<Positions(int, int, const Positions&)>& change) {
    DatasetTake there;
    there.name = take == 0 ? "one" : "two";
    there.clip = there.name + ".glb";
    there.shapes = there.name + ".pc2";
    Clip clip;
    clip.name = there.name;
    Pc2Writer writer(folder_ / there.shapes, character_.output_count(), kSweepFrames);
    for (int frame = 1; frame <= kSweepFrames; ++frame) {
      there.frames.push_back(frame);
      clip.poses.push_back(pose(take, frame));
      writer.append(output_from_welded(character_, change(take, frame, truth(take, frame))));
    }
    writer.close();
    write_clip(clip, character_.skeleton, folder_ / there.clip);
    dataset_.takes.push_back(there);
  }

  std::array<double, 2> twist_;
  TemporaryFolder folder_;
  Character character_ = limb_character();
  Dataset dataset_;
};

// A mesh of a frame as it is now becomes its sculpt.
inline std::vector<std::string> sculpt_frame(const CuratedLimb& limb, const std::string& name, const std::string& take,
                                             int frame, const std::vector<float>& mesh, bool unposed, double spread) {
  const trainer::ShapeStack stack = limb.stack();
  const trainer::ExportedFrame now = trainer::exported_now(stack, stack.database().find(take, frame, "the test"));
  return trainer::add_sculpt(limb.path(), name, take, frame, now, mesh, unposed, spread);
}

// Root mean square distance of vertices, mm.
inline double rms_mm(const Positions& a, const Positions& b) {
  return 1e3 * std::sqrt((a - b).rowwise().squaredNorm().mean());
}

}  // namespace bodyopt
