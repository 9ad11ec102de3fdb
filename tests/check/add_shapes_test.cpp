#include "trainer/check/add_shapes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>

#include "assets/caches/pc2.h"
#include "dataset/modifier.h"
#include "runtime/core/error.h"
#include "tests/simulate/limb.h"
#include "tests/support/damaged_cache.h"
#include "tests/support/hostile_bytes.h"
#include "tests/support/temporary_folder.h"
#include "trainer/curate/shape_stack.h"
#include "trainer/train/skinning/unpose.h"

namespace bodyopt::trainer {
namespace {

namespace fs = std::filesystem;

// A limb, a clip of 8 frames that bends it, and an empty folder for a dataset of them.
class AddShapes : public ::testing::Test {
 protected:
  AddShapes() {
    clip_.name = "bend";
    for (int k = 0; k < 8; ++k) clip_.poses.push_back(bent(limb_, degrees(10.0 * k)));
    write_character(limb_, folder_ / "limb.glb");
    write_clip(clip_, limb_.skeleton, folder_ / "bend.glb");
    fs::create_directory(folder_ / "data");
  }

  // The limb skinned to a frame, moved along x by `shift` metres.
  std::vector<float> shape(int frame, double shift) const {
    Positions shape = skin_linear(limb_, clip_.poses[static_cast<std::size_t>(frame - 1)]);
    shape.col(0).array() += shift;
    return output_from_welded(limb_, shape);
  }

  fs::path write_shapes(const std::vector<int>& frames, double shift = 0) const {
    const fs::path path = folder_ / "delivered.pc2";
    Pc2Writer writer(path, limb_.output_count(), static_cast<std::uint32_t>(frames.size()));
    for (const int frame : frames) writer.append(shape(frame, shift));
    writer.close();
    return path;
  }

  DatasetTake take_of(const std::vector<int>& frames, const std::vector<int>& heldout = {}) const {
    DatasetTake take;
    take.name = "bend";
    take.clip = "../bend.glb";
    take.frames = frames;
    take.heldout = heldout;
    return take;
  }

  // Its shapes are moved on purpose.
  DatasetTake meant(const std::vector<int>& frames) const {
    DatasetTake take = take_of(frames);
    take.as_given = true;
    return take;
  }

  fs::path path() const { return folder_ / "data/dataset.json"; }

  AddedShapes add(const DatasetTake& take, const fs::path& source, bool replace = false) const {
    Dataset begun;
    begun.folder = folder_ / "data";
    begun.character = "../limb.glb";
    return add_shapes(begun, path(), take, source, replace);
  }

  // The dataset's takes pass `check`, and its only one has these frames, each with the shape of that shift.
  void expect_shapes(const std::vector<std::pair<int, double>>& expected) const {
    const Dataset dataset = read_dataset(path());
    EXPECT_EQ(first_problem(check_dataset(dataset), path()), "");
    ASSERT_EQ(dataset.takes.size(), 1u);
    const Pc2Reader cache(dataset.folder / dataset.takes[0].shapes);
    ASSERT_EQ(dataset.takes[0].frames.size(), expected.size());
    ASSERT_EQ(cache.sample_count(), expected.size());
    for (std::uint32_t k = 0; k < expected.size(); ++k) {
      EXPECT_EQ(dataset.takes[0].frames[k], expected[k].first);
      EXPECT_TRUE(std::ranges::equal(cache.sample(k), shape(expected[k].first, expected[k].second))) << "sample " << k;
    }
  }

  // The shape of a frame through the modifiers is that of a shift.
  void expect_seen(int frame, double shift) const {
    const ShapeStack stack(read_pose_database(read_dataset(path())));
    const Positions seen = stack.shape(stack.database().find("bend", frame, "the test"));
    const std::vector<float> expected = shape(frame, shift);
    EXPECT_LT((seen - welded_from_output(limb_, expected.data())).cwiseAbs().maxCoeff(), 1e-6) << frame;
  }

  // Names and bytes of all files of the dataset.
  std::vector<std::pair<std::string, std::string>> files() const {
    std::vector<std::pair<std::string, std::string>> files;
    for (const auto& entry : fs::directory_iterator(folder_ / "data")) {
      if (entry.path().filename() == ".dataset.json.lock" || entry.is_directory()) continue;  // which stays, empty
      files.push_back({entry.path().filename().string(), testing::read_bytes(entry.path())});
    }
    std::sort(files.begin(), files.end());
    return files;
  }

