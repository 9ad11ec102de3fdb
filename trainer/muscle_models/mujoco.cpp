// Reads MuJoCo models (.xml).
#include <sys/stat.h>

#include <algorithm>
#include <map>
#include <numbers>
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

constexpr std::size_t kMostBodies = 1000;
constexpr int kDeepestIncludes = 32;  // files within files

Vector3d unit_axis(char letter) { return Vector3d::Unit(letter - 'x'); }

// The folder that holds those of a library's models, which include each other's parts.
std::filesystem::path library_of(const std::filesystem::path& model) {
  return std::filesystem::weakly_canonical(std::filesystem::absolute(model)).parent_path().parent_path();
}

bool lies_in(const std::filesystem::path& folder, const std::filesystem::path& file) {
  const std::filesystem::path place = std::filesystem::weakly_canonical(std::filesystem::absolute(file));
  return std::mismatch(folder.begin(), folder.end(), place.begin(), place.end()).first == folder.end();
}

// Replaces every <include> by what its file holds.
class Includes {
 public:
  // `missing`: gets the names of files that are not there.
  Includes(XmlFile& main, std::vector<std::string>& notes, std::vector<std::string>& missing)
      : folder_(main.path.parent_path()),
        library_(library_of(main.path)),
        notes_(notes),
        missing_(missing),
        elements_(main.elements) {
    read_.insert(identity(main.path));
    expand(main.path, main.document.document_element(), 0);
    require_shallow(main.path, main.document);
  }

 private:
  // All links to a file have the same identity.
  using Identity = std::pair<dev_t, ino_t>;
  static Identity identity(const std::filesystem::path& path) {
    struct stat status {};
    if (stat(path.c_str(), &status) != 0) return {};  // reading it will say so
    return {status.st_dev, status.st_ino};
  }

  void expand(const std::filesystem::path& path, xml_node parent, int depth) {
    for (xml_node child = parent.first_child(); child;) {
      const xml_node next = child.next_sibling();
      if (std::string(child.name()) == "include") {
        insert(path, child, depth + 1);
        parent.remove_child(child);
      } else {
        expand(path, child, depth);
      }
      child = next;
    }
  }

  void insert(const std::filesystem::path& path, xml_node include, int depth) {
    const std::string name = include.attribute("file").value();
    if (name.empty()) refuse(path, include, "names no file");
    if (std::filesystem::path(name).is_absolute()) {
      refuse(path, include, "names '", name, "': expected a path relative to the model's folder");
    }
    if (depth > kDeepestIncludes) {
      refuse(path, include, "names '", name, "', more than ", kDeepestIncludes, " files deep");
    }
    const std::filesystem::path target = folder_ / name;
    std::error_code ignored;
    if (!std::filesystem::exists(target, ignored)) {
      notes_.push_back("'" + name + "', which " + path.string() + " includes, is missing: left out");
      missing_.push_back(name);
      return;
    }
    if (!lies_in(library_, target)) {
      refuse(path, include, "names '", name, "', which lies neither in the model's folder nor in one beside it, links ",
             "followed: only those are read");
    }
    if (!read_.insert(identity(target)).second) {
      refuse(path, include, "names '", name, "', which is included already: a loop?");
    }
    XmlFile file(target);
    elements_ += file.elements;
    if (elements_ > kMostElements) {
      refuse(path, include, "names '", name, "', with which the model has more than ", kMostElements,
             " elements: no muscle model does");
    }
    expand(target, file.document.document_element(), depth);
    for (const xml_node child : file.document.document_element().children()) {
      include.parent().insert_copy_before(child, include);
    }
  }

  std::filesystem::path folder_, library_;
  std::vector<std::string>& notes_;
  std::vector<std::string>& missing_;
  std::set<Identity> read_;
  int elements_;  // of all files
};

class MujocoReader {
 public:
  explicit MujocoReader(const std::filesystem::path& path) : file_(path) {}

  // What is not understood may be in a file that is not there.
  Model read() {
    try {
      return parse();
    } catch (const Error& error) {
      if (missing_.empty()) throw;
      throw Error(error.kind(), error.what(), "; of the files that it includes, missing are ", list_names(missing_),
                  ": does it need them?");
    }
  }

 private:
  Model parse() {
    const xml_node top = file_.document.document_element();
    if (std::string(top.name()) != "mujoco") fail(top, "is not a MuJoCo model: expected <mujoco>");
    Includes(file_, model_.notes, missing_);
    model_.file = file_.path.string();
    for (const xml_node compiler : top.children("compiler")) read_compiler(compiler);
    for (const xml_node defaults : top.children("default")) read_defaults(defaults, "");
    model_.segments.emplace_back().name = "world";
    for (const xml_node world : top.children("worldbody")) read_contents(world, 0, "");
    for (const xml_node equality : top.children("equality")) {
      for (const xml_node joint : equality.children("joint")) read_coupling(joint);
    }
    read_muscles(top);
    if (model_.muscles.empty()) fail(top, "has no muscle: no spatial tendon with a muscle that pulls it");
    return std::move(model_);
  }

