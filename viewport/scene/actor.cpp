#include "viewport/scene/actor.h"

#include <cmath>
#include <iterator>
#include <utility>

#include "assets/clips/clip_source.h"
#include "assets/clips/joint_roles.h"
#include "assets/clips/matched_joints.h"
#include "assets/clips/shot_modifiers.h"
#include "geometry/mesh.h"
#include "runtime/basis/character_unit.h"
#include "runtime/basis/output_order.h"
#include "runtime/core/error.h"
#include "runtime/core/extent.h"
#include "runtime/core/transformed.h"
#include "runtime/cpu/kernels.h"
#include "runtime/host/rig.h"
#include "runtime/vulkan/device.h"
#include "trainer/train/skinning/unpose.h"

namespace bodyopt::viewport {
namespace {

namespace fs = std::filesystem;

// Returns the poses of a dataset's frames, one a sample.
std::vector<Pose> frame_poses(const trainer::NamedShapes& shapes) {
  return transformed(shapes.numbers(), [&](const std::size_t n) { return shapes.stack()->database().frames[n].pose; });
}

// The character that a basis was trained on: its skin weights are in the character's file alone.
Character read_own_character(const std::string& path, const Basis& basis) {
  Character character = read_character(path, kept_unit(basis));
  if (character.output_count() != basis.mesh.output_count() ||
      skeleton_hash(character.skeleton) != skeleton_hash(basis.skeleton)) {
    throw Error(ErrorKind::mismatch, path, ": is not the character of the basis: it has ", character.output_count(),
                " vertices and ", character.skeleton.size(), " joints, the basis ", basis.mesh.output_count(), " and ",
                basis.skeleton.size());
  }
  return character;
}

}  // namespace

WornMeshes::WornMeshes(const vulkan::Device& device, FollowingMeshes following)
    : device_(device), following_(std::move(following)) {
  for (const AttachedMesh& mesh : following_.attached().meshes) {
    triangles_.push_back(vulkan::upload(device_, mesh.triangles, "attached triangles"));
  }
}

std::vector<WornMesh> WornMeshes::carry(std::span<const float> skins, std::span<const Pose> poses) const {
  const std::vector<AttachedMesh>& attached = following_.attached().meshes;
  std::vector<std::vector<float>> positions(attached.size()), normals(attached.size());
  FollowingMeshes::Memory memory;
  following_.carry_each(skins, poses, memory, [&](std::size_t, std::size_t m, const std::vector<float>& points) {
    std::ranges::copy(points, std::back_inserter(positions[m]));
    const Positions areas = vertex_normals(rows_of(points), rows_of(attached[m].triangles));
    std::ranges::copy(floats_of(areas), std::back_inserter(normals[m]));
  });
  std::vector<WornMesh> meshes;
  for (std::size_t m = 0; m < attached.size(); ++m) {
    const AttachedMesh& mesh = attached[m];
    if (sizeof(float) * positions[m].size() > device_.info().max_storage_buffer_range) {
      throw Error(ErrorKind::usage, "mesh '", mesh.name, "' is too large to be shown ", poses.size(),
                  " times at once: fewer copies or ghosts, or 'worn off'");
    }
    meshes.push_back({&triangles_[m], mesh.triangle_count(),
                      static_cast<std::uint32_t>(positions[m].size() / (3 * std::max<std::size_t>(1, poses.size()))),
                      vulkan::upload(device_, positions[m], "attached positions"),
                      vulkan::upload(device_, normals[m], "attached normals")});
  }
  return meshes;
}

std::vector<float> WornMeshes::points(std::span<const float> skin, const Pose& pose) const {
  std::vector<float> points;
  for (const std::vector<float>& mesh : following_.carry(skin, pose.joints)) {
    std::ranges::copy(mesh, std::back_inserter(points));
  }
  return points;
}

Actor::Actor(std::shared_ptr<const vulkan::Device> device, const shots::ActorFiles& files, const ClipOptions& options,
             LevelPool& pool)
    : device_(std::move(device)), files_(files), clip_options_(options) {
  shots::OpenedCharacter opened;
  const auto make = [&] { return make_levels(opened); };
  const bool trained = shots::is_basis(files.basis);
  const LevelPool::Levels levels = trained ? pool.get({files.basis, files.dynamics(), files.levels()}, make) : make();
  for (const auto& level : levels) details_.push_back(std::make_unique<Detail>(device_, level));
  notes_ = std::move(opened.notes);
  shown_by_ = std::move(opened.shown_by);
  Attachments attached = std::move(opened.attached);
  if (trained && fs::exists(files.attached())) {
    attached = load_attachments(files.attached(), finest().basis(), files.basis);
  }
  if (!files.character.empty()) {
    character_ = read_own_character(files.character, finest().basis());
  } else {
    character_ = std::move(opened.character);
  }
  if (!attached.meshes.empty()) {
    worn_ = std::make_unique<WornMeshes>(
        *device_, FollowingMeshes(finest_basis(), std::move(attached), finest().level().following.full_skin()));
  }
  read_materials(pool);
  if (!files.limits.empty()) {
    const Skeleton& skeleton = finest().basis().skeleton;
    turning_ = shots::turning_within(trainer::read_joint_limits(files.limits, skeleton), skeleton);
  }
  if (opened.clip) {
    take_clip(std::move(*opened.clip));
  } else {
    ClipOptions still = options;
    if (has_dynamics()) still.fps = finest().jiggle_rate();  // a pose has no rate of its own
    take_clip(shots::still_clip(finest().basis().skeleton, still));
  }
  measure_size();
  if (!files.truth.empty()) open_truth(files.truth);
  if (files.clip.empty()) {
    measure_ground();
  } else {
    open_clip(files.clip);
  }
}

std::vector<fs::path> Actor::paths() const {
  std::vector<fs::path> all = files_.paths();
  if (materials_) std::ranges::copy(materials_->files, std::back_inserter(all));
  return all;
}

void Actor::read_materials(LevelPool& pool) {
  const std::string own = files_.own_file();
  if (own.empty()) return;
  materials_ =
      pool.materials({own, files_.basis, files_.attached(), files_.levels()}, [&] { return materials_of(own); });
  const bool is_guessed = files_.character.empty() && own != files_.basis;  // and may be of another
  if (is_guessed) return;
  std::ranges::copy(materials_->notes, std::back_inserter(notes_));
  const double unit = kept_unit(finest().basis());  // 0: metres
  own_cameras_ = read_still_cameras(own, unit > 0 ? unit : 1);
}

std::vector<ClipCamera> Actor::cameras() const {
  std::vector<ClipCamera> all = clip_.cameras;
  for (const ClipCamera& camera : own_cameras_) {
    if (std::ranges::find(all, camera.name, &ClipCamera::name) == all.end()) all.push_back(camera);
  }
  return all;
}

std::shared_ptr<const CharacterMaterials> Actor::materials_of(const std::string& own) const {
  std::vector<const Basis*> levels;
  for (const auto& detail : details_) levels.push_back(&detail->basis());
  return make_character_materials(*device_, own, levels, following().attached());
}

LevelPool::Levels Actor::make_levels(shots::OpenedCharacter& opened) const {
  opened = shots::open_character(files_.basis, clip_options_);
  std::optional<Dynamics> dynamics;
  if (shots::is_basis(files_.basis) && fs::exists(files_.dynamics())) {
    dynamics = load_dynamics(files_.dynamics(), opened.levels.front().basis);
  }
  LevelPool::Levels levels;
  const auto add = [&](Level& level) {
    levels.push_back(std::make_shared<const LevelOnDevice>(device_, std::move(level), std::exchange(dynamics, {})));
  };
  for (Level& level : opened.levels) add(level);
  if (fs::exists(files_.levels()) || !files_.proxy.empty()) {
    std::vector<Level> proxy = proxy_of(levels.front()->basis());
    for (Level& level : proxy) add(level);
  }
  return levels;
}

// Coarser levels of the same character.
std::vector<Level> Actor::proxy_of(const Basis& full) const {
  const std::string path = files_.levels().string();
  std::vector<Level> levels = load_levels(path);
  for (const Level& level : levels) {
    if (level.carried.empty()) {
      throw Error(ErrorKind::mismatch, path, ": is a basis that carries no full skin, expected a proxy of ",
                  files_.basis, ": 'bodyopt proxy' makes them");
    }
    if (skeleton_hash(level.basis.skeleton) == skeleton_hash(full.skeleton) &&
        level.carried.size() == full.mesh.output_count()) {
      continue;
    }
    throw Error(ErrorKind::mismatch, path, ": is no proxy of ", files_.basis, ": it carries ", level.carried.size(),
                " vertices of ", level.basis.skeleton.size(), " joints, the character has ", full.mesh.output_count(),
                " and ", full.skeleton.size(), " (was it made of another basis?)");
  }
  return levels;
}

std::string Actor::name() const { return files_.basis.empty() ? "arm" : fs::path(files_.basis).stem().string(); }

std::size_t Actor::level_within(double metres) const {
  std::size_t level = details_.size() - 1;
  while (level > 0 && details_[level]->level().distance > metres) --level;
  return level;
}

bool Actor::has(SkinMethod method) const {
  if (method == SkinMethod::jiggle) return shown().jiggles() && why_still().empty();
  const bool of_finest = method == SkinMethod::proxy || method == SkinMethod::lbs || method == SkinMethod::truth;
  return (level_ == 0 || !of_finest) && has_at_finest(method);
}

bool Actor::has_at_finest(SkinMethod method) const {
  if (method == SkinMethod::jiggle) return has_dynamics() && why_still().empty();
  if (method == SkinMethod::proxy) return details_.size() > 1 && !details_[1]->level().following.full_skin().empty();
  if (method == SkinMethod::lbs) return character_.has_value();
  return method != SkinMethod::truth || truth_.has_value();
}

std::string Actor::why_still() const {
  if (!has_dynamics()) return "";
  const std::string problem = shots::problem_of_rate(*finest().level().model->dynamics, clip_);
  return problem.empty() ? "" : name() + ": " + problem;
}

// Opens the poses of the frames that NamedShapes has of a dataset.
void Actor::open_frames(const std::string& dataset) {
  const trainer::NamedShapes shapes =
      truth_ && files_.truth == dataset ? truth_->shapes.as_they_are() : trainer::NamedShapes(dataset);
  const trainer::PoseDatabase& database = shapes.stack()->database();
  if (skeleton_hash(database.character.skeleton) != skeleton_hash(basis().skeleton)) {
    throw Error(ErrorKind::mismatch, dataset + ": the dataset is of another skeleton than " + name());
  }
  Clip clip;
  clip.name = fs::path(dataset).parent_path().filename().string();
  clip.controls = database.controls;
  std::vector<int> keys;
  for (std::size_t k = 0; k < shapes.numbers().size(); ++k) {
    const trainer::DatabaseFrame& frame = database.frames[shapes.numbers()[k]];
    const bool begins = k == 0 || frame.take != database.frames[shapes.numbers()[k - 1]].take;
    if (begins) keys.push_back(shapes.frames()[k]);
    clip.poses.push_back(frame.pose);
  }
  take_clip(std::move(clip));
  keys_ = std::move(keys);
  files_.clip = dataset;
  measure_ground();
}

void Actor::show_raw(bool raw) {
  if (!truth_ || truth_->raw == raw || !truth_->shapes.stack()) return;
  truth_->raw = raw;
  truth_->shown.reset();
}

void Actor::show_sculpted(int frame, std::vector<float> points) {
  if (!truth_) return;
  truth_->sculpted.emplace(frame, std::move(points));
  truth_->shown.reset();
}

bool Actor::reread_truth() {
  const trainer::NamedShapes before = truth_->shapes;
  trainer::NamedShapes now = before.as_they_are();
  if (!now.stack() || !same(frame_poses(now), frame_poses(before))) return false;
  truth_->shapes = std::move(now);
  truth_->shown.reset();
  truth_->sculpted.reset();
  return true;
}

void Actor::open_clip_of(const Actor& lead) {
  const shots::ActorFiles before = files_;
  files_.joint_map = lead.files().joint_map;
  files_.up = lead.files().up;
  try {
    open_clip(lead.files().clip);
  } catch (...) {
    files_ = before;
    throw;
  }
}

void Actor::open_clip(const std::string& source) {
  if (trainer::is_dataset(source)) return open_frames(source);
  ClipOptions options = clip_options_;
  options.unit = clip_unit(source, kept_unit(basis()));
  options.joint_map = files_.joint_map;
  options.up = files_.up_of(source);
  Clip clip = read_clip(source, basis(), options);
  if (clip.poses.empty()) throw Error(ErrorKind::file, source + ": the clip has no frame");
  keys_ = clip_keys(source, options);
  take_clip(std::move(clip));
  files_.clip = source;
  measure_ground();
  // A character without a file of its own has the materials of the clip's file, where that has its skin, too.
  const std::string path = split_source(source).path.string();
  if (materials_ || !is_called_scene(path)) return;
  like_ = path;
  const auto found = materials_of(path);
  if (!found->skin.front().parts.empty()) materials_ = found;
}

void Actor::take_clip(Clip clip) {
  Clip as_read = clip;
  for (const std::string& note : apply_channels(basis(), clip)) clip.notes.push_back(note);
  source_ = std::move(as_read);
  modifiers_ = {};
  clip_ = std::move(clip);
}

// Returns its own Direct Delta Mush, where it is the character of the dataset; otherwise null.
std::shared_ptr<const trainer::UnposedSpace> Actor::unposed_space(const trainer::PoseDatabase& database) const {
  std::error_code absent;
  const Dataset& dataset = database.dataset;
  const bool is_its_character = !shots::is_basis(files_.basis) && clip_options_.unit == dataset.unit &&
                                fs::equivalent(files_.basis, dataset.folder / dataset.character, absent);
  if (!is_its_character) return nullptr;
  return std::make_shared<const trainer::UnposedSpace>(database.character, finest_basis());
}

void Actor::open_truth(const std::string& name) {
  trainer::NamedShapes shapes(name, [this](const trainer::PoseDatabase& database) { return unposed_space(database); });
  if (shapes.point_count() != basis().mesh.output_count()) {
    throw Error(ErrorKind::mismatch, name, ": the cache has ", shapes.point_count(), " points, the character ",
                basis().mesh.output_count(), " vertices: it is of another character, or another level of it");
  }
  if (shapes.sample_count() == 0) throw Error(ErrorKind::file, name + ": the cache has no sample");
  truth_.emplace(Truth{std::move(shapes), {}, {}, false});
  files_.truth = name;
}

std::size_t Actor::clip_index(int frame) const {
  return static_cast<std::size_t>(std::clamp(frame, clip_.first_frame, clip_.last_frame()) - clip_.first_frame);
}

std::optional<shots::JointRange> Actor::free_turns(std::size_t joint, int frame) const {
  if (joint >= turning_.ranges.size() || !turning_.ranges[joint]) return std::nullopt;
  return shots::turns_within(*turning_.ranges[joint], basis().skeleton.joints[joint].bind.rotation,
                             clip_pose(frame).joints[joint].rotation);
}

std::pair<double, double> Actor::free_axis(const trainer::DegreeOfFreedom& dof, int frame) const {
  return shots::free_angles(turning_.limits, basis().skeleton, dof, clip_pose(frame));
}

Vec3 Actor::facing(std::size_t joint, int frame, const shots::ViewSettings::PoseKey& posing) const {
  return shots::facing_of(basis().skeleton, turning_, clip_pose(frame), posing, joint);
}

std::vector<std::string> Actor::movable_joints() const {
  constexpr double kMoves = 1e-3;  // metres
  const Skeleton& skeleton = basis().skeleton;
  std::vector<int> children(skeleton.size());
  for (const Joint& joint : skeleton.joints) {
    if (joint.parent >= 0) ++children[static_cast<std::size_t>(joint.parent)];
  }
  const std::vector<std::optional<JointRole>> roles = joint_roles(named_joints(skeleton));
  const std::vector<trainer::DetachedJoint>& detached = turning_.limits.detached;
  std::vector<bool> carries;  // nothing but it hangs under what is above it
  std::vector<std::string> movable;
  for (std::size_t j = 0; j < skeleton.size(); ++j) {
    const Joint& joint = skeleton.joints[j];
    const auto above = static_cast<std::size_t>(std::max(0, joint.parent));
    carries.push_back(joint.parent < 0 || (carries[above] && children[above] == 1));
    const bool is_moved = std::ranges::any_of(clip_.poses, [&](const Pose& pose) {
      return length(pose.joints[j].translation - clip_.poses.front().joints[j].translation) > kMoves;
    });
    const bool is_detached = std::ranges::find(detached, j, &trainer::DetachedJoint::joint) != detached.end();
    const bool is_hips = roles[j] && roles[j]->part == BodyPart::hips;
    const bool is_limb = j < turning_.ranges.size() && turning_.ranges[j];  // which turns, and would tear
    if ((carries[j] && !is_limb) || is_moved || is_detached || is_hips) movable.push_back(joint.name);
  }
  return movable;
}

std::vector<shots::MissedPin> Actor::missed_pins(int frame, const shots::ViewSettings::PoseKey& posing) const {
  return shots::missed_pins(basis().skeleton, turning_, clip_pose(frame), posing);
}

Pose Actor::pose(int frame, const shots::ViewSettings::Posing& posing) const {
  return shots::posed_frame(source_, clip_index(frame), basis(), turning_, posing, modifiers_);
}

Clip Actor::posed_source(const shots::ViewSettings::Posing& posing) const {
  return shots::posed_clip(source_, basis().skeleton, turning_, posing);
}

shots::Shot Actor::shot(const shots::ViewSettings& settings, std::vector<int> frames, const shots::Tell& tell) const {
  const bool jiggles = settings.jiggle.on && has_at_finest(SkinMethod::jiggle);
  const int first = frames.front();
  shots::Shot shot{.name = name(),
                   .deformer = finest().level().make_deformer(jiggles ? std::optional(JiggleOptions()) : std::nullopt),
                   .jiggles = jiggles,
                   .checks = false,
                   .following = following(),
                   .clip = source_,
                   .frames = std::move(frames),
                   .preroll = jiggles ? shots::usual_preroll(source_, first) : 0,
                   .surface = {},
                   .surfaces = {},
                   .bound = {}};
  shots::pose_shot({turning_, settings.pose, static_cast<float>(settings.jiggle.amount)}, shot, tell);
  return shot;
}

const FollowingMeshes& Actor::following() const { return worn_ ? worn_->following() : finest().level().following; }

const Evaluation& Actor::evaluate(SkinMethod method, std::span<const Pose> poses, int frame, const Weights& weights,
                                  bool dressed) {
  if (hosted_skin(method)) hosted_pose_ = poses[0];
  if (method == SkinMethod::truth) {
    try {
      show_truth(frame);
    } catch (...) {
      truth_.reset();  // until it is read again
      throw;
    }
    return hosted_;
  }
  if (method == SkinMethod::lbs) {
    show_linear_blend(poses[0]);
    return hosted_;
  }
  const SkinRequest asked = *request(method, poses, frame, weights, dressed);
  evaluate_together({&asked, 1});
  return method == SkinMethod::proxy ? carry_proxy() : asked.detail->last(method).result;
}

std::optional<SkinRequest> Actor::request(SkinMethod method, std::span<const Pose> poses, int frame,
                                          const Weights& weights, bool dressed) {
  if (method == SkinMethod::truth || method == SkinMethod::lbs) return std::nullopt;
  const bool is_one = method == SkinMethod::proxy || method == SkinMethod::jiggle;
  SkinRequest asked{.detail = details_[level_].get(),
                    .method = method,
                    .poses = {poses.begin(), is_one ? poses.begin() + 1 : poses.end()},
                    .frame = frame,
                    .weights = weights,
                    .host = dressed && worn_ && has_worn_skin()};
  if (method == SkinMethod::proxy) {
    asked.detail = details_[1].get();
    asked.method = SkinMethod::full;
    asked.host = true;
  }
  return asked;
}

std::span<const WornMesh> Actor::worn(SkinMethod method) {
  if (!worn_ || !has_worn_skin()) return {};
  Worn& worn = worn_on_[method];
  const HostedSkin* hosted = hosted_skin(method);
  const Source on = hosted ? Source{0, hosted->number} : Source{level_, shown().last(method).number};
  const std::vector<Pose> poses = hosted ? std::vector{hosted_pose_} : shown().last(method).poses;
  if (on == worn.on && same(poses, worn.poses)) return worn.meshes;
  worn.meshes = worn_->carry(skins_on_host(method), poses);
  for (std::size_t m = 0; materials_ && m < worn.meshes.size(); ++m) worn.meshes[m].materials = &materials_->worn[m];
  worn.on = on;
  worn.poses = poses;
  return worn.meshes;
}

std::vector<float> Actor::worn_points(std::span<const float> skin, const Pose& pose) const {
  return worn_ ? worn_->points(skin, pose) : std::vector<float>();
}

// Returns the skin that the host makes; null: the method evaluates on the device.
const Actor::HostedSkin* Actor::hosted_skin(SkinMethod method) const {
  if (method == SkinMethod::lbs) return &blended_;
  if (method == SkinMethod::proxy) return &carried_;
  return method == SkinMethod::truth ? &truth_->skin : nullptr;
}

// F x O x 3 of the finest level, of every pose that the method has evaluated last.
std::vector<float> Actor::skins_on_host(SkinMethod method) const {
  const HostedSkin* hosted = hosted_skin(method);
  return hosted ? hosted->points : full_skin(shown(), shown().last(method).result);
}

void Actor::show_linear_blend(const Pose& pose) {
  if (same(blended_of_, {&pose, 1})) return;
  blended_ = upload_output(linear_skin(pose));
  blended_of_ = {pose};
}

// O x 3.
std::vector<float> Actor::linear_skin(const Pose& pose) const {
  return output_from_welded(*character_, trainer::skin_linear(*character_, pose));
}

// Meshes follow the finest level; a proxy that is opened alone carries the full skin, not that of its finest level.
bool Actor::has_worn_skin() const {
  return level_ == 0 || shown().level().following.full_skin().size() == finest().basis().mesh.output_count();
}

// F x O x 3 of the finest level, of all poses of the evaluation.
std::vector<float> Actor::full_skin(const Detail& detail, const Evaluation& evaluation) const {
  const FollowingMeshes& following = detail.level().following;
  if (&detail == details_.front().get() || following.full_skin().empty()) return evaluation.positions;
  FollowingMeshes::Memory memory;
  return following.carry_full_skin(evaluation.positions, evaluation.normals, memory);
}

// Uploads the full skin as it follows the last evaluation of the proxy.
const Evaluation& Actor::carry_proxy() {
  const Detail& proxy = *details_[1];
  const Evaluation& result = proxy.last(SkinMethod::full).result;
  const Source from{1, proxy.last(SkinMethod::full).number};
  if (from != carried_from_) carried_ = upload_output(full_skin(proxy, result));
  carried_from_ = from;
  return result;
}

void Actor::reset_jiggle() {
  for (const auto& detail : details_) detail->reset_jiggle();
}

DeviceSkin Actor::skin(SkinMethod method) const {
  if (const HostedSkin* hosted = hosted_skin(method)) return {&hosted->positions, &hosted->normals};
  return shown().skin(method);
}

std::vector<float> Actor::measure(SkinMethod method, const Pose& pose, int frame, float correction) {
  if (method == SkinMethod::proxy) {
    return full_skin(*details_[1], details_[1]->measure(SkinMethod::full, pose, correction));
  }
  if (method == SkinMethod::lbs) return linear_skin(pose);
  if (method != SkinMethod::truth) return finest().measure(method, pose, correction).positions;
  return read_sample(truth_->shapes.as_they_are(), truth_time(frame).value());
}

void Actor::show_truth(int frame) {
  const std::optional<SampleTime> time = truth_time(frame);
  if (!time || (time == truth_->shown && !truth_->shapes.was_edited())) return;
  truth_->shapes = truth_->shapes.as_they_are();
  truth_->skin = upload_output(shown_truth(frame, *time));
  truth_->shown = time;
}

std::vector<float> Actor::shown_truth(int frame, const SampleTime& time) const {
  if (truth_->raw) return truth_->shapes.raw_sample(time.sample);
  if (truth_->sculpted && truth_->sculpted->first == frame) return truth_->sculpted->second;
  return read_sample(truth_->shapes, time);
}

Actor::HostedSkin Actor::upload_output(std::span<const float> points) {
  const MeshTable& mesh = finest().basis().mesh;
  const std::vector<float> positions = vertices_of(mesh, points);
  std::vector<float> normals(positions.size());
  cpu::output_normals(mesh, positions, normals);
  return {++uploads_,
          {points.begin(), points.end()},
          vulkan::upload(*device_, positions, "a skin"),
          vulkan::upload(*device_, normals, "its normals")};
}

void Actor::measure_size() {
  const MeshTable& mesh = finest().basis().mesh;
  size_ = box_diagonal(mesh.rest);
  std::vector<float> points = mesh.rest;
  if (worn_) {
    const std::vector<float> worn = worn_points(output_of(mesh, mesh.rest), bind_pose(finest().basis().skeleton));
    std::ranges::copy(worn, std::back_inserter(points));
  }
  reach_ = box_diagonal(points);
}

void Actor::measure_ground() {
  const std::vector<float> positions = measure(SkinMethod::full, clip_.poses.front(), clip_.first_frame);
  double low = positions.empty() ? 0 : static_cast<double>(positions[1]);
  for (std::size_t k = 1; k < positions.size(); k += 3) low = std::min(low, static_cast<double>(positions[k]));
  ground_ = low;
}

}  // namespace bodyopt::viewport
