#include "viewport/scene/actor.h"

#include <numbers>

#include "runtime/coverage/expected_error.h"
#include "runtime/cpu/kernels.h"
#include "runtime/deformer/evaluate_together.h"
#include "tests/support/attached_limb.h"
#include "tests/support/error_kind.h"
#include "tests/viewport/characters_fixture.h"

namespace bodyopt::testing {
namespace {

using namespace shots;
using namespace viewport;

class ActorTest : public CharactersTest {
 protected:
  // What is on the device, F x V x 3, as a deformer gives it: F x O x 3.
  static std::vector<float> in_output_order(const MeshTable& mesh, const std::vector<float>& values) {
    std::vector<float> out;
    for (std::size_t begin = 0; begin < values.size(); begin += mesh.rest.size()) {
      for (const std::uint32_t v : mesh.output_vertex) {
        const auto at = values.begin() + static_cast<std::ptrdiff_t>(begin + 3 * v);
        out.insert(out.end(), at, at + 3);
      }
    }
    return out;
  }

  // Buffers have room for the most poses that there were at once.
  static std::vector<float> of_last_poses(const Actor& character, SkinMethod method, const vulkan::Buffer& buffer) {
    std::vector<float> values = download(buffer);
    values.resize(character.shown().last(method).poses.size() * character.basis().mesh.rest.size());
    return in_output_order(character.basis().mesh, values);
  }
  static std::vector<float> shown_positions(const Actor& character, SkinMethod method) {
    return of_last_poses(character, method, *character.skin(method).positions);
  }

  static Actor small_character() { return {device_, {small_->basis, small_->clip, small_->truth}, {}, pool_}; }
  static inline LevelPool pool_;

