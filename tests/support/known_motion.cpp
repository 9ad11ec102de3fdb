#include "tests/support/known_motion.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <sstream>

#include "runtime/host/rig.h"
#include "tests/support/random_tables.h"

namespace bodyopt::testing {
namespace {

constexpr double kPi = std::numbers::pi;

struct Body {
  const char* name;
  int parent;
  Vec3 offset;  // metres, arms stretched out to the sides, facing z
};

const std::vector<Body>& body() {
  static const std::vector<Body> joints = {{"Hips", -1, {0, 0.92, 0}},
                                           {"Spine", 0, {0, 0.14, 0}},
                                           {"Chest", 1, {0, 0.18, 0}},
                                           {"Neck", 2, {0, 0.2, 0}},
                                           {"Head", 3, {0, 0.11, 0}},
                                           {"LeftCollar", 2, {0.04, 0.16, 0}},
                                           {"LeftShoulder", 5, {0.13, 0, 0}},
                                           {"LeftElbow", 6, {0.27, 0, 0}},
                                           {"LeftWrist", 7, {0.24, 0, 0}},
                                           {"RightCollar", 2, {-0.04, 0.16, 0}},
                                           {"RightShoulder", 9, {-0.13, 0, 0}},
                                           {"RightElbow", 10, {-0.27, 0, 0}},
                                           {"RightWrist", 11, {-0.24, 0, 0}},
                                           {"LeftHip", 0, {0.1, -0.05, 0}},
                                           {"LeftKnee", 13, {0, -0.41, 0}},
                                           {"LeftAnkle", 14, {0, -0.4, 0}},
                                           {"LeftToe", 15, {0, -0.06, 0.14}},
                                           {"RightHip", 0, {-0.1, -0.05, 0}},
                                           {"RightKnee", 17, {0, -0.41, 0}},
                                           {"RightAnkle", 18, {0, -0.4, 0}},
                                           {"RightToe", 19, {0, -0.06, 0.14}},
                                           {"LeftHandIndex1", 8, {0.09, 0, 0.03}},
                                           {"LeftHandPinky1", 8, {0.08, 0, -0.04}},
                                           {"RightHandIndex1", 12, {-0.09, 0, 0.03}},
                                           {"RightHandPinky1", 12, {-0.08, 0, -0.04}}};
  return joints;
}

using Turns = std::vector<Quat>;  // per joint, world

std::size_t above(std::size_t joint) { return static_cast<std::size_t>(body()[joint].parent); }
bool is_root(std::size_t joint) { return body()[joint].parent < 0; }
bool is_finger(std::size_t joint) { return joint > 20; }

// The arms away from the T pose, downwards by an angle.
Turns arms_lowered(double angle) {
  Turns turns(body().size(), Quat{0, 0, 0, 1});
  for (const std::size_t shoulder : {6u, 10u}) {
    for (std::size_t j = shoulder; j < shoulder + 3; ++j) {
      turns[j] = axis_angle({0, 0, 1}, shoulder == 6 ? -angle : angle);
    }
  }
  for (std::size_t j = 0; j < body().size(); ++j) {
    if (is_finger(j)) turns[j] = turns[above(j)];
  }
  return turns;
}

Vec3 axis(std::size_t k) {
  Vec3 direction{0, 0, 0};
  direction[k] = 1;
  return direction;
}

Quat quarter_turns(Random& random) {
  Quat turn{0, 0, 0, 1};
  for (std::size_t k = 0; k < 3; ++k) turn = turn * axis_angle(axis(k), random.below(4) * kPi / 2);
  return normalized(turn);
}

// Axes of the joints in the T pose, x along the bone from each (or to it, of the last), y to the front.
Turns along_bones() {
  Turns turns;
  for (std::size_t j = 0; j < body().size(); ++j) {
    std::size_t next = j + 1 < body().size() && body()[j + 1].parent == static_cast<int>(j) ? j + 1 : j;
    if (is_root(j) || j == 2) next = j + 1;  // up the trunk
    const Vec3 bone = (1 / length(body()[next].offset)) * body()[next].offset;
    const bool goes_ahead = bone[2] > 0.5;
    const Vec3 side = goes_ahead ? Vec3{-1, 0, 0} : cross(bone, {0, 0, 1});
    const Vec3 front = cross((1 / length(side)) * side, bone);
    // The rotation with these columns: it takes x to the bone, then y to the front.
    const Vec3 turned = cross({1, 0, 0}, bone);
    const Quat first = length(turned) > 1e-9 ? axis_angle(turned, std::acos(std::clamp(bone[0], -1.0, 1.0)))
                                             : axis_angle({0, 0, 1}, bone[0] > 0 ? 0 : kPi);
    const Vec3 y = rotate(first, {0, 1, 0});
    turns.push_back(normalized(axis_angle(bone, std::atan2(dot(cross(y, front), bone), dot(y, front))) * first));
  }
  return turns;
}

// Degrees about three different axes, the first outermost, by which the rotation is written.
Vec3 angles(const Quat& rotation, const std::array<std::size_t, 3>& order) {
  const auto r = rotation_matrix(normalized(rotation));
  const auto [a, b, c] = order;
  const double sign = (b + 3 - a) % 3 == 1 ? 1 : -1;
  const double middle = std::asin(std::clamp(sign * r[a][c], -1.0, 1.0));
  return (180 / kPi) * Vec3{std::atan2(-sign * r[b][c], r[c][c]), middle, std::atan2(-sign * r[a][b], r[a][a])};
}

struct Moves {
  std::vector<Turns> turns;  // per frame, world, away from the T pose
  std::vector<Vec3> places;  // of the hips
};

// Knees go back, elbows of stretched out arms to the front; what is above them is twisted about its bone, and so are
// forearms, with the hands, where there are fingers to tell.
struct Bends {
  double angle = 0;  // 0: none
  Turns twist{body().size(), Quat{0, 0, 0, 1}};

