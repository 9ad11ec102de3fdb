#include "viewport/scene/scene.h"

#include <set>

#include "runtime/core/error.h"
#include "tests/support/attached_limb.h"
#include "tests/viewport/characters_fixture.h"
#include "viewport/describe_scene.h"
#include "viewport/state/strain_colour.h"

namespace bodyopt::testing {
namespace {

using namespace shots;
using namespace draw;
using namespace viewport;

constexpr Rectangle kArea = {10, 20, 301, 200};

class SceneTest : public CharactersTest {
 protected:
  void SetUp() override {
    controls_.playback = Playback({1, kClipFrames}, 24);
    controls_.playback.scrub(5);
  }

  void add_small() { scene_.add({small_->basis, small_->clip, small_->truth}, {}); }
  void add_jiggling() { scene_.add({jiggling_->basis, jiggling_->clip, {}}, {}); }

  // Every skin that is to be drawn is what a method has on the device now.
  void expect_skins_are_there(const std::vector<View>& views) {
    for (const View& view : views) {
      for (const SkinDraw& skin : view.skins) {
        const auto lives = [&](const vulkan::Buffer* buffer) {
          for (const auto& character : scene_.cast()) {
            for (const SkinMethod method :
                 {SkinMethod::ddm, SkinMethod::linear, SkinMethod::full, SkinMethod::jiggle, SkinMethod::truth}) {
              if (shown_.contains(method) && character->has(method) && character->skin(method).positions == buffer) {
                return true;
              }
            }
          }
          return false;
        };
        EXPECT_TRUE(lives(skin.positions));
        EXPECT_TRUE(!skin.reference || lives(skin.reference));
      }
    }
  }

