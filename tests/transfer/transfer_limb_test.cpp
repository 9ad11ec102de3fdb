// Skeletons, skins, bases and datasets of a synthetic limb, carried to itself and to others.
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>

#include "assets/caches/pc2.h"
#include "assets/clips/matched_joints.h"
#include "dataset/dataset.h"
#include "dataset/modifier.h"
#include "geometry/mesh.h"
#include "runtime/deformer/deformer.h"
#include "runtime/host/device_choice.h"
#include "runtime/host/rig.h"
#include "tests/support/capsule_limb.h"
#include "tests/support/error_kind.h"
#include "tests/support/temporary_folder.h"
#include "tests/transfer/refined_limb.h"
#include "trainer/train/coverage/coverage.h"
#include "trainer/train/features/features.h"
#include "trainer/train/fit/train.h"
#include "trainer/train/skinning/ddm.h"
#include "trainer/train/skinning/unpose.h"
#include "trainer/transfer/carry_parts.h"
#include "trainer/transfer/correspondence.h"
#include "trainer/transfer/transfer_basis.h"
#include "trainer/transfer/transfer_columns.h"

namespace bodyopt::trainer {
namespace {

const SampleSet& limb_set() {
  static const SampleSet set = limb_samples(120, 20);
  return set;
}

const Basis& trained_limb() {
  static const Basis basis = train(limb_set(), {}).basis;
  return basis;
}

// The limb moved by an affine map of its rest: vertices and joints.
Character moved_limb(const Affine& map) {
  Character limb = limb_character();
  for (Eigen::Index v = 0; v < limb.vertices.rows(); ++v) {
    const Vec3 to = map * Vec3{limb.vertices(v, 0), limb.vertices(v, 1), limb.vertices(v, 2)};
    limb.vertices.row(v) << to[0], to[1], to[2];
  }
  for (std::size_t j = 0; j < limb.skeleton.size(); ++j) {
    Joint& joint = limb.skeleton.joints[j];
    Affine world = map * inverse(joint.inverse_bind);
    world = affine_from({{world.m[0][3], world.m[1][3], world.m[2][3]}, decompose(world).rotation, {1, 1, 1}});
    joint.inverse_bind = inverse(world);
    joint.bind = decompose(j == 0 ? world : limb.skeleton.joints[j - 1].inverse_bind * world);
    joint.default_local = joint.bind;
  }
  return limb;
}

Positions evaluate(const Basis& basis, const Pose& pose) {
  Deformer deformer(basis, {.name = "cpu"});
  return rows_of(deformer.evaluate({&pose, 1}).positions);
}

double rms(const Positions& difference) {
  return std::sqrt(difference.squaredNorm() / static_cast<double>(difference.rows()));
}

// What the trained limb is off its Direct Delta Mush; runtime order.
Positions unposed_displacement(const Pose& pose) {
  const MeshTable& mesh = trained_limb().mesh;
  const Positions output = evaluate(trained_limb(), pose);
  Positions shape(mesh.vertex_count(), 3);
  for (std::uint32_t o = 0; o < mesh.output_count(); ++o) shape.row(mesh.output_vertex[o]) = output.row(o);
  return unpose_ddm(trained_limb(), pose, shape);
}

// What the source is off its own Direct Delta Mush, carried and put on the target's; output order.
Positions transferred_frame(const TransferPair& pair, const Pose& pose) {
  const Positions carried = pair.skin(unposed_displacement(pose));
  const Pose moved = transferred_pose(pair.match, pair.source.skeleton, pair.target.skeleton, pose);
  // Un-posing is an isometry: the target's bare shape, un-posed, differs from the one wanted by a turn per vertex.
  const Positions bare = evaluate(pair.target, moved);
  Positions result(bare.rows(), 3);
  Positions unit[3];
  Positions runtime(pair.target.mesh.vertex_count(), 3);
  for (std::uint32_t o = 0; o < pair.target.mesh.output_count(); ++o) {
    runtime.row(pair.target.mesh.output_vertex[o]) = bare.row(o);
  }
  for (int axis = 0; axis < 3; ++axis) {  // column `axis` of R^T: what a step along it un-poses to
    Positions step = runtime;
    step.col(axis).array() += 1;
    unit[axis] = unpose_ddm(pair.target, moved, step) - unpose_ddm(pair.target, moved, runtime);
  }
  for (std::uint32_t o = 0; o < pair.target.mesh.output_count(); ++o) {
    const std::uint32_t v = pair.target.mesh.output_vertex[o];
    for (int axis = 0; axis < 3; ++axis) result(o, axis) = bare(o, axis) + unit[axis].row(v).dot(carried.row(v));
  }
  return result;
}

const Pose& bent() {
  static const Pose pose = limb_set().heldout[7].pose;
  return pose;
}

}  // namespace

TEST(TransferLimb, ModifiersStayWithTheSourceAndThatIsSaid) {
  Basis source = trained_limb();
  SkinModifier& smile = source.modifiers.stack.emplace_back();
  smile.name = "smile";
  smile.type = "morph";
  smile.component_count = 1;
  source.modifiers.blend_begin.assign(source.mesh.block_count() + 1, 0);
  const TransferPair pair(source, limb_character(), {});
  std::vector<std::string> notes;
  EXPECT_TRUE(transfer_basis(pair, {}, notes).modifiers.empty());
  ASSERT_EQ(notes.size(), 1u);
  EXPECT_NE(notes[0].find("bodyopt modifiers"), std::string::npos) << notes[0];
}

TEST(TransferLimb, ABasisCarriedToItsOwnCharacterIsTheSame) {
  const TransferPair pair(trained_limb(), limb_character(), {});
  ASSERT_TRUE(pair.correspondence.same_topology);
  std::vector<std::string> notes;
  const Basis result = transfer_basis(pair, {}, notes);
  EXPECT_TRUE(notes.empty());
  EXPECT_EQ(result.residual.projections, trained_limb().residual.projections);
  EXPECT_EQ(result.residual.centres, trained_limb().residual.centres);
  EXPECT_EQ(result.residual.fade.directions, trained_limb().residual.fade.directions);
  EXPECT_EQ(result.strain.rest_length, trained_limb().strain.rest_length);
  for (const Sample& sample : limb_set().heldout) {
    EXPECT_LT(rms(evaluate(result, sample.pose) - evaluate(trained_limb(), sample.pose)), 5e-5);
  }
}

TEST(TransferLimb, AScaledAndTurnedCharacterMovesAlike) {
  Affine map = affine_from({{0.3, -0.2, 1}, axis_angle({1, 0, 0}, 0.8), {1, 1, 1}});
  for (auto& row : map.m) {
    for (int k = 0; k < 3; ++k) row[k] *= 1.7;
  }
  TransferOptions options;
  options.tolerance = 1e-7;
  const TransferPair pair(trained_limb(), moved_limb(map), options);
  EXPECT_NEAR(pair.match.size, 1.7, 1e-9);
  std::vector<std::string> notes;
  const Basis result = transfer_basis(pair, options, notes);
  const Pose moved = transferred_pose(pair.match, pair.source.skeleton, pair.target.skeleton, bent());
  const Positions expected = 1.7 * evaluate(trained_limb(), bent());
  Positions difference = evaluate(result, moved) - expected;
  difference.rowwise() -= difference.colwise().mean().eval();  // of where the root stands
  EXPECT_LT(rms(difference), 1e-4);                            // features in other axes are projected by other halves
  Positions per_frame = transferred_frame(pair, bent()) - expected;
  per_frame.rowwise() -= per_frame.colwise().mean().eval();
  EXPECT_LT(per_frame.cwiseAbs().maxCoeff(), 1e-5 * longest_extent(expected));
  // At rest it is at rest.
  const Positions rest = evaluate(result, bind_pose(result.skeleton)),
                  bare = evaluate(pair.target, bind_pose(result.skeleton));
  EXPECT_EQ(rest, bare);
}

// The basis without fibres: what is left is told by joints alone.
Basis trained_by_joints() {
  SampleSet set = limb_set();
  set.muscles.clear();
  return train(set, {}).basis;
}

// What the live transfer is off that of each frame, less what the source shows where it stands as the target rests; and
// what is carried at all; root mean squares over some held-out frames, metres.
struct LiveError {
  double error = 0, carried = 0;
};

LiveError live_error(const Basis& source, const Character& target) {
  const TransferPair pair(source, target, {});
  std::vector<std::string> notes;
  const Basis result = transfer_basis(pair, {}, notes);
  const auto displacement = [&](const Basis& basis, const Pose& pose) {
    const Positions output = evaluate(basis, pose);
    Positions shape(basis.mesh.vertex_count(), 3);
    for (std::uint32_t o = 0; o < basis.mesh.output_count(); ++o)
      shape.row(basis.mesh.output_vertex[o]) = output.row(o);
    return unpose_ddm(basis, pose, shape);
  };
  const Positions at_rest = pair.skin(displacement(source, pose_at_target_rest(pair.match, source.skeleton)));
  LiveError mean;
  std::size_t count = 0;
  for (std::size_t k = 0; k < limb_set().heldout.size(); k += 5, ++count) {
    Pose pose = limb_set().heldout[k].pose;
    pose.joints.resize(source.skeleton.size());
    const Pose moved = transferred_pose(pair.match, source.skeleton, result.skeleton, pose);
    const Positions wanted = pair.skin(displacement(source, pose)) - at_rest;
    mean.error += std::pow(rms(displacement(result, moved) - wanted), 2);
    mean.carried += std::pow(rms(wanted), 2);
  }
  return {std::sqrt(mean.error / static_cast<double>(count)), std::sqrt(mean.carried / static_cast<double>(count))};
}

// The limb with a joint more, half-way along the forearm, that the skin does not know.
Character limb_with_twist_joint() {
  Character limb = limb_character();
  Skeleton& skeleton = limb.skeleton;
  Joint twist = skeleton.joints[2];
  twist.name = "twist";
  twist.bind.translation[2] = twist.default_local.translation[2] = 0.1;
  twist.inverse_bind.m[2][3] = -0.4;
  skeleton.joints.insert(skeleton.joints.begin() + 2, twist);
  skeleton.joints[3].parent = 2;
  skeleton.joints[3].bind.translation[2] = skeleton.joints[3].default_local.translation[2] = 0.1;
  for (std::vector<JointWeight>& weights : limb.weights) {
    for (JointWeight& weight : weights) weight.joint += weight.joint == 2 ? 1 : 0;
  }
  return limb;
}

// The limb as it is bent at rest, its joints resting so, too.
Character bent_limb(double angle) {
  Character limb = limb_character();
  const Pose pose = limb_pose(limb.skeleton, angle, 0, 0);
  limb.vertices = skin_linear(limb, pose);
  const std::vector<Affine> world = posed_joints(limb.skeleton, pose.joints);
  for (std::size_t j = 0; j < limb.skeleton.size(); ++j) {
    Joint& joint = limb.skeleton.joints[j];
    joint.bind = joint.default_local = pose.joints[j];
    joint.inverse_bind = inverse(world[j]);
  }
  return limb;
}

TEST(TransferLimb, LiveTransferIsThatOfEachFrame) {
  Affine stockier;
  stockier.m[0][0] = stockier.m[1][1] = 1.4;
  stockier.m[2][2] = 0.9;
  const Basis source = trained_by_joints();
  const std::pair<const char*, Character> targets[] = {{"stockier", moved_limb(stockier)},
                                                       {"finer", refined_limb()},
                                                       {"a joint more", limb_with_twist_joint()},
                                                       {"another rest", bent_limb(0.9)}};
  for (const auto& [name, target] : targets) {
    const LiveError told = live_error(source, target);
    EXPECT_GT(told.carried, 5e-4) << name;
    EXPECT_LT(told.error, std::max(5e-5, 0.01 * told.carried)) << name;
  }
}

// Trained with a twist joint that does not turn by itself, carried to a limb that lacks it.
TEST(TransferLimb, LiveTransferIsThatOfEachFrameWhereAJointIsLacking) {
  SampleSet set = limb_set();
  set.muscles.clear();
  set.character = limb_with_twist_joint();
  const auto with_twist = [&](Pose& pose) {
    pose.joints.insert(pose.joints.begin() + 2, set.character.skeleton.joints[2].bind);
    pose.joints[3].translation = set.character.skeleton.joints[3].bind.translation;
  };
  for (std::vector<Sample>* samples : {&set.train, &set.heldout}) {
    for (Sample& sample : *samples) with_twist(sample.pose);
  }
  const Basis source = train(set, {}).basis;
  const TransferPair pair(source, limb_character(), {});
  std::vector<std::string> notes;
  const Basis result = transfer_basis(pair, {}, notes);
  for (std::size_t k = 0; k < set.heldout.size(); k += 5) {
    const Positions wanted = evaluate(source, set.heldout[k].pose);
    EXPECT_LT(rms(evaluate(result, limb_set().heldout[k].pose) - wanted), 5e-5);
  }
}

// Where a body rests bent, its fibres are strained as those of the source are where it is bent so.
TEST(TransferLimb, FibresAreStrainedAtRestAsTheSourcesAreInThatPose) {
  const TransferPair pair(trained_limb(), bent_limb(0.9), {});
  std::vector<std::string> notes;
  const Basis result = transfer_basis(pair, {}, notes);
  const std::vector<float> wanted = measure_strains(trained_limb(), pose_at_target_rest(pair.match, limb_skeleton())),
                           there = measure_strains(result, bind_pose(result.skeleton));
  ASSERT_EQ(there.size(), wanted.size());
  for (std::size_t k = 0; k < there.size(); ++k) {
    EXPECT_GT(std::abs(wanted[k]), 0.01f);
    EXPECT_NEAR(there[k], wanted[k], 1e-5f);
  }
}

// The same poses are as well known on the target as on the source.
TEST(TransferLimb, ErrorsAreExpectedAsOnTheSource) {
  for (const Character& target : {bent_limb(0.9), limb_with_twist_joint()}) {
    const TransferPair pair(trained_limb(), target, {});
    std::vector<std::string> notes;
    const Basis result = transfer_basis(pair, {}, notes);
    for (std::size_t k = 0; k < limb_set().heldout.size(); k += 5) {
      const Pose& pose = limb_set().heldout[k].pose;
      const double own = expected_errors(trained_limb(), {pose})[0].rms_mm;
      const Pose moved = transferred_pose(pair.match, pair.source.skeleton, result.skeleton, pose);
      EXPECT_NEAR(expected_errors(result, {moved})[0].rms_mm, own, 0.1 * own);
    }
  }
}

// Vertices of one number: the skin says whether that is likely.
TEST(TransferLimb, TheSameTrianglesTurnedInsideTheirJointsAreUnlike) {
  Character turned = limb_character();
  turned.vertices.col(2) = (kLimbLength - turned.vertices.col(2).array()).matrix();
  turned.vertices.col(0) *= -1;
  for (Eigen::Index v = 0; v < turned.vertices.rows(); ++v) {
    turned.weights[static_cast<std::size_t>(v)] = limb_weights(turned.vertices(v, 2));
  }
  const TransferPair alike(trained_limb(), limb_character(), {}), unlike(trained_limb(), turned, {});
  ASSERT_TRUE(unlike.correspondence.same_topology);
  EXPECT_GT(alike.correspondence.mean_confidence(), 0.99);
  EXPECT_LT(unlike.correspondence.mean_confidence(), 0.5);
}

TEST(TransferLimb, MarkersThatAgreeWithTheNumbersChangeNothing) {
  const auto matched = [](const std::vector<SkinMarker>& markers) {
    return TransferPair(trained_limb(), limb_character(), {.markers = markers}).correspondence;
  };
  const Correspondence agreed = matched({{100, 100}, {200, 200}});
  EXPECT_TRUE(agreed.same_topology);
  EXPECT_TRUE(agreed.notes.empty());
  const Correspondence contradicted = matched({{100, 100}, {200, 208}});
  EXPECT_FALSE(contradicted.same_topology);
  EXPECT_EQ(contradicted.notes.size(), 1u);
}

TEST(TransferLimb, AFinerSkinIsMatchedWhereItIs) {
  const Character finer = refined_limb();
  const TransferPair pair(trained_limb(), finer, {});
  ASSERT_FALSE(pair.correspondence.same_topology);
  const std::vector<std::uint32_t> order = morton_order(finer.vertices);
  Positions found(finer.vertices.rows(), 3);
  for (std::size_t v = 0; v < order.size(); ++v) {
    const SkinPoint& at = pair.correspondence.at[v];
    Eigen::RowVector3d place = Eigen::RowVector3d::Zero();
    for (int k = 0; k < 3; ++k) {
      const float* corner = trained_limb().mesh.rest.data() + 3 * at.vertices[static_cast<std::size_t>(k)];
      place += at.weights[k] * Eigen::RowVector3f(corner[0], corner[1], corner[2]).cast<double>();
    }
    found.row(order[v]) = place;
  }
  EXPECT_LT(rms(found - finer.vertices), 3e-4);  // half a per cent of its thickness
  EXPECT_GT(pair.correspondence.mean_confidence(), 0.95);
}

// Both lie in one box: a point of either has the colour of its place.
TEST(TransferLimb, MatchedPointsHaveOneColourAndAreAsSureOnEitherBody) {
  TransferPair pair(trained_limb(), refined_limb(), {});
  const Positions source = rows_of(trained_limb().mesh.rest), target = rows_of(pair.target.mesh.rest);
  const Positions colours = place_colours(source);
  EXPECT_LT(rms(matched_colours(pair.correspondence, colours) - place_colours(target)), 0.01);
  EXPECT_GT(rms(colours.rowwise() - colours.colwise().mean()), 0.1);  // one place is not as another
  pair.correspondence.confidence = target.col(2) / target.col(2).maxCoeff();
  const Eigen::VectorXd told = source_confidence(pair.correspondence, rows_of(pair.target.mesh.triangles));
  ASSERT_EQ(told.size(), source.rows());
  EXPECT_LT((told - source.col(2) / target.col(2).maxCoeff()).cwiseAbs().maxCoeff(), 0.03);
}

// A hole in the skin, and a triangle that hangs beside it: it is no part of the source, and stays as it is un-posed.
TEST(TransferLimb, AnOpenTargetInPiecesIsCarriedTo) {
  Character target = refined_limb();
  const Eigen::Index vertices = target.vertices.rows(), triangles = target.triangles.rows() - 8;
  target.vertices.conservativeResize(vertices + 3, 3);
  target.triangles.conservativeResize(triangles + 1, 3);
  const double away = 1.5 * longest_extent(target.vertices.topRows(vertices));
  for (Eigen::Index k = 0; k < 3; ++k) {
    target.vertices.row(vertices + k) << away + (k == 1 ? 0.01 : 0), k == 2 ? 0.01 : 0, 0.2;
    target.triangles(triangles, k) = static_cast<std::uint32_t>(vertices + k);
    target.weights.push_back({{0, 1}});
    target.output_vertex.push_back(static_cast<std::uint32_t>(vertices + k));
  }
  target.output_triangles = target.triangles;
  const TransferPair pair(trained_limb(), target, {});
  EXPECT_GT(pair.correspondence.mean_confidence(), 0.8);
  const Positions carried = pair.skin(unposed_displacement(bent()));
  ASSERT_TRUE(carried.allFinite());
  const std::vector<std::uint32_t> order = morton_order(target.vertices);
  for (std::size_t v = 0; v < order.size(); ++v) {
    if (order[v] < static_cast<std::uint32_t>(vertices)) continue;
    EXPECT_LT(pair.correspondence.confidence[static_cast<Eigen::Index>(v)], kSureConfidence);
    EXPECT_LT(carried.row(static_cast<Eigen::Index>(v)).norm(), 1e-6);
  }
  std::vector<std::string> notes;
  EXPECT_TRUE(evaluate(transfer_basis(pair, {}, notes), bent()).allFinite());
}

TEST(TransferLimb, ADatasetCarriedToItsOwnCharacterIsTheSame) {
  const TemporaryFolder folder;
  const Character limb = limb_character();
  write_character(limb, folder / "limb.glb");
  Clip clip;
  clip.name = "bend";
  for (const Sample& sample : limb_set().heldout) clip.poses.push_back(sample.pose);
  write_clip(clip, limb.skeleton, folder / "bend.glb");
  write_muscles(limb_muscles(), limb.skeleton, folder / "muscles.json");
  const auto count = static_cast<std::uint32_t>(clip.poses.size());
  Pc2Writer writer(folder / "bend.pc2", limb.output_count(), count);
  std::vector<int> frames;
  for (const Sample& sample : limb_set().heldout) {
    writer.append(output_from_welded(limb, sample.shape.read()));
    frames.push_back(static_cast<int>(frames.size()) + 1);
  }
  writer.close();
  Dataset dataset;
  dataset.folder = folder.path();
  dataset.character = "limb.glb";
  dataset.muscles = "muscles.json";
  dataset.takes.push_back({"bend", "bend.glb", "", 24, 1, frames, "bend.pc2", "", {3}});
  dataset.modifiers = {{.name = "even", .type = "smooth", .strength = 0.5}};
  dataset.selections.push_back({"first", Json::array({{{"take", "bend"}, {"frames", "1-3"}}})});

  const Character read = read_character(folder / "limb.glb");
  const Basis source = build_ddm_basis(read, {});
  const TransferPair pair(source, read, {});
  const TransferredDataset told = transfer_dataset(dataset, read, pair, {read, folder / "limb.glb"}, folder / "copy");
  EXPECT_EQ(told.frames, frames.size());

  transfer_dataset(dataset, read, pair, {read, folder / "limb.glb"}, folder / "copy");  // again: nothing is there twice
  const Dataset copy = read_dataset(folder / "copy" / "dataset.json");
  EXPECT_EQ(copy.modifiers, dataset.modifiers);
  EXPECT_EQ(copy.selections, dataset.selections);
  EXPECT_EQ(copy.takes.at(0).heldout, std::vector<int>{3});
  const Pc2Reader before(folder / "bend.pc2"), after(folder / "copy" / copy.takes[0].shapes);
  for (std::uint32_t k = 0; k < count; ++k) {
    const std::vector<float> a = before.sample(k), b = after.sample(k);
    for (std::size_t i = 0; i < a.size(); ++i) ASSERT_NEAR(a[i], b[i], 1e-5);
  }
  const Clip moved = read_clip(copy, copy.takes[0], read.skeleton);
  for (std::size_t k = 0; k < moved.poses.size(); ++k) {
    const RigFrame a = pose_rig(read.skeleton, moved.poses[k]), b = pose_rig(read.skeleton, clip.poses[k]);
    for (std::size_t i = 0; i < a.skinning.size(); ++i) ASSERT_NEAR(a.skinning[i], b.skinning[i], 1e-5);
  }
  const auto muscles = read_muscles(folder / "copy" / copy.muscles, read.skeleton);
  ASSERT_EQ(muscles.size(), 2u);
  for (int i = 0; i < 3; ++i) {
    EXPECT_NEAR(muscles[0].path[1].position[static_cast<std::size_t>(i)],
                limb_muscles()[0].path[1].position[static_cast<std::size_t>(i)], 1e-5);
  }
  EXPECT_NEAR(muscles[0].radius, limb_muscles()[0].radius, 1e-6);
}

// A body of twice the size, whose joints have other names: lengths double, joints are renamed, and what was sculpted is
// twice as large.
TEST(TransferLimb, CurationIsCarriedWithTheDataset) {
  const TemporaryFolder folder;
  const Character limb = limb_character();
  Character giant = moved_limb(affine_from({{0, 0, 0}, {0, 0, 0, 1}, {2, 2, 2}}));
  const std::string lower = limb.skeleton.joints[1].name;
  giant.skeleton.joints[1].name = "Left_Other";
  write_character(giant, folder / "giant.glb");
  std::ofstream(folder / "map.json") << R"({"schema": "bodyopt-joint-map-1", "joints": [{"from": ")" + lower +
                                            R"(", "to": "Left_Other"}]})";
  std::filesystem::create_directories(folder / "modifiers");
  Pc2Writer offsets(folder / "modifiers" / "a.pc2", limb.output_count(), 1);
  std::vector<float> sculpted(3 * limb.output_count(), 0.0f);
  for (std::size_t v = 0; v < limb.output_count(); ++v) sculpted[3 * v] = 0.01f;
  offsets.append(sculpted);
  offsets.close();
  Dataset dataset;
  dataset.folder = folder.path();
  dataset.modifiers = read_modifiers(Json::parse(R"([
    {"name": "even", "type": "smooth", "mask": {"joints": [")" +
                                                 lower + R"("]}, "parameters": {"radius_mm": 5}},
    {"name": "hand", "type": "sculpt", "parameters": {"sculpts": [{"take": "t", "frame": 3, "offsets": "modifiers/a.pc2"}]}},
    {"name": "lost", "type": "inflate", "mask": {"joints": ["none"]}, "parameters": {"distance_mm": 1}},
    {"name": "mix", "type": "blend", "parameters": {"cache": "b.pc2"}},
    {"name": "both", "type": "symmetry"}])"),
                                     folder / "dataset.json");

  const Basis source = build_ddm_basis(limb, {});
  const TransferPair pair(source, giant, {.joint_map = (folder / "map.json").string()});
  std::vector<std::string> notes;
  const std::vector<Modifier> carried = carried_modifiers(dataset, limb, giant, pair, folder / "out", notes);
  ASSERT_EQ(carried.size(), 5u);
  EXPECT_TRUE(carried[4].enabled);
  EXPECT_EQ(carried[0].mask.at("joints"), Json::array({"Left_Other"}));
  EXPECT_NEAR(carried[0].parameters.at("radius_mm").get<double>(), 10, 1e-6);
  EXPECT_TRUE(carried[0].enabled && carried[1].enabled);
  const Pc2Reader read(folder / "out" / carried[1].parameters.at("sculpts").at(0).at("offsets").get<std::string>());
  const std::vector<float> points = read.sample(0);
  for (std::size_t v = 0; v < points.size(); v += 3) {
    ASSERT_NEAR(points[v], 0.02f, 1e-5f);
    ASSERT_NEAR(points[v + 1], 0, 1e-5f);
  }
  EXPECT_FALSE(carried[2].enabled || carried[3].enabled);
  EXPECT_EQ(carried[2].mask.at("joints"), Json::array({"none"}));
  EXPECT_EQ(notes.size(), 2u);
  giant.vertices(12 * kLimbSides, 0) *= 0.9;
  EXPECT_FALSE(carried_modifiers(dataset, limb, giant, pair, folder / "out", notes)[4].enabled);
}

