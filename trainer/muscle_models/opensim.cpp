// Reads OpenSim models (.osim).
#include <algorithm>
#include <functional>
#include <map>
#include <set>

#include "base/wording.h"
#include "trainer/muscle_models/model.h"
#include "trainer/muscle_models/xml_file.h"

namespace bodyopt::trainer::muscle_models {
namespace {

using Eigen::AngleAxisd;
using Eigen::Isometry3d;
using Eigen::Vector3d;
using pugi::xml_node;

constexpr std::size_t kLongestSpline = 10000, kMostSegments = 1000;
constexpr int kDeepestFrame = 16;  // offset frames in offset frames
constexpr const char* kGround = "ground";

// The last part of a path like "/jointset/knee_r/knee_angle_r".
std::string last_part(const std::string& path) { return path.substr(path.find_last_of('/') + 1); }

// The text of an element, without the blanks around it that version 2 writes.
std::string text(xml_node element, const char* child) {
  constexpr const char* kBlanks = " \t\r\n";
  const std::string value = element.child_value(child);
  const std::size_t begin = value.find_first_not_of(kBlanks);
  return begin == std::string::npos ? "" : value.substr(begin, value.find_last_not_of(kBlanks) + 1 - begin);
}

// Version 4 keeps joints in a set of their own, earlier ones in the body that each moves.
std::vector<xml_node> joints_of(xml_node model) {
  std::vector<xml_node> joints;
  for (const xml_node joint : model.child("JointSet").child("objects").children()) joints.push_back(joint);
  for (const xml_node body : model.child("BodySet").child("objects").children("Body")) {
    for (const xml_node joint : body.child("Joint").children()) joints.push_back(joint);
  }
  return joints;
}

std::vector<xml_node> coordinates_of(xml_node joint) {
  std::vector<xml_node> coordinates;
  for (const xml_node set : {joint.child("coordinates"), joint.child("CoordinateSet").child("objects")}) {
    for (const xml_node coordinate : set.children("Coordinate")) coordinates.push_back(coordinate);
  }
  return coordinates;
}

// The function of a property: inside an element of its name, or itself named so.
xml_node function_of(xml_node holder, const std::string& property) {
  const xml_node named = holder.find_child_by_attribute("name", property.c_str());
  return named ? named : holder.child(property.c_str()).first_child();
}

// The effects of a joint's coordinates, in their order. X, Y, Z turn about an axis that the earlier turns moved, x, y,
// z shift along an axis of the parent's frame.
constexpr std::pair<const char*, const char*> kJoints[] = {
    {"WeldJoint", ""},    {"PinJoint", "Z"},      {"SliderJoint", "x"},   {"UniversalJoint", "XY"},
    {"BallJoint", "XYZ"}, {"GimbalJoint", "XYZ"}, {"PlanarJoint", "Zxy"}, {"FreeJoint", "XYZxyz"}};

class OpenSimReader {
 public:
  explicit OpenSimReader(const std::filesystem::path& path) : file_(path) {}

  Model read() {
    const xml_node top = file_.document.child("OpenSimDocument");
    const xml_node model = top.child("Model");
    if (!model)
      fail(file_.document.first_child(), "is not an OpenSim model: expected <OpenSimDocument> with a <Model>");
    const int version = top.attribute("Version").as_int();
    if (version < 20000 || (version > 30000 && version < 40000)) {
      fail(top, "has version '", top.attribute("Version").value(),
           "', expected 20000 to 30000, or 40000 or later: open it in OpenSim 4 and save it again");
    }
    if (const std::string units = text(model, "length_units"); units != "meters" && units != "m" && !units.empty()) {
      fail(model, "has lengths in '", units, "', expected meters");
    }
    model_.file = file_.path.string();
    const std::vector<xml_node> joints = joints_of(model);
    read_coordinates(joints);
    read_frames(model);
    read_segments(model, joints);
    for (const xml_node force : model.child("ForceSet").child("objects").children()) read_force(force);
    if (model_.muscles.empty()) fail(model, "has no muscle");
    note_constraints(model);
    return std::move(model_);
  }

 private:
  [[noreturn]] void fail(xml_node element, const auto&... what) const { refuse(file_.path, element, what...); }

  std::vector<double> numbers(xml_node element, const char* child, std::size_t least, std::size_t most) const {
    if (!element.child(child)) fail(element, "lacks <", child, ">");
    return parse_numbers(file_.path, element, std::string("<") + child + ">", element.child_value(child), least, most);
  }
  double number(xml_node element, const char* child) const { return numbers(element, child, 1, 1)[0]; }
  Vector3d vector(xml_node element, const char* child) const {
    return Vector3d::Map(numbers(element, child, 3, 3).data());
  }
  Vector3d vector_or_zero(xml_node element, const char* child) const {
    return element.child(child) ? vector(element, child) : Vector3d::Zero();
  }