  [[noreturn]] void fail(xml_node element, const auto&... what) const { refuse(file_.path, element, what...); }

  void read_compiler(xml_node compiler) {
    if (const pugi::xml_attribute angle = compiler.attribute("angle"))
      degrees_ = std::string(angle.value()) != "radian";
    if (const pugi::xml_attribute order = compiler.attribute("eulerseq")) {
      euler_order_ = order.value();
      if (euler_order_.size() != 3 || euler_order_.find_first_not_of("xyzXYZ") != std::string::npos) {
        fail(compiler, "has eulerseq '", euler_order_, "', expected three of xyz or XYZ");
      }
    }
    if (std::string(compiler.attribute("coordinate").value()) == "global") {
      fail(compiler, "has global coordinates, which MuJoCo itself no longer reads");
    }
  }

  // A default class is the list of <default> elements it inherits from, its own first.
  void read_defaults(xml_node element, const std::string& parent) {
    std::string name = element.attribute("class").value();
    if (name.empty()) name = "main";
    std::vector<xml_node>& chain = classes_[name];
    if (!parent.empty() && !chain.empty()) fail(element, "has the name of an earlier default class");
    chain.insert(chain.begin(), element);
    if (!parent.empty()) {
      const std::vector<xml_node>& inherited = classes_[parent];
      chain.insert(chain.end(), inherited.begin(), inherited.end());
    }
    for (const xml_node child : element.children("default")) read_defaults(child, name);
  }

  // An attribute of an element, or of its default class, or nothing.
  std::string attribute(xml_node element, const char* name, const std::string& child_class) const {
    if (const pugi::xml_attribute own = element.attribute(name)) return own.value();
    std::string class_name = element.attribute("class").value();
    if (class_name.empty()) class_name = child_class.empty() ? "main" : child_class;
    const auto found = classes_.find(class_name);
    if (found == classes_.end()) {
      if (class_name == "main") return "";
      fail(element, "has the default class '", class_name, "', which the model does not define");
    }
    for (const xml_node defaults : found->second) {
      for (const xml_node entry : defaults.children(element.name())) {
        if (const pugi::xml_attribute value = entry.attribute(name)) return value.value();
      }
    }
    return "";
  }

  std::vector<double> numbers(xml_node element, const char* name, const std::string& text, std::size_t least,
                              std::size_t most) const {
    return parse_numbers(file_.path, element, "'" + std::string(name) + "'", text, least, most);
  }

  Vector3d vector(xml_node element, const char* name, const std::string& child_class, const Vector3d& otherwise) const {
    const std::string text = attribute(element, name, child_class);
    return text.empty() ? otherwise : Vector3d(Vector3d::Map(numbers(element, name, text, 3, 3).data()));
  }

  double radians(double angle) const { return degrees_ ? angle * std::numbers::pi / 180 : angle; }

  // pos, and quat, axisangle or euler.
  Isometry3d frame(xml_node element, const std::string& child_class) const {
    Isometry3d frame(Eigen::Translation3d(vector(element, "pos", child_class, Vector3d::Zero())));
    for (const char* other : {"xyaxes", "zaxis"}) {
      if (element.attribute(other)) fail(element, "is turned by '", other, "', which is not read here");
    }
    if (const std::string text = attribute(element, "quat", child_class); !text.empty()) {
      const std::vector<double> q = numbers(element, "quat", text, 4, 4);
      const Eigen::Quaterniond turn(q[0], q[1], q[2], q[3]);
      if (!(turn.norm() > 1e-6)) fail(element, "has a quaternion without length");
      return frame * turn.normalized();
    }
    if (const std::string text = attribute(element, "axisangle", child_class); !text.empty()) {
      const std::vector<double> turn = numbers(element, "axisangle", text, 4, 4);
      return frame * AngleAxisd(radians(turn[3]), direction(element, Vector3d::Map(turn.data())));
    }
    if (const std::string text = attribute(element, "euler", child_class); !text.empty()) {
      const std::vector<double> angles = numbers(element, "euler", text, 3, 3);
      Eigen::Quaterniond turn = Eigen::Quaterniond::Identity();
      for (std::size_t k = 0; k < 3; ++k) {
        const char letter = euler_order_[k];
        const bool fixed = letter < 'a';  // a capital: about the fixed axis, so before the turns so far
        const Eigen::Quaterniond step(AngleAxisd(radians(angles[k]), unit_axis(fixed ? letter + 32 : letter)));
        turn = fixed ? step * turn : turn * step;
      }
      return frame * turn;
    }
    return frame;
  }