  Quat of(std::size_t joint, double share) const {
    const double bent = angle * (1 + 0.5 * share);
    if (joint == 7 || joint == 11) return axis_angle({0, joint == 7 ? -1.0 : 1.0, 0}, bent) * twist[joint];
    return axis_angle({1, 0, 0}, bent);
  }
};

bool is_hinge(std::size_t joint) { return joint == 7 || joint == 11 || joint == 14 || joint == 18; }

Bends bends_of(Random& random, bool has_fingers) {
  Bends bends;
  for (const std::size_t wrist : {8u, 12u}) {
    if (has_fingers) bends.twist[above(wrist)] = axis_angle(body()[wrist].offset, random.uniform(-1.3, 1.3));
  }
  if (random.below(2) == 0) return bends;
  bends.angle = random.uniform(0.6, 1);
  for (std::size_t j = 0; j < body().size(); ++j) {
    if (is_hinge(j)) bends.twist[above(j)] = axis_angle(body()[j].offset, random.uniform(-1.3, 1.3));
  }
  return bends;
}

// Every joint swings about an axis of its own, to either side alike, or bends; the hips go somewhere, or stay.
Moves moves_of(Random& random, bool has_fingers) {
  constexpr std::size_t kFrames = 24;
  Moves moves;
  const Vec3 goes{random.below(2) * random.uniform(-2, 2), 0, random.below(2) * random.uniform(-2, 2)};
  struct Swing {
    Quat to;
    double times, phase;
  };
  std::vector<Swing> swings;
  for (std::size_t j = 0; j < body().size(); ++j) {
    swings.push_back({random.turn(is_root(j) ? 0.35 : 0.7), 1.0 + random.below(3), random.uniform(0, 2 * kPi)});
  }
  const Bends bends = bends_of(random, has_fingers);
  const Quat faces = axis_angle({0, 1, 0}, random.uniform(-kPi, kPi));
  for (std::size_t k = 0; k < kFrames; ++k) {
    const double along = static_cast<double>(k) / kFrames;
    Turns turns;
    for (std::size_t j = 0; j < body().size(); ++j) {
      const auto& [to, times, phase] = swings[j];
      const double share = std::sin(2 * kPi * times * along + phase);
      Quat swung = slerp({0, 0, 0, 1}, share < 0 ? conjugate(to) : to, std::abs(share)) * bends.twist[j];
      if (bends.angle > 0 && is_hinge(j)) swung = bends.of(j, share);
      if (is_finger(j)) swung = {0, 0, 0, 1};
      turns.push_back(normalized((is_root(j) ? faces : turns[above(j)]) * swung));
    }
    moves.turns.push_back(turns);
    moves.places.push_back(body()[0].offset + along * goes);
  }
  return moves;
}

// Bound with the joints turned away from the T pose by `bound`, their axes at random.
Skeleton skeleton_bound(const Turns& bound, Random& random) {
  Skeleton skeleton;
  std::vector<Affine> world;
  std::vector<Vec3> places;
  for (std::size_t j = 0; j < body().size(); ++j) {
    const Body& from = body()[j];
    const Vec3 bone = rotate(bound[is_root(j) ? j : above(j)], from.offset);
    places.push_back(is_root(j) ? bone : places[above(j)] + bone);
    JointTransform t;
    t.translation = places[j];
    t.rotation = random.turn(3);
    world.push_back(affine_from(t));
    Joint joint;
    joint.name = from.name;
    joint.parent = from.parent;
    joint.inverse_bind = inverse(world[j]);
    joint.bind = decompose(is_root(j) ? world[j] : skeleton.joints[above(j)].inverse_bind * world[j]);
    joint.default_local = joint.bind;
    skeleton.joints.push_back(joint);
  }
  return skeleton;
}

// How the file is written.
struct Hand {
  Turns axes;  // of the joints in the T pose, in the body's axes
  Quat up;     // from the body's axes to the file's
  double unit = 1;
  std::array<std::size_t, 3> order{0, 1, 2}, places{0, 1, 2};
  bool has_positions = false, has_offsets = true;  // of all joints
  bool has_fingers = false;
};

class Writer {
 public:
  Writer(const Hand& hand, const Moves& moves) : hand_(hand), moves_(moves) { text_.precision(12); }