  int coordinate(xml_node element, const std::string& path) const {
    const int index = model_.find_coordinate(last_part(path));
    if (index < 0) fail(element, "names the coordinate '", path, "', which no joint has");
    return index;
  }

  // Versions before 4 name a socket without the word.
  int socket_coordinate(xml_node element, const std::string& name) const {
    const std::string socket = "socket_" + name;
    return coordinate(element, text(element, element.child(name.c_str()) ? name.c_str() : socket.c_str()));
  }

  Curve curve(xml_node element) const {
    const std::string kind = element.name();
    if (kind == "Constant") return Curve::polynomial({number(element, "value")});
    if (kind == "LinearFunction") {
      const std::vector<double> line = numbers(element, "coefficients", 2, 2);
      return Curve::polynomial({line[1], line[0]});
    }
    if (kind == "PolynomialFunction") {
      std::vector<double> coefficients = numbers(element, "coefficients", 1, kLongestSpline);
      std::ranges::reverse(coefficients);  // the highest power comes first
      return Curve::polynomial(coefficients);
    }
    if (kind == "MultiplierFunction") return curve_of(element, "function").scaled(number(element, "scale"));
    const bool straight = kind == "PiecewiseLinearFunction";
    if (!straight && kind != "SimmSpline" && kind != "NaturalCubicSpline" && kind != "natCubicSpline") {
      fail(element,
           "is no function read here: Constant, LinearFunction, PiecewiseLinearFunction, PolynomialFunction, "
           "SimmSpline, MultiplierFunction");
    }
    const std::vector<double> x = numbers(element, "x", 2, kLongestSpline);
    const std::vector<double> y = numbers(element, "y", x.size(), x.size());
    for (std::size_t k = 1; k < x.size(); ++k) {
      if (!(x[k] - x[k - 1] > 1e-9)) fail(element, "has an <x> that does not grow");
    }
    return straight ? Curve::polyline(x, y) : Curve::spline(x, y);
  }

  Curve curve_of(xml_node holder, const std::string& property) const {
    const xml_node function = function_of(holder, property);
    if (!function) fail(holder, "lacks the function <", property, ">");
    return curve(function);
  }

  void read_coordinates(const std::vector<xml_node>& joints) {
    std::set<std::string> names;
    for (const xml_node joint : joints) {
      for (const xml_node entry : coordinates_of(joint)) {
        Coordinate coordinate;
        coordinate.name = entry.attribute("name").value();
        if (entry.child("default_value")) coordinate.default_value = number(entry, "default_value");
        if (!names.insert(coordinate.name).second) fail(entry, "has the name of an earlier coordinate");
        model_.coordinates.push_back(coordinate);
      }
    }
  }

  // A frame fixed to a body or to the ground.
  struct Frame {
    std::string body;
    Isometry3d to_body = Isometry3d::Identity();
  };

  Isometry3d offset(xml_node element, const char* shift, const char* turn) const {
    const Vector3d angles = vector_or_zero(element, turn);
    return Eigen::Translation3d(vector_or_zero(element, shift)) * AngleAxisd(angles.x(), Vector3d::UnitX()) *
           AngleAxisd(angles.y(), Vector3d::UnitY()) * AngleAxisd(angles.z(), Vector3d::UnitZ());
  }

  // Offset frames by "owner/name": a joint or a body has them.
  void read_frames(xml_node model) {
    for (const pugi::xpath_node found : model.select_nodes(".//PhysicalOffsetFrame")) {
      const xml_node frame = found.node();
      const std::string owner = frame.parent().parent().attribute("name").value();
      if (!frames_.emplace(owner + "/" + frame.attribute("name").value(), frame).second) {
        fail(frame, "has the name of an earlier frame of '", owner, "'");
      }
    }
  }

  // A socket of an element names one of its own offset frames, that of another, what it stands in (".."), a body, or
  // the ground.
  Frame frame(xml_node element, const std::string& path, int depth = 0) const {
    if (depth == kDeepestFrame) fail(element, "stands in a frame of a frame, and so on: a loop?");
    if (path == "..") {
      const xml_node holder = element.parent().parent();
      return frame(holder.parent().parent(), holder.attribute("name").value(), depth + 1);
    }
    const std::string name = last_part(path);
    const std::string owners = path.substr(0, path.size() - std::min(path.size(), name.size() + 1));
    const std::string owner = owners.empty() ? element.attribute("name").value() : last_part(owners);
    const auto found = frames_.find(owner + "/" + name);
    if (found == frames_.end()) return {name};
    Frame result = frame(found->second, text(found->second, "socket_parent"), depth + 1);
    result.to_body = result.to_body * offset(found->second, "translation", "orientation");
    return result;
  }