  Vector3d direction(xml_node element, const Vector3d& axis) const {
    if (!(axis.norm() > 1e-6)) fail(element, "has an axis without length");
    return axis.normalized();
  }

  void read_contents(xml_node body, int segment, const std::string& child_class) {
    for (const xml_node child : body.children()) {
      const std::string kind = child.name();
      if (kind == "body") {
        read_body(child, segment, child_class);
      } else if (kind == "site" && child.attribute("name")) {
        PathPoint& site = sites_[child.attribute("name").value()];
        site.segment = segment;
        site.position = vector(child, "pos", child_class, Vector3d::Zero());
      } else if (kind == "geom" && child.attribute("name")) {
        geoms_[child.attribute("name").value()] = {child, segment, child_class};
      } else if (kind == "frame" || kind == "replicate" || kind == "attach" || kind == "composite") {
        fail(child, "is not read here: save the model from MuJoCo as plain bodies");
      }
    }
  }

  void read_body(xml_node body, int parent, const std::string& inherited_class) {
    std::string child_class = body.attribute("childclass").value();
    if (child_class.empty()) child_class = inherited_class;
    Segment segment;
    segment.name = body.attribute("name").value();
    if (!segment.name.empty() && model_.find_segment(segment.name) >= 0) fail(body, "has the name of an earlier body");
    if (model_.segments.size() == kMostBodies) fail(body, "is one body too many: no muscle model has so many");
    if (segment.name.empty()) segment.name = "unnamed body " + std::to_string(model_.segments.size());
    segment.parent = parent;
    segment.before = frame(body, "");
    bool first = true;
    for (const xml_node joint : body.children("joint")) {
      const Motion motion = read_joint(joint, child_class);
      if (first) segment.centre = motion.point;
      first = false;
      if (motion.coordinate >= 0) segment.motions.push_back(motion);
    }
    model_.segments.push_back(segment);
    read_contents(body, static_cast<int>(model_.segments.size()) - 1, child_class);
  }

  // No coordinate: a joint that stays as it is.
  Motion read_joint(xml_node joint, const std::string& child_class) {
    Motion motion;
    motion.point = vector(joint, "pos", child_class, Vector3d::Zero());
    const std::string type = attribute(joint, "type", child_class);
    if (type == "ball" || type == "free") return motion;
    if (!type.empty() && type != "hinge" && type != "slide") fail(joint, "has the unknown type '", type, "'");
    motion.kind = type == "slide" ? Motion::Kind::shift : Motion::Kind::turn;
    motion.axis = direction(joint, vector(joint, "axis", child_class, Vector3d::UnitZ()));
    Coordinate coordinate;
    coordinate.name = joint.attribute("name").value();
    if (!coordinate.name.empty() && model_.find_coordinate(coordinate.name) >= 0) {
      fail(joint, "has the name of an earlier joint");
    }
    if (const std::string text = attribute(joint, "ref", child_class); !text.empty()) {
      const double reference = numbers(joint, "ref", text, 1, 1)[0];
      coordinate.default_value = type == "slide" ? reference : radians(reference);
    }
    motion.curve = Curve::polynomial({-coordinate.default_value, 1});
    motion.coordinate = static_cast<int>(model_.coordinates.size());
    model_.coordinates.push_back(coordinate);
    return motion;
  }

  int coordinate(xml_node element, const char* name) const {
    const std::string joint = element.attribute(name).value();
    const int index = model_.find_coordinate(joint);
    if (joint.empty() || index < 0) fail(element, "names the joint '", joint, "', which no body has");
    return index;
  }

  // joint1 - its reference = polynomial of (joint2 - its reference), which is zero in the default pose.
  void read_coupling(xml_node element) {
    if (std::string(element.attribute("active").value()) == "false") return;
    Coordinate& follower = model_.coordinates[static_cast<std::size_t>(coordinate(element, "joint1"))];
    const std::string text = element.attribute("polycoef").value();
    if (!text.empty()) follower.default_value += numbers(element, "polycoef", text, 1, 5)[0];
  }