TEST(MatchSkeletons, RefusesMirrorImagesAndStrangers) {
  Skeleton source, mirrored, stranger;
  const Vec3 places[] = {{0, 1, 0}, {0, 1.5, 0}, {0.3, 1.4, 0.1}, {-0.5, 1.3, 0.2}, {0.1, 0.5, -0.3}};
  for (int j = 0; j < 5; ++j) {
    for (Skeleton* skeleton : {&source, &mirrored, &stranger}) {
      Joint joint;
      joint.name = (skeleton == &stranger ? "other" : "joint") + std::to_string(j);
      joint.parent = j == 0 ? -1 : 0;
      Vec3 place = places[j];
      if (j > 0) place = place - places[0];
      if (skeleton == &mirrored) place[0] = -place[0];
      joint.bind.translation = place;
      joint.default_local = joint.bind;
      skeleton->joints.push_back(joint);
    }
  }
  EXPECT_NO_THROW(match_skeletons(source, source, ""));
  EXPECT_FALSE(match_skeletons(source, source, "").is_aligned());
  EXPECT_EQ(testing::kind_of([&] { match_skeletons(source, mirrored, ""); }), ErrorKind::mismatch);
  EXPECT_EQ(testing::kind_of([&] { match_skeletons(source, stranger, ""); }), ErrorKind::mismatch);
}