  static std::vector<float> evaluate(Actor& character, SkinMethod method, const Pose& pose, const Weights& weights) {
    character.evaluate(method, {&pose, 1}, 1, weights);
    return shown_positions(character, method);
  }
};

// Largest distance of coordinates.
double distance(const std::vector<float>& a, const std::vector<float>& b) {
  EXPECT_EQ(a.size(), b.size());
  double largest = 0;
  for (std::size_t k = 0; k < std::min(a.size(), b.size()); ++k) {
    largest = std::max(largest, std::abs(static_cast<double>(a[k]) - static_cast<double>(b[k])));
  }
  return largest;
}

TEST_F(ActorTest, SkinOnTheDeviceHasTheBitsOfEval) {
  Actor character = small_character();
  Deformer deformer(small_->made, test_device());
  for (const std::size_t count : {1u, 4u, 4u, 1u, 9u}) {  // ghosts come and go
    std::vector<Pose> poses;
    for (std::size_t k = 0; k < count; ++k) poses.push_back(character.pose(static_cast<int>(3 + k), {}));
    const Evaluation& evaluation = character.evaluate(SkinMethod::full, poses, 3, {});
    const Evaluation expected = deformer.evaluate(poses);
    EXPECT_EQ(shown_positions(character, SkinMethod::full), expected.positions) << count;
    EXPECT_EQ(of_last_poses(character, SkinMethod::full, *character.skin(SkinMethod::full).normals), expected.normals);
    EXPECT_EQ(evaluation.strains, expected.strains);
    EXPECT_EQ(evaluation.outside, expected.outside);
    EXPECT_TRUE(evaluation.positions.empty());
    EXPECT_EQ(
        character.measure(SkinMethod::full, poses.back(), 3),
        std::vector<float>(expected.positions.end() - static_cast<std::ptrdiff_t>(expected.positions.size() / count),
                           expected.positions.end()));
  }
}

// A software device that nobody named draws what the CPU's kernels make, as eval does there.
TEST_F(ActorTest, SkinThatASoftwareDeviceOnlyDrawsHasTheBitsOfTheCpu) {
  DeviceChoice choice = test_device();
  choice.name = "auto";
  const auto device = std::make_shared<const vulkan::Device>(choice, vulkan::DeviceUse{.draws = true});
  if (!device->only_draws()) GTEST_SKIP() << device->info().name << " is no software";
  LevelPool pool;
  Actor character(device, {jiggling_->basis, jiggling_->clip}, {}, pool);
  EXPECT_EQ(character.shown().level().tables, nullptr);
  Deformer deformer(jiggling_->made.basis, jiggling_->made.dynamics, {}, {.name = "cpu"});
  const auto drawn = [&](SkinMethod method, std::size_t count) {
    std::vector<float> values = testing::download(*device, *character.skin(method).positions);
    values.resize(count * character.basis().mesh.rest.size());
    return in_output_order(character.basis().mesh, values);
  };
  for (const std::size_t count : {1u, 4u, 1u}) {  // ghosts come and go
    std::vector<Pose> poses;
    for (std::size_t k = 0; k < count; ++k) poses.push_back(character.pose(static_cast<int>(3 + k), {}));
    const Evaluation& evaluation = character.evaluate(SkinMethod::full, poses, 3, {});
    EXPECT_TRUE(evaluation.positions.empty());
    EXPECT_EQ(drawn(SkinMethod::full, count), deformer.evaluate(poses).positions) << count;
  }
  for (const int frame : {1, 2, 3}) {
    const Pose pose = character.pose(frame, {});
    character.evaluate(SkinMethod::jiggle, {&pose, 1}, frame, {});
    EXPECT_EQ(drawn(SkinMethod::jiggle, 1), deformer.jiggle({&pose, 1}, {&frame, 1}).positions) << frame;
  }
}

TEST_F(ActorTest, MeasuringLeavesWhatIsShown) {
  Actor character = small_character();
  const std::vector<float> shown = evaluate(character, SkinMethod::full, character.pose(2, {}), {});
  const Pose other = character.pose(9, {});
  EXPECT_GT(distance(character.measure(SkinMethod::full, other, 9), shown), 0.01);
  EXPECT_EQ(shown_positions(character, SkinMethod::full), shown);
}

TEST_F(ActorTest, JiggleStepsOncePerFrameAsEvalDoes) {
  Actor character(device_, {jiggling_->basis, jiggling_->clip, {}}, {}, pool_);
  ASSERT_TRUE(character.has(SkinMethod::jiggle));
  const auto run = [&] {
    Deformer deformer(jiggling_->made.basis, jiggling_->made.dynamics, {}, test_device());
    for (int frame = 1; frame <= 6; ++frame) {
      const Pose pose = character.pose(frame, {});
      const std::vector<Pose> with_ghosts(3, pose);
      const std::vector<float> expected = deformer.jiggle({&pose, 1}, {&frame, 1}).positions;
      for (int again = 0; again < 2; ++again) {
        character.evaluate(SkinMethod::jiggle, with_ghosts, frame, {});
        character.evaluate(SkinMethod::full, with_ghosts, frame, {});
        EXPECT_EQ(shown_positions(character, SkinMethod::jiggle), expected) << frame;
      }
    }
  };
  run();
  character.reset_jiggle();
  run();
}

TEST_F(ActorTest, JiggleAmountScalesWhatIsShownAndChangesNoState) {
  Actor character(device_, {jiggling_->basis, jiggling_->clip, {}}, {}, pool_);
  for (int frame = 1; frame < 6; ++frame) {
    const Pose pose = character.pose(frame, {});
    character.evaluate(SkinMethod::jiggle, {&pose, 1}, frame, {1, frame % 2 == 0 ? 2.0f : 0.0f});
  }
  Actor plain(device_, {jiggling_->basis, jiggling_->clip, {}}, {}, pool_);
  Pose pose;
  for (int frame = 1; frame <= 6; ++frame) {
    pose = plain.pose(frame, {});
    plain.evaluate(SkinMethod::jiggle, {&pose, 1}, frame, {});
  }
  character.evaluate(SkinMethod::jiggle, {&pose, 1}, 6, {});
  const std::vector<float> jiggled = shown_positions(plain, SkinMethod::jiggle);
  EXPECT_EQ(shown_positions(character, SkinMethod::jiggle), jiggled);
  EXPECT_GT(distance(evaluate(plain, SkinMethod::full, pose, {}), jiggled), 5e-5);
}

TEST_F(ActorTest, CorrectionGoesFromDirectDeltaMushToTheFull) {
  Actor character = small_character();
  const Pose pose = character.pose(8, {});
  const std::vector<float> none = evaluate(character, SkinMethod::full, pose, {0, 1});
  const std::vector<float> half = evaluate(character, SkinMethod::full, pose, {0.5f, 1});
  const std::vector<float> full = evaluate(character, SkinMethod::full, pose, {1, 1});
  EXPECT_EQ(none, evaluate(character, SkinMethod::ddm, pose, {1, 1}));
  Basis plain = small_->made;
  std::fill(plain.residual.weights.begin(), plain.residual.weights.end(), 0.0f);
  EXPECT_EQ(none, Deformer(plain, test_device()).evaluate({&pose, 1}).positions);
  EXPECT_EQ(full, Deformer(small_->made, test_device()).evaluate({&pose, 1}).positions);
  EXPECT_GT(distance(none, full), 1e-3);
  std::vector<float> middle;
  for (std::size_t k = 0; k < none.size(); ++k) middle.push_back(0.5f * (none[k] + full[k]));
  EXPECT_LT(distance(half, middle), 1e-6);
}

TEST_F(ActorTest, LinearPartIsLinearInFeatures) {
  Basis linear = small_->made;
  for (const Region& region : linear.residual.regions) {
    const std::size_t columns = std::size_t{1} + region.coordinate_count + region.centre_count;
    for (std::size_t k = 0; k < region.coefficient_count * columns; ++k) {
      if (k % columns > region.coordinate_count) linear.residual.weights[region.weight_values + k] = 0;
    }
  }
  Actor shown = small_character();
  const Pose bent = shown.pose(8, {});
  EXPECT_EQ(evaluate(shown, SkinMethod::linear, bent, {}),
            Deformer(linear, test_device()).evaluate({&bent, 1}).positions);
  // The control is one of the features: half of it moves every vertex half as far, which kernels do not.
  Actor character = small_character();
  const auto bow = [&](SkinMethod method) {
    std::vector<float> at[3];
    for (int k = 0; k < 3; ++k) {
      ViewSettings::Posing posing;
      posing.controls["breath"] = 0.5 * k;
      at[k] = evaluate(character, method, character.pose(6, posing), {});
    }
    EXPECT_GT(distance(at[0], at[2]), 1e-4);
    for (std::size_t k = 0; k < at[0].size(); ++k) at[0][k] = 0.5f * (at[0][k] + at[2][k]);
    return distance(at[0], at[1]);
  };
  EXPECT_LT(bow(SkinMethod::linear), 1e-6);
  EXPECT_GT(bow(SkinMethod::full), 1e-5);
}

TEST_F(ActorTest, MorePosesThanABatchTakesAreRefused) {
  Deformer deformer(std::make_shared<const vulkan::DeviceModel>(device_, make_character_model(small_->made)));
  const std::vector<Pose> poses(deformer.largest_batch() + std::size_t{1}, bind_pose(small_->made.skeleton));
  const auto evaluate_some = [&](std::size_t count) {
    Evaluation result;
    DeformerCall call{
        .deformer = &deformer, .poses = std::span(poses).first(count), .evaluation = &result, .stays_on_device = true};
    evaluate_together({&call, 1});
    if (call.error) std::rethrow_exception(call.error);
  };
  EXPECT_EQ(kind_of([&] { evaluate_some(poses.size()); }), ErrorKind::usage);
  EXPECT_NO_THROW(evaluate_some(2));
}

TEST_F(ActorTest, PoseOfAFrameBeyondTheClipIsTheNearest) {
  const Actor character = small_character();
  const Clip clip = read_clip(small_->clip, small_->made.skeleton, {});
  const auto same = [](const Pose& a, const Pose& b) {
    return a.joints[0].translation == b.joints[0].translation && a.joints[1].rotation == b.joints[1].rotation;
  };
  EXPECT_TRUE(same(character.pose(-3, {}), clip.poses.front()));
  EXPECT_TRUE(same(character.pose(4, {}), clip.poses[3]));
  EXPECT_TRUE(same(character.pose(1000, {}), clip.poses.back()));
}

TEST_F(ActorTest, PoseTurnsJointsAndSetsControls) {
  const Actor character = small_character();
  ViewSettings::Posing posing;
  posing.joints["upper"] = {0, 90, 0};
  posing.joints["of another character"] = {1, 2, 3};
  posing.controls["breath"] = 0.7;
  const Pose plain = character.pose(5, {}), turned = character.pose(5, posing);
  EXPECT_EQ(turned.joints[0].rotation, plain.joints[0].rotation);
  const Quat expected = plain.joints[1].rotation * axis_angle({0, 1, 0}, std::numbers::pi / 2);
  for (std::size_t k = 0; k < 4; ++k) EXPECT_NEAR(turned.joints[1].rotation[k], expected[k], 1e-12);
  EXPECT_EQ(turned.controls, std::vector<float>{0.7f});
}

// Samples 0, 1, 2 of frames 10, 12, 14: every point its own place. Frame 11 lies halfway between two.
TEST_F(ActorTest, TruthIsThatOfTheFrameInTheOrderOfTheFile) {
  const MeshTable& mesh = small_->made.mesh;
  const std::string path = (*folder_ / "thirds.pc2").string();
  Pc2Writer writer(path, mesh.output_count(), 3, 10, 2);
  const auto points = [&](float sample) {
    std::vector<float> all;
    for (const std::uint32_t v : mesh.output_vertex) {
      for (const float x : {0.0f, 1.0f, 2.0f}) all.push_back(static_cast<float>(3 * v) + x + 0.25f * sample);
    }
    return all;
  };
  for (const float sample : {0.0f, 1.0f, 2.0f}) writer.append(points(sample));
  writer.close();
  Actor character = small_character();
  EXPECT_TRUE(character.has(SkinMethod::truth));
  character.open_truth(path);
  const Pose pose = character.pose(1, {});
  const std::pair<int, float> shown[] = {{10, 0}, {12, 1}, {13, 1.5f}, {14, 2}, {10, 0}, {11, 0.5f}};
  for (const auto& [frame, sample] : shown) {
    character.evaluate(SkinMethod::truth, {&pose, 1}, frame, {});
    EXPECT_EQ(in_output_order(character.basis().mesh, download(*character.skin(SkinMethod::truth).positions)),
              points(sample))
        << frame;
  }
  std::vector<float> normals(mesh.rest.size());
  cpu::output_normals(mesh, download(*character.skin(SkinMethod::truth).positions), normals);
  EXPECT_EQ(download(*character.skin(SkinMethod::truth).normals), normals);
  // Figures are of frames that are there.
  EXPECT_EQ(character.measure(SkinMethod::truth, pose, 12), points(1));
  EXPECT_EQ(character.truth_time(12), (SampleTime{1, 0}));
  EXPECT_EQ(character.truth_time(13), (SampleTime{1, 0.5f}));
  EXPECT_TRUE(character.has_sample_at(12));
  EXPECT_FALSE(character.has_sample_at(13));
  for (const int frame : {-50, 8, 9, 15, 100, 5000}) {
    EXPECT_FALSE(character.truth_time(frame).has_value()) << frame;
    EXPECT_FALSE(character.has_sample_at(frame)) << frame;
  }
}

TEST_F(ActorTest, TruthOfAnotherCharacterIsRefusedAndTheOldOneStays) {
  Actor character = small_character();
  const std::string other = (*folder_ / "other.pc2").string(), empty = (*folder_ / "empty.pc2").string();
  Pc2Writer writer(other, 7, 1);
  writer.append(std::vector<float>(21));
  writer.close();
  Pc2Writer(empty, small_->made.mesh.output_count(), 0).close();
  EXPECT_EQ(kind_of([&] { character.open_truth(other); }), ErrorKind::mismatch);
  EXPECT_EQ(kind_of([&] { character.open_truth(empty); }), ErrorKind::file);
  EXPECT_EQ(kind_of([&] { character.open_truth((*folder_ / "none.pc2").string()); }), ErrorKind::file);
  EXPECT_EQ(character.files().truth, small_->truth);
  EXPECT_FALSE(character.measure(SkinMethod::truth, character.pose(1, {}), 1).empty());
}

TEST_F(ActorTest, TruthThatIsCutOffOrTakenAwayIsLeftOut) {
  for (const bool removed : {false, true}) {
    const std::string path = (*folder_ / "goes_away.pc2").string();
    std::filesystem::copy_file(small_->truth, path);
    Actor character = small_character();
    character.open_truth(path);
    const Pose pose = character.pose(1, {});
    character.evaluate(SkinMethod::truth, {&pose, 1}, 1, {});
    if (removed) {
      std::filesystem::remove(path);
    } else {
      std::filesystem::resize_file(path, 100);
    }
    character.evaluate(SkinMethod::truth, {&pose, 1}, 1, {});  // what is on the device needs no file
    EXPECT_EQ(kind_of([&] { character.evaluate(SkinMethod::truth, {&pose, 1}, 7, {}); }), ErrorKind::file);
    EXPECT_FALSE(character.has(SkinMethod::truth));
    character.evaluate(SkinMethod::full, {&pose, 1}, 7, {});
    std::filesystem::remove(path);
  }
}

TEST_F(ActorTest, ClipOfAnotherSkeletonIsRefusedAndTheOldOneStays) {
  Actor character = small_character();
  EXPECT_EQ(kind_of([&] { character.open_clip(jiggling_->clip); }), ErrorKind::mismatch);
  EXPECT_EQ(kind_of([&] { character.open_clip((*folder_ / "none.bvh").string()); }), ErrorKind::file);
  EXPECT_EQ(character.clip().last_frame(), kClipFrames);
  EXPECT_EQ(character.files().clip, small_->clip);
}

TEST_F(ActorTest, DynamicsOfAnotherBasisAreRefused) {
  const TemporaryFolder folder;
  std::filesystem::copy_file(small_->basis, folder / "a.safetensors");
  std::filesystem::copy_file(*folder_ / "limb.dynamics.safetensors", folder / "a.dynamics.safetensors");
  EXPECT_EQ(kind_of([&] {
              Actor(device_, {(folder / "a.safetensors").string(), {}, {}}, {}, pool_);
            }),
            ErrorKind::mismatch);
}

TEST_F(ActorTest, WatchesWhatLiesBesideTheBasisEvenBeforeItIsThere) {
  const ActorFiles files{.basis = "a/hero.safetensors", .clip = "shot.glb#walk", .proxy = "p.safetensors"};
  EXPECT_EQ(files.paths(),
            (std::vector<std::filesystem::path>{"a/hero.dynamics.safetensors", "a/hero.attached.safetensors",
                                                "a/hero.safetensors", "shot.glb", "p.safetensors"}));
}

TEST_F(ActorTest, WithoutAClipItStandsInTheBindPose) {
  Actor character(device_, {small_->basis, {}, {}}, {}, pool_);
  EXPECT_EQ(character.clip().poses.size(), 240u);  // ten seconds, to be posed
  EXPECT_FALSE(character.has(SkinMethod::truth));
  EXPECT_FALSE(character.has(SkinMethod::jiggle));
  // A cylinder of 1 m between caps 5 cm out.
  EXPECT_NEAR(character.ground(), -0.05, 0.02);
  EXPECT_NEAR(character.size(), std::hypot(1.1, 0.2, 0.2), 0.02);
}

// Nodes on the skin are where the skin carries them, without the jiggle and as it begins.
TEST_F(ActorTest, TetsLieUnderTheSkin) {
  Actor character(device_, {jiggling_->basis, jiggling_->clip}, {}, pool_);
  const std::vector<SurfacePoint>& surface = jiggling_->made.dynamics.tets.surface;
  ASSERT_FALSE(surface.empty());
  for (const int frame : {2, 9}) {
    const Pose pose = character.pose(frame, {});
    character.evaluate(SkinMethod::full, {&pose, 1}, frame, {});
    const std::vector<float> skin = download(*character.skin(SkinMethod::full).positions);
    character.reset_jiggle();
    character.evaluate(SkinMethod::jiggle, {&pose, 1}, frame, {});
    for (const std::optional<float> jiggle : {std::optional<float>(), std::optional(1.0f)}) {
      const std::vector<float> nodes = download(character.shown().cut_tets(pose, jiggle, {0, 0, 1}, 0.4).positions());
      EXPECT_EQ(nodes.size(), jiggling_->made.dynamics.tets.nodes.size());
      for (std::size_t b = 0; b < surface.size(); ++b) {
        const SurfacePoint& p = surface[b];
        for (std::size_t i = 0; i < 3; ++i) {
          const float expected = p.wa * skin[3 * p.a + i] + p.wb * skin[3 * p.b + i] + p.wc * skin[3 * p.c + i];
          ASSERT_NEAR(nodes[3 * b + i], expected, 1e-5f) << b;
        }
      }
    }
  }
}

// Of vertices of the trained limb between two heights of the rest shape, the mean, mm.
double mean_between(const Basis& basis, const std::vector<float>& metres, float low, float high) {
  double sum = 0, count = 0;
  for (std::size_t v = 0; v < metres.size(); ++v) {
    const float z = basis.mesh.rest[3 * v + 2];
    if (z < low || z > high) continue;
    sum += 1e3 * static_cast<double>(metres[v]);
    ++count;
  }
  return sum / count;
}

// Its wrist, at 0.5 m, was turned by 0.7 at most.
TEST_F(ActorTest, ErrorIsExpectedWhereThePoseLeavesTheTraining) {
  Actor character(device_, {trained_->basis}, {}, pool_);
  const Skeleton& skeleton = trained_->made.skeleton;
  const Pose usual = limb_pose(skeleton, 0.6, 0.2, 0.3), far = limb_pose(skeleton, 0.6, 0.2, 2);
  ASSERT_TRUE(character.shown().knows_coverage());
  character.evaluate(SkinMethod::full, std::vector{usual, far}, 1, {});
  const std::vector<float> before = download(character.shown().expected_skin(SkinMethod::full).vertices);
  const Evaluation& evaluated = character.evaluate(SkinMethod::full, std::vector{far, usual}, 1, {});
  const ExpectedSkin& skin = character.shown().expected_skin(SkinMethod::full);
  const std::vector<float> after = download(skin.vertices);
  ASSERT_EQ(after.size(), trained_->made.mesh.vertex_count());
  EXPECT_GT(mean_between(trained_->made, after, 0.48f, 0.56f), 10 * mean_between(trained_->made, before, 0.48f, 0.56f));
  EXPECT_LT(mean_between(trained_->made, after, 0, 0.12f), 0.4 * mean_between(trained_->made, after, 0.48f, 0.56f));
  // As coverage has it of the whole skin, but for what shares of regions are in the basis.
  double squares = 0, largest = 0;
  for (const float metres : after) {
    squares += 1e6 * static_cast<double>(metres) * static_cast<double>(metres);
    largest = std::max(largest, 1e3 * static_cast<double>(metres));
  }
  EXPECT_EQ(skin.largest_mm, largest);
  const double rms = ErrorExpectation(trained_->made).of(evaluated, 0).rms_mm;
  EXPECT_EQ(skin.rms_mm, rms);
  EXPECT_NEAR(std::sqrt(squares / static_cast<double>(after.size())), rms, 0.2 * rms);
}

TEST_F(ActorTest, WithoutShapesNoErrorIsExpected) {
  EXPECT_FALSE(Actor(device_, {jiggling_->basis}, {}, pool_).shown().knows_coverage());
}

// A character in a folder of its own, with an outfit.
std::string dressed(const JigglingCharacter& character, const TemporaryFolder& folder) {
  const std::string basis = (folder / "limb.safetensors").string();
  std::filesystem::copy_file(character.basis, basis);
  save_attachments(limb_outfit(), folder / "limb.attached.safetensors");
  return basis;
}

TEST_F(ActorTest, EveryPoseWearsItsOwn) {
  const TemporaryFolder folder;
  Actor character(device_, {dressed(*jiggling_, folder), jiggling_->clip}, {}, pool_);
  const std::vector<Pose> poses = {character.pose(1, {}), character.pose(9, {})};
  const Evaluation& result = character.evaluate(SkinMethod::full, poses, 1, {});
  const std::size_t count = result.positions.size() / 2;
  const WornMesh& sleeve = character.worn(SkinMethod::full)[2];
  const std::vector<float> worn = download(sleeve.positions);
  ASSERT_EQ(worn.size(), 2 * std::size_t{3} * sleeve.vertex_count);
  const Attachments outfit = limb_outfit();
  const FollowingMeshes carrier(jiggling_->made.basis, outfit);
  for (std::size_t k = 0; k < 2; ++k) {
    const auto expected = carrier.carry(std::span(result.positions).subspan(k * count, count), poses[k].joints)[2];
    EXPECT_LT(distance({worn.begin() + static_cast<std::ptrdiff_t>(k * expected.size()),
                        worn.begin() + static_cast<std::ptrdiff_t>((k + 1) * expected.size())},
                       expected),
              1e-6);
  }
  EXPECT_GT(character.reach(), character.size()) << "the blade stands off";
}

// The skin of every one is drawn, also where batches are short, as those of the CPU are.
TEST_F(ActorTest, ManyDressedPosesAreOnTheDeviceTogether) {
  const TemporaryFolder folder;
  const auto software = std::make_shared<const vulkan::Device>(DeviceChoice{}, vulkan::DeviceUse{.draws = true});
  for (const auto& device : {device_, software}) {
    Actor character(device, {.basis = dressed(*jiggling_, folder), .clip = jiggling_->clip}, {}, pool_);
    std::filesystem::remove(folder / "limb.safetensors");
    std::vector<Pose> many;
    for (int k = 0; k < 20; ++k) many.push_back(character.pose(1 + k % kClipFrames, {}));
    const std::vector<float> result = character.evaluate(SkinMethod::full, many, 1, {}).positions;
    const std::vector<float> drawn = testing::download(*device, *character.skin(SkinMethod::full).positions);
    const MeshTable& mesh = character.basis().mesh;
    const std::size_t skin = 3 * std::size_t{mesh.vertex_count()}, outputs = mesh.output_count();
    ASSERT_GE(drawn.size(), many.size() * skin);
    for (std::size_t k = 0; k < many.size(); ++k) {
      for (std::size_t o = 0; o < outputs; ++o) {
        ASSERT_EQ(drawn[k * skin + 3 * mesh.output_vertex[o]], result[3 * (k * outputs + o)]) << k << " " << o;
      }
    }
  }
}

TEST_F(ActorTest, MoreDressedPosesThanABatchTakesAreRefused) {
  const TemporaryFolder folder;
  Actor character(device_, {.basis = dressed(*jiggling_, folder), .clip = jiggling_->clip}, {}, pool_);
  const Deformer of_character(
      std::make_shared<const vulkan::DeviceModel>(device_, make_character_model(jiggling_->made.basis)));
  const std::vector<Pose> many(of_character.largest_batch() + std::size_t{1}, character.pose(1, {}));
  EXPECT_EQ(kind_of([&] { character.evaluate(SkinMethod::full, many, 1, {}); }), ErrorKind::usage);
}

// The truth is half a metre above.
TEST_F(ActorTest, WhatIsComparedWithWearsItToo) {
  const TemporaryFolder folder;
  const std::string truth = (folder / "truth.pc2").string();
  write_truth(jiggling_->made.basis, read_clip(jiggling_->clip, jiggling_->made.basis.skeleton, {}), 0.5f, truth);
  Actor character(device_, {.basis = dressed(*jiggling_, folder), .clip = jiggling_->clip, .truth = truth}, {}, pool_);
  const Pose pose = character.pose(4, {});
  for (const SkinMethod method : {SkinMethod::full, SkinMethod::truth}) character.evaluate(method, {&pose, 1}, 4, {});
  std::vector<float> expected = download(character.worn(SkinMethod::full)[2].positions);
  for (std::size_t k = 1; k < expected.size(); k += 3) expected[k] += 0.5f;
  EXPECT_LT(distance(download(character.worn(SkinMethod::truth)[2].positions), expected), 1e-4);
}

// What is the same is carried and uploaded once.
TEST_F(ActorTest, WhatItWearsMovesWithTheSkinAlone) {
  const TemporaryFolder folder;
  const std::string basis = (folder / "limb.safetensors").string();
  std::filesystem::copy_file(jiggling_->basis, basis);
  save_attachments(limb_outfit(), folder / "limb.attached.safetensors");
  save_dynamics(jiggling_->made.dynamics, folder / "limb.dynamics.safetensors");
  Actor character(device_, {basis, jiggling_->clip}, {}, pool_);
  const auto worn = [&](SkinMethod method) -> const vulkan::Buffer& {
    return character.worn(method)[2].positions;  // the sleeve
  };
  const auto evaluate = [&](SkinMethod method, int frame) {
    const Pose pose = character.pose(frame, {});
    character.evaluate(method, {&pose, 1}, frame, {});
  };
  for (int frame = 1; frame < 9; ++frame) evaluate(SkinMethod::jiggle, frame);
  evaluate(SkinMethod::full, 8);
  const std::vector<float> jiggled = download(worn(SkinMethod::jiggle)), still = download(worn(SkinMethod::full));
  EXPECT_GT(distance(jiggled, still), 1e-5);
  const VkBuffer buffer = worn(SkinMethod::full).handle();
  evaluate(SkinMethod::full, 8);
  EXPECT_EQ(worn(SkinMethod::full).handle(), buffer);
  evaluate(SkinMethod::full, 2);
  EXPECT_GT(distance(download(worn(SkinMethod::full)), still), 0.01);
  Actor bare = small_character();
  bare.evaluate(SkinMethod::full, std::vector{bare.pose(1, {})}, 1, {});
  EXPECT_TRUE(bare.worn(SkinMethod::full).empty());
}

}  // namespace
}  // namespace bodyopt::testing