  // The frame or body of a path point, which earlier versions name otherwise.
  Frame point_frame(xml_node point) const {
    const char* socket = point.child("body") ? "body" : "socket_parent_frame";
    const Frame result = frame(point, text(point, socket));
    if (model_.find_segment(result.body) < 0) {
      fail(point, "names the body '", text(point, socket), "', which the model does not have");
    }
    return result;
  }

  Motion motion(xml_node axis, Motion::Kind kind) const {
    Motion motion;
    motion.kind = kind;
    motion.axis = vector(axis, "axis");
    if (!(motion.axis.norm() > 1e-6)) fail(axis, "has an axis without length");
    motion.axis.normalize();
    const std::string name = text(axis, "coordinates");
    if (!name.empty()) motion.coordinate = coordinate(axis, name);
    if (motion.coordinate >= 0 || function_of(axis, "function")) motion.curve = curve_of(axis, "function");
    return motion;
  }

  // Shifts first, in the parent's frame, then the three turns, each about an axis that the earlier ones moved.
  std::vector<Motion> spatial_transform(xml_node joint) const {
    std::vector<Motion> shifts, turns;
    for (const xml_node axis : joint.child("SpatialTransform").children("TransformAxis")) {
      const bool turn = std::string(axis.attribute("name").value()).starts_with("rotation");
      (turn ? turns : shifts).push_back(motion(axis, turn ? Motion::Kind::turn : Motion::Kind::shift));
    }
    if (shifts.size() != 3 || turns.size() != 3) fail(joint, "lacks some of its six transform axes");
    shifts.insert(shifts.end(), turns.begin(), turns.end());
    return shifts;
  }

  std::vector<Motion> motions(xml_node joint) const {
    const std::string kind = joint.name();
    if (kind == "CustomJoint") return spatial_transform(joint);
    const auto known = std::ranges::find(kJoints, kind, [](const auto& one) { return std::string(one.first); });
    if (known == std::end(kJoints)) {
      fail(joint,
           "is no joint read here: CustomJoint, WeldJoint, PinJoint, SliderJoint, UniversalJoint, BallJoint, "
           "GimbalJoint, PlanarJoint, FreeJoint");
    }
    const std::string axes = known->second;
    const std::vector<xml_node> coordinates = coordinates_of(joint);
    if (coordinates.size() != axes.size()) {
      fail(joint, "has ", count_of(coordinates.size(), "coordinate", "coordinates"), ", expected ", axes.size());
    }
    std::vector<Motion> motions;
    for (std::size_t k = 0; k < axes.size(); ++k) {
      const bool turn = axes[k] < 'a';
      motions.push_back({turn ? Motion::Kind::turn : Motion::Kind::shift, Vector3d::Unit(axes[k] - (turn ? 'X' : 'x')),
                         Vector3d::Zero(), coordinate(joint, coordinates[k].attribute("name").value()),
                         Curve::polynomial({0, 1})});
    }
    std::ranges::stable_sort(motions, std::greater{},
                             [](const Motion& one) { return one.kind == Motion::Kind::shift; });
    return motions;
  }

  struct BodyJoint {
    xml_node element;
    Frame parent, child;
  };

  BodyJoint body_joint(xml_node joint) const {
    if (!joint.child("parent_body")) {
      return {joint, frame(joint, text(joint, "socket_parent_frame")), frame(joint, text(joint, "socket_child_frame"))};
    }
    return {joint,
            {text(joint, "parent_body"), offset(joint, "location_in_parent", "orientation_in_parent")},
            {joint.parent().parent().attribute("name").value(), offset(joint, "location", "orientation")}};
  }

  // Bodies in an order where parents come first.
  void read_segments(xml_node model, const std::vector<xml_node>& elements) {
    std::map<std::string, BodyJoint> joints;  // by the child's name
    for (const xml_node element : elements) {
      const BodyJoint joint = body_joint(element);
      if (!joints.emplace(joint.child.body, joint).second) fail(element, "is the second joint of its child body");
    }
    model_.segments.emplace_back().name = kGround;
    read_wraps(model.child("Ground"));
    std::vector<xml_node> left;
    for (const xml_node body : model.child("BodySet").child("objects").children("Body")) {
      if (body.attribute("name").value() == std::string(kGround)) {
        read_wraps(body);
      } else {
        left.push_back(body);
      }
    }
    if (left.size() > kMostSegments) fail(model, "has too many bodies: no muscle model has so many");
    while (!left.empty()) {
      const std::size_t before = left.size();
      std::erase_if(left, [&](xml_node body) { return add_segment(body, joints); });
      if (left.size() == before) fail(left[0], "hangs on no joint that leads to the ground");
    }
  }

