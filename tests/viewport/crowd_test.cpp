// Several of the cast: where they stand, which frames they play, which level of detail they show, what they share.
#include <nlohmann/json.hpp>

#include "assets/clips/matched_joints.h"
#include "runtime/basis/output_order.h"
#include "tests/support/error_kind.h"
#include "tests/viewport/characters_fixture.h"
#include "tests/viewport/played_viewport.h"
#include "tests/viewport/twin_level.h"
#include "trainer/transfer/markers_file.h"
#include "trainer/transfer/transfer_basis.h"
#include "viewport/matching.h"
#include "viewport/picking.h"
#include "viewport/scene/scene.h"

namespace bodyopt::testing {
namespace crowd_test {

using namespace trainer;
using namespace shots;
using namespace draw;
using namespace viewport;

constexpr Rectangle kArea = {0, 0, 320, 200};

class CrowdTest : public CharactersTest {
 protected:
  void SetUp() override {
    controls_.playback = Playback({1, kClipFrames}, 24);
    controls_.placements.resize(3);
  }
  void add(const std::string& basis) { scene_.add({.basis = basis, .clip = small_->clip}, {}); }
  std::vector<float> shown(std::size_t index) {
    return download(*scene_.look(controls_, kArea).at(0).skins.at(index).positions);
  }
  // A character with a level that lies that far from the full skin.
  std::string with_proxy(const std::string& name, std::int16_t micrometres) {
    Level level = twin(small_->made);
    for (CarriedPoint& point : level.carried.points) point.along_normal = micrometres;
    const std::string basis = (*folder_ / (name + ".safetensors")).string();
    save_basis(small_->made, basis);
    save_levels({level}, proxy_beside(basis));
    return basis;
  }