  std::string write() {
    text_ << "HIERARCHY\n";
    add(0);
    text_ << "MOTION\nFrames: " << moves_.turns.size() << "\nFrame Time: " << 1 / 24.0 << "\n";
    for (std::size_t k = 0; k < moves_.turns.size(); ++k) add_frame(k);
    return text_.str();
  }

 private:
  bool places(std::size_t joint) const { return is_root(joint) || hand_.has_positions; }

  Vec3 offset(std::size_t joint) const {
    const Vec3& bone = body()[joint].offset;
    return (1 / hand_.unit) * rotate(is_root(joint) ? hand_.up : conjugate(hand_.axes[above(joint)]), bone);
  }

  void add(std::size_t joint) {
    const Vec3 at = places(joint) && !hand_.has_offsets ? Vec3{0, 0, 0} : offset(joint);
    text_ << (is_root(joint) ? "ROOT " : "JOINT ") << body()[joint].name << "\n{\nOFFSET " << at[0] << " " << at[1]
          << " " << at[2] << "\nCHANNELS " << (places(joint) ? 6 : 3);
    for (const std::size_t k : hand_.places) {
      if (places(joint))
        text_ << " "
              << "XYZ"[k] << "position";
    }
    for (const std::size_t k : hand_.order)
      text_ << " "
            << "XYZ"[k] << "rotation";
    text_ << "\n";
    order_.push_back(joint);
    bool ends = true;
    for (std::size_t child = joint + 1; child < body().size(); ++child) {
      if (body()[child].parent != static_cast<int>(joint) || (is_finger(child) && !hand_.has_fingers)) continue;
      add(child);
      ends = false;
    }
    text_ << (ends ? "End Site\n{\nOFFSET 0 0 0\n}\n}\n" : "}\n");
  }

  void add_frame(std::size_t k) {
    for (const std::size_t joint : order_) {
      const Vec3 at = is_root(joint) ? (1 / hand_.unit) * rotate(hand_.up, moves_.places[k]) : offset(joint);
      for (const std::size_t place : hand_.places) {
        if (places(joint)) text_ << at[place] << " ";
      }
      const Quat own = world(k, joint);
      for (const double angle : angles(is_root(joint) ? own : conjugate(world(k, above(joint))) * own, hand_.order)) {
        text_ << angle << " ";
      }
    }
    text_ << "\n";
  }

  Quat world(std::size_t k, std::size_t joint) const { return hand_.up * moves_.turns[k][joint] * hand_.axes[joint]; }

