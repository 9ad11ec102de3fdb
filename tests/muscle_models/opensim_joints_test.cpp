// The same limb by every kind of joint, by a CustomJoint about the same axes, and in the form of earlier versions.
#include <gtest/gtest.h>

#include <map>
#include <random>
#include <sstream>

#include "tests/support/hostile_bytes.h"
#include "tests/support/temporary_folder.h"
#include "trainer/muscle_models/model.h"

namespace bodyopt::trainer::muscle_models {
namespace {

using namespace testing;
using Eigen::Isometry3d;
using Eigen::Vector3d;

// What its coordinates do: capitals turn, small letters shift.
const std::map<std::string, std::string> kKinds = {
    {"WeldJoint", ""},    {"PinJoint", "Z"},      {"SliderJoint", "x"},   {"UniversalJoint", "XY"},
    {"BallJoint", "XYZ"}, {"GimbalJoint", "XYZ"}, {"PlanarJoint", "Zxy"}, {"FreeJoint", "XYZxyz"}};

struct Limb {
  std::string kind, axes;
  Vector3d places[4];  // of the joint in its parent, its orientation there, the same in its child
  std::vector<double> defaults;
};

std::string words(const Vector3d& vector) {
  std::ostringstream text;
  text.precision(17);
  text << ' ' << vector.x() << ' ' << vector.y() << ' ' << vector.z() << ' ';
  return text.str();
}

Limb random_limb(const std::string& kind, std::mt19937& random) {
  std::uniform_real_distribution<double> some(-1.5, 1.5);
  Limb limb{kind, kKinds.at(kind), {}, {}};
  for (Vector3d& place : limb.places) place = {some(random), some(random), some(random)};
  for (std::size_t k = 0; k < limb.axes.size(); ++k) limb.defaults.push_back(some(random));
  return limb;
}

std::string coordinates(const Limb& limb) {
  std::ostringstream text;
  text.precision(17);
  for (std::size_t k = 0; k < limb.axes.size(); ++k) {
    text << "<Coordinate name=\"q" << k << "\"><default_value> " << limb.defaults[k]
         << " </default_value></Coordinate>";
  }
  return text.str();
}

// A CustomJoint's axes; those without a coordinate stay.
std::string transform(const Limb& limb, const std::string& order) {
  std::ostringstream text;
  text << "<SpatialTransform>";
  for (std::size_t n = 0; n < 6; ++n) {
    const std::size_t k = limb.axes.find(order[n]);
    const bool moves = k != std::string::npos;
    const Vector3d axis = Vector3d::Unit((order[n] < 'a' ? order[n] - 'A' : order[n] - 'a') - ('X' - 'A'));
    text << "<TransformAxis name=\"" << (n < 3 ? "rotation" : "translation") << n % 3 + 1 << "\"><coordinates> "
         << (moves ? "q" + std::to_string(k) : "") << " </coordinates><axis>" << words(axis) << "</axis>"
         << (moves ? "<function><LinearFunction><coefficients> 1 0</coefficients></LinearFunction></function>" : "")
         << "</TransformAxis>";
  }
  text << "</SpatialTransform>";
  return text.str();
}

std::string muscle(const std::string& socket, const std::string& base) {
  return "<ForceSet><objects><Thelen2003Muscle name=\"m\"><max_isometric_force>1</max_isometric_force><GeometryPath>"
         "<PathPointSet><objects><PathPoint name=\"a\"><" +
         socket + ">" + base + "upper</" + socket + "><location>0 0.1 0</location></PathPoint><PathPoint name=\"b\"><" +
         socket + ">" + base + "fore</" + socket +
         "><location>0 0 0.2</location></PathPoint></objects></PathPointSet></GeometryPath></Thelen2003Muscle>"
         "</objects></ForceSet>";
}

std::string offset_frame(const std::string& name, const std::string& parent, const Vector3d& shift,
                         const Vector3d& turn) {
  return "<PhysicalOffsetFrame name=\"" + name + "\"><socket_parent>" + parent + "</socket_parent><translation>" +
         words(shift) + "</translation><orientation>" + words(turn) + "</orientation></PhysicalOffsetFrame>";
}

// Version 4: sockets and offset frames, of the joint itself or, `in_bodies`, of the bodies.
std::string with_sockets(const Limb& limb, const std::string& kind, const std::string& inside, bool in_bodies) {
  const std::string parent = offset_frame("end", in_bodies ? ".." : "/bodyset/upper", limb.places[0], limb.places[1]);
  const std::string child = offset_frame("begin", in_bodies ? ".." : "/bodyset/fore", limb.places[2], limb.places[3]);
  const auto body = [&](const std::string& name, const std::string& frame) {
    return "<Body name=\"" + name + "\"><components>" + (in_bodies ? frame : "") + "</components></Body>";
  };
  return R"(<OpenSimDocument Version="40000"><Model name="limb"><length_units>meters</length_units>
<BodySet name="bodyset"><objects>)" +
         body("fore", child) + body("upper", parent) + R"(</objects></BodySet><JointSet name="jointset"><objects>
<WeldJoint name="base"><socket_parent_frame>/ground</socket_parent_frame>
<socket_child_frame>/bodyset/upper</socket_child_frame></WeldJoint><)" +
         kind + " name=\"elbow\"><socket_parent_frame>" + (in_bodies ? "/bodyset/upper/end" : "end") +
         "</socket_parent_frame><socket_child_frame>" + (in_bodies ? "/bodyset/fore/begin" : "begin") +
         "</socket_child_frame><coordinates>" + coordinates(limb) + "</coordinates><frames>" +
         (in_bodies ? "" : parent + child) + "</frames>" + inside + "</" + kind + "></objects></JointSet>" +
         muscle("socket_parent_frame", "/bodyset/") + "</Model></OpenSimDocument>";
}