  Scene scene_{device_};
  Controls controls_;
};

TEST_F(CrowdTest, BodiesOfOneBasisShareItsTables) {
  add(small_->basis);
  add(small_->basis);
  scene_.add({.basis = trained_->basis}, {});
  const auto tables = [&](std::size_t c) { return &scene_.cast()[c]->basis(); };
  EXPECT_EQ(tables(0), tables(1));
  EXPECT_NE(tables(0), tables(2));
  controls_.placements[1].ahead = 5;
  EXPECT_NE(shown(0), shown(1));  // each its own pose
  // A file that is written again is another.
  std::filesystem::last_write_time(small_->basis, std::filesystem::file_time_type::clock::now());
  add(small_->basis);
  EXPECT_NE(tables(0), tables(3));
}

TEST_F(CrowdTest, WhoIsAheadGoesRoundInHisOwnClip) {
  add(small_->basis);
  add(small_->basis);
  for (const int ahead : {0, 4, -3, 5 * kClipFrames + 2}) {
    for (const int frame : {1, 7, kClipFrames}) {
      controls_.placements[1].ahead = ahead;
      controls_.playback.scrub(frame);
      const std::vector<float> other = shown(1);
      const int played = 1 + ((frame - 1 + ahead) % kClipFrames + kClipFrames) % kClipFrames;
      controls_.playback.scrub(played);
      EXPECT_EQ(shown(0), other) << ahead << " ahead at frame " << frame;
    }
  }
  controls_.placements[0].ahead = 3;  // the lead plays what the timeline says
  controls_.placements[1].ahead.reset();
  EXPECT_EQ(shown(0), shown(1));
}

TEST_F(CrowdTest, WhoIsPlacedBeginsThere) {
  add(small_->basis);
  add(small_->basis);
  controls_.placements[1].at = Vec3{2, 0.5, -3};
  const std::array<float, 3> offset = scene_.look(controls_, kArea).at(0).skins.at(1).offset;
  const Actor& other = *scene_.cast()[1];
  EXPECT_NEAR(static_cast<double>(offset[0]) + other.start()[0], 2, 1e-6);
  EXPECT_NEAR(static_cast<double>(offset[1]) + other.ground(), scene_.cast()[0]->ground() + 0.5, 1e-6);
  EXPECT_NEAR(static_cast<double>(offset[2]) + other.start()[2], -3, 1e-6);
}

TEST_F(CrowdTest, FurtherAwayItIsCoarser) {
  add(small_->basis);
  add(with_proxy("far", 2000));
  ASSERT_EQ(scene_.cast()[1]->level_count(), 2u);  // the proxy that lies beside the basis
  EXPECT_NEAR(scene_.cast()[1]->level_within(1.9e-3), 0, 0);
  EXPECT_NEAR(scene_.cast()[1]->level_within(2.1e-3), 1, 0);
  controls_.placements[1].at = Vec3{};
  const auto level_at = [&](double distance) {
    controls_.camera = OrbitCamera({.target = {0, 0, 0}, .distance = distance});
    return scene_.level_by_size(1, controls_, 1000);
  };
  EXPECT_EQ(level_at(1), 0u);
  EXPECT_EQ(level_at(100), 1u);
  // A fifth of a pixel is 2 mm where 10 m fill the picture's height.
  const double far = 5 / std::tan(0.5 * static_cast<double>(kVerticalAngle));
  const double size = 0.5 * scene_.cast()[1]->size();
  EXPECT_EQ(level_at(0.9 * far), 0u);
  EXPECT_EQ(level_at(1.1 * far + 2 * size), 1u);
}

TEST_F(CrowdTest, MatchedBodiesHaveOneColourAtOnePoint) {
  add(small_->basis);
  add(small_->basis);
  Matching matching(device_, scene_, controls_);
  const auto skins = [&] { return scene_.look(controls_, kArea).at(0).skins; };
  Snapshot snapshot;
  matching.look();
  matching.describe(snapshot);
  EXPECT_FALSE(snapshot.match.has_value());  // nobody asked for it
  EXPECT_EQ(skins()[0].colours, nullptr);

  controls_.settings.compare.coverage = controls_.settings.compare.heat = true;
  controls_.settings.compare.match = MatchView::colours;
  matching.look();
  const std::vector<SkinDraw> coloured = skins();
  const std::vector<float> lead = download(*coloured[0].colours), second = download(*coloured[1].colours);
  EXPECT_EQ(lead, second);
  const std::vector<float>& rest = small_->made.mesh.rest;
  ASSERT_EQ(lead.size(), rest.size());
  for (std::size_t k = 3; k < rest.size(); ++k) {  // what lies further along an axis has more of its colour
    EXPECT_EQ(rest[k] > rest[k - 3], lead[k] > lead[k - 3]) << k;
  }
  EXPECT_EQ(coloured[0].distances, nullptr);

  controls_.settings.compare.match = MatchView::confidence;
  matching.look();
  const SkinDraw unsure = skins()[1];
  EXPECT_EQ(unsure.colours, nullptr);
  EXPECT_EQ(unsure.heat_range, 1);
  for (const float off : download(*unsure.distances)) EXPECT_NEAR(off, 0, 1e-5f);
  matching.describe(snapshot);
  ASSERT_TRUE(snapshot.match.has_value());
  EXPECT_TRUE(snapshot.match->same_topology);
  EXPECT_NEAR(snapshot.match->size, 1, 1e-9);
  EXPECT_FALSE(snapshot.match->parts.empty());

  const auto is_by_number = [&](const std::vector<MarkedPair>& pairs) {
    controls_.marking.pairs = pairs;
    matching.look();
    matching.describe(snapshot);
    return snapshot.match->same_topology;
  };
  EXPECT_TRUE(is_by_number({{0, 0}}));  // says what the numbers say
  const auto last = static_cast<std::uint32_t>(rest.size() / 3 - 1);
  EXPECT_FALSE(is_by_number({{0, last}}));  // the numbers are then no longer believed
  matching.forget();
  matching.describe(snapshot);
  EXPECT_FALSE(snapshot.match.has_value());
  EXPECT_EQ(skins()[0].colours, nullptr);
}

// The divergence theorem, over triangles of output vertices.
double volume_of(const MeshTable& mesh, const std::vector<float>& output) {
  double sum = 0;
  const auto corner = [&](std::size_t t, std::size_t k) {
    const float* at = &output[std::size_t{3} * mesh.output_triangles[3 * t + k]];
    return Vec3{at[0], at[1], at[2]};
  };
  for (std::size_t t = 0; t < mesh.output_triangles.size() / 3; ++t) {
    sum += dot(corner(t, 0), cross(corner(t, 1), corner(t, 2))) / 6;
  }
  return sum;
}

TEST_F(CrowdTest, AMatchTellsVolumesAtTheFrameAndWhatIsWorthSimulating) {
  scene_.add({.basis = trained_->basis, .clip = jiggling_->clip}, {});
  scene_.add({.basis = trained_->basis, .clip = jiggling_->clip}, {});
  controls_.settings.compare.match = MatchView::confidence;
  controls_.placements[1].ahead = 3;
  Matching matching(device_, scene_, controls_);
  Snapshot snapshot;
  const Actor& second = *scene_.cast()[1];
  const auto expect_volumes = [&](int frame) {
    controls_.playback.scrub(frame);
    matching.look();
    matching.describe(snapshot);
    ASSERT_TRUE(snapshot.match->volumes.has_value());
    const MeshTable& mesh = second.finest_basis().mesh;
    const double rest = volume_of(mesh, output_of(mesh, mesh.rest));
    for (std::size_t k = 0; k < 2; ++k) {
      EXPECT_NEAR((*snapshot.match->volumes)[k], volume_of(mesh, scene_.skin_on_stage(k, controls_)) / rest, 1e-5) << k;
    }
  };
  expect_volumes(1);
  const double first = snapshot.match->volumes->front();
  expect_volumes(kClipFrames);
  EXPECT_NE(snapshot.match->volumes->front(), first);
  EXPECT_EQ(snapshot.match->to_simulate, frames_to_simulate(second.finest_basis(), second.clip()));
  EXPECT_FALSE(snapshot.match->to_simulate.empty());
  controls_.playback.play();
  matching.look();
  matching.describe(snapshot);
  EXPECT_FALSE(snapshot.match->volumes.has_value());
}

TEST_F(CrowdTest, BodiesThatCannotBeMatchedAreShownAsTheyWere) {
  add(small_->basis);
  scene_.add({.basis = trained_->basis}, {});
  controls_.settings.compare.match = MatchView::colours;
  Matching matching(device_, scene_, controls_);
  EXPECT_EQ(kind_of([&] { matching.look(); }), ErrorKind::mismatch);
  EXPECT_EQ(controls_.settings.compare.match, MatchView::none);
  EXPECT_EQ(scene_.look(controls_, kArea).at(0).skins.at(0).colours, nullptr);
}

class PlayedCrowdTest : public PlayedTest {};

TEST_F(PlayedCrowdTest, AMatchIsOfTwoBodiesAndIsWorkedOutForOthersAnew) {
  const auto alone = open(small(), kBarePicture + "; match colours");
  EXPECT_EQ(alone->controls().settings.compare.match, MatchView::none);
  EXPECT_TRUE(alone->controls().missing.contains("match colours"));
  const auto viewport = open(small({small_.basis}), kBarePicture + "; match colours; save-state match.json");
  EXPECT_TRUE(viewport->session().snapshot.match.has_value());
  EXPECT_EQ(read_view_settings("match.json").compare.match, MatchView::colours);
  viewport->prompt("remove 2");
  EXPECT_FALSE(viewport->session().snapshot.match.has_value());
  viewport->prompt("open " + small_.basis);
  EXPECT_TRUE(viewport->session().snapshot.match.has_value());
}

TEST_F(PlayedCrowdTest, MarkersAndMatchAreOfThePairTheyWereMadeFor) {
  const auto viewport = open(small({small_.basis, small_.basis}), kBarePicture + "; marker 3 5; match colours");
  const auto markers = [&] { return viewport->controls().marking.pairs.size(); };
  viewport->prompt("remove 3");
  viewport->prompt("same-clip");
  EXPECT_EQ(markers(), 1u);
  viewport->prompt("open " + small_.basis);
  viewport->prompt("remove 2");
  EXPECT_EQ(markers(), 0u);
  EXPECT_TRUE(viewport->session().snapshot.match.has_value());
}

TEST_F(PlayedCrowdTest, MarkersAreSetByClicksOnOneBodyAndTheOther) {
  const auto viewport = open(small({small_.basis}), kBarePicture + "; mark on; frame-selection");
  const auto click_vertex = [&](std::size_t character, std::uint32_t vertex) {
    Scene& scene = const_cast<Session&>(viewport->session()).scene;
    const std::vector<float> skin = scene.skin_on_stage(character, viewport->controls());
    const float* at = &skin[3 * std::size_t{vertex}];
    const Rectangle picture = {0, 0, viewport->screen.pixels[0], viewport->screen.pixels[1]};
    const auto pixel = pixel_of(scene, viewport->controls(), picture, 0, {at[0], at[1], at[2]});
    ASSERT_TRUE(pixel.has_value());
    const auto seen = vertex_at(scene, viewport->controls(), picture, static_cast<float>((*pixel)[0]),
                                static_cast<float>((*pixel)[1]));
    ASSERT_TRUE(seen.has_value());
    EXPECT_EQ(seen->character, character);
    viewport->click((*pixel)[0], (*pixel)[1]);
  };
  const std::vector<float> rest = small_.made.mesh.rest;
  std::uint32_t front = 0;  // the vertex nearest to the camera, which nothing hides
  const Vec3 eye = to_double(viewport->controls().camera.camera().eye);
  const MeshTable& mesh = small_.made.mesh;
  const auto distance = [&](std::uint32_t o) {
    const float* at = &rest[3 * std::size_t{mesh.output_vertex[o]}];
    return length(Vec3{at[0], at[1], at[2]} - eye);
  };
  for (std::uint32_t o = 1; o < mesh.output_count(); ++o) {
    if (distance(o) < distance(front)) front = o;
  }
  click_vertex(1, front);  // first one of the lead is wanted
  EXPECT_TRUE(viewport->controls().marking.pairs.empty());
  click_vertex(0, front);
  EXPECT_TRUE(viewport->controls().marking.of_lead.has_value());
  click_vertex(1, front);
  ASSERT_EQ(viewport->controls().marking.pairs.size(), 1u);
  viewport->prompt("save-markers m.json");
  const std::vector<SkinMarker> kept = read_markers("m.json");
  ASSERT_EQ(kept.size(), 1u);
  EXPECT_EQ(kept[0].source, viewport->controls().marking.pairs[0].of_lead);
  write_markers({{0, 999999}}, "far.json");
  const auto again = open(small({small_.basis}), "open m.json; open far.json");  // the latter is refused
  EXPECT_EQ(again->controls().marking.pairs, viewport->controls().marking.pairs);
}

// Of other names, as a joint map matched them when it was carried; what is read again says so, too.
TEST_F(PlayedCrowdTest, ABodyOfOtherJointsPlaysTheClipOfItsSource) {
  Basis other = small_.made;
  Json joints = Json::array();
  for (Joint& joint : other.skeleton.joints) {
    joints.push_back({{"from", joint.name}, {"to", "other_" + joint.name}});
    joint.name = "other_" + joint.name;
  }
  other.metadata[kMatchedJoints] = joints.dump();
  save_basis(other, "other.safetensors");
  {
    const auto viewport = open(small(), "open other.safetensors; same-clip; save both.json");
    const auto& cast = viewport->session().scene.cast();
    ASSERT_EQ(cast.at(1)->files().clip, small_.clip);
  }
  const auto viewport = open(small(), "open both.json");
  const auto& cast = viewport->session().scene.cast();
  ASSERT_EQ(cast.size(), 2u);
  ASSERT_EQ(cast[1]->clip().poses.size(), cast[0]->clip().poses.size());
  for (std::size_t k = 0; k < cast[0]->clip().poses.size(); ++k) {
    EXPECT_TRUE(same({&cast[0]->clip().poses[k], 1}, {&cast[1]->clip().poses[k], 1})) << k;
  }
}

// Where the legend is drawn is found by leaving it out.
TEST_F(PlayedCrowdTest, TheLegendCoversNoneOfTheTwo) {
  const auto viewport = open(small({small_.basis}), kBarePicture + "; match confidence");
  viewport->screen.pixels = {900, 500};
  viewport->prompt("frame-selection");
  Scene& scene = const_cast<Session&>(viewport->session()).scene;
  const Rectangle picture = {0, 0, 900, 500};
  double furthest = 0;
  const std::vector<float> skin = scene.skin_on_stage(1, viewport->controls());
  for (std::size_t k = 0; k < skin.size(); k += 3) {
    const auto pixel = pixel_of(scene, viewport->controls(), picture, 0, {skin[k], skin[k + 1], skin[k + 2]});
    ASSERT_TRUE(pixel.has_value());
    furthest = std::max(furthest, static_cast<double>((*pixel)[0]));
  }
  viewport->prompt("dolly 0.01");  // so that nothing is framed anew
  const Image with = viewport->screen.picture;
  viewport->prompt("legend off");
  const Image without = viewport->screen.picture;
  std::size_t leftmost = 900;
  for (std::size_t k = 0; k < with.rgba.size(); ++k) {
    if (with.rgba[k] != without.rgba[k]) leftmost = std::min(leftmost, k / 4 % 900);
  }
  ASSERT_LT(leftmost, 900u);
  EXPECT_LT(furthest, static_cast<double>(leftmost));
}

TEST_F(PlayedCrowdTest, ASessionKeepsHowEachStandsAndPlays) {
  const Placement second{Vec3{1, 0, -2}, 5, 1};
  {
    const auto viewport = open(small(), "open " + small_.basis + "; same-clip; open " + small_.basis +
                                            "; place 2 1 0 -2; ahead 2 5; level-of 2 1; save crowd.json");
    EXPECT_EQ(viewport->session().scene.cast()[1]->files().clip, small_.clip);
  }
  const SessionFile kept = read_session("crowd.json");
  ASSERT_EQ(kept.cast.size(), 3u);
  EXPECT_EQ(kept.cast[1].placement, second);
  EXPECT_EQ(kept.cast[2].placement, Placement());
  {
    const auto viewport = open(small(), "open crowd.json; lead 2");
    EXPECT_EQ(viewport->controls().placements.at(0), second);
    viewport->prompt("remove 1");
    EXPECT_EQ(viewport->controls().placements, (std::vector<Placement>{second, {}}));
    viewport->prompt("save crowd.json");
  }
  // Who is the lead now, and who came third, keep their numbers in the file, too.
  const auto viewport = open(small(), "open crowd.json; open " + small_.basis);
  EXPECT_EQ(viewport->controls().cast_numbers, (std::vector<int>{2, 3, 4}));
  viewport->prompt("ahead 3 7");
  EXPECT_EQ(viewport->controls().placements.at(1).ahead, 7);
}

}  // namespace crowd_test
}  // namespace bodyopt::testing
