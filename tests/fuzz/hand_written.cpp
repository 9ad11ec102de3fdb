// The small JSON files that people write and edit.
#include <array>

#include "assets/clips/controls.h"
#include "assets/clips/joint_match.h"
#include "dataset/regions_file.h"
#include "shots/session/session_file.h"
#include "shots/session/view_settings.h"
#include "tests/attack/limb_mapping.h"
#include "tests/fuzz/fuzz_target.h"
#include "tests/fuzz/small_limb.h"
#include "tests/support/paths.h"
#include "trainer/anatomy/body_kind.h"
#include "trainer/dynamics/jiggle_settings.h"
#include "trainer/motion/joint_limits.h"
#include "trainer/muscle_models/mapping.h"
#include "trainer/simulate/materials.h"

namespace bodyopt::fuzz {
namespace {

using namespace trainer;
using namespace shots;

using Seeds = std::vector<std::string>;

Seeds muscles_seeds() {
  return {written("m.json", [](const auto& path) { write_muscles({make_flexor()}, limb().skeleton, path); })};
}
void read_muscles_file(const std::string& bytes) {
  for (const Muscle& muscle : read_muscles(as_file("muscles.json", bytes), limb().skeleton)) {
    require_finite(std::vector{muscle.radius, muscle.max_activation}, "a muscle");
    for (const MusclePoint& point : muscle.path) require_finite(point.position, "a path");
  }
}

Seeds controls_seeds() {
  return {R"({"schema": "bodyopt-controls-1", "controls": {"biceps*": [[1, 0], [3, 1], [4, 0.5]], "breath": 0.25}})"};
}
void read_controls_file(const std::string& bytes) {
  Clip clip;
  clip.poses.resize(5);
  read_controls(as_file("controls.json", bytes), clip);
  for (const Pose& pose : clip.poses) require_finite(pose.controls, "controls");
}

Seeds joint_map_seeds() {
  return {
      R"({"schema": "bodyopt-joint-map-1", "joints": [{"from": "a", "to": "upper"}, {"from": "b", "to": "lower"}]})"};
}
void read_joint_map_file(const std::string& bytes) { read_joint_map(as_file("joint_map.json", bytes)); }

Seeds materials_seeds() { return {testing::read_bytes(kSourceFolder + "/rigs/materials.json")}; }
void read_materials_file(const std::string& bytes) {
  const Materials m = read_materials(as_file("materials.json", bytes));
  require_finite(std::array{m.fat.mu, m.fat.lambda, m.muscle.mu, m.muscle.lambda, m.muscle_bulk, m.active_fibre,
                            m.active_slack, m.passive_fibre, m.bone_springs, m.skin_bending, m.contact},
                 "a material");
}

Seeds jiggle_seeds() { return {testing::read_bytes(kSourceFolder + "/rigs/human/jiggle.json")}; }
void read_jiggle_file(const std::string& bytes) {
  const JiggleSettings s = read_jiggle(as_file("jiggle.json", bytes));
  require_possible(s);
  require_finite(std::array{s.softness, s.damping, s.amount, s.flesh, s.poisson, s.density, s.tension}, "a setting");
}

Seeds limits_seeds() {
  return {R"({"schema": "bodyopt-joint-limits-1", "source": "made up",
 "mirrored_joints": [{"joint": "upper", "mirror": "lower"}],
 "dofs": [{"name": "raise", "mirror": "lower_raise", "rest": 40, "min": 0, "max": 120,
 "turns": [{"joint": "upper", "axis": [1, 2, 2], "share": 0.5}]}],
 "detached_joints": [{"joint": "lower", "follows": "upper", "source": "made up"}]})"};
}
void read_limits_file(const std::string& bytes) {
  const JointLimits limits = read_joint_limits(as_file("limits.json", bytes), limb().skeleton);
  for (const DegreeOfFreedom& dof : limits.dofs) require_finite(std::array{dof.rest, dof.min, dof.max}, "a limit");
}

Seeds mapping_seeds() {
  return {attack::kLimbMapping, testing::read_bytes(kSourceFolder + "/rigs/human/myo_arm.json")};
}
void read_mapping_file(const std::string& bytes) { muscle_models::read_mapping(as_file("mapping.json", bytes)); }

Seeds corrections_seeds() {
  return {R"({"schema": "bodyopt-anatomy-corrections-1", "kind": "biped", "body_fat": 0.2,
 "bones": [{"joint": "lower", "carries": false, "thicker": 0.001}],
 "fat": [{"region": "trunk", "factor": 1.5}, {"joint": "upper", "factor": 0.5}],
 "muscles": [{"muscle": "flexor", "volume": 90}, {"muscle": "extensor", "factor": 1.2}]})"};
}
void read_corrections_file(const std::string& bytes) {
  const AnatomyCorrections corrections = read_corrections(as_file("anatomy.json", bytes), limb().skeleton);
  for (const auto& [joint, of] : corrections.bones) require_finite(std::array{of.thicker}, "a bone");
  for (const auto& [muscle, of] : corrections.muscles) require_finite(std::array{of.volume, of.factor}, "a muscle");
}

