// Lines over the skins: bones, rings, fibres, pins and markers.
#include <algorithm>
#include <map>
#include <set>

#include "shots/session/pinned_joints.h"
#include "viewport/scene/scene.h"
#include "viewport/scene/turn_rings.h"
#include "viewport/state/strain_colour.h"

namespace bodyopt::viewport {
namespace {

constexpr std::uint32_t kBone = 0xd0f0e4c8, kJoint = 0xffffffff, kSelected = 0xff2fb4ff;
constexpr std::array<std::uint32_t, 3> kAxisColours{0xff5050f0, 0xff50d070, 0xfff09050};  // x, y, z
constexpr std::uint32_t kMarked = 0xff5a40ff;
constexpr std::array<std::uint32_t, 6> kPairColours{0xff4060ff, 0xff50d070, 0xffff9040,
                                                    0xff40d8ff, 0xffe060e0, 0xffd8d840};

draw::LinePoint line_point(const Vec3& at, std::uint32_t colour) {
  const auto [x, y, z] = draw::to_float(at);
  return {x, y, z, colour};
}

// Adds a cross along the world's axes.
void add_cross(const Vec3& at, double reach, std::uint32_t colour, std::vector<draw::LinePoint>& lines) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    Vec3 along{};
    along[axis] = reach;
    for (const Vec3& end : {at - along, at + along}) lines.push_back(line_point(end, colour));
  }
}

}  // namespace

void Scene::add_lines(std::vector<draw::LinePoint> points, const std::array<float, 3>& offset, float width,
                      draw::View& view) {
  lines_.push_back(std::move(points));
  view.lines.push_back({lines_.back(), offset, width, true});
}

void Scene::add_marker(const Vec3& at, std::uint32_t colour, draw::View& view) {
  std::vector<draw::LinePoint> cross;
  add_cross(at, 0.012 * lead().size(), colour, cross);
  add_lines(std::move(cross), {}, 2, view);
}

// Marks the worst error. Pairs have one colour each; a vertex that waits for its other is white.
void Scene::add_markings(const Controls& controls, std::vector<draw::View>& views) {
  if (controls.marker && controls.marker->frame == controls.playback.frame()) {
    for (draw::View& view : views) add_marker(controls.marker->at, kMarked, view);
  }
  const Marking& marking = controls.marking;
  if (cast_.size() < 2 || (marking.pairs.empty() && !marking.of_lead)) return;
  const std::vector<float> lead = skin_on_stage(0, controls), second = skin_on_stage(1, controls);
  const auto mark = [&](const std::vector<float>& skin, std::uint32_t vertex, std::uint32_t colour) {
    if (3 * std::size_t{vertex} + 2 >= skin.size()) return;  // of a body that was opened since
    const float* at = &skin[3 * std::size_t{vertex}];
    add_marker({at[0], at[1], at[2]}, colour, views[0]);
  };
  for (std::size_t k = 0; k < marking.pairs.size(); ++k) {
    const std::uint32_t colour = kPairColours[k % kPairColours.size()];
    mark(lead, marking.pairs[k].of_lead, colour);
    mark(second, marking.pairs[k].of_second, colour);
  }
  if (marking.of_lead) mark(lead, *marking.of_lead, kJoint);
}

void Scene::add_skeleton(const Actor& character, const Pose& pose, const std::array<float, 3>& offset,
                         const Controls& controls, draw::View& view) {
  const Skeleton& skeleton = character.basis().skeleton;
  const std::vector<Vec3> centres = joint_centres(skeleton, pose);
  std::vector<draw::LinePoint> bones, joints;
  const double cross = 0.008 * character.size();
  for (std::size_t j = 0; j < centres.size(); ++j) {
    const std::string& name = skeleton.joints[j].name;
    const bool selected = name == controls.joint || controls.also.contains(name);
    const int parent = skeleton.joints[j].parent;
    if (parent >= 0) {
      bones.push_back(line_point(centres[static_cast<std::size_t>(parent)], kBone));
      bones.push_back(line_point(centres[j], kBone));
    }
    add_cross(centres[j], selected ? 2 * cross : cross, selected ? kSelected : kJoint, joints);
  }
  add_lines(std::move(bones), offset, 3, view);
  add_lines(std::move(joints), offset, 1.5f, view);
}