  Scene scene_{device_};
  Controls controls_;
  std::set<SkinMethod> shown_;  // what has been evaluated
};

// A frame that is asked for jiggles as when it is played to.
TEST_F(SceneTest, AFrameThatIsAskedForHasJiggledUpToIt) {
  add_jiggling();
  controls_.settings.jiggle.on = true;
  const auto shown = [&](int frame) {
    controls_.playback.scrub(frame);
    return download(*scene_.look(controls_, kArea).at(0).skins.at(0).positions);
  };
  const std::vector<float> asked = shown(6);
  scene_.reset_jiggle();
  std::vector<float> stepped;
  for (int frame = 1; frame <= 6; ++frame) stepped = shown(frame);
  EXPECT_EQ(asked, stepped);
  controls_.settings.jiggle.on = false;
  EXPECT_NE(asked, shown(6));
}

// Through where the joint is in each frame of the range; a cross where there is a key.
TEST_F(SceneTest, ATrailIsTheWayOfTheJoint) {
  add_small();
  controls_.playback.set_range(2, 6);
  controls_.settings.look.skeleton = false;
  controls_.settings.ghosts.trail = true;
  EXPECT_TRUE(scene_.look(controls_, kArea).at(0).lines.empty()) << "none is selected";
  const Skeleton& skeleton = scene_.lead().basis().skeleton;
  controls_.joint = skeleton.joints.back().name;
  controls_.settings.pose.keys[4].joints[skeleton.joints.front().name] = {0, 0, 10};
  controls_.follow_keys();
  const std::vector<View> views = scene_.look(controls_, kArea);
  const std::vector<LineDraw>& lines = views.at(0).lines;
  ASSERT_EQ(lines.size(), 2u);
  ASSERT_EQ(lines[0].points.size(), 8u);
  EXPECT_EQ(lines[1].points.size(), 6u);
  for (int frame = 2; frame <= 6; ++frame) {
    controls_.playback.scrub(frame);
    controls_.follow_keys();
    const Vec3 at = scene_.joint_centres(controls_).back();
    for (const int k : {2 * (frame - 2) - 1, 2 * (frame - 2)}) {
      if (k < 0 || k > 7) continue;
      const LinePoint& point = lines[0].points[static_cast<std::size_t>(k)];
      EXPECT_LT(length(Vec3{point.x, point.y, point.z} - at), 1e-6) << frame;
    }
  }
}

TEST_F(SceneTest, NothingToCompareWithIsOneView) {
  add_small();
  for (const CompareWith with : {CompareWith::none, CompareWith::full, CompareWith::jiggle}) {
    controls_.settings.compare.with = with;
    const std::vector<View> views = scene_.look(controls_, kArea);
    ASSERT_EQ(views.size(), 1u);
    EXPECT_EQ(views[0].skins.size(), 1u);
    EXPECT_EQ(views[0].skins[0].reference, nullptr);
  }
}

TEST_F(SceneTest, SideBySideHalvesTheAreaAndAWipeSplitsIt) {
  add_small();
  ViewSettings::Compare& compare = controls_.settings.compare;
  compare.with = CompareWith::truth;
  std::vector<View> views = scene_.look(controls_, kArea);
  ASSERT_EQ(views.size(), 2u);
  EXPECT_EQ(views[0].area.width + views[1].area.width, kArea.width);
  EXPECT_EQ(views[1].area.x, views[0].area.x + static_cast<std::int32_t>(views[0].area.width));
  EXPECT_NE(views[0].skins[0].positions, views[1].skins[0].positions);
  compare.layout = CompareLayout::wipe;
  for (const double at : {0.0, 0.3, 1.0}) {
    compare.wipe = at;
    views = scene_.look(controls_, kArea);
    ASSERT_EQ(views.size(), 2u);
    EXPECT_EQ(views[0].area.width, kArea.width);
    EXPECT_NEAR(views[0].part.width, at * kArea.width, 0.51);
    EXPECT_EQ(views[0].part.width + views[1].part.width, kArea.width);
    EXPECT_EQ(views[1].part.x, kArea.x + static_cast<std::int32_t>(views[0].part.width));
  }
}

TEST_F(SceneTest, HoldFlipsAndOverlayLaysBothOverEachOther) {
  add_small();
  ViewSettings::Compare& compare = controls_.settings.compare;
  compare.with = CompareWith::ddm;
  compare.layout = CompareLayout::hold;
  const auto shown = [&] { return scene_.look(controls_, kArea).at(0).skins.at(0).positions; };
  const vulkan::Buffer* full = shown();
  EXPECT_EQ(full, scene_.lead().skin(SkinMethod::full).positions);
  controls_.flipped = true;
  EXPECT_EQ(shown(), scene_.lead().skin(SkinMethod::ddm).positions);
  controls_.flipped = false;
  compare.layout = CompareLayout::overlay;
  const std::vector<View> views = scene_.look(controls_, kArea);
  ASSERT_EQ(views.size(), 1u);
  ASSERT_EQ(views[0].skins.size(), 2u);
  EXPECT_LT(views[0].skins[1].alpha, 1);
}

TEST_F(SceneTest, HeatIsTheDistanceToWhatIsComparedWith) {
  add_small();
  controls_.settings.compare.with = CompareWith::truth;
  controls_.settings.compare.heat = true;
  controls_.settings.compare.heat_scale_mm = 4;
  const SkinDraw skin = scene_.look(controls_, kArea).at(0).skins.at(0);
  EXPECT_EQ(skin.reference, scene_.lead().skin(SkinMethod::truth).positions);
  EXPECT_FLOAT_EQ(skin.heat_range, 0.004f);
}

TEST_F(SceneTest, CoverageIsOfTheSkinThatIsShownAndGoesBeforeHeat) {
  scene_.add({.basis = trained_->basis}, {});
  ViewSettings& s = controls_.settings;
  s.compare.coverage = s.compare.heat = true;
  s.compare.with = CompareWith::ddm;
  s.cast.copies = 2;
  s.ghosts.before = 1;
  const std::vector<View> views = scene_.look(controls_, kArea);
  ASSERT_NE(scene_.lead_expected(), nullptr);
  EXPECT_EQ(views.at(0).skins.at(0).distances, &scene_.lead_expected()->vertices);
  EXPECT_EQ(views[0].skins.size(), 3u);
  for (std::size_t k = 1; k < views[0].skins.size(); ++k) EXPECT_EQ(views[0].skins[k].distances, nullptr);
  EXPECT_EQ(views.at(1).skins.at(0).distances, nullptr);
  s.compare.coverage = false;
  EXPECT_EQ(scene_.look(controls_, kArea).at(0).skins.at(0).distances, nullptr);
  EXPECT_EQ(scene_.lead_expected(), nullptr);
}

TEST_F(SceneTest, WithoutCoverageHeatStays) {
  add_small();
  controls_.settings.compare.coverage = controls_.settings.compare.heat = true;
  controls_.settings.compare.with = CompareWith::ddm;
  const SkinDraw skin = scene_.look(controls_, kArea).at(0).skins.at(0);
  EXPECT_EQ(skin.distances, nullptr);
  EXPECT_NE(skin.reference, nullptr);
  EXPECT_EQ(scene_.lead_expected(), nullptr);
}

// Ghosts of a character that jiggles are quasi-static skins: with the quasi-static skin to compare with, both are of
// one evaluation, whose buffers are replaced when the number of ghosts changes.
TEST_F(SceneTest, GhostsTakeNoBufferAwayFromWhatIsCompared) {
  add_jiggling();
  controls_.settings.jiggle.on = true;
  controls_.settings.compare.with = CompareWith::full;
  controls_.settings.compare.heat = true;
  shown_ = {SkinMethod::full, SkinMethod::jiggle};
  for (const auto& [before, after] : {std::pair(0, 0), {2, 1}, {4, 0}, {0, 0}}) {
    controls_.settings.ghosts = {before, after, 2, 0.3};
    const std::vector<View> views = scene_.look(controls_, kArea);
    ASSERT_EQ(views.size(), 2u);
    expect_skins_are_there(views);
    EXPECT_EQ(views[0].skins.size(), 1u + static_cast<std::size_t>(before + after));
    EXPECT_EQ(views[0].skins[0].reference, scene_.lead().skin(SkinMethod::full).positions);
    EXPECT_EQ(views[0].skins[0].positions, scene_.lead().skin(SkinMethod::jiggle).positions);
    std::set<std::uint32_t> first;
    for (std::size_t g = 1; g < views[0].skins.size(); ++g) {
      EXPECT_TRUE(first.insert(views[0].skins[g].first_vertex).second);
      EXPECT_LT(views[0].skins[g].alpha, 1);
    }
    EXPECT_FALSE(first.contains(0));
  }
}

TEST_F(SceneTest, CharactersStandBesideEachOtherOnOneGround) {
  add_small();
  add_jiggling();
  add_small();
  const std::vector<View> views = scene_.look(controls_, kArea);
  ASSERT_EQ(views.at(0).skins.size(), 3u);
  std::vector<float> places;
  for (std::size_t c = 0; c < 3; ++c) {
    const SkinDraw& skin = views[0].skins[c];
    places.push_back(skin.offset[0]);
    EXPECT_NEAR(static_cast<double>(skin.offset[1]) + scene_.cast()[c]->ground(), views[0].ground.height, 1e-6);
  }
  EXPECT_EQ(places[0], 0);
  EXPECT_GT(places[1], 0.2f);
  EXPECT_LT(places[2], -0.2f);
}

TEST_F(SceneTest, CharactersOfOneShotStayWhereTheirClipsHaveThem) {
  Clip far = bending_clip(small_->made.skeleton);
  for (Pose& pose : far.poses) pose.joints.front().translation = pose.joints.front().translation + Vec3{0, 0.5, 3};
  const std::string file = (folder_->path() / "far.glb").string();
  write_clip(far, small_->made.skeleton, file);
  add_small();
  scene_.add({.basis = small_->basis, .clip = file}, {});
  const std::vector<View> views = scene_.look(controls_, kArea);
  EXPECT_EQ(views.at(0).skins.at(1).offset, (std::array<float, 3>{0, 0, 0}));
}

TEST_F(SceneTest, ShadowsOfACastAreThoseOfOne) {
  add_small();
  const View alone = scene_.look(controls_, kArea).at(0);
  EXPECT_EQ(alone.ground.caster, alone.radius);
  add_small();
  add_small();
  const View three = scene_.look(controls_, kArea).at(0);
  EXPECT_FLOAT_EQ(three.ground.caster, alone.ground.caster);
  EXPECT_GT(three.radius, alone.radius);
}

TEST_F(SceneTest, WhatIsWornIsWornByAllUnlessItIsOff) {
  const TemporaryFolder folder;
  const std::string basis = (folder / "limb.safetensors").string();
  std::filesystem::copy_file(jiggling_->basis, basis);
  const Attachments outfit = limb_outfit();
  save_attachments(outfit, folder / "limb.attached.safetensors");
  scene_.add({.basis = basis, .clip = jiggling_->clip}, {});
  ViewSettings& s = controls_.settings;
  s.ghosts.before = 1;
  s.cast.copies = 2;
  s.compare.with = CompareWith::ddm;
  const std::size_t each = 1 + outfit.meshes.size();
  for (const View& view : scene_.look(controls_, kArea)) EXPECT_EQ(view.skins.size(), 3 * each);
  const std::vector<View> views = scene_.look(controls_, kArea);
  EXPECT_NE(views[0].skins[1].positions, views[1].skins[1].positions) << "each on its own side's skin";
  EXPECT_EQ(views[0].skins[1].colour, views[1].skins[1].colour);
  EXPECT_NE(views[0].skins[1].colour, views[0].skins[0].colour);
  EXPECT_EQ(views[0].skins.back().colour, views[0].skins[2 * each].colour) << "of the ghost";
  const std::size_t framed = scene_.points_to_frame(controls_).size();
  s.look.worn = false;
  for (const View& view : scene_.look(controls_, kArea)) EXPECT_EQ(view.skins.size(), 3u);
  EXPECT_LT(scene_.points_to_frame(controls_).size(), framed);
}

// The small character's truth has its clip's frames.
TEST_F(SceneTest, NothingIsShownOfATruthThatLacksTheFrame) {
  Clip late = bending_clip(small_->made.skeleton);
  const std::string file = (folder_->path() / "late.glb").string();
  write_clip(late, small_->made.skeleton, file);
  scene_.add({.basis = small_->basis, .clip = file, .truth = small_->truth}, {.first_frame = 1000});
  controls_.playback = Playback({1000, 1005}, 24);
  controls_.settings.compare.with = CompareWith::truth;
  const std::vector<View> views = scene_.look(controls_, kArea);
  ASSERT_EQ(views.size(), 2u);
  EXPECT_EQ(views[0].skins.size(), 1u);
  EXPECT_EQ(views[1].skins.size(), 0u);
  EXPECT_EQ(views[0].skins[0].reference, nullptr);
}

TEST_F(SceneTest, BetweenTwoSamplesATruthIsShownButNotMeasured) {
  const std::string file = (folder_->path() / "every_other.pc2").string();
  const std::uint32_t count = small_->made.mesh.output_count();
  Pc2Writer writer(file, count, 6, 1, 2);
  for (int k = 0; k < 6; ++k) writer.append(std::vector<float>(std::size_t{3} * count, static_cast<float>(k)));
  writer.close();
  scene_.add({.basis = small_->basis, .clip = small_->clip, .truth = file}, {});
  controls_.settings.compare.with = CompareWith::truth;
  controls_.settings.compare.heat = true;
  Snapshot snapshot;
  describe_cast(scene_, snapshot);
  for (const auto& [frame, is_sample] : {std::pair{3, true}, {4, false}, {5, true}}) {
    controls_.playback.scrub(frame);
    const std::vector<View> views = scene_.look(controls_, kArea);
    ASSERT_EQ(views.size(), 2u);
    EXPECT_EQ(views[1].skins.size(), 1u) << frame;
    EXPECT_EQ(views[0].skins.at(0).reference != nullptr, is_sample) << frame;
    describe_comparison(scene_, controls_, ErrorCurve(), snapshot);
    EXPECT_EQ(snapshot.compared, is_sample ? "truth" : "truth, between two samples");
  }
}

TEST_F(SceneTest, WhatIsSeeThroughIsDrawnLast) {
  add_small();
  add_small();
  controls_.settings.ghosts.before = 1;
  const std::vector<SkinDraw> skins = scene_.look(controls_, kArea).at(0).skins;
  ASSERT_EQ(skins.size(), 4u);
  for (std::size_t k = 0; k < 4; ++k) EXPECT_EQ(skins[k].alpha < 1, k >= 2) << k;
}

TEST_F(SceneTest, AllJointsLieInTheSphereThatIsSeen) {
  add_small();
  add_jiggling();
  const View view = scene_.look(controls_, kArea).at(0);
  const std::vector<float> points = scene_.points_to_frame(controls_);
  ASSERT_FALSE(points.empty());
  for (std::size_t k = 0; k < points.size(); k += 3) {
    double squared = 0;
    for (std::size_t i = 0; i < 3; ++i) squared += std::pow(static_cast<double>(points[k + i] - view.middle[i]), 2);
    EXPECT_LT(std::sqrt(squared), static_cast<double>(view.radius));
  }
}

TEST_F(SceneTest, SelectedJointIsWhatIsFramed) {
  add_small();
  controls_.joint = "upper";
  const std::vector<float> points = scene_.points_to_frame(controls_);
  Vec3 mean{};
  for (std::size_t k = 0; k < points.size(); ++k)
    mean[k % 3] += static_cast<double>(points[k]) * 3 / static_cast<double>(points.size());
  const Vec3 joint = scene_.joint_centres(controls_).at(1);
  EXPECT_LT(length(mean - joint), 1e-6);
}

TEST_F(SceneTest, LivePosesTakeThePlaceOfTheLeadsClip) {
  add_small();
  add_small();
  Pose pose = bind_pose(small_->made.skeleton);
  pose.joints[0].translation = {0, 3, 0};
  scene_.set_live_pose(pose);
  EXPECT_NEAR(scene_.joint_centres(controls_).at(0)[1], 3, 1e-12);
  scene_.look(controls_, kArea);
  ASSERT_NE(scene_.lead_evaluation(), nullptr);
  EXPECT_EQ(scene_.lead_evaluation()->strains.size(), small_->made.strain.fibre_count());
}

// A character that cannot be read again stays.
TEST_F(SceneTest, ReplacingByAFileThatIsDamagedLeavesTheOldOne) {
  add_small();
  const std::string damaged = (*folder_ / "damaged.safetensors").string();
  std::filesystem::copy_file(small_->basis, damaged, std::filesystem::copy_options::overwrite_existing);
  std::filesystem::resize_file(damaged, std::filesystem::file_size(damaged) / 2);
  EXPECT_THROW(scene_.make({damaged, small_->clip, {}}, {}), Error);
  EXPECT_EQ(scene_.lead().files().basis, small_->basis);
  EXPECT_EQ(scene_.look(controls_, kArea).at(0).skins.size(), 1u);
}

}  // namespace
}  // namespace bodyopt::testing
