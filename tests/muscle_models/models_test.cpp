// Models with round numbers, their poses and lengths checked by hand; damaged files.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "runtime/core/error.h"
#include "tests/muscle_models/small_models.h"
#include "tests/support/hostile_bytes.h"
#include "tests/support/temporary_folder.h"
#include "trainer/muscle_models/model.h"

namespace bodyopt::trainer::muscle_models {
namespace {

using namespace testing;
using Eigen::Vector3d;

constexpr double kRight = std::numbers::pi / 2;

Model read(const TemporaryFolder& folder, const std::string& name, const std::string& text) {
  write_bytes(folder / name, text);
  return read_model(folder / name);
}

double length_at(const Model& model, std::size_t muscle, const std::vector<double>& values) {
  return path_length(trace_path(model.muscles[muscle], pose_model(model, values)));
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t place = text.find(from);
  EXPECT_NE(place, std::string::npos) << from;
  return text.replace(place, from.size(), to);
}

TEST(OpenSim, PosesJointsAndTracesFixedConditionalAndMovingPoints) {
  const TemporaryFolder folder;
  const Model model = read(folder, "limb.osim", small_osim());
  ASSERT_EQ(model.segments.size(), 3u);
  EXPECT_EQ(model.segments[2].name, "fore");
  EXPECT_EQ(model.segments[2].parent, 1);
  ASSERT_EQ(model.muscles.size(), 1u);
  EXPECT_EQ(model.muscles[0].max_force, 600);
  ASSERT_EQ(model.muscles[0].wraps.size(), 1u);
  EXPECT_EQ(model.muscles[0].wraps[0].name, "bone");
  EXPECT_FALSE(honoured(model.muscles[0].wraps[0]));

  // Straight down: from (0.04, 1) to (0.04, 0.4); the conditional point is off.
  EXPECT_NEAR(length_at(model, 0, default_values(model)), 0.6, 1e-15);

  // A quarter turn: the forearm points to +x from its joint, which has shifted by 0.01 * angle.
  const double shift = 0.01 * kRight, moving = -0.1 + 0.1 * kRight;
  const ModelPose pose = pose_model(model, {kRight});
  EXPECT_LT((pose.segments[2] * Vector3d(0, -1, 0) - Vector3d(1 + shift, 0.5, 0)).norm(), 1e-15);
  const double bent = std::hypot(0.03, 0.4) + std::hypot(shift - moving - 0.07, 0.54 - 0.6);
  EXPECT_NEAR(length_at(model, 0, {kRight}), bent, 1e-14);
  EXPECT_EQ(trace_path(model.muscles[0], pose).size(), 3u);
}

TEST(OpenSim, SplineIsTheCubicThroughItsPointsAndStraightOutside) {
  const auto cubic = [](double x) { return 1 - 2 * x + 0.5 * x * x * x; };
  std::vector<double> x = {-1, 0.5, 1, 2.5, 3}, y;
  for (const double at : x) y.push_back(cubic(at));
  const Curve spline = Curve::spline(x, y).scaled(2);
  for (double at = -1; at <= 3; at += 0.125) EXPECT_NEAR(spline(at), 2 * cubic(at), 1e-12) << at;
  EXPECT_NEAR(spline(4), 2 * (cubic(3) + 11.5), 1e-12);
  EXPECT_NEAR(spline(-3), 2 * (cubic(-1) + 2 * 0.5), 1e-12);
}

TEST(OpenSim, PolynomialsAndPolylinesAreRead) {
  const TemporaryFolder folder;
  const auto at = [&](const std::string& function, double x) {
    const Model model =
        read(folder, "limb.osim", replaced(small_osim(), "<Constant><value>0.04</value></Constant>", function));
    return trace_path(model.muscles[0], pose_model(model, {x})).back().position.x() -
           trace_path(model.muscles[0], pose_model(model, {x})).front().position.x();
  };
  const auto on_x = [&](const std::string& function) { return at(function, 0); };
  EXPECT_NEAR(on_x("<PolynomialFunction><coefficients>3 2 0.5</coefficients></PolynomialFunction>"), 0.46, 1e-15);
  EXPECT_NEAR(on_x("<PiecewiseLinearFunction><x>1 2 4</x><y>1 2 3</y></PiecewiseLinearFunction>"), -0.04, 1e-15);
  EXPECT_NEAR(on_x("<SimmSpline name=\"x_location\"><x>-1 1</x><y>1 2</y></SimmSpline>"), 1.46, 1e-15);
  const Curve line = Curve::polyline({1, 2, 4}, {1, 2, 3});
  EXPECT_NEAR(line(3), 2.5, 1e-15);
  EXPECT_NEAR(line(6), 4, 1e-15);
  const Curve powers = Curve::polynomial({0.5, 2, 3});
  EXPECT_NEAR(powers(2), 16.5, 1e-15);
}

TEST(OpenSim, RefusesEveryTruncationAndNamesWhatIsWrong) {
  const TemporaryFolder folder;
  const Reader read_path = [](const std::filesystem::path& path) { read_model(path); };
  const std::filesystem::path path = folder / "limb.osim";
  const std::string good = small_osim();
  expect_every_truncation_refused(read_path, path, good);
  damage_bytes(read_path, path, good, 500);
  const auto expect = [&](const std::string& from, const std::string& to, const std::string& named) {
    expect_refused(read_path, path, replaced(good, from, to), named);
  };
  expect("<location>0.04 0 0<", "<location>0.04 0 nan<", "nan");
  expect("<location>0.04 0 0<", "<location>0.04 0<", "2 numbers in <location>");
  expect("<location>0.04 0 0<", "<location>0.04 0 1e99<", "1e99");
  expect("<x>0 1</x>", "<x>1 1</x>", "does not grow");
  expect("/bodyset/upper</socket_parent_frame>\n       <location>0.04",
         "/bodyset/thigh</socket_parent_frame>\n<location>0.04", "thigh");
  expect("/jointset/elbow/flexion</socket_coordinate>", "/jointset/knee</socket_coordinate>", "/jointset/knee");
  expect("<wrap_object>bone", "<wrap_object>horn", "horn");
  expect("\"40000\"", "\"30515\"", "save it again");
  expect("\"40000\"", "\"10904\"", "save it again");
  expect("<socket_parent>/ground<", "<socket_parent>/bodyset/fore<", "leads to the ground");
  expect("/bodyset/fore</socket_child_frame>", "/bodyset/upper</socket_child_frame>", "second joint");
  const auto with_joint = [&](const std::string& joint) {
    return replaced(replaced(good, "<CustomJoint", "<" + joint), "</CustomJoint", "</" + joint);
  };
  expect_refused(read_path, path, with_joint("EllipsoidJoint"), "BallJoint");
  expect_refused(read_path, path, with_joint("BallJoint"), "has 1 coordinate, expected 3");
  expect("<socket_parent>/bodyset/upper</socket_parent>", "<socket_parent>/elbow/end</socket_parent>", "a loop?");
  expect("<Constant><value>0.04</value></Constant>", "<Sine/>", "PolynomialFunction");
  expect("<x_location><Constant><value>0.04</value></Constant></x_location>", "", "<x_location>");
  expect("<length_units>meters", "<length_units>inches", "inches");
}

TEST(Mujoco, PosesJointsAndBendsPathsAroundCylinders) {
  const TemporaryFolder folder;
  const Model model = read(folder, "limb.xml", small_mujoco());
  ASSERT_EQ(model.muscles.size(), 2u);
  EXPECT_EQ(model.muscles[0].name, "extensor");
  EXPECT_EQ(model.muscles[0].max_force, 120);
  EXPECT_EQ(model.muscles[1].name, "flexor");
  EXPECT_EQ(model.muscles[1].max_force, 60);
  ASSERT_EQ(model.notes.size(), 1u);
  EXPECT_NE(model.notes[0].find("ligament"), std::string::npos);

  // Straight down; with the hinge turned away the first tendon misses the cylinder on its right side.
  EXPECT_NEAR(length_at(model, 1, {0, 0}), 0.9, 1e-15);
  const double x = 0.1 * std::cos(0.2) + 0.5 * std::sin(0.2), z = 0.1 * std::sin(0.2) - 0.5 * std::cos(0.2);
  EXPECT_NEAR(length_at(model, 0, {0, -0.2}), std::hypot(x - 0.1, z - 0.5), 1e-14);

  // The hinge at a quarter turn about +y takes the forearm's end from below to -x, its site above the axis ... and
  // the first tendon a quarter around the cylinder: 0.5 straight, a quarter circle, 0.5 straight.
  const ModelPose pose = pose_model(model, {0.2, kRight});
  EXPECT_LT((pose.segments[2].translation() - Vector3d(0, 0, 0.7)).norm(), 1e-15) << "the slide's axis is made unit";
  EXPECT_LT((pose.segments[2] * Vector3d(0.1, 0, -0.5) - Vector3d(-0.5, 0, 0.6)).norm(), 1e-15);
  EXPECT_NEAR(length_at(model, 0, {0.2, kRight}), 1 + 0.1 * kRight, 1e-12);
  EXPECT_EQ(trace_path(model.muscles[0], pose).size(), 4u);
}

TEST(Mujoco, ASideInsideTheSurfaceMakesThePathPassThroughIt) {
  const TemporaryFolder folder;
  const Model model =
      read(folder, "limb.xml",
           replaced(small_mujoco(), "name=\"side\" pos=\"0.3 0 -0.5\"", "name=\"side\" pos=\"0 0 -0.5\""));
  // Turned away as above, the shortest path that touches the cylinder, found by trying its points.
  const double x = 0.1 * std::cos(0.2) + 0.5 * std::sin(0.2), z = 0.1 * std::sin(0.2) - 0.5 * std::cos(0.2);
  double shortest = 10;
  for (double angle = -1; angle < 1; angle += 1e-5) {
    const double px = 0.1 * std::cos(angle), pz = 0.1 * std::sin(angle);
    shortest = std::min(shortest, std::hypot(px - 0.1, pz - 0.5) + std::hypot(px - x, pz - z));
  }
  EXPECT_NEAR(length_at(model, 0, {0, -0.2}), shortest, 1e-9);
}

TEST(Mujoco, EulerSequencesAndRadiansAreTheCompilers) {
  const TemporaryFolder folder;
  const auto end_of = [&](const std::string& compiler) {
    const Model model =
        read(folder, "limb.xml",
             replaced(replaced(small_mujoco(), "<default>", compiler + "<default>"),
                      "<body name=\"fore\" pos=\"0 0 -0.5\">", "<body name=\"fore\" pos=\"0 0 0\" euler=\"90 90 0\">"));
    const ModelPose pose = pose_model(model, default_values(model));
    return Vector3d(pose.segments[2].linear() * Vector3d::UnitZ());
  };
  // z by 90 degrees about x is -y; a turn about the new y comes first in the intrinsic sequence: z to x, and x stays.
  EXPECT_LT((end_of("") - Vector3d::UnitX()).norm(), 1e-12);
  EXPECT_LT((end_of("<compiler eulerseq=\"XYZ\"/>") - -Vector3d::UnitY()).norm(), 1e-12);
  EXPECT_GT((end_of("<compiler angle=\"radian\"/>") - Vector3d::UnitX()).norm(), 0.1);
}

TEST(Mujoco, IncludesAreReadOnceAndMissingOnesNoted) {
  const TemporaryFolder folder;
  const std::string whole = small_mujoco();
  const std::size_t begin = whole.find(" <tendon>"), end = whole.find(" <actuator>");
  write_bytes(folder / "tendons.xml", "<mujocoinclude>" + whole.substr(begin, end - begin) + "</mujocoinclude>");
  std::string main = whole;
  main.replace(begin, end - begin, "<include file=\"tendons.xml\"/><include file=\"scene.xml\"/>");
  const Model model = read(folder, "main.xml", main);
  EXPECT_EQ(model.muscles.size(), 2u);
  ASSERT_EQ(model.notes.size(), 2u);
  EXPECT_NE(model.notes[0].find("scene.xml"), std::string::npos);

  const Reader read_path = [](const std::filesystem::path& path) { read_model(path); };
  expect_refused(read_path, folder / "self.xml", replaced(whole, "<default>", "<include file=\"self.xml\"/><default>"),
                 "a loop?");
  write_bytes(folder / "ping.xml", "<mujocoinclude><include file=\"pong.xml\"/></mujocoinclude>");
  write_bytes(folder / "pong.xml", "<mujocoinclude><include file=\"ping.xml\"/></mujocoinclude>");
  expect_refused(read_path, folder / "loop.xml", replaced(whole, "<default>", "<include file=\"ping.xml\"/><default>"),
                 "a loop?");
  expect_refused(read_path, folder / "dir.xml", replaced(whole, "<default>", "<include file=\".\"/><default>"),
                 "is a folder");
}

TEST(Mujoco, AFailureNamesTheMissingIncludes) {
  const TemporaryFolder folder;
  const Reader read_path = [](const std::filesystem::path& path) { read_model(path); };
  const std::string parts = R"(<include file="bodies.xml"/><include file="muscles.xml"/>)";
  expect_refused(read_path, folder / "arm.xml", "<mujoco>" + parts + "</mujoco>",
                 "has no muscle: no spatial tendon with a muscle that pulls it; of the files that it includes, missing "
                 "are 'bodies.xml', 'muscles.xml'");
}

// A library's models include parts of those in the folders beside theirs; nothing else of the disk is read.
TEST(Mujoco, IncludesStayInTheModelsFolderAndThoseBesideIt) {
  const TemporaryFolder folder;
  const Reader read_path = [](const std::filesystem::path& path) { read_model(path); };
  const std::string whole = small_mujoco();
  const auto including = [&](const std::string& name) {
    return replaced(whole, "<default>", "<include file=\"" + name + "\"/><default>");
  };
  for (const char* name : {"library/arm", "library/leg", "elsewhere"}) {
    std::filesystem::create_directories(folder / name);
  }
  const std::string part = "<mujocoinclude><size/></mujocoinclude>";
  write_bytes(folder / "library/leg/part.xml", part);
  write_bytes(folder / "elsewhere/part.xml", part);
  const std::filesystem::path model = folder / "library/arm/limb.xml";
  write_bytes(model, including("../leg/part.xml"));
  EXPECT_TRUE(read_model(model).notes.size() == 1u);  // the ligament
  expect_refused(read_path, model, including((folder / "library/leg/part.xml").string()), "relative to the model");
  expect_refused(read_path, model, including("../../elsewhere/part.xml"), "only those are read");
  std::filesystem::create_symlink(folder / "elsewhere/part.xml", folder / "library/arm/link.xml");
  expect_refused(read_path, model, including("link.xml"), "only those are read");
}

// Neither a chain of files that include one another, nor many names of one file, nor many files.
TEST(Mujoco, IncludesAreBounded) {
  const TemporaryFolder folder;
  const Reader read_path = [](const std::filesystem::path& path) { read_model(path); };
  const std::filesystem::path model = folder / "limb.xml";
  const auto including = [](const std::string& name) { return "<include file=\"" + name + "\"/>"; };
  const auto part = [](const std::string& content) { return "<mujocoinclude>" + content + "</mujocoinclude>"; };
  const auto with = [](const std::string& includes) {
    return replaced(small_mujoco(), "<default>", includes + "<default>");
  };
  for (int k = 0; k < 40; ++k) {
    write_bytes(folder / ("chain" + std::to_string(k) + ".xml"),
                part(including("chain" + std::to_string(k + 1) + ".xml")));
  }
  write_bytes(folder / "chain40.xml", part("<size/>"));
  EXPECT_NO_THROW(read(folder, "limb.xml", with(including("chain20.xml"))));
  expect_refused(read_path, model, with(including("chain0.xml")), "files deep");

  write_bytes(folder / "one.xml", part("<size/>"));
  std::filesystem::create_hard_link(folder / "one.xml", folder / "same.xml");
  expect_refused(read_path, model, with(including("one.xml") + including("same.xml")), "included already");

  std::string many, includes;
  for (int k = 0; k < 60000; ++k) many += "<size/>";
  for (int k = 0; k < 4; ++k) {
    const std::string name = "many" + std::to_string(k) + ".xml";
    write_bytes(folder / name, part(many));
    includes += including(name);
  }
  expect_refused(read_path, model, with(includes), "'many3.xml', with which the model has more");
}

TEST(Mujoco, RefusesEveryTruncationAndNamesWhatIsWrong) {
  const TemporaryFolder folder;
  const Reader read_path = [](const std::filesystem::path& path) { read_model(path); };
  const std::filesystem::path path = folder / "limb.xml";
  const std::string good = small_mujoco();
  expect_every_truncation_refused(read_path, path, good);
  damage_bytes(read_path, path, good, 500);
  const auto expect = [&](const std::string& from, const std::string& to, const std::string& named) {
    expect_refused(read_path, path, replaced(good, from, to), named);
  };
  expect("<site site=\"a\"/>", "<site site=\"z\"/>", "'z'");
  expect("geom geom=\"roll\"", "geom geom=\"ball\"", "'ball'");
  expect("<site site=\"a\"/>", "<geom geom=\"roll\"/><site site=\"a\"/>", "without a site before");
  expect("</spatial>", "<geom geom=\"roll\"/></spatial>", "without a site before");
  expect("size=\"0.1 1\"", "size=\"-0.1 1\"", "no radius");
  expect("pos=\"0 0 1\"", "pos=\"0 0 inf\"", "inf");
  expect("childclass=\"bent\"", "childclass=\"straight\"", "'straight'");
  expect("axis=\"0 0 2\"", "axis=\"0 0 0\"", "without length");
  expect("type=\"slide\"", "type=\"screw\"", "'screw'");
  expect("tendon=\"plain\"", "tendon=\"plane\"", "'plane'");
  expect("<mujoco model", "<world model", "whole XML");
  expect("<default class=\"bent\">", "<default class=\"bent\"><default class=\"bent\"/>", "earlier default class");
  std::string deep;
  for (int k = 0; k < 100000; ++k) deep += "<body>";
  expect_refused(read_path, path, "<mujoco><worldbody>" + deep, "whole XML");
  std::string closed = deep;
  for (int k = 0; k < 100000; ++k) closed += "</body>";
  expect_refused(read_path, path, "<mujoco><worldbody>" + closed + "</worldbody></mujoco>", "deep");
}

TEST(Model, OtherFilesAreRefused) {
  EXPECT_THROW(read_model("model.urdf"), Error);
  EXPECT_THROW(read_model("nowhere.osim"), Error);
  EXPECT_THROW(read_model("nowhere.xml"), Error);
}

}  // namespace
}  // namespace bodyopt::trainer::muscle_models