// Draws the selected joints' paths, in the colours of ghosts, through the frames of the range that are near. Each frame
// with a key has a cross.
void Scene::add_trails(const Controls& controls, const std::array<float, 3>& offset, draw::View& view) {
  constexpr int kLongest = 120;  // frames either way
  constexpr std::uint32_t kBefore = 0xffe0a060, kAfter = 0xff40a0f0;
  const Skeleton& skeleton = lead().basis().skeleton;
  const int shown = controls.playback.frame();
  const int first = std::max(controls.playback.in(), shown - kLongest);
  const int last = std::min(controls.playback.out(), shown + kLongest);
  if (live_pose_ || controls.joint.empty() || last <= first) return;
  std::set<std::string> names = controls.also;
  names.insert(controls.joint);
  std::map<std::string, std::vector<draw::LinePoint>> ways;
  std::vector<draw::LinePoint> keys;
  for (int frame = first; frame <= last; ++frame) {
    const std::vector<Vec3> centres = joint_centres(skeleton, pose_at(lead(), frame, controls));
    for (const std::string& name : names) {
      const int joint = skeleton.find(name);
      if (joint < 0) continue;
      const Vec3& at = centres[static_cast<std::size_t>(joint)];
      std::vector<draw::LinePoint>& way = ways[name];
      const draw::LinePoint point = line_point(at, frame <= shown ? kBefore : kAfter);
      if (!way.empty()) way.push_back(point);
      way.push_back(point);
      if (controls.settings.pose.keys.contains(frame)) add_cross(at, 0.006 * lead().size(), kSelected, keys);
    }
  }
  for (auto& [name, way] : ways) {
    way.pop_back();  // which begins no line
    add_lines(std::move(way), offset, 2, view);
  }
  add_lines(std::move(keys), offset, 2, view);
}

// Draws the selected joint's rings, bright as far as it may turn, with a hand at its angle; its arrows; and all pins.
void Scene::add_rings(const Controls& controls, const std::array<float, 3>& offset, draw::View& view) {
  constexpr int kSteps = 72;
  std::vector<draw::LinePoint> lines;
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
  const std::vector<shots::MissedPin> missed = lead().missed_pins(controls.playback.frame(), controls.settings.pose);
  for (const auto& [joint, at] : controls.settings.pose.pins) {
    const bool is_missed = std::ranges::find(missed, joint, &shots::MissedPin::joint) != missed.end();
    for (std::size_t axis = 0; axis < 3; ++axis) {  // an octahedron, seen from wherever
      Vec3 right{}, up{};
      right[axis] = up[(axis + 1) % 3] = size;
      const Vec3 corners[] = {at + right, at + up, at - right, at - up};
      for (std::size_t k = 0; k < 4; ++k) draw(corners[k], corners[(k + 1) % 4], is_missed ? kMarked : kSelected);
    }
  }
  add_lines(std::move(lines), offset, 2, view);
}

void Scene::add_fibres(const Actor& character, const Shown& shown, const std::array<float, 3>& offset,
                       draw::View& view) {
  if (character.shown().level().fibre_segment_count == 0 || shown.method == SkinMethod::truth) return;
  std::vector<std::uint32_t> colours;
  const std::uint32_t fibres = character.basis().strain.fibre_count();
  for (std::uint32_t f = 0; f < fibres; ++f) colours.push_back(strain_colour(shown.evaluation->strains[f]));
  colours_.push_back(std::move(colours));
  draw::FibreDraw draw;
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

}  // namespace bodyopt::viewport
