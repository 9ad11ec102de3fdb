#include "proxy_viewer/scene/scene.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <set>

#include "draw/camera.h"
#include "proxy_viewer/scene/turn_rings.h"
#include "proxy_viewer/state/strain_colour.h"
#include "runtime/core/transformed.h"
#include "runtime/host/rig.h"
#include "shots/session/pinned_joints.h"
#include "shots/session/posed_clip.h"

namespace bodyopt {
namespace {

constexpr std::array<float, 3> kBeforeColour = {0.12f, 0.30f, 0.75f}, kAfterColour = {0.80f, 0.33f, 0.10f};
constexpr std::array<float, 3> kWornColour = {0.16f, 0.19f, 0.23f};
constexpr std::array<float, 3> kOtherColour = {0.25f, 0.47f, 0.62f};  // of what is compared with
constexpr std::uint32_t kBone = 0xd0f0e4c8, kJoint = 0xffffffff, kSelected = 0xff2fb4ff;
constexpr std::array<std::uint32_t, 3> kAxisColours{0xff5050f0, 0xff50d070, 0xfff09050};  // x, y, z
constexpr std::size_t kColumns = 7;                                                       // of copies
constexpr std::uint32_t kMarked = 0xff5a40ff;
constexpr std::array<std::uint32_t, 6> kPairColours{0xff4060ff, 0xff50d070, 0xffff9040,
                                                    0xff40d8ff, 0xffe060e0, 0xffd8d840};
constexpr double kSpacing = 0.7;      // between characters, of their size
constexpr double kOverlap = 0.3;      // of its size: nearer to another, a character would begin inside it
constexpr double kSkinAround = 0.12;  // of joints, of the character's size
constexpr float kSkinOverTets = 0.12f;
constexpr double kSphere = 0.75;  // around the joints, of the character's size

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

std::vector<Vec3> centres_of(const Actor& character, const Pose& pose) {
  return transformed(posed_joints(character.basis().skeleton, pose.joints), [&](const Affine& joint) {
    return joint * Vec3{0, 0, 0};
  });
}

// A round number of metres, about a tenth of the size.
float grid_spacing(double size) {
  const double power = std::pow(10, std::floor(std::log10(std::max(1e-3, size / 10))));
  const double share = size / 10 / power;
  return static_cast<float>(power * (share < 2 ? 1 : share < 5 ? 2 : 5));
}

SkinDraw draw_of(const Actor& character, const DeviceSkin& shown, const Controls& controls) {
  const ViewSettings::Look& look = controls.settings.look;
  SkinDraw skin;
  skin.triangles = &character.shown().level().triangles;
  skin.triangle_count = static_cast<std::uint32_t>(character.basis().mesh.triangles.size() / 3);
  skin.positions = shown.positions;
  skin.normals = shown.normals;
  skin.style = static_cast<SurfaceStyle>(look.style);  // of the same names
  skin.materials = character.materials();
  skin.wire = look.wire;
  skin.shadow = look.shadow;
  skin.heat_range = static_cast<float>(1e-3 * controls.heat_mm());
  return skin;
}

// Heat is of a character's skin alone: what else is drawn of it keeps its colour.
SkinDraw without_heat(SkinDraw draw) {
  draw.reference = draw.distances = draw.colours = nullptr;
  return draw;
}

// What is worn over a skin that is drawn, at that of its poses.
void dress(std::span<const WornMesh> meshes, std::size_t pose, const SkinDraw& skin, const std::array<float, 3>& colour,
           View& view) {
  for (const WornMesh& mesh : meshes) {
    SkinDraw worn = without_heat(skin);
    worn.triangles = mesh.triangles;
    worn.triangle_count = mesh.triangle_count;
    worn.materials = mesh.materials;
    worn.positions = &mesh.positions;
    worn.normals = &mesh.normals;
    worn.first_vertex = static_cast<std::uint32_t>(pose) * mesh.vertex_count;
    worn.colour = colour;
    view.skins.push_back(worn);
  }
}

// Ghosts are quasi-static: they have no past.
std::span<const Pose> wanted(SkinMethod method, std::span<const Pose> poses) {
  return method == SkinMethod::full ? poses : poses.first(1);
}

LinePoint line_point(const Vec3& at, std::uint32_t colour) {
  const auto [x, y, z] = to_float(at);
  return {x, y, z, colour};
}

// Of those that stand in a row: to the right, to the left, further to the right...
double place_in_row(std::size_t index) {
  return index % 2 == 1 ? static_cast<double>(index + 1) / 2 : -static_cast<double>(index) / 2;
}

}  // namespace

Weights weights_of(const Controls& controls) {
  return {static_cast<float>(controls.settings.pose.correction), static_cast<float>(controls.settings.jiggle.amount)};
}

SkinMethod shown_method(const Actor& character, const ViewSettings& settings) {
  return settings.jiggle.on && character.has(SkinMethod::jiggle) ? SkinMethod::jiggle : SkinMethod::full;
}

std::optional<SkinMethod> compared_method(const Actor& character, const ViewSettings& settings) {
  static constexpr std::optional<SkinMethod> kMethods[] = {std::nullopt,       SkinMethod::lbs,  SkinMethod::ddm,
                                                           SkinMethod::linear, SkinMethod::full, SkinMethod::jiggle,
                                                           SkinMethod::truth,  SkinMethod::proxy};  // as CompareWith
  const ViewSettings::Compare& compare = settings.compare;
  const auto wanted = compare.activation ? SkinMethod::ddm : kMethods[static_cast<std::size_t>(compare.with)];
  if (!wanted || !character.has(*wanted) || *wanted == shown_method(character, settings)) return std::nullopt;
  return wanted;
}

void Scene::add(const ActorFiles& files, const ClipOptions& options) { cast_.push_back(make(files, options)); }

std::unique_ptr<Actor> Scene::make(const ActorFiles& files, const ClipOptions& options) const {
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

void Scene::forget_look() {
  lead_evaluation_ = nullptr;
  lead_expected_ = nullptr;
}

// Those of one shot stay where their clips have them. Who would begin inside another is put beside it, in a row.
std::array<float, 3> Scene::free_place(std::size_t index) const {
  const auto begins_inside = [&](const std::unique_ptr<Actor>& other) {
    const Vec3 apart = cast_[index]->start() - other->start();
    return std::hypot(apart[0], apart[2]) < kOverlap * cast_[index]->size();
  };
  if (std::none_of(cast_.begin(), cast_.begin() + static_cast<std::ptrdiff_t>(index), begins_inside)) return {0, 0, 0};
  return to_float(
      {kSpacing * cast_[index]->size() * place_in_row(index), cast_.front()->ground() - cast_[index]->ground(), 0});
}

// Where it is to begin, or where there is room.
std::array<float, 3> Scene::place(std::size_t index, const Controls& controls) const {
  const Actor& character = *cast_[index];
  const std::optional<Vec3>& at = placement(character, controls).at;
  if (!at) return free_place(index);
  const Vec3 begins = character.start();
  return to_float(*at - Vec3{begins[0], character.ground(), begins[2]});
}

const Placement& Scene::placement(const Actor& character, const Controls& controls) const {
  static const Placement kUsual;
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
  const Vec3 at = pose.joints.front().translation + to_double(place(index, controls));
  const Camera camera = controls.camera.camera();
  const double away = std::max(1e-3, length(at - to_double(camera.eye)) - 0.5 * character.size());
  const double seen = camera.orthographic_height > 0
                          ? static_cast<double>(camera.orthographic_height)
                          : 2 * away * std::tan(0.5 * static_cast<double>(camera.vertical_angle));
  return character.level_within(kPixels * seen / std::max(1u, height));
}

// Of the lead: in rows behind it.
std::array<float, 3> Scene::place_copy(std::size_t copy) const {
  const double step = kSpacing * cast_.front()->size();
  return to_float({step * place_in_row(copy % kColumns), 0, -step * static_cast<double>(copy / kColumns)});
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
  return character.pose(own, keyed_posing(character.posing(), own));
}

std::vector<Pose> Scene::poses_of(const Actor& character, const Controls& controls) const {
  const ViewSettings& s = controls.settings;
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

void Scene::preroll(Actor& character, const Controls& controls, const Weights& weights) const {
  const int frame = controls.playback.frame(), second = static_cast<int>(character.clip().fps);
  const int played = played_frame(character, frame, controls);
  const std::optional<int> last = character.shown().jiggle_frame();
  const bool came_by_itself = last && *last <= played && played - *last <= second;
  if (came_by_itself || controls.playback.playing() || live_pose_) return;
  for (int k = std::max(character.clip().first_frame - played, -second); k < 0; ++k) {
    const Pose pose = pose_at(character, frame + k, controls);
    character.evaluate(SkinMethod::jiggle, {&pose, 1}, played + k, weights, false);
  }
}

// What add_character() shows of all of the cast, so that the device has it at once.
void Scene::evaluate_cast(const Controls& controls) {
  const Weights weights = weights_of(controls);
  std::vector<SkinRequest> requests;
  for (const auto& character : cast_) {
    const std::vector<Pose> poses = poses_of(*character, controls);
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

std::vector<View> Scene::look(const Controls& controls, const Rectangle& area) {
  stage_seconds_ = {};
  lead_expected_ = nullptr;
  lines_.clear();
  colours_.clear();
  View view;
  view.camera = controls.camera.camera();
  view.area = view.part = area;
  const ViewSettings::Look& look = controls.settings.look;
  view.ground.grid = look.grid;
  view.ground.axes = look.axes;
  view.ground.light = look.style == LookStyle::silhouette;
  view.ground.shadow = look.shadow ? 0.85f : 0.0f;
  if (!cast_.empty()) {
    view.ground.height = static_cast<float>(lead().ground());
    view.ground.spacing = grid_spacing(lead().size());
    surround(controls, view);
  }

  std::vector<View> views = {view};
  const ViewSettings::Compare& compare = controls.settings.compare;
  const bool compares = !cast_.empty() && compared_method(lead(), controls.settings) && !compare.activation;
  if (compares && (compare.layout == CompareLayout::side_by_side || compare.layout == CompareLayout::wipe)) {
    views.push_back(view);
    if (compare.layout == CompareLayout::side_by_side) {
      const std::vector<Rectangle> areas = view_areas(controls.settings, area);
      for (std::size_t k = 0; k < 2; ++k) views[k].area = views[k].part = areas[k];
    } else {
      const auto wipe = static_cast<std::uint32_t>(std::lround(compare.wipe * area.width));
      views[0].part.width = wipe;
      views[1].part.x += static_cast<std::int32_t>(wipe);
      views[1].part.width = area.width - wipe;
    }
  }
  evaluate_cast(controls);
  for (std::size_t c = 0; c < cast_.size(); ++c) add_character(c, controls, views);
  add_markings(controls, views[0]);
  if (controls.marker && controls.marker->frame == controls.playback.frame()) {
    for (View& v : views) add_marker(controls.marker->at, kMarked, v);
  }
  // What is see-through is drawn over what is not.
  for (View& v : views) std::ranges::stable_partition(v.skins, [](const SkinDraw& draw) { return draw.alpha >= 1; });
  return views;
}

void Scene::surround(const Controls& controls, View& view) const {
  const auto ghosts = static_cast<std::size_t>(controls.settings.ghosts.before + controls.settings.ghosts.after);
  Box all;
  double around_largest = 0, smallest = 1e30;
  for (std::size_t c = 0; c < cast_.size(); ++c) {
    const std::vector<Pose> poses = poses_of(*cast_[c], controls);
    const double around = kSphere * std::max(0.1, cast_[c]->reach());
    for (std::size_t k = 0; k < poses.size(); ++k) {
      const Vec3 offset = to_double(k > ghosts ? place_copy(k - ghosts) : place(c, controls));
      Box own;
      for (const Vec3& centre : centres_of(*cast_[c], poses[k])) own.add(centre + offset);
      all.add(own.low);
      all.add(own.high);
      smallest = std::min(smallest, own.radius() + around);
    }
    around_largest = std::max(around_largest, around);
  }
  view.middle = to_float(0.5 * (all.low + all.high));
  view.radius = static_cast<float>(all.radius() + around_largest);
  view.ground.caster = static_cast<float>(smallest);
}

std::vector<Rectangle> Scene::view_areas(const ViewSettings& settings, const Rectangle& area) const {
  const ViewSettings::Compare& compare = settings.compare;
  const bool two = !cast_.empty() && compare.layout == CompareLayout::side_by_side && !compare.activation &&
                   compared_method(lead(), settings);
  if (!two) return {area};
  const std::uint32_t left = area.width / 2;
  return {{area.x, area.y, left, area.height},
          {area.x + static_cast<std::int32_t>(left), area.y, area.width - left, area.height}};
}

void Scene::add_marker(const Vec3& at, std::uint32_t colour, View& view) {
  const double reach = 0.012 * lead().size();
  std::vector<LinePoint> cross;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (const double side : {-reach, reach}) {
      Vec3 end = at;
      end[axis] += side;
      cross.push_back(line_point(end, colour));
    }
  }
  add_lines(std::move(cross), {}, 2, view);
}

void Scene::add_lines(std::vector<LinePoint> points, const std::array<float, 3>& offset, float width, View& view) {
  lines_.push_back(std::move(points));
  view.lines.push_back({lines_.back(), offset, width, true});
}

// Pairs in one colour each, the one that waits for its other in white.
void Scene::add_markings(const Controls& controls, View& view) {
  const Marking& marking = controls.marking;
  if (cast_.size() < 2 || (marking.pairs.empty() && !marking.of_lead)) return;
  const std::vector<float> lead = skin_on_stage(0, controls), second = skin_on_stage(1, controls);
  const auto mark = [&](const std::vector<float>& skin, std::uint32_t vertex, std::uint32_t colour) {
    if (3 * std::size_t{vertex} + 2 >= skin.size()) return;  // of a body that was opened since
    const float* at = &skin[3 * std::size_t{vertex}];
    add_marker({at[0], at[1], at[2]}, colour, view);
  };
  for (std::size_t k = 0; k < marking.pairs.size(); ++k) {
    const std::uint32_t colour = kPairColours[k % kPairColours.size()];
    mark(lead, marking.pairs[k].of_lead, colour);
    mark(second, marking.pairs[k].of_second, colour);
  }
  if (marking.of_lead) mark(lead, *marking.of_lead, kJoint);
}

void Scene::add_character(std::size_t index, const Controls& controls, std::vector<View>& views) {
  Actor& character = *cast_[index];
  const ViewSettings& s = controls.settings;
  const std::vector<Pose> poses = poses_of(character, controls);
  const SkinMethod method = shown_method(character, s);
  const std::optional<SkinMethod> other = compared_method(character, s);
  const Shown shown = evaluate(character, method, poses, controls);
  if (index == 0) lead_evaluation_ = shown.evaluation;
  std::optional<Shown> compared;
  const int frame = played_frame(character, controls.playback.frame(), controls);
  const bool is_missing = other == SkinMethod::truth && !character.truth_time(frame);
  const bool is_measured = other != SkinMethod::truth || character.has_sample_at(frame);
  if (other && !is_missing) compared = evaluate(character, *other, poses, controls);

  SkinDraw skin = draw_of(character, shown.skin, controls);
  skin.offset = place(index, controls);
  SkinDraw second = skin;
  if (compared) {
    second.positions = compared->skin.positions;
    second.normals = compared->skin.normals;
    second.colour = kOtherColour;
    second.materials = nullptr;
    if ((s.compare.heat || s.compare.activation) && is_measured) skin.reference = second.positions;
  }
  if (s.compare.coverage && character.shown().knows_coverage()) {
    const ExpectedSkin& expected = character.shown().expected_skin(poses[0]);
    skin.distances = &expected.vertices;
    if (index == 0) lead_expected_ = &expected;
  }

  colour_by_match(index, s, skin);
  if (s.look.tets && character.shown().tet_count() > 0) {
    add_tets(character, poses[0], skin, controls, views);
    skin.alpha = kSkinOverTets;
    skin.shadow = skin.wire = false;
  }
  const bool flips = compared && s.compare.layout == CompareLayout::hold && controls.shows_compared();
  const bool opened = index == 0 && cut_open_;
  if (opened) {
    add_cut_open(skin, views[0]);
  } else {
    views[0].skins.push_back(flips ? second : skin);
  }
  if (views.size() > 1) {
    if (!is_missing) views[1].skins.push_back(compared ? second : skin);
  } else if (compared && s.compare.layout == CompareLayout::overlay && !s.compare.activation) {
    second.alpha = 0.6f;
    second.shadow = false;
    views[0].skins.push_back(second);
  }
  if (s.look.worn) {
    const SkinMethod first = flips ? compared->method : method;
    if (!opened) dress(character.worn(first), 0, skin, kWornColour, views[0]);
    if (views.size() > 1 && !is_missing) {
      dress(character.worn(compared ? compared->method : method), 0, skin, kWornColour, views[1]);
    }
  }
  for (View& view : views) {
    if (s.look.skeleton) add_skeleton(character, poses[0], skin.offset, controls, view);
    if (s.look.skeleton && &character == &lead()) add_rings(controls, skin.offset, view);
    if (s.look.fibres) add_fibres(character, shown, skin.offset, view);
  }
  if (poses.size() > 1) add_copies_and_ghosts(character, poses, shown, skin, controls, views);
}

// Neither heat nor wires are of it.
void Scene::add_cut_open(const SkinDraw& skin, View& view) const {
  for (const CutOpenSkin::Part* part : {&cut_open_->skin, &cut_open_->face}) {
    if (part->triangle_count == 0) continue;
    SkinDraw draw = without_heat(skin);
    draw.triangles = &part->triangles;
    draw.triangle_count = part->triangle_count;
    draw.positions = &part->positions;
    draw.normals = &part->normals;
    draw.colours = &part->colours;
    draw.first_vertex = 0;
    draw.wire = false;
    view.skins.push_back(draw);
  }
}

// They are quasi-static: they have no past.
void Scene::add_copies_and_ghosts(Actor& character, std::span<const Pose> poses, const Shown& shown,
                                  const SkinDraw& skin, const Controls& controls, std::vector<View>& views) {
  const ViewSettings& s = controls.settings;
  const Shown others =
      shown.method == SkinMethod::full ? shown : evaluate(character, SkinMethod::full, poses, controls);
  const std::span<const WornMesh> worn = s.look.worn ? character.worn(SkinMethod::full) : std::span<const WornMesh>();
  SkinDraw extra = without_heat(skin);
  extra.positions = others.skin.positions;
  extra.normals = others.skin.normals;
  const std::size_t ghosts = static_cast<std::size_t>(s.ghosts.before + s.ghosts.after);
  const auto add = [&](std::size_t pose, const std::array<float, 3>& worn_colour) {
    extra.first_vertex = static_cast<std::uint32_t>(pose) * character.basis().mesh.vertex_count();
    for (View& view : views) {
      view.skins.push_back(extra);
      dress(worn, pose, extra, worn_colour, view);
    }
  };
  for (std::size_t k = ghosts + 1; k < poses.size(); ++k) {
    extra.offset = place_copy(k - ghosts);
    add(k, kWornColour);
  }
  extra.offset = skin.offset;
  extra.wire = extra.shadow = false;
  for (std::size_t g = 1; g <= ghosts; ++g) {
    const bool before = g <= static_cast<std::size_t>(s.ghosts.before);
    const std::size_t away = before ? g : g - static_cast<std::size_t>(s.ghosts.before);
    const int count = before ? s.ghosts.before : s.ghosts.after;
    extra.colour = before ? kBeforeColour : kAfterColour;
    const double fades = 1 - 0.6 * static_cast<double>(away - 1) / std::max(1, count);
    extra.alpha = static_cast<float>(std::clamp(s.ghosts.opacity * fades, 0.0, 0.99));
    add(g, extra.colour);
  }
}

// In place of any heat.
void Scene::colour_by_match(std::size_t index, const ViewSettings& settings, SkinDraw& skin) const {
  const MatchView view = settings.compare.match;
  if (view == MatchView::none || !match_ || index >= 2 || cast_[index]->level() > 0) return;
  skin = without_heat(skin);
  skin.heat_range = 1;  // of what is not sure at all
  (view == MatchView::colours ? skin.colours : skin.distances) =
      &(view == MatchView::colours ? match_->colours : match_->unsure)[index];
}

void Scene::add_tets(Actor& character, const Pose& pose, const SkinDraw& skin, const Controls& controls,
                     std::vector<View>& views) {
  const ViewSettings& s = controls.settings;
  const Camera camera = controls.camera.camera();
  Vec3 towards = to_double(camera.eye) - to_double(camera.target);
  towards = 1 / length(towards) * towards;
  const bool jiggles = shown_method(character, s) == SkinMethod::jiggle;
  const auto amount = jiggles ? std::optional(static_cast<float>(s.jiggle.amount)) : std::nullopt;
  const CutTets& tets = character.shown().cut_tets(pose, amount, towards, s.look.tet_cut);
  SkinDraw draw = without_heat(skin);
  draw.positions = draw.normals = &tets.positions();  // facets need no normals
  draw.style = SurfaceStyle::flat;
  for (const CutTets::Part& part : tets.parts()) {
    draw.triangles = &part.triangles;
    draw.triangle_count = part.triangle_count;
    draw.colour = part.colour;
    for (View& view : views) view.skins.push_back(draw);
  }
}

void Scene::add_skeleton(const Actor& character, const Pose& pose, const std::array<float, 3>& offset,
                         const Controls& controls, View& view) {
  const Skeleton& skeleton = character.basis().skeleton;
  const std::vector<Vec3> centres = centres_of(character, pose);
  std::vector<LinePoint> bones, joints;
  const double cross = 0.008 * character.size();
  for (std::size_t j = 0; j < centres.size(); ++j) {
    const std::string& name = skeleton.joints[j].name;
    const bool selected = name == controls.joint || controls.also.contains(name);
    const int parent = skeleton.joints[j].parent;
    if (parent >= 0) {
      bones.push_back(line_point(centres[static_cast<std::size_t>(parent)], kBone));
      bones.push_back(line_point(centres[j], kBone));
    }
    for (std::size_t i = 0; i < 3; ++i) {
      Vec3 along{};
      along[i] = selected ? 2 * cross : cross;
      joints.push_back(line_point(centres[j] - along, selected ? kSelected : kJoint));
      joints.push_back(line_point(centres[j] + along, selected ? kSelected : kJoint));
    }
  }
  add_lines(std::move(bones), offset, 3, view);
  add_lines(std::move(joints), offset, 1.5f, view);
}

// Of the joint that is selected: bright as far as it may turn, with a hand at its angle; arrows where it may move. And
// the pins.
void Scene::add_rings(const Controls& controls, const std::array<float, 3>& offset, View& view) {
  constexpr int kSteps = 72;
  std::vector<LinePoint> lines;
  const auto draw = [&](const Vec3& from, const Vec3& to, std::uint32_t colour) {
    for (const Vec3& at : {from, to}) lines.push_back(line_point(at, colour));
  };
  for (const TurnRing& ring : turn_rings(*this, controls)) {
    const std::uint32_t colour = kAxisColours[ring.axis];
    for (int k = 0; k < kSteps; ++k) {
      const double from = -180.0 + 360.0 * k / kSteps, to = from + 360.0 / kSteps;
      const bool is_free = ring.low <= from && to <= ring.high;
      draw(ring.point(from), ring.point(to), is_free ? colour : (colour & 0x00ffffff) | 0x40000000);
    }
    draw(ring.centre, ring.point(ring.angle), colour);
  }
  for (const MoveArrow& arrow : move_arrows(*this, controls)) {
    const std::uint32_t colour = kAxisColours[arrow.axis];
    const Vec3 along = arrow.to - arrow.from;
    draw(arrow.from, arrow.to, colour);
    for (std::size_t across = 1; across < 3; ++across) {  // its head, from two sides
      Vec3 side{};
      side[(arrow.axis + across) % 3] = 0.08 * length(along);
      for (const Vec3& end : {side, -1 * side}) draw(arrow.to, arrow.to - 0.2 * along + end, colour);
    }
  }
  const double size = 0.012 * lead().size();
  const std::vector<MissedPin> missed = lead().missed_pins(controls.playback.frame(), controls.settings.pose);
  for (const auto& [joint, at] : controls.settings.pose.pins) {
    const bool is_missed = std::ranges::find(missed, joint, &MissedPin::joint) != missed.end();
    for (std::size_t axis = 0; axis < 3; ++axis) {  // an octahedron, seen from wherever
      Vec3 right{}, up{};
      right[axis] = up[(axis + 1) % 3] = size;
      const Vec3 corners[] = {at + right, at + up, at - right, at - up};
      for (std::size_t k = 0; k < 4; ++k) draw(corners[k], corners[(k + 1) % 4], is_missed ? kMarked : kSelected);
    }
  }
  add_lines(std::move(lines), offset, 2, view);
}

void Scene::add_fibres(const Actor& character, const Shown& shown, const std::array<float, 3>& offset, View& view) {
  if (character.shown().level().fibre_segment_count == 0 || shown.method == SkinMethod::truth) return;
  std::vector<std::uint32_t> colours;
  const std::uint32_t fibres = character.basis().strain.fibre_count();
  for (std::uint32_t f = 0; f < fibres; ++f) colours.push_back(strain_colour(shown.evaluation->strains[f]));
  colours_.push_back(std::move(colours));
  FibreDraw draw;
  draw.segments = &character.shown().level().fibre_segments;
  draw.segment_count = character.shown().level().fibre_segment_count;
  draw.points = &character.shown().level().fibre_points;
  draw.positions = shown.skin.positions;
  draw.normals = shown.skin.normals;
  draw.colours = colours_.back();
  draw.offset = offset;
  draw.lift = static_cast<float>(0.0015 * character.size());
  view.fibres.push_back(draw);
}

std::vector<Vec3> Scene::joint_centres(const Controls& controls) const {
  return cast_.empty() ? std::vector<Vec3>() : centres_of(lead(), lead_pose(controls));
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
      const std::array<float, 3> at = place_copy(static_cast<std::size_t>(copy));
      for (std::size_t corner = 0; corner < 8; ++corner) {
        for (std::size_t i = 0; i < 3; ++i) {
          points.push_back(static_cast<float>((corner >> i & 1) != 0 ? box.high[i] : box.low[i]) + at[i]);
        }
      }
    }
  }
  return points;
}

}  // namespace bodyopt