Seeds regions_seeds() {
  return {R"({"schema": "bodyopt-regions-1", "vertex_count": 232, "complete": false, "regions": [
 {"name": "elbow", "vertices": [100, 101, 102], "weights": [0.25, 1, 0.5]}]})"};
}
void read_regions_file(const std::string& bytes) {
  const std::filesystem::path path = as_file("regions.json", bytes);
  Dataset dataset;
  dataset.folder = path.parent_path();
  dataset.character = "none.glb";
  dataset.regions = path.filename();
  for (const RegionWeights& region : read_regions(dataset, limb())) require_finite(region.weights, "weights");
}

Seeds view_seeds() {
  ViewSettings settings;
  settings.cameras["face"] = settings.camera;
  settings.pose.joints["lower"] = {0, 0, 45};
  settings.pose.controls["breath"] = 0.5;
  return {written("v.json", [&](const auto& path) { write_view_settings(settings, path); })};
}
void read_view_file(const std::string& bytes) { read_view_settings(as_file("view.json", bytes)); }

Seeds session_seeds() {
  SessionFile session;
  session.cast.push_back({.files = {.basis = "hero.safetensors", .clip = "shot.glb#walk", .truth = "truth.pc2"}});
  session.cast.push_back({.files = {.basis = "villain.glb", .clip = "run.bvh", .up = "z"}, .number = 3});
  session.cast[1].pose.joints["lower"] = {0, 0, 45};
  session.frame = 12;
  session.joint = "lower";
  session.saved_as = "shot.json";
  session.image_plane.file = "plate.%04d.png";
  session.sound.file = "voice.wav";
  return {written("s.json", [&](const auto& path) { write_session(session, path); })};
}
void read_session_file(const std::string& bytes) {
  const SessionFile session = read_session(as_file("session.json", bytes));
  require_finite(std::array{session.clip.fps, session.clip.unit}, "a clip");
  for (const SessionCharacter& character : session.cast) {
    for (const auto& [joint, turns] : character.pose.joints) require_finite(turns, "a pose");
  }
}

const bool added = add_target({"muscles", muscles_seeds, read_muscles_file}) &&
                   add_target({"controls", controls_seeds, read_controls_file}) &&
                   add_target({"joint_map", joint_map_seeds, read_joint_map_file}) &&
                   add_target({"materials", materials_seeds, read_materials_file}) &&
                   add_target({"jiggle_settings", jiggle_seeds, read_jiggle_file}) &&
                   add_target({"joint_limits", limits_seeds, read_limits_file}) &&
                   add_target({"mapping", mapping_seeds, read_mapping_file}) &&
                   add_target({"corrections", corrections_seeds, read_corrections_file}) &&
                   add_target({"regions", regions_seeds, read_regions_file}) &&
                   add_target({"view_settings", view_seeds, read_view_file}) &&
                   add_target({"session", session_seeds, read_session_file});

}  // namespace
}  // namespace bodyopt::fuzz