// A body of two sides that looks along z; `build`: how it differs from another.
Skeleton two_sided(double build) {
  struct Place {
    const char* name;
    int parent;
    Vec3 at;
  };
  const Place places[] = {{"Hips", -1, {0, 1, 0}},
                          {"Spine", 0, {0, 1.4 + 0.1 * build, -0.03}},
                          {"Head", 1, {0, 1.7, 0.05}},
                          {"LeftArm", 1, {0.2 + 0.1 * build, 1.4, -0.05}},
                          {"LeftHand", 3, {0.7, 1.4 - 0.3 * build, 0.02}},
                          {"RightArm", 1, {-0.2 - 0.1 * build, 1.4, -0.05}},
                          {"RightHand", 5, {-0.7, 1.4 - 0.3 * build, 0.02}},
                          {"LeftUpLeg", 0, {0.1, 0.9, 0}},
                          {"LeftFoot", 7, {0.12, 0.05, -0.04}},
                          {"LeftToeBase", 8, {0.13, 0, 0.15 + 0.05 * build}},
                          {"RightUpLeg", 0, {-0.1, 0.9, 0}},
                          {"RightFoot", 10, {-0.12, 0.05, -0.04}},
                          {"RightToeBase", 11, {-0.13, 0, 0.15 + 0.05 * build}}};
  Skeleton skeleton;
  for (const Place& place : places) {
    Joint joint;
    joint.name = place.name;
    joint.parent = place.parent;
    joint.bind.translation = place.parent < 0 ? place.at : place.at - places[static_cast<std::size_t>(place.parent)].at;
    joint.default_local = joint.bind;
    joint.inverse_bind = inverse(affine_from({place.at, {0, 0, 0, 1}, {1, 1, 1}}));
    skeleton.joints.push_back(joint);
  }
  return skeleton;
}