  // Notes which segment has the surfaces: the one that was read last.
  void read_wraps(xml_node body) {
    for (const xml_node wrap : body.child("WrapObjectSet").child("objects").children()) {
      wrap_segment_[wrap.attribute("name").value()] = static_cast<int>(model_.segments.size()) - 1;
    }
  }

  bool add_segment(xml_node body, const std::map<std::string, BodyJoint>& joints) {
    const std::string name = body.attribute("name").value();
    const auto found = joints.find(name);
    if (found == joints.end()) return false;
    const auto& [joint, parent, child] = found->second;
    Segment segment;
    segment.name = name;
    segment.parent = model_.find_segment(parent.body);
    if (segment.parent < 0) return false;
    if (model_.find_segment(name) >= 0) fail(body, "has the name of an earlier body");
    segment.motions = motions(joint);
    if (text(joint, "reverse") == "true") {
      std::ranges::reverse(segment.motions);
      for (Motion& motion : segment.motions) motion.curve = motion.curve.scaled(-1);
    }
    segment.before = parent.to_body;
    segment.after = child.to_body.inverse();
    segment.centre = child.to_body.translation();
    model_.segments.push_back(segment);
    read_wraps(body);
    return true;
  }

  PathPoint path_point(xml_node element) const {
    const std::string kind = element.name();
    const Frame in = point_frame(element);
    PathPoint point;
    point.segment = model_.find_segment(in.body);
    if (kind == "MovingPathPoint") {
      if (!in.to_body.isApprox(Isometry3d::Identity())) fail(element, "moves in an offset frame, expected a body");
      for (const std::string axis : {"x", "y", "z"}) {
        point.moving.push_back(
            {socket_coordinate(element, axis + "_coordinate"), curve_of(element, axis + "_location")});
      }
      return point;
    }
    point.position = in.to_body * vector(element, "location");
    if (kind == "ConditionalPathPoint") {
      const std::vector<double> range = numbers(element, "range", 2, 2);
      point.condition = {socket_coordinate(element, "coordinate"), range[0], range[1]};
    } else if (kind != "PathPoint") {
      fail(element, "is no path point read here: PathPoint, ConditionalPathPoint, MovingPathPoint");
    }
    return point;
  }

  void read_force(xml_node force) {
    const xml_node path = force.child("GeometryPath");
    if (!path) return;
    ModelMuscle muscle;
    muscle.name = force.attribute("name").value();
    if (muscle.name.empty()) fail(force, "has no name");
    if (!force.child("max_isometric_force")) {
      model_.notes.push_back("'" + muscle.name + "' has a path but is no muscle: left out");
      return;
    }
    muscle.max_force = number(force, "max_isometric_force");
    for (const xml_node point : path.child("PathPointSet").child("objects").children()) {
      muscle.path.push_back(path_point(point));
    }
    for (const xml_node wrap : path.child("PathWrapSet").child("objects").children()) {
      Wrap entry;
      entry.name = text(wrap, "wrap_object");
      const auto found = wrap_segment_.find(entry.name);
      if (found == wrap_segment_.end()) fail(wrap, "names the wrap object '", entry.name, "', which no body has");
      entry.segment = found->second;
      muscle.wraps.push_back(entry);
    }
    if (muscle.path.size() < 2) fail(force, "has fewer than two path points");
    if (!names_.insert(muscle.name).second) fail(force, "has the name of an earlier muscle");
    model_.muscles.push_back(muscle);
  }

  void note_constraints(xml_node model) {
    std::vector<std::string> names;
    for (const xml_node constraint : model.child("ConstraintSet").child("objects").children()) {
      names.emplace_back(constraint.attribute("name").value());
    }
    if (!names.empty()) model_.notes.push_back("constraints are not honoured: " + list_names(names));
  }

  XmlFile file_;
  Model model_;
  std::map<std::string, xml_node> frames_;
  std::map<std::string, int> wrap_segment_;
  std::set<std::string> names_;
};

}  // namespace

Model read_opensim(const std::filesystem::path& path) { return OpenSimReader(path).read(); }

}  // namespace bodyopt::trainer::muscle_models