  const Hand& hand_;
  const Moves& moves_;
  std::ostringstream text_;
  std::vector<std::size_t> order_;
};

// That turns y to an axis.
Quat raised(std::uint32_t which) {
  return which < 4 ? axis_angle({1, 0, 0}, which * kPi / 2) : axis_angle({0, 0, 1}, (which == 4 ? 1 : -1) * kPi / 2);
}

// The axes of joints that have the file's axes where the body stands as `zero` says, turned as a whole.
Turns of_zero_pose(const Turns& zero, const Quat& whole) {
  Turns axes;
  for (const Quat& turn : zero) axes.push_back(conjugate(normalized(whole * turn)));
  return axes;
}

}  // namespace

KnownMotion known_motion(std::uint32_t seed) {
  Random random(seed);
  KnownMotion known;
  Hand hand;
  hand.has_fingers = random.below(2) == 0;
  const Moves moves = moves_of(random, hand.has_fingers);
  const std::uint32_t kind = random.below(4);
  // Where the zero pose stands otherwise than the body, nothing but custom says what is up.
  hand.up = raised(kind == 1 ? 0 : random.below(6));
  hand.unit = std::pow(10, random.uniform(-3, 1));
  for (std::size_t k = 0; k < 2; ++k) {
    std::swap(hand.order[k], hand.order[k + random.below(static_cast<std::uint32_t>(3 - k))]);
    std::swap(hand.places[k], hand.places[k + random.below(static_cast<std::uint32_t>(3 - k))]);
  }
  hand.has_positions = random.below(4) == 0;
  hand.has_offsets = random.below(2) == 0;
  const double lowered = random.uniform(-1.5, 1.5);
  if (kind == 0) hand.axes = of_zero_pose(arms_lowered(lowered), hand.up);
  if (kind == 1) hand.axes = of_zero_pose(arms_lowered(lowered), quarter_turns(random));
  if (kind == 2) {
    const Quat others = quarter_turns(random);
    for (const Quat& axes : along_bones()) hand.axes.push_back(normalized(axes * others));
  }
  while (hand.axes.size() < body().size()) hand.axes.push_back(random.turn(3));
  known.bvh = Writer(hand, moves).write();
  const char* kinds[] = {"standing", "turned", "along bones", "at random"};
  known.what = std::string("zero pose ") + kinds[kind] + ", arms at " + std::to_string(lowered) +
               (hand.has_fingers ? ", fingers" : "") + ", seed " + std::to_string(seed);

  Turns bound = arms_lowered(random.uniform(-0.2, 1.2));
  const Quat faces = axis_angle({0, 1, 0}, random.below(4) * kPi / 2);
  for (Quat& turn : bound) turn = faces * turn;
  known.skeleton = skeleton_bound(bound, random);
  const std::vector<Affine> bind = posed_joints(known.skeleton, bind_pose(known.skeleton).joints);
  for (std::size_t k = 0; k < moves.turns.size(); ++k) {
    Turns& rotations = known.rotations.emplace_back();
    for (std::size_t j = 0; j < body().size(); ++j) {
      rotations.push_back(moves.turns[k][j] * conjugate(bound[j]) * decompose(bind[j]).rotation);
    }
    known.places.push_back(moves.places[k]);
  }
  return known;
}

bool asks_for_up(const Clip& clip) {
  return std::ranges::any_of(
      clip.notes, [](const std::string& note) { return note.find("was taken to be up") != std::string::npos; });
}

std::string wrong_in(const KnownMotion& known, const Clip& clip) {
  constexpr double kTurn = kPi / 360, kHeight = 1.7;
  if (clip.poses.size() != known.rotations.size()) return std::to_string(clip.poses.size()) + " frames";
  double worst = 0;
  std::string joint;
  for (std::size_t k = 0; k < clip.poses.size(); ++k) {
    const std::vector<Affine> posed = posed_joints(known.skeleton, clip.poses[k].joints);
    for (std::size_t j = 0; j < posed.size(); ++j) {
      const double turned = angle_between(decompose(posed[j]).rotation, known.rotations[k][j]);
      if (turned <= worst) continue;
      worst = turned;
      joint = body()[j].name;
    }
    const double away = length(posed[0] * Vec3{0, 0, 0} - known.places[k]);
    if (!(away < 1e-3 * kHeight)) return "the hips are " + std::to_string(away) + " m away";
  }
  return worst < kTurn ? "" : "'" + joint + "' is turned by " + std::to_string(worst * 180 / kPi) + " degrees";
}

}  // namespace bodyopt::testing