// Versions 2 and 3: the joint inside the body that it moves.
std::string with_bodies(const Limb& limb, const std::string& inside, const std::string& version) {
  const auto body = [](const std::string& name, const std::string& joint) {
    return "<Body name=\"" + name + "\"><Joint>" + joint + "</Joint></Body>";
  };
  const std::string base = "<WeldJoint name=\"base\"><parent_body> ground </parent_body></WeldJoint>";
  const std::string elbow = "<" + limb.kind + " name=\"elbow\"><parent_body> upper </parent_body><location_in_parent>" +
                            words(limb.places[0]) + "</location_in_parent><orientation_in_parent>" +
                            words(limb.places[1]) + "</orientation_in_parent><location>" + words(limb.places[2]) +
                            "</location><orientation>" + words(limb.places[3]) +
                            "</orientation><CoordinateSet><objects>" + coordinates(limb) +
                            "</objects></CoordinateSet>" + inside + "</" + limb.kind + ">";
  return "<OpenSimDocument Version=\"" + version +
         "\"><Model name=\"limb\"><length_units> meters </length_units><BodySet><objects>" + body("ground", "") +
         body("upper", base) + body("fore", elbow) + "</objects></BodySet>" + muscle("body", " ") +
         "</Model></OpenSimDocument>";
}

Isometry3d fore_of(const TemporaryFolder& folder, const std::string& text, const std::vector<double>& values) {
  write_bytes(folder / "limb.osim", text);
  const Model model = read_model(folder / "limb.osim");
  const ModelPose pose = pose_model(model, values.empty() ? default_values(model) : values);
  return pose.segments[static_cast<std::size_t>(model.find_segment("fore"))];
}

class OpenSimJoint : public ::testing::TestWithParam<std::string> {};

TEST_P(OpenSimJoint, IsTheCustomJointAboutTheSameAxes) {
  const TemporaryFolder folder;
  std::mt19937 random(7);
  for (int trial = 0; trial < 5; ++trial) {
    const Limb limb = random_limb(GetParam(), random);
    const std::string order = limb.axes.starts_with("Z") ? "ZXYxyz" : "XYZxyz";
    const std::string custom = with_sockets(limb, "CustomJoint", transform(limb, order), false);
    const std::vector<double> other = random_limb(GetParam(), random).defaults;
    for (const std::vector<double>& values : {std::vector<double>(), other}) {
      const Isometry3d expected = fore_of(folder, custom, values);
      const auto expect = [&](const std::string& text) {
        EXPECT_LT((fore_of(folder, text, values).matrix() - expected.matrix()).norm(), 1e-12) << trial << text;
      };
      expect(with_sockets(limb, limb.kind, "", false));
      expect(with_sockets(limb, limb.kind, "", true));
      for (const char* version : {"20302", "30000"}) {
        expect(with_bodies(limb, "", version));
        Limb as_custom = limb;
        as_custom.kind = "CustomJoint";
        expect(with_bodies(as_custom, transform(limb, order), version));
      }
      // Reversed, it takes the parent to the child: the joint's own motion is turned round.
      Limb bare = limb;
      for (Vector3d& place : bare.places) place.setZero();
      const Isometry3d motion = fore_of(folder, with_bodies(bare, "", "30000"), values);
      const Isometry3d reversed = fore_of(folder, with_bodies(bare, "<reverse> true </reverse>", "30000"), values);
      EXPECT_LT(((motion * reversed).matrix() - Isometry3d::Identity().matrix()).norm(), 1e-12);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Kinds, OpenSimJoint,
                         ::testing::Values("WeldJoint", "PinJoint", "SliderJoint", "UniversalJoint", "BallJoint",
                                           "GimbalJoint", "PlanarJoint", "FreeJoint"),
                         [](const auto& kind) { return kind.param; });

}  // namespace
}  // namespace bodyopt::trainer::muscle_models