  Wrap read_wrap(xml_node element, int after) const {
    Wrap wrap;
    wrap.name = element.attribute("geom").value();
    wrap.after = after;
    const auto found = geoms_.find(wrap.name);
    if (found == geoms_.end()) fail(element, "names the geom '", wrap.name, "', which no body has");
    const auto& [geom, segment, child_class] = found->second;
    const std::string type = attribute(geom, "type", child_class);
    wrap.segment = segment;
    if (type.empty() || type == "sphere") wrap.shape = Wrap::Shape::sphere;
    if (type == "cylinder") wrap.shape = Wrap::Shape::cylinder;
    if (wrap.shape == Wrap::Shape::other || geom.attribute("fromto"))
      fail(geom, "bends a tendon, but is no sphere or cylinder");
    wrap.frame = frame(geom, child_class);
    wrap.radius = numbers(geom, "size", attribute(geom, "size", child_class), 1, 3)[0];
    if (!(wrap.radius > 0)) fail(geom, "has no radius");
    if (const std::string side = element.attribute("sidesite").value(); !side.empty()) wrap.side = site(element, side);
    return wrap;
  }

  PathPoint site(xml_node element, const std::string& name) const {
    const auto found = sites_.find(name);
    if (found == sites_.end()) fail(element, "names the site '", name, "', which no body has");
    return found->second;
  }

  ModelMuscle read_tendon(xml_node tendon) const {
    ModelMuscle muscle;
    for (const xml_node item : tendon.children()) {
      const std::string kind = item.name();
      if (kind == "site") {
        muscle.path.push_back(site(item, item.attribute("site").value()));
      } else if (kind == "geom") {
        muscle.wraps.push_back(read_wrap(item, static_cast<int>(muscle.path.size()) - 1));
      } else {
        fail(tendon, "holds a <", kind, ">, which is not read here");
      }
    }
    if (muscle.path.size() < 2) fail(tendon, "has fewer than two sites");
    for (const Wrap& wrap : muscle.wraps) {
      if (wrap.after < 0 || wrap.after + 1 >= static_cast<int>(muscle.path.size())) {
        fail(tendon, "bends around '", wrap.name, "' without a site before or after it");
      }
    }
    return muscle;
  }

  // The largest isometric force of a muscle actuator; nothing when the actuator is none.
  std::optional<double> muscle_force(xml_node actuator) const {
    const std::string kind = actuator.name();
    if (kind == "muscle") {
      const std::string text = attribute(actuator, "force", "");
      return text.empty() ? 0 : std::max(numbers(actuator, "force", text, 1, 1)[0], 0.0);
    }
    if (kind != "general" || attribute(actuator, "gaintype", "") != "muscle") return std::nullopt;
    const std::string text = attribute(actuator, "gainprm", "");
    return text.empty() ? 0 : std::max(numbers(actuator, "gainprm", text, 3, 10)[2], 0.0);
  }

  // A muscle is a spatial tendon and the actuator that pulls it; it has the actuator's name.
  void read_muscles(xml_node top) {
    std::map<std::string, std::pair<std::string, double>> pulled;  // by tendon: the muscle's name and force
    for (const xml_node group : top.children("actuator")) {
      for (const xml_node actuator : group.children()) {
        const std::string tendon = actuator.attribute("tendon").value();
        if (tendon.empty()) continue;
        const std::optional<double> force = muscle_force(actuator);
        const std::string name = actuator.attribute("name").value();
        if (!force) continue;
        if (!pulled.emplace(tendon, std::pair(name.empty() ? tendon : name, *force)).second) {
          fail(actuator, "pulls the tendon '", tendon, "', which another muscle pulls already");
        }
      }
    }
    std::vector<std::string> idle;
    for (const xml_node group : top.children("tendon")) {
      for (const xml_node tendon : group.children("spatial")) {
        const std::string name = tendon.attribute("name").value();
        const auto found = pulled.find(name);
        if (found == pulled.end()) {
          idle.push_back(name);
          continue;
        }
        ModelMuscle muscle = read_tendon(tendon);
        std::tie(muscle.name, muscle.max_force) = found->second;
        model_.muscles.push_back(muscle);
        pulled.erase(found);
      }
    }
    if (!pulled.empty()) {
      throw Error(ErrorKind::file, file_.path, ": the muscle '", pulled.begin()->second.first, "' pulls the tendon '",
                  pulled.begin()->first, "', which is no spatial tendon");
    }
    if (!idle.empty()) model_.notes.push_back("tendons without a muscle, left out: " + list_names(idle));
  }

  struct Geom {
    xml_node element;
    int segment;
    std::string child_class;
  };

  XmlFile file_;
  Model model_;
  std::vector<std::string> missing_;  // files that are included and not there
  bool degrees_ = true;
  std::string euler_order_ = "xyz";
  std::map<std::string, std::vector<xml_node>> classes_;
  std::map<std::string, PathPoint> sites_;
  std::map<std::string, Geom> geoms_;
};

}  // namespace

Model read_mujoco(const std::filesystem::path& path) { return MujocoReader(path).read(); }

}  // namespace bodyopt::trainer::muscle_models
