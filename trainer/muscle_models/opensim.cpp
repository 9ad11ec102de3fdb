#include "trainer/muscle_models/opensim.h"

#include <cstring>
#include <map>
#include <set>

#include "assets/wording.h"
#include "runtime/core/error.h"
#include "trainer/muscle_models/xml_file.h"

namespace bodyopt::muscle_models {
namespace {

using Eigen::AngleAxisd;
using Eigen::Isometry3d;
using Eigen::Vector3d;
using pugi::xml_node;

constexpr std::size_t kLongestSpline = 10000, kMostSegments = 1000;

// The last part of a path like "/jointset/knee_r/knee_angle_r".
std::string last_part(const std::string& path) { return path.substr(path.find_last_of('/') + 1); }

class OpenSimReader {
 public:
  explicit OpenSimReader(const std::filesystem::path& path) : file_(path) {}

  Model read() {
    const xml_node top = file_.document.child("OpenSimDocument");
    const xml_node model = top.child("Model");
    if (!model)
      fail(file_.document.first_child(), "is not an OpenSim model: expected <OpenSimDocument> with a <Model>");
    if (top.attribute("Version").as_int() < 40000) {
      fail(top, "has version '" + std::string(top.attribute("Version").value()) +
                    "', expected 40000 or later: open it in OpenSim 4 and save it again");
    }
    if (const std::string units = model.child_value("length_units"); units != "meters" && units != "m") {
      fail(model, "has lengths in '" + units + "', expected meters");
    }
    model_.file = file_.path.string();
    read_coordinates(model);
    read_segments(model);
    for (const xml_node force : model.child("ForceSet").child("objects").children()) read_force(force);
    if (model_.muscles.empty()) fail(model, "has no muscle");
    note_constraints(model);
    return std::move(model_);
  }

 private:
  [[noreturn]] void fail(xml_node element, const std::string& what) const { refuse(file_.path, element, what); }

  std::vector<double> numbers(xml_node element, const char* child, std::size_t least, std::size_t most) const {
    if (!element.child(child)) fail(element, std::string("lacks <") + child + ">");
    return parse_numbers(file_.path, element, std::string("<") + child + ">", element.child_value(child), least, most);
  }
  double number(xml_node element, const char* child) const { return numbers(element, child, 1, 1)[0]; }
  Vector3d vector(xml_node element, const char* child) const {
    return Vector3d::Map(numbers(element, child, 3, 3).data());
  }

  int coordinate(xml_node element, const std::string& path) const {
    const int index = model_.find_coordinate(last_part(path));
    if (index < 0) fail(element, "names the coordinate '" + path + "', which no joint has");
    return index;
  }

  int segment(xml_node element, const std::string& path) const {
    const int index = model_.find_segment(last_part(path));
    if (index < 0) fail(element, "names the body '" + path + "', which the model does not have");
    return index;
  }

  Curve curve(xml_node element) const {
    const std::string kind = element.name();
    if (kind == "Constant") return Curve::polynomial({number(element, "value")});
    if (kind == "LinearFunction") {
      const std::vector<double> line = numbers(element, "coefficients", 2, 2);
      return Curve::polynomial({line[1], line[0]});
    }
    if (kind == "MultiplierFunction") return inner_curve(element.child("function")).scaled(number(element, "scale"));
    if (kind != "SimmSpline") {
      fail(element, "is no function read here: Constant, LinearFunction, SimmSpline, MultiplierFunction");
    }
    const std::vector<double> x = numbers(element, "x", 2, kLongestSpline);
    const std::vector<double> y = numbers(element, "y", x.size(), x.size());
    for (std::size_t k = 1; k < x.size(); ++k) {
      if (!(x[k] - x[k - 1] > 1e-9)) fail(element, "has an <x> that does not grow");
    }
    return Curve::spline(x, y);
  }

  // The function inside an element like <function> or <x_location>.
  Curve inner_curve(xml_node holder) const {
    if (!holder.first_child()) fail(holder, "holds no function");
    return curve(holder.first_child());
  }

  void read_coordinates(xml_node model) {
    std::set<std::string> names;
    for (const xml_node joint : model.child("JointSet").child("objects").children()) {
      for (const xml_node entry : joint.child("coordinates").children("Coordinate")) {
        Coordinate coordinate;
        coordinate.name = entry.attribute("name").value();
        coordinate.default_value = number(entry, "default_value");
        if (!names.insert(coordinate.name).second) fail(entry, "has the name of an earlier coordinate");
        model_.coordinates.push_back(coordinate);
      }
    }
  }

  struct Frame {
    std::string body;
    Isometry3d to_body = Isometry3d::Identity();
  };

