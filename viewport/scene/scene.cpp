#include "viewport/scene/scene.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <set>
#include <utility>

#include "draw/camera.h"
#include "runtime/core/transformed.h"
#include "runtime/host/rig.h"
#include "shots/session/posed_clip.h"

namespace bodyopt::viewport {
namespace {

constexpr std::size_t kColumns = 7;   // of copies, at least
constexpr double kSpacing = 0.7;      // between characters, of their size
constexpr double kOverlap = 0.3;      // of its size: nearer to another, a character would begin inside it
constexpr double kSkinAround = 0.12;  // of joints, of the character's size
constexpr double kSphere = 0.75;      // around the joints, of the character's size

struct AtTheEnd {
  std::function<void()> action;
  ~AtTheEnd() { action(); }
};

// An upright box around points.
struct Box {
  Vec3 low{1e30, 1e30, 1e30}, high{-1e30, -1e30, -1e30};  // of no point

  void add(const Vec3& point) {
    for (std::size_t i = 0; i < 3; ++i) {
      low[i] = std::min(low[i], point[i]);
      high[i] = std::max(high[i], point[i]);
    }
  }
  double radius() const { return 0.5 * length(high - low); }
};

Box box_around(std::span<const float> points) {
  Box box;
  for (std::size_t k = 0; k + 2 < points.size(); k += 3) {
    box.add({points[k], points[k + 1], points[k + 2]});
  }
  return box;
}

// Ghosts are quasi-static: they have no past.
std::span<const Pose> wanted(SkinMethod method, std::span<const Pose> poses) {
  return method == SkinMethod::full ? poses : poses.first(1);
}

// Places alternate in a row: to the right, to the left, further to the right...
double place_in_row(std::size_t index) {
  return index % 2 == 1 ? static_cast<double>(index + 1) / 2 : -static_cast<double>(index) / 2;
}

}  // namespace

Weights weights_of(const Controls& controls) {
  return {static_cast<float>(controls.settings.pose.correction), static_cast<float>(controls.settings.jiggle.amount)};
}

SkinMethod shown_method(const Actor& character, const shots::ViewSettings& settings) {
  return settings.jiggle.on && character.has(SkinMethod::jiggle) ? SkinMethod::jiggle : SkinMethod::full;
}

std::optional<SkinMethod> compared_method(const Actor& character, const shots::ViewSettings& settings) {
  static constexpr std::optional<SkinMethod> kMethods[] = {std::nullopt,       SkinMethod::lbs,  SkinMethod::ddm,
                                                           SkinMethod::linear, SkinMethod::full, SkinMethod::jiggle,
                                                           SkinMethod::truth,  SkinMethod::proxy};  // as CompareWith
  const shots::ViewSettings::Compare& compare = settings.compare;
  const auto wanted = compare.activation ? SkinMethod::ddm : kMethods[static_cast<std::size_t>(compare.with)];
  if (!wanted || !character.has(*wanted) || *wanted == shown_method(character, settings)) return std::nullopt;
  return wanted;
}

void Scene::add(const shots::ActorFiles& files, const ClipOptions& options) { cast_.push_back(make(files, options)); }

std::unique_ptr<Actor> Scene::make(const shots::ActorFiles& files, const ClipOptions& options) const {
  return std::make_unique<Actor>(device_, files, options, levels_);
}

void Scene::swap(std::size_t index, std::unique_ptr<Actor>& other) {
  cast_[index].swap(other);
  forget_look();
}

void Scene::make_lead(std::size_t index) {
  const auto lead = cast_.begin() + static_cast<std::ptrdiff_t>(index);
  std::rotate(cast_.begin(), lead, lead + 1);
  forget_look();
}

void Scene::remove(std::size_t index) {
  cast_.erase(cast_.begin() + static_cast<std::ptrdiff_t>(index));
  forget_look();
}

std::vector<std::filesystem::path> Scene::paths() const {
  std::vector<std::filesystem::path> paths;
  for (const auto& character : cast_) std::ranges::copy(character->paths(), std::back_inserter(paths));
  return paths;
}

void Scene::forget_look() {
  lead_evaluation_ = nullptr;
  lead_expected_ = nullptr;
}

// Characters of one shot stay where their clips have them. Who would begin inside another is put beside it, in a row.
std::array<float, 3> Scene::free_place(std::size_t index) const {
  const auto begins_inside = [&](const std::unique_ptr<Actor>& other) {
    const Vec3 apart = cast_[index]->start() - other->start();
    return std::hypot(apart[0], apart[2]) < kOverlap * cast_[index]->size();
  };
  if (std::none_of(cast_.begin(), cast_.begin() + static_cast<std::ptrdiff_t>(index), begins_inside)) return {0, 0, 0};
  return draw::to_float(
      {kSpacing * cast_[index]->size() * place_in_row(index), cast_.front()->ground() - cast_[index]->ground(), 0});
}

// Places it where it is to begin, heights over the ground that is drawn, which is the lead's; or where there is room.
std::array<float, 3> Scene::place(std::size_t index, const Controls& controls) const {
  const Actor& character = *cast_[index];
  const std::optional<Vec3>& at = placement(character, controls).at;
  if (!at) return free_place(index);
  const Vec3 begins = character.start();
  return draw::to_float(*at - Vec3{begins[0], character.ground() - cast_.front()->ground(), begins[2]});
}

const shots::Placement& Scene::placement(const Actor& character, const Controls& controls) const {
  static const shots::Placement kUsual;
  const auto own = std::ranges::find_if(cast_, [&](const auto& one) { return one.get() == &character; });
  const auto index = static_cast<std::size_t>(own - cast_.begin());
  return index == 0 || index >= controls.placements.size() ? kUsual : controls.placements[index];
}

int Scene::played_frame(const Actor& character, int frame, const Controls& controls) const {
  const std::optional<int>& ahead = placement(character, controls).ahead;
  if (!ahead) return frame;
  const Clip& clip = character.clip();
  const int length = static_cast<int>(clip.poses.size());
  const int from_first = (frame - lead().clip().first_frame + *ahead) % length;
  return clip.first_frame + (from_first + length) % length;
}

std::size_t Scene::level_by_size(std::size_t index, const Controls& controls, std::uint32_t height) const {
  constexpr double kPixels = 0.2;  // RMS: where it is half a pixel, heads look cut
  const Actor& character = *cast_[index];
  const Pose pose = pose_at(character, controls.playback.frame(), controls);
  const Vec3 at = pose.joints.front().translation + draw::to_double(place(index, controls));
  const draw::Camera camera = controls.camera.camera();
  const double away = std::max(1e-3, length(at - draw::to_double(camera.eye)) - 0.5 * character.size());
  const double seen = camera.orthographic_height > 0
                          ? static_cast<double>(camera.orthographic_height)
                          : 2 * away * std::tan(0.5 * static_cast<double>(camera.vertical_angle));
  return character.level_within(kPixels * seen / std::max(1u, height));
}

// Copies of the lead are in rows behind it.
std::array<float, 3> Scene::place_copy(std::size_t copy, const Controls& controls) const {
  const auto all = static_cast<double>(controls.settings.cast.copies);
  const std::size_t columns = std::max(kColumns, static_cast<std::size_t>(std::sqrt(all)));
  const double step = kSpacing * cast_.front()->size();
  return draw::to_float({step * place_in_row(copy % columns), 0, -step * static_cast<double>(copy / columns)});
}

void Scene::reset_jiggle() {
  for (const auto& character : cast_) character->reset_jiggle();
  forget_look();
}

Pose Scene::pose_at(const Actor& character, int frame, const Controls& controls) const {
  const bool leads = &character == &lead();
  if (leads && live_pose_) return *live_pose_;
  if (leads) return character.pose(frame, controls.posing_at(frame));
  const int own = played_frame(character, frame, controls);
  return character.pose(own, shots::keyed_posing(character.posing(), own));
}

std::vector<Pose> Scene::poses_of(const Actor& character, const Controls& controls) const {
  const shots::ViewSettings& s = controls.settings;
  const int frame = controls.playback.frame();
  std::vector<Pose> poses = {pose_at(character, frame, controls)};
  for (int k = 1; k <= s.ghosts.before; ++k) poses.push_back(pose_at(character, frame - k * s.ghosts.step, controls));
  for (int k = 1; k <= s.ghosts.after; ++k) poses.push_back(pose_at(character, frame + k * s.ghosts.step, controls));
  if (&character != cast_.front().get()) return poses;
  const Playback& playback = controls.playback;
  const int length = playback.out() - playback.in() + 1;
  for (int k = 1; k < s.cast.copies; ++k) {  // goes round and round, as they do
    const int ahead = (frame - playback.in() + k * s.cast.delay) % length;
    poses.push_back(pose_at(character, playback.in() + (ahead + length) % length, controls));
  }
  return poses;
}

std::vector<std::vector<Pose>> Scene::poses_of_cast(const Controls& controls) const {
  return transformed(cast_, [&](const auto& character) { return poses_of(*character, controls); });
}

const ExpectedSkin& Scene::expect(const Controls& controls) {
  evaluate_cast(poses_of_cast(controls), controls);
  return lead().shown().expected_skin(shown_method(lead(), controls.settings));
}

void Scene::preroll(Actor& character, const Controls& controls, const Weights& weights) const {
  const int frame = controls.playback.frame(), played = played_frame(character, frame, controls);
  const std::optional<int> last = character.shown().jiggle_frame();
  const bool came_by_itself = last && *last <= played && played - *last <= static_cast<int>(character.clip().fps);
  if (came_by_itself || controls.playback.playing() || live_pose_) return;
  for (int k = -shots::usual_preroll(character.clip(), played); k < 0; ++k) {
    const Pose pose = pose_at(character, frame + k, controls);
    character.evaluate(SkinMethod::jiggle, {&pose, 1}, played + k, weights, false);
  }
}

// Evaluates what add_character() shows of all of the cast, so that the device has it at once.
void Scene::evaluate_cast(const std::vector<std::vector<Pose>>& all_poses, const Controls& controls) {
  const Weights weights = weights_of(controls);
  std::vector<SkinRequest> requests;
  for (std::size_t c = 0; c < cast_.size(); ++c) {
    const auto& character = cast_[c];
    const std::vector<Pose>& poses = all_poses[c];
    const int frame = played_frame(*character, controls.playback.frame(), controls);
    std::set<SkinMethod> methods = {shown_method(*character, controls.settings)};
    if (const auto other = compared_method(*character, controls.settings)) methods.insert(*other);
    if (poses.size() > 1) methods.insert(SkinMethod::full);
    for (const SkinMethod method : methods) {
      if (method == SkinMethod::jiggle) preroll(*character, controls, weights);
      const auto asked = character->request(method, wanted(method, poses), frame, weights, controls.settings.look.worn);
      if (asked) requests.push_back(*asked);
    }
  }
  evaluate_together(requests);
}

Scene::Shown Scene::evaluate(Actor& character, SkinMethod method, std::span<const Pose> poses,
                             const Controls& controls) {
  const Evaluation& evaluation =
      character.evaluate(method, wanted(method, poses), played_frame(character, controls.playback.frame(), controls),
                         weights_of(controls), controls.settings.look.worn);
  stage_seconds_.add(evaluation.stage_seconds);
  return {method, &evaluation, character.skin(method)};
}

void Scene::surround(const std::vector<std::vector<Pose>>& all_poses, const Controls& controls,
                     draw::View& view) const {
  const auto ghosts = static_cast<std::size_t>(controls.settings.ghosts.before + controls.settings.ghosts.after);
  Box all;
  double around_largest = 0, smallest = 1e30;
  for (std::size_t c = 0; c < cast_.size(); ++c) {
    const std::vector<Pose>& poses = all_poses[c];
    const double around = kSphere * std::max(0.1, cast_[c]->reach());
    for (std::size_t k = 0; k < poses.size(); ++k) {
      const Vec3 offset = draw::to_double(k > ghosts ? place_copy(k - ghosts, controls) : place(c, controls));
      Box own;
      for (const Vec3& centre : joint_centres(cast_[c]->basis().skeleton, poses[k])) own.add(centre + offset);
      all.add(own.low);
      all.add(own.high);
      smallest = std::min(smallest, own.radius() + around);
    }
    around_largest = std::max(around_largest, around);
  }
  view.middle = draw::to_float(0.5 * (all.low + all.high));
  view.radius = static_cast<float>(all.radius() + around_largest);
  view.ground.caster = static_cast<float>(smallest);
}

std::vector<Vec3> Scene::joint_centres(const Skeleton& skeleton, const Pose& pose) {
  return transformed(posed_joints(skeleton, pose.joints), [](const Affine& joint) { return joint * Vec3{0, 0, 0}; });
}

std::vector<Vec3> Scene::joint_centres(const Controls& controls) const {
  return cast_.empty() ? std::vector<Vec3>() : joint_centres(lead().basis().skeleton, lead_pose(controls));
}

Pose Scene::lead_pose(const Controls& controls) const { return pose_at(lead(), controls.playback.frame(), controls); }

std::vector<float> Scene::lead_skin(const Controls& controls) {
  return lead().measure(SkinMethod::full, lead_pose(controls), controls.playback.frame(),
                        weights_of(controls).correction);
}

std::vector<float> Scene::skin_on_stage(std::size_t index, const Controls& controls) {
  const int frame = controls.playback.frame();
  const std::array<float, 3> offset = place(index, controls);
  std::vector<float> skin = cast_[index]->measure(SkinMethod::full, pose_at(*cast_[index], frame, controls), frame,
                                                  weights_of(controls).correction);
  for (std::size_t k = 0; k < skin.size(); ++k) skin[k] += offset[k % 3];
  return skin;
}

Vec3 Scene::root_place(int frame) const {
  const Clip& clip = lead().clip();
  const int at = std::clamp(frame, clip.first_frame, clip.last_frame());
  return clip.poses[static_cast<std::size_t>(at - clip.first_frame)].joints.front().translation;
}

Vec3 Scene::whereabouts(int frame) const {
  const Actor& lead = *cast_.front();
  const Clip& clip = lead.clip();
  const auto root_at = [&](int at) {
    const Vec3 root = root_place(at);
    return Vec3{root[0], 0, root[2]};
  };
  const int around = static_cast<int>(std::lround(0.5 * clip.fps));
  const Vec3 here = root_at(frame);
  Vec3 mean = here;
  int count = 1;
  for (const int way : {-1, 1}) {
    for (int k = 1; k <= around; ++k) {
      const Vec3 there = root_at(frame + way * k);
      if (length(there - here) > 0.5 * lead.size()) break;
      ++count;
      mean = mean + (1.0 / count) * (there - mean);
    }
  }
  return mean;
}

std::vector<draw::View> Scene::portrait(const shots::ViewSettings::PoseKey& pose, const Controls& controls,
                                        std::uint32_t pixels) {
  constexpr double kRight = 0.45, kUp = 0.18;  // radians
  Controls own;
  own.playback = controls.playback;
  own.settings.pose = controls.settings.pose;
  static_cast<shots::ViewSettings::PoseKey&>(own.settings.pose) = pose;
  own.settings.look.grid = own.settings.look.axes = false;
  std::vector<std::unique_ptr<Actor>> cast;
  cast.push_back(std::move(cast_.front()));
  std::optional<Pose> live = std::exchange(live_pose_, std::nullopt);
  std::optional<CutOpenSkin> cut_open = std::exchange(cut_open_, std::nullopt);
  cast_.swap(cast);
  const AtTheEnd put_back{[&] {
    cast.front() = std::move(cast_.front());
    cast_.swap(cast);
    live_pose_ = std::move(live);
    cut_open_ = std::move(cut_open);
  }};
  own.camera.orbit(kRight, kUp);
  own.camera.frame(points_to_frame(own), 1, 1);
  return look(own, {0, 0, pixels, pixels});
}

std::vector<float> Scene::points_to_frame(const Controls& controls) {
  const int frame = controls.playback.frame();
  const int selected = controls.joint.empty() ? -1 : lead().basis().skeleton.find(controls.joint);
  std::vector<float> points;
  if (selected >= 0) {
    const Vec3 centre = joint_centres(controls)[static_cast<std::size_t>(selected)];
    for (const double around : {-kSkinAround * lead().size(), kSkinAround * lead().size()}) {
      for (const double x : centre) points.push_back(static_cast<float>(x + around));
    }
    return points;
  }
  for (std::size_t c = 0; c < cast_.size(); ++c) {
    const std::array<float, 3> offset = place(c, controls);
    const Pose pose = pose_at(*cast_[c], frame, controls);
    std::vector<float> own = cast_[c]->measure(SkinMethod::full, pose, frame);
    if (controls.settings.look.worn) std::ranges::copy(cast_[c]->worn_points(own, pose), std::back_inserter(own));
    const std::optional<SkinMethod> other = compared_method(*cast_[c], controls.settings);
    if (other == SkinMethod::truth ? cast_[c]->has_sample_at(frame) : other && *other != SkinMethod::jiggle) {
      std::ranges::copy(cast_[c]->measure(*other, pose, frame), std::back_inserter(own));
    }
    for (std::size_t k = 0; k < own.size(); ++k) points.push_back(own[k] + offset[k % 3]);
    // Copies as they are now, of the corners of the box around it: they are many.
    const Box box = box_around(own);
    for (int copy = 1; c == 0 && copy < controls.settings.cast.copies; ++copy) {
      const std::array<float, 3> at = place_copy(static_cast<std::size_t>(copy), controls);
      for (std::size_t corner = 0; corner < 8; ++corner) {
        for (std::size_t i = 0; i < 3; ++i) {
          points.push_back(static_cast<float>((corner >> i & 1) != 0 ? box.high[i] : box.low[i]) + at[i]);
        }
      }
    }
  }
  return points;
}

}  // namespace bodyopt::viewport