// Of another build, facing elsewhere, and matched by hand with its sides exchanged.
TEST(MatchSkeletons, RefusesSidesThatAJointMapExchanges) {
  const TemporaryFolder folder;
  const Skeleton source = two_sided(0);
  for (const double turn : {0.0, std::numbers::pi}) {
    Skeleton target = two_sided(1);
    target.joints[0].bind.rotation = axis_angle({0, 1, 0}, turn);
    for (Joint& joint : target.joints) joint.name = "bone" + std::to_string(&joint - target.joints.data());
    const auto write_map = [&](bool exchanged) {
      Json joints = Json::array();
      for (const Joint& joint : source.joints) {
        std::string name = joint.name;
        const bool left = name.starts_with("Left"), right = name.starts_with("Right");
        if (exchanged && left) name.replace(0, 4, "Right");
        if (exchanged && right) name.replace(0, 5, "Left");
        const auto place = static_cast<std::size_t>(source.find(name));
        joints.push_back({{"from", joint.name}, {"to", target.joints[place].name}});
      }
      std::ofstream(folder / "map.json") << Json{{"schema", "bodyopt-joint-map-1"}, {"joints", joints}};
    };
    write_map(false);
    EXPECT_NO_THROW(match_skeletons(source, target, (folder / "map.json").string()));
    write_map(true);
    EXPECT_EQ(testing::kind_of([&] { match_skeletons(source, target, (folder / "map.json").string()); }),
              ErrorKind::mismatch);
  }
}