  void expect_refused(const DatasetTake& take, const fs::path& source, ErrorKind kind, const std::string& named,
                      bool replace = false) const {
    const auto before = files();
    try {
      add(take, source, replace);
      FAIL() << "expected a message with " << named;
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), kind) << error.what();
      EXPECT_NE(std::string(error.what()).find(named), std::string::npos) << error.what();
    }
    EXPECT_EQ(files(), before);
  }

  Character limb_ = make_limb();
  Clip clip_;
  TemporaryFolder folder_;
};

TEST_F(AddShapes, InPiecesIsAsTheWhole) {
  add(take_of({1, 2, 3, 4, 5, 6}, {2, 6}), write_shapes({1, 2, 3, 4, 5, 6}));
  const Dataset whole = read_dataset(path());
  const std::string whole_cache = testing::read_bytes(folder_ / "data/bend.pc2");
  fs::remove_all(folder_ / "data");
  fs::create_directory(folder_ / "data");

  add(take_of({4, 6}, {6}), write_shapes({4, 6}));
  add(take_of({5, 1, 3}), write_shapes({5, 1, 3}));
  const AddedShapes last = add(take_of({2}, {2}), write_shapes({2}));
  EXPECT_EQ(last.replaced, 0);
  const Dataset pieces = read_dataset(path());
  ASSERT_EQ(pieces.takes.size(), 1u);
  EXPECT_EQ(pieces.takes[0].frames, whole.takes[0].frames);
  EXPECT_EQ(pieces.takes[0].heldout, whole.takes[0].heldout);
  EXPECT_EQ(testing::read_bytes(folder_ / "data" / pieces.takes[0].shapes), whole_cache);
  EXPECT_EQ(files().size(), 2u);  // no cache of before is left
  expect_shapes({{1, 0}, {2, 0}, {3, 0}, {4, 0}, {5, 0}, {6, 0}});
}

TEST_F(AddShapes, AFrameIsReplacedOnlyWhenAsked) {
  add(take_of({1, 2, 3, 5}), write_shapes({1, 2, 3, 5}));
  const fs::path sculpted = write_shapes({3, 4}, 0.004);
  expect_refused(meant({3, 4}), sculpted, ErrorKind::usage, "has the frames 3 already: --replace");
  EXPECT_EQ(add(meant({3, 4}), sculpted, true).replaced, 1);
  expect_shapes({{1, 0}, {2, 0}, {3, 0}, {4, 0.004}, {5, 0}});
  expect_seen(3, 0.004);
  add(meant({3}), write_shapes({3}, 0.006), true);
  expect_seen(3, 0.006);
  expect_seen(4, 0.004);
  undo_modifiers(path());
  expect_seen(3, 0.004);
  undo_modifiers(path());
  expect_seen(3, 0);
}

TEST_F(AddShapes, WhatDoesNotBelongIsRefusedAndNothingChanges) {
  add(take_of({1, 2}), write_shapes({1, 2}));
  expect_refused(take_of({3, 4, 5}), write_shapes({3, 4}), ErrorKind::mismatch, "2 samples");
  expect_refused(take_of({3, 9}), write_shapes({3, 4}), ErrorKind::mismatch, "frame 9 lies outside the clip");
  expect_refused(take_of({3, 4}), write_shapes({3, 4}, 0.2), ErrorKind::mismatch, "from the skinned character");
  expect_refused(take_of({3}), folder_ / "none.pc2", ErrorKind::file, "none.pc2");
  expect_refused(take_of({3}), folder_ / "bend.glb", ErrorKind::file, "POINTCACHE2");
  DatasetTake other = take_of({3, 4});
  other.fps = 12;
  expect_refused(other, write_shapes({3, 4}), ErrorKind::mismatch, "--name");
}

TEST_F(AddShapes, WhatIsMovedIsTakenWhereItIsMeantAndStaysMeant) {
  expect_refused(take_of({1, 2}), write_shapes({1, 2}, 0.01), ErrorKind::mismatch, "moved by 0.01 0 0 m in all frames");
  add(meant({1, 2}), write_shapes({1, 2}, 0.01));
  expect_shapes({{1, 0.01}, {2, 0.01}});
  EXPECT_TRUE(read_dataset(path()).takes[0].as_given);
  expect_refused(take_of({3}), write_shapes({3}, 0.01), ErrorKind::mismatch, "as_given");
  add(take_of({3}), write_shapes({3}));
  expect_shapes({{1, 0.01}, {2, 0.01}, {3, 0}});
}

