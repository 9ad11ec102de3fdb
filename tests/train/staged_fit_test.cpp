// Training that goes on from what an earlier one kept.
#include "trainer/train/fit/staged_fit.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <random>

#include "runtime/core/error.h"
#include "runtime/deformer/deformer.h"
#include "runtime/host/device_choice.h"
#include "tests/support/capsule_limb.h"
#include "tests/support/same_basis.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/trained_basis.h"
#include "trainer/train/fit/train.h"
#include "trainer/train/judge/test_errors.h"
#include "trainer/train/pack/trade_off.h"
#include "trainer/train/skinning/ddm.h"

namespace bodyopt::trainer {
namespace staged_fit_test {

namespace fs = std::filesystem;

const SampleSet& samples() {
  static const SampleSet set = limb_samples(160, 40);
  return set;
}

// Without some of the training frames.
SampleSet without(std::initializer_list<std::size_t> frames) {
  SampleSet set = samples();
  for (const std::size_t frame : std::vector(std::rbegin(frames), std::rend(frames))) {
    set.train.erase(set.train.begin() + static_cast<std::ptrdiff_t>(frame));
  }
  return set;
}

TrainOptions keeping(const TemporaryFolder& folder) {
  TrainOptions options{.components = 8, .centres = 60};
  options.keep_in = folder / "kept";
  return options;
}

TrainOptions updating(const TemporaryFolder& folder) {
  TrainOptions options = keeping(folder);
  options.update = true;
  return options;
}

const Basis& from_the_start() {
  static const Basis basis = trained_basis(samples(), {.components = 8, .centres = 60});
  return basis;
}

double heldout_rms(const Basis& basis) {
  Deformer deformer(basis, {.name = "cpu"});
  return heldout_errors(samples().heldout, heldout_by_basis(samples(), deformer)).rms;
}

// What no pose tells, so that what is left of the motion does not depend on single frames.
void roughen(SampleSet& set) {
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal(0, 2e-4);
  for (Sample& sample : set.train) {
    sample.shape = Positions(sample.shape.read().unaryExpr([&](double x) { return x + normal(random); }));
  }
}

// The one that is kept.
fs::path region_file(const TemporaryFolder& folder, std::size_t number) {
  for (const fs::directory_entry& entry : fs::directory_iterator(folder / "kept")) {
    if (entry.path().filename().string().starts_with("region_" + std::to_string(number) + "_")) return entry.path();
  }
  return {};
}

// Marks what is kept of a region, so that a basis shows whether it was used.
void spoil_region(const TemporaryFolder& folder, std::size_t number) {
  const TrainingStore store(folder / "kept");
  const std::uint64_t key = store.layout()->key;
  RegionModel model = store.region(number, key).value();
  for (Regression& fit : model.fits) fit.weights *= 0.5;
  store.keep(number, key, model);
}

TEST(StagedFit, GoesOnWhereItStopped) {
  const TemporaryFolder folder;
  EXPECT_EQ(testing::difference(trained_basis(samples(), keeping(folder)), from_the_start()), "");
  const std::size_t regions = TrainingStore(folder / "kept").layout()->layout.regions.size();
  ASSERT_GT(regions, 2u);
  // As if it had been interrupted after one region, and after the layout.
  for (std::size_t r = 1; r < regions; ++r) ASSERT_TRUE(fs::remove(region_file(folder, r)));
  EXPECT_EQ(testing::difference(trained_basis(samples(), keeping(folder)), from_the_start()), "");
  for (std::size_t r = 0; r < regions; ++r) ASSERT_TRUE(fs::remove(region_file(folder, r)));
  EXPECT_EQ(testing::difference(trained_basis(samples(), keeping(folder)), from_the_start()), "");
  // What is kept is used: nothing else would notice that it was spoilt.
  spoil_region(folder, 1);
  EXPECT_EQ(testing::difference(trained_basis(samples(), keeping(folder)), from_the_start()), "residual");
}

// Whoever goes on from a basis knows the radius that its training chose.
TEST(StagedFit, TheRadiusThatTrainingChoseIsNoOtherOption) {
  const TemporaryFolder folder;
  trained_basis(without({3, 17}), keeping(folder));
  TrainOptions told = updating(folder);
  told.smoothing_radius = TrainingStore(folder / "kept").layout()->smoothing_radius;
  std::vector<std::string> notes;
  trained_basis(samples(), told, &notes);
  for (const std::string& note : notes) EXPECT_EQ(note.find("trained from the start"), std::string::npos) << note;
  told.smoothing_radius *= 1.5;
  notes.clear();
  trained_basis(samples(), told, &notes);
  EXPECT_EQ(notes.at(0), "the earlier training had another smoothing radius: trained from the start");
}

TEST(StagedFit, AnotherSizeIsMadeOfWhatIsKept) {
  const TemporaryFolder folder;
  trained_basis(samples(), keeping(folder));
  TrainOptions small = keeping(folder);
  small.budget = 0.9 * bytes_per_vertex(from_the_start());
  const Basis made = trained_basis(samples(), small);
  for (std::size_t r = 0; r < 3; ++r) spoil_region(folder, r);
  EXPECT_EQ(testing::difference(trained_basis(samples(), small), made), "residual");
  small.keep_in.clear();
  EXPECT_EQ(testing::difference(trained_basis(samples(), small), made), "");
}

// Each of them another character, pose, shape, muscle or option.
TEST(StagedFit, WhatIsKeptOfOtherInputsIsNotUsed) {
  const TemporaryFolder folder;
  SampleSet pose = samples(), shape = samples(), weights = samples(), muscle = samples(), painted = samples(),
            bind = samples(), control = samples();
  painted.regions = {{"mine", {10, 11, 12}, {1, 1, 1}}};
  bind.character.skeleton.joints[1].bind.translation[2] += 1e-4;
  control.controls = {"breath"};
  for (std::vector<Sample>* some : {&control.train, &control.heldout}) {
    for (Sample& sample : *some) sample.pose.controls = {0.1f};
  }
  pose.train[5].pose.joints[1].rotation = axis_angle({1, 0, 0}, 0.3);
  shape.train[9].shape = Positions(shape.train[9].shape.read().array() + 1e-4);
  weights.character.weights[300] = {{0, 0.7}, {1, 0.3}};
  muscle.muscles[0].path[1].position[1] += 0.01;
  for (const SampleSet& other : {pose, shape, weights, muscle, painted, bind, control}) {
    trained_basis(other, keeping(folder));
    EXPECT_EQ(testing::difference(trained_basis(samples(), keeping(folder)), from_the_start()), "");
  }
  std::vector<TrainOptions> others(6, keeping(folder));
  others[0].seed = 7;
  others[1].components = 6;
  others[2].centres = 30;
  others[3].smoothing_radius = 0.02;
  others[4].method.support = Method::Support::static_regions;
  others[5].surface_curves = 2;
  for (const TrainOptions& other : others) {
    trained_basis(samples(), other);
    EXPECT_EQ(testing::difference(trained_basis(samples(), keeping(folder)), from_the_start()), "");
  }
}

TEST(StagedFit, NewFramesAreLearnedAsFromTheStart) {
  const TemporaryFolder folder;
  SampleSet all = samples();
  all.train.resize(60);
  roughen(all);
  SampleSet known = all;
  known.train.erase(known.train.begin() + 31, known.train.begin() + 35);
  // One of the skin's own choice would be another of all frames.
  const double radius = default_smoothing_radius(all.character.vertices);
  const auto of_radius = [&](TrainOptions options) {
    options.smoothing_radius = radius;
    return options;
  };
  const double before = heldout_rms(trained_basis(known, of_radius(keeping(folder))));
  std::vector<std::string> notes;
  const Basis updated = trained_basis(all, of_radius(updating(folder)), &notes);
  // At most a region whose hyper-parameters no longer suit so few frames is fitted anew.
  for (const std::string& note : notes) EXPECT_EQ(note.find("trained from the start"), std::string::npos) << note;
  const Basis from_all = trained_basis(all, of_radius({.components = 8, .centres = 60}));
  const double anew = heldout_rms(from_all), after = heldout_rms(updated);
  RecordProperty("mm", std::to_string(before) + " before, " + std::to_string(after) + " updated, " +
                           std::to_string(anew) + " from the start");
  EXPECT_LT(after, 1.05 * anew);
  EXPECT_LT(after, 0.99 * before);
  EXPECT_NE(updated.metadata.at("provenance").find("updated"), std::string::npos);
  EXPECT_EQ(from_all.metadata.at("provenance").find("updated"), std::string::npos);
  // It is kept in turn, for the next update, and does not pass for a training from the start.
  EXPECT_EQ(testing::difference(trained_basis(all, of_radius(updating(folder))), updated), "");
  EXPECT_EQ(testing::difference(trained_basis(all, of_radius(keeping(folder))), from_all), "");
}

TEST(StagedFit, AnEditedFrameIsForgotten) {
  const TemporaryFolder folder;
  SampleSet wrong = samples();
  for (const std::size_t n : {30, 31, 32}) {
    wrong.train[n].shape = limb_truth(wrong.character, {}, wrong.train[n].pose);
  }
  const double before = heldout_rms(trained_basis(wrong, keeping(folder))), anew = heldout_rms(from_the_start());
  EXPECT_GT(before, 2 * anew);
  EXPECT_LT(heldout_rms(trained_basis(samples(), updating(folder))), 1.1 * anew);
}

// The wrist's own displacement is in the new frames only.
TEST(StagedFit, RegionsThatLackWhatIsNewAreFittedAnew) {
  const TemporaryFolder folder;
  SampleSet flat = samples();
  for (std::size_t n = 0; n < flat.train.size(); ++n) {
    Sample& sample = flat.train[n];
    if (n % 12 == 5) continue;
    Pose straight = sample.pose;
    straight.joints[2].rotation = axis_angle({0, 1, 0}, 0.03 * static_cast<double>(n % 7));
    sample.pose = straight;
    sample.shape = limb_truth(flat.character, flat.muscles, straight);
  }
  SampleSet known = flat;
  for (std::size_t n = known.train.size(); n-- > 0;) {
    if (n % 12 == 5) known.train.erase(known.train.begin() + static_cast<std::ptrdiff_t>(n));
  }
  trained_basis(known, keeping(folder));
  std::vector<std::string> notes;
  const Basis updated = trained_basis(flat, updating(folder), &notes);
  ASSERT_EQ(notes.size(), 1u);
  EXPECT_NE(notes[0].find("fitted from the start"), std::string::npos) << notes[0];
  const double anew = heldout_rms(trained_basis(flat, {.components = 8, .centres = 60}));
  EXPECT_LT(heldout_rms(updated), 1.1 * anew);
}

// Whatever else an update began with: its regions are its own until it is done.
TEST(StagedFit, AnUpdateDoesNotDependOnOneThatWasInterrupted) {
  const SampleSet known = without({40, 90}), other = without({90});
  const TemporaryFolder folder, clean;
  trained_basis(known, keeping(folder));
  fs::copy(folder / "kept", clean / "kept");
  const fs::path layout = folder / "kept/layout.safetensors";
  fs::copy_file(layout, folder / "before");
  trained_basis(other, updating(folder));
  fs::rename(folder / "before", layout);  // as if it had been interrupted before its end
  for (const fs::directory_entry& entry : fs::directory_iterator(clean / "kept")) {
    if (entry.path() != clean / "kept/layout.safetensors") {
      fs::copy_file(entry.path(), folder / "kept" / entry.path().filename());
    }
  }
  const Basis updated = trained_basis(samples(), updating(clean));
  EXPECT_EQ(testing::difference(trained_basis(samples(), updating(folder)), updated), "");
  // And nothing else is left behind.
  std::size_t files = 0;
  for ([[maybe_unused]] const auto& entry : fs::directory_iterator(folder / "kept")) ++files;
  EXPECT_EQ(files, 1 + TrainingStore(folder / "kept").layout()->layout.regions.size());
}

TEST(StagedFit, TakesMayComeInAnotherOrder) {
  const TemporaryFolder folder;
  SampleSet two = samples(), swapped = samples();
  two.takes = swapped.takes = {"first", "second", "heldout"};
  for (std::size_t n = 0; n < 160; ++n) two.train[n].take = n < 100 ? 0 : 1;
  std::rotate(swapped.train.begin(), swapped.train.begin() + 100, swapped.train.end());
  for (std::size_t n = 0; n < 160; ++n) swapped.train[n].take = n < 60 ? 0 : 1;
  trained_basis(two, keeping(folder));
  std::vector<std::string> notes;
  const double updated = heldout_rms(trained_basis(swapped, updating(folder), &notes));
  for (const std::string& note : notes) EXPECT_NE(note.find("regions of 3"), std::string::npos) << note;  // other folds
  EXPECT_LT(updated, 1.1 * heldout_rms(trained_basis(swapped, {.components = 8, .centres = 60})));
}

// Training must not know what it is measured on.
TEST(StagedFit, FramesThatAreHeldOutNowAreForgotten) {
  const TemporaryFolder folder;
  trained_basis(samples(), keeping(folder));
  SampleSet split = without({70, 71, 72});
  for (const std::size_t n : {70, 71, 72}) split.heldout.push_back(samples().train[n]);
  std::vector<std::string> notes;
  const Basis updated = trained_basis(split, updating(folder), &notes);
  ASSERT_EQ(notes.size(), 1u);
  EXPECT_NE(notes[0].find("held out"), std::string::npos) << notes[0];
  EXPECT_EQ(testing::difference(updated, trained_basis(split, {.components = 8, .centres = 60})), "");
}

TEST(StagedFit, SurfaceCurvesStayWhereTheyAre) {
  const TemporaryFolder folder;
  TrainOptions options = keeping(folder);
  options.surface_curves = 3;
  SampleSet bare = samples();
  bare.muscles.clear();
  SampleSet known = bare;
  known.train.erase(known.train.begin() + 40);
  trained_basis(known, options);
  const std::vector<Muscle> before = TrainingStore(folder / "kept").layout()->curves;
  ASSERT_EQ(before.size(), 6u);
  options.update = true;
  std::vector<std::string> notes;
  const Basis updated = trained_basis(bare, options, &notes);
  for (const std::string& note : notes)
    EXPECT_NE(note.find("what the earlier training found does not fit"), std::string::npos) << note;
  EXPECT_EQ(muscles_hash(TrainingStore(folder / "kept").layout()->curves), muscles_hash(before));
  options.update = false;
  options.keep_in.clear();
  EXPECT_LT(heldout_rms(updated), 1.1 * heldout_rms(trained_basis(bare, options)));
}

TEST(StagedFit, ABudgetBelowTheEarlierRadiusIsATraining) {
  const TemporaryFolder folder;
  TrainOptions options = keeping(folder);
  trained_basis(samples(), options);
  options.update = true;
  options.budget = bytes_per_vertex(without_residual(from_the_start())) * 0.99;
  std::vector<std::string> notes;
  try {
    trained_basis(samples(), options, &notes);
  } catch (const Error& error) {  // of the limb's radii neither may fit
    EXPECT_EQ(error.kind(), ErrorKind::usage);
    notes.push_back(error.what());
  }
  ASSERT_FALSE(notes.empty());
  EXPECT_NE(notes[0].find("--budget"), std::string::npos) << notes[0];
}

TEST(StagedFit, AnUpdateThatCannotBeIsATraining) {
  const TemporaryFolder folder;
  const auto expect_anew = [&](const std::string& why) {
    std::vector<std::string> notes;
    EXPECT_EQ(testing::difference(trained_basis(samples(), updating(folder), &notes), from_the_start()), "");
    ASSERT_EQ(notes.size(), 1u);
    EXPECT_NE(notes[0].find(why), std::string::npos) << notes[0];
  };
  expect_anew("nothing to update");
  SampleSet few = samples();
  few.train.resize(100);
  trained_basis(few, keeping(folder));
  expect_anew("60 frames of 160 are new");
  SampleSet many = samples();
  for (std::size_t n = 0; n < 30; ++n) {
    many.train.push_back(many.train[n]);
    many.train.back().shape = Positions(many.train[n].shape.read().array() + 1e-5);
  }
  trained_basis(many, keeping(folder));
  expect_anew("30 frames of 190 are gone");
  SampleSet still = without({70, 71});
  for (Sample& sample : still.train) sample.pose.joints[2] = still.character.skeleton.joints[2].bind;
  for (std::size_t n : {70, 71}) still.train.push_back(samples().train[n]);
  SampleSet known = still;
  known.train.resize(158);
  trained_basis(known, keeping(folder));
  std::vector<std::string> notes;
  trained_basis(still, updating(folder), &notes);
  ASSERT_EQ(notes.size(), 1u);
  EXPECT_NE(notes[0].find("did not move before"), std::string::npos) << notes[0];
}

// What is said of the data is said again, of the frames as they are numbered now.
TEST(StagedFit, WarningsAreCarriedOver) {
  const TemporaryFolder folder;
  SampleSet bad = samples();
  Positions flown = bad.train[50].shape.read();
  flown.row(300) += Eigen::RowVector3d(0.3, 0, 0);
  bad.train[50].shape = flown;
  Sample twin = bad.train[20];
  Positions other = twin.shape.read();
  other.col(1).array() += 0.01;
  twin.shape = other;
  bad.train.push_back(twin);
  SampleSet known = bad;
  known.train.erase(known.train.begin() + 3);
  const std::vector<std::string> before = train(known, keeping(folder)).warnings;
  EXPECT_GE(before.size(), 2u);
  EXPECT_EQ(train(bad, updating(folder)).warnings, before);
  // Found in a new frame, too.
  SampleSet clean = bad;
  clean.train[50].shape = samples().train[50].shape;
  clean.train.pop_back();
  TemporaryFolder another;
  trained_basis(clean, keeping(another));
  EXPECT_EQ(train(bad, updating(another)).warnings.size(), before.size());
}

TEST(StagedFit, ADamagedFileIsNamed) {
  const TemporaryFolder folder;
  trained_basis(samples(), keeping(folder));
  fs::resize_file(region_file(folder, 1), 1000);
  try {
    trained_basis(samples(), keeping(folder));
    FAIL() << "nothing was said";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::file);
    EXPECT_NE(std::string(error.what()).find("region_1_"), std::string::npos) << error.what();
    EXPECT_NE(std::string(error.what()).find("delete the folder"), std::string::npos) << error.what();
  }
  const TemporaryFolder another;
  std::ofstream(another / "kept") << "no folder";
  try {
    trained_basis(samples(), keeping(another));
    FAIL() << "nothing was said";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::file);
  }
}

}  // namespace staged_fit_test
}  // namespace bodyopt::trainer