// By a joint map; what was carried with it says so to who looks at it later.
TEST(MatchSkeletons, WhatWasCarriedTellsHowItWasMatched) {
  const TemporaryFolder folder;
  Character other = limb_character();
  for (Joint& joint : other.skeleton.joints) joint.name = "other_" + joint.name;
  Json joints = Json::array();
  for (const Joint& joint : limb_skeleton().joints)
    joints.push_back({{"from", joint.name}, {"to", "other_" + joint.name}});
  std::ofstream(folder / "map.json") << Json{{"schema", "bodyopt-joint-map-1"}, {"joints", joints}};
  const TransferPair pair(trained_limb(), other, {.joint_map = (folder / "map.json").string()});
  std::vector<std::string> notes;
  const Basis carried = transfer_basis(pair, {}, notes);
  EXPECT_EQ(match_as_carried(limb_skeleton(), carried.skeleton, carried.metadata).source_joint,
            pair.match.source_joint);
  EXPECT_EQ(testing::kind_of([&] { match_as_carried(limb_skeleton(), carried.skeleton, {}); }), ErrorKind::mismatch);
  // Clips of the source's joints move what was carried from it.
  const Clip clip{"bend", 24, 1, {bind_pose(limb_skeleton()), bent()}, {}, {}};
  write_clip(clip, limb_skeleton(), folder / "source.glb");
  write_clip(clip, other.skeleton, folder / "own.glb");
  for (const char* name : {"source.glb", "own.glb"}) {
    const Clip read = read_clip((folder / name).string(), carried, {});
    ASSERT_EQ(read.poses.size(), 2u);
    for (std::size_t j = 0; j < 3; ++j) {
      const Quat &turn = read.poses[1].joints[j].rotation, &wanted = bent().joints[j].rotation;
      for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(turn[i], wanted[i], 1e-6) << name << j;
    }
  }
  // A joint map from the source's joints to its own does, too; what it leaves out stays at rest.
  joints.erase(joints.size() - 1);
  std::ofstream(folder / "most.json") << Json{{"schema", "bodyopt-joint-map-1"}, {"joints", joints}};
  const auto by_map = [&](const auto& moved) {
    return read_clip((folder / "source.glb").string(), moved, {.joint_map = (folder / "most.json").string()});
  };
  const Clip read = by_map(carried), expected = by_map(carried.skeleton);
  ASSERT_EQ(read.poses.size(), expected.poses.size());
  for (std::size_t j = 0; j < carried.skeleton.size(); ++j) {
    EXPECT_EQ(read.poses[1].joints[j].rotation, expected.poses[1].joints[j].rotation) << j;
  }
  EXPECT_EQ(testing::kind_of([&] { read_clip((folder / "source.glb").string(), carried.skeleton, {}); }),
            ErrorKind::mismatch);
  const Skeleton stranger = two_sided(0);
  EXPECT_EQ(match_as_carried(stranger, stranger, carried.metadata).source_joint.back(), 12);
}