// Found only when half of the new cache is written.
TEST_F(AddShapes, ADamagedShapeOfTheTakeLeavesEverythingAsItWas) {
  add(take_of({1, 2}), write_shapes({1, 2}));
  put_nan(folder_ / "data/bend.pc2", 1, 0);
  expect_refused(take_of({3, 4}), write_shapes({3, 4}), ErrorKind::file, "not a finite number");
  add(take_of({2, 3}), write_shapes({2, 3}), true);  // the damaged one among them
  expect_shapes({{1, 0}, {2, 0}, {3, 0}});
}

// A simulated take: the side-car goes on to tell of the others, and vouches for what is given.
TEST_F(AddShapes, ASideCarKnowsWhatWasGiven) {
  add(take_of({1, 3, 5}), write_shapes({1, 3, 5}));
  Dataset dataset = read_dataset(path());
  EXPECT_TRUE(has_given_shapes(dataset, dataset.takes[0]));
  dataset.takes[0].shapes_status = "bend.status.json";
  write_dataset(dataset, path());
  std::vector<FrameStatus> status(3);
  for (int k = 0; k < 3; ++k) {
    status[static_cast<std::size_t>(k)].frame = 1 + 2 * k;
    status[static_cast<std::size_t>(k)].converged = k != 1;
    status[static_cast<std::size_t>(k)].residual = k == 1 ? 1 : 1e-5;
    status[static_cast<std::size_t>(k)].inputs = 7;
  }
  write_frame_status(status, folder_ / "data/bend.status.json");
  dataset = read_dataset(path());
  EXPECT_FALSE(has_given_shapes(dataset, dataset.takes[0]));
  EXPECT_EQ(unconverged_frames(dataset, dataset.takes[0]), std::set<int>{3});

  add(take_of({3, 2}), write_shapes({3, 2}), true);
  dataset = read_dataset(path());
  EXPECT_TRUE(has_given_shapes(dataset, dataset.takes[0]));
  EXPECT_TRUE(unconverged_frames(dataset, dataset.takes[0]).empty());
  expect_seen(3, 0);
  const std::vector<FrameStatus> now = read_frame_status(folder_ / "data" / dataset.takes[0].shapes_status);
  ASSERT_EQ(now.size(), 4u);
  EXPECT_EQ(now[0].residual, 1e-5);
  EXPECT_EQ(now[0].inputs, 7u);
  EXPECT_EQ(now[1].frame, 2);
  EXPECT_EQ(now[1].inputs, 0u);  // given
  EXPECT_EQ(now[2].inputs, 7u);  // what the solver said of what is covered
  EXPECT_EQ(now[3].frame, 5);
  EXPECT_EQ(files().size(), 3u);
  expect_shapes({{1, 0}, {2, 0}, {3, 0}, {5, 0}});
}

// Killed between the cache and dataset.json; whoever does it again gets what would have been there, and nothing else.
TEST_F(AddShapes, WhatAKilledRunLeftIsTakenOver) {
  add(take_of({1}), write_shapes({1}));
  const auto before = files();
  add(take_of({2}), write_shapes({2}));
  const auto undisturbed = files();
  for (const auto& [name, bytes] : before) std::ofstream(folder_ / "data" / name, std::ios::binary) << bytes;
  ASSERT_EQ(files().size(), undisturbed.size() + 1);
  add(take_of({2}), write_shapes({2}));
  EXPECT_EQ(files(), undisturbed);
}

// Left by a run that was killed, or put there by somebody: nothing is overwritten but what the dataset names.
TEST_F(AddShapes, AForeignFileOfTheTakesNameStays) {
  std::ofstream(folder_ / "data/bend.pc2") << "somebody's";
  add(take_of({1}), write_shapes({1}));
  add(take_of({2}), write_shapes({2}));
  EXPECT_EQ(testing::read_bytes(folder_ / "data/bend.pc2").size(), 10u);
  expect_shapes({{1, 0}, {2, 0}});
}

}  // namespace
}  // namespace bodyopt::trainer