  // What a joint's socket names: one of its own offset frames, a body, or the ground.
  Frame joint_frame(xml_node joint, const char* socket) const {
    const std::string name = joint.child_value(socket);
    for (const xml_node frame : joint.child("frames").children("PhysicalOffsetFrame")) {
      if (name != frame.attribute("name").value()) continue;
      const Vector3d turn = vector(frame, "orientation");
      Frame result{last_part(frame.child_value("socket_parent")), Isometry3d::Identity()};
      result.to_body = Eigen::Translation3d(vector(frame, "translation")) * AngleAxisd(turn.x(), Vector3d::UnitX()) *
                       AngleAxisd(turn.y(), Vector3d::UnitY()) * AngleAxisd(turn.z(), Vector3d::UnitZ());
      return result;
    }
    return {last_part(name), Isometry3d::Identity()};
  }

  Motion motion(xml_node axis, Motion::Kind kind) const {
    Motion motion;
    motion.kind = kind;
    motion.axis = vector(axis, "axis");
    if (!(motion.axis.norm() > 1e-6)) fail(axis, "has an axis without length");
    motion.axis.normalize();
    const std::string name = axis.child_value("coordinates");
    if (!name.empty()) motion.coordinate = coordinate(axis, name);
    for (const xml_node child : axis.children()) {
      if (std::strcmp(child.attribute("name").value(), "function") == 0) motion.curve = curve(child);
      if (std::strcmp(child.name(), "function") == 0) motion.curve = inner_curve(child);
    }
    return motion;
  }

  // Shifts first, in the parent's frame, then the three turns, each about an axis that the earlier ones carried.
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

  struct BodyJoint {
    xml_node element;
    Frame parent, child;
  };

  // Bodies in an order where parents come first.
  void read_segments(xml_node model) {
    std::map<std::string, BodyJoint> joints;  // by the child's name
    for (const xml_node joint : model.child("JointSet").child("objects").children()) {
      const BodyJoint entry{joint, joint_frame(joint, "socket_parent_frame"), joint_frame(joint, "socket_child_frame")};
      if (!joints.emplace(entry.child.body, entry).second) fail(joint, "is the second joint of its child body");
    }
    model_.segments.emplace_back().name = "ground";
    std::vector<xml_node> left;
    for (const xml_node body : model.child("BodySet").child("objects").children("Body")) left.push_back(body);
    if (left.size() > kMostSegments) fail(model, "has too many bodies: no muscle model has so many");
    while (!left.empty()) {
      const std::size_t before = left.size();
      std::erase_if(left, [&](xml_node body) { return add_segment(body, joints); });
      if (left.size() == before) fail(left[0], "hangs on no joint that leads to the ground");
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
    const std::string kind = joint.name();
    if (kind == "CustomJoint") {
      segment.motions = spatial_transform(joint);
    } else if (kind != "WeldJoint") {
      fail(joint, "is no joint read here: CustomJoint, WeldJoint");
    }
    segment.before = parent.to_body;
    segment.after = child.to_body.inverse();
    segment.centre = child.to_body.translation();
    model_.segments.push_back(segment);
    for (const xml_node wrap : body.child("WrapObjectSet").child("objects").children()) {
      wrap_segment_[wrap.attribute("name").value()] = static_cast<int>(model_.segments.size()) - 1;
    }
    return true;
  }

  PathPoint path_point(xml_node element) const {
    const std::string kind = element.name();
    PathPoint point;
    point.segment = segment(element, element.child_value("socket_parent_frame"));
    if (kind == "MovingPathPoint") {
      for (const std::string axis : {"x", "y", "z"}) {
        const std::string socket = element.child_value(("socket_" + axis + "_coordinate").c_str());
        point.moving.push_back({coordinate(element, socket), inner_curve(element.child((axis + "_location").c_str()))});
      }
      return point;
    }
    point.position = vector(element, "location");
    if (kind == "ConditionalPathPoint") {
      const std::vector<double> range = numbers(element, "range", 2, 2);
      point.condition = {coordinate(element, element.child_value("socket_coordinate")), range[0], range[1]};
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
      entry.name = wrap.child_value("wrap_object");
      const auto found = wrap_segment_.find(entry.name);
      if (found == wrap_segment_.end()) fail(wrap, "names the wrap object '" + entry.name + "', which no body has");
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
  std::map<std::string, int> wrap_segment_;
  std::set<std::string> names_;
};

}  // namespace

Model read_opensim(const std::filesystem::path& path) { return OpenSimReader(path).read(); }

}  // namespace bodyopt::muscle_models