TEST(MatchSkeletons, NamesTheRatioOfUnits) {
  const Character limb = limb_character();
  const auto notes_at = [&](double size) {
    const Character other = moved_limb(affine_from({{0, 0, 0}, {0, 0, 0, 1}, {size, size, size}}));
    const SkeletonMatch match = match_skeletons(limb.skeleton, other.skeleton, "");
    EXPECT_NEAR(match.size, size, 1e-9 * size);
    return match.notes;
  };
  EXPECT_TRUE(notes_at(2).empty());
  ASSERT_EQ(notes_at(100).size(), 1u);
  EXPECT_NE(notes_at(100).front().find("100 times"), std::string::npos) << notes_at(100).front();
  EXPECT_NE(notes_at(100).front().find("centimetres"), std::string::npos) << notes_at(100).front();
  EXPECT_NE(notes_at(10).front().find("--unit 0.1"), std::string::npos);
  EXPECT_EQ(notes_at(0.01).size(), 1u);
}

// A joint that only one of the two has, half-way along the forearm: named, and what it turns is counted to the wrist.
TEST(MatchSkeletons, TwistJointsThatOnlyOneHasAreNamedAndCountedToTheNext) {
  const Skeleton plain = limb_skeleton();
  const Skeleton twisting = limb_with_twist_joint().skeleton;
  const auto turns = [](const Skeleton& skeleton, const Pose& pose, std::size_t joint) {
    return decompose(posed_joints(skeleton, pose.joints)[joint]).rotation;
  };
  const auto expect_same = [](const Quat& a, const Quat& b) {
    for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(a[i], b[i], 1e-9) << i;
  };
  const auto is_named = [](const SkeletonMatch& match) {
    return std::any_of(match.notes.begin(), match.notes.end(),
                       [](const std::string& note) { return note.find("twist") != std::string::npos; });
  };
  Pose posed = bind_pose(twisting);
  posed.joints[1].rotation = axis_angle({1, 0, 0}, 0.9);
  posed.joints[2].rotation = axis_angle({0, 0, 1}, 0.7);
  posed.joints[3].rotation = axis_angle({0, 1, 0}, 0.3);

  const SkeletonMatch to_plain = match_skeletons(twisting, plain, "");
  EXPECT_TRUE(is_named(to_plain));
  EXPECT_EQ(to_plain.target_joint, (std::vector<int>{0, 1, -1, 2}));
  const Pose folded = transferred_pose(to_plain, twisting, plain, posed);
  expect_same(turns(plain, folded, 1), turns(twisting, posed, 1));
  expect_same(turns(plain, folded, 2), turns(twisting, posed, 3));

  const SkeletonMatch to_twisting = match_skeletons(plain, twisting, "");
  EXPECT_TRUE(is_named(to_twisting));
  const Pose back = transferred_pose(to_twisting, plain, twisting, folded);
  expect_same(turns(twisting, back, 2), turns(plain, folded, 1));  // it keeps to the joint above
  expect_same(turns(twisting, back, 3), turns(plain, folded, 2));
}

// A limb that is bent at rest, 60 degrees: posed as the straight one rests, it is straight.
TEST(MatchSkeletons, PosesTheTargetAsTheSourceRests) {
  const Skeleton source = limb_skeleton();
  Skeleton bent_skeleton = source;
  bent_skeleton.joints[1].bind.rotation = axis_angle({1, 0, 0}, 1.05);
  const SkeletonMatch match = match_skeletons(source, bent_skeleton, "");
  ASSERT_TRUE(match.is_aligned());
  const std::vector<Affine> world = posed_joints(bent_skeleton, match.common.joints);
  const Vec3 upper = {world[1].m[0][3] - world[0].m[0][3], world[1].m[1][3] - world[0].m[1][3],
                      world[1].m[2][3] - world[0].m[2][3]},
             fore = {world[2].m[0][3] - world[1].m[0][3], world[2].m[1][3] - world[1].m[1][3],
                     world[2].m[2][3] - world[1].m[2][3]};
  EXPECT_NEAR(dot(upper, fore) / (length(upper) * length(fore)), 1, 1e-9);
}

}  // namespace bodyopt::trainer
