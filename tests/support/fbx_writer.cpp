#include "tests/support/fbx_writer.h"

#include <zlib.h>

#include <cstring>
#include <numbers>
#include <sstream>

namespace bodyopt::testing {
namespace {

struct Node {
  using Value = std::variant<std::int64_t, double, std::string, std::vector<std::int64_t>, std::vector<double>>;
  std::string name;
  std::vector<Value> values;
  std::vector<Node> children;
};

constexpr double kTicks = 46186158000;

std::int64_t ticks(double seconds) { return std::llround(seconds * kTicks); }

Node property(const std::string& name, const std::vector<Node::Value>& values) {
  Node node{"P", {name, std::string(), std::string(), std::string("A")}, {}};
  node.values.insert(node.values.end(), values.begin(), values.end());
  return node;
}

Node vector(const std::string& name, const Vector& v) {
  return property(name, std::vector<Node::Value>{v[0], v[1], v[2]});
}

Node object(const std::string& kind, std::int64_t id, const std::string& name, const std::string& type) {
  return {kind, {id, name + std::string("\0\1", 2) + kind, type}, {}};
}

std::vector<double> columns(const Eigen::Affine3d& matrix) {
  return {matrix.matrix().data(), matrix.matrix().data() + 16};
}

// Identities by what they are: models from 1000, meshes, skins, clusters, curves.
std::int64_t id_of(int kind, std::size_t place) { return 1000 * (kind + 1) + static_cast<std::int64_t>(place); }
enum { kModel, kMesh, kSkin, kCluster, kStack, kLayer, kCurveNode, kCurve, kMaterial, kTexture, kVideo };

struct Tree {
  Node objects{"Objects", {}, {}}, links{"Connections", {}, {}};

  Node& add(const Node& node) { return objects.children.emplace_back(node); }
  void link(std::int64_t from, std::int64_t to, const std::string& name = "") {
    Node node{"C", {std::string(name.empty() ? "OO" : "OP"), from, to}, {}};
    if (!name.empty()) node.values.emplace_back(name);
    links.children.push_back(node);
  }
};

void add_model(Tree& tree, const WrittenModel& m, std::size_t k) {
  Node& node = tree.add(object("Model", id_of(kModel, k), m.name, m.type));
  node.children = {{"Properties70",
                    {},
                    {property("RotationActive", {std::int64_t{1}}), property("RotationOrder", {std::int64_t{m.order}}),
                     property("InheritType", {std::int64_t{m.inherit}}), vector("Lcl Translation", m.translation),
                     vector("Lcl Rotation", m.degrees), vector("Lcl Scaling", m.scale), vector("PreRotation", m.before),
                     vector("PostRotation", m.after), vector("RotationOffset", m.rotation_offset),
                     vector("RotationPivot", m.rotation_pivot), vector("ScalingOffset", m.scale_offset),
                     vector("ScalingPivot", m.scale_pivot), vector("GeometricTranslation", m.mesh_translation),
                     vector("GeometricRotation", m.mesh_degrees), vector("GeometricScaling", m.mesh_scale)}}};
  tree.link(id_of(kModel, k), m.parent < 0 ? 0 : id_of(kModel, static_cast<std::size_t>(m.parent)));
}

void add_mesh(Tree& tree, const WrittenMesh& mesh, std::size_t k) {
  std::vector<double> numbers;
  for (const Vector& p : mesh.points) numbers.insert(numbers.end(), p.begin(), p.end());
  Node& node = tree.add(object("Geometry", id_of(kMesh, k), "", "Mesh"));
  node.children = {{"Vertices", {numbers}, {}}, {"PolygonVertexIndex", {mesh.polygons}, {}}};
  if (!mesh.texture.empty()) {
    node.children.push_back({"LayerElementUV",
                             {std::int64_t{0}},
                             {{"MappingInformationType", {std::string("ByPolygonVertex")}, {}},
                              {"ReferenceInformationType", {std::string("IndexToDirect")}, {}},
                              {"UV", {mesh.texture}, {}},
                              {"UVIndex", {mesh.texture_of}, {}}}});
  }
  if (!mesh.material_of.empty()) {
    node.children.push_back(
        {"LayerElementMaterial",
         {std::int64_t{0}},
         {{"MappingInformationType", {std::string("ByPolygon")}, {}}, {"Materials", {mesh.material_of}, {}}}});
  }
  tree.link(id_of(kMesh, k), id_of(kModel, static_cast<std::size_t>(mesh.model)));
  if (mesh.clusters.empty()) return;
  tree.add(object("Deformer", id_of(kSkin, k), "", "Skin"));
  tree.link(id_of(kSkin, k), id_of(kMesh, k));
  for (std::size_t c = 0; c < mesh.clusters.size(); ++c) {
    const WrittenCluster& cluster = mesh.clusters[c];
    const std::int64_t id = id_of(kCluster, 100 * k + c);
    Node& deformer = tree.add(object("Deformer", id, "", "Cluster"));
    deformer.children = {{"Indexes", {cluster.points}, {}},
                         {"Weights", {cluster.weights}, {}},
                         {"Transform", {columns(cluster.bone_then.inverse() * cluster.mesh_then)}, {}},
                         {"TransformLink", {columns(cluster.bone_then)}, {}}};
    tree.link(id, id_of(kSkin, k));
    tree.link(id_of(kModel, static_cast<std::size_t>(cluster.bone)), id);
  }
}

void add_material(Tree& tree, const WrittenMaterial& material, std::size_t k) {
  Node& node = tree.add(object("Material", id_of(kMaterial, k), material.name, ""));
  node.children = {{"Properties70", {}, {vector("DiffuseColor", material.colour)}}};
  tree.link(id_of(kMaterial, k), id_of(kModel, static_cast<std::size_t>(material.model)));
  if (material.shares >= 0) {
    const auto other = static_cast<std::size_t>(material.shares);
    tree.link(id_of(kTexture, other), id_of(kMaterial, k), "DiffuseColor");
  }
  if (material.image.empty() && material.file.empty()) return;
  Node& texture = tree.add(object("Texture", id_of(kTexture, k), material.name, ""));
  texture.children = {{"RelativeFilename", {material.file}, {}}};
  tree.link(id_of(kTexture, k), id_of(kMaterial, k), "DiffuseColor");
  Node& video = tree.add(object("Video", id_of(kVideo, k), material.name, "Clip"));
  video.children = {{"Content", {material.image}, {}}};
  tree.link(id_of(kVideo, k), id_of(kTexture, k));
}

void add_curve(Tree& tree, const WrittenCurve& curve, std::size_t k) {
  std::vector<std::int64_t> times;
  for (const double seconds : curve.seconds) times.push_back(ticks(seconds));
  tree.add(object("AnimationCurveNode", id_of(kCurveNode, k), "", ""));
  Node& node = tree.add(object("AnimationCurve", id_of(kCurve, k), "", ""));
  node.children = {{"KeyTime", {times}, {}},
                   {"KeyValueFloat", {curve.values}, {}},
                   {"KeyAttrFlags", {std::vector<std::int64_t>{curve.flags}}, {}},
                   {"KeyAttrDataFloat", {std::vector<double>{curve.slope_out, curve.slope_in, 0, 0}}, {}},
                   {"KeyAttrRefCount", {std::vector<std::int64_t>{static_cast<std::int64_t>(times.size())}}, {}},
                   {"Post-Extrapolation", {}, {{"Type", {curve.beyond}, {}}}}};
  tree.link(id_of(kCurveNode, k), id_of(kLayer, static_cast<std::size_t>(curve.layer)));
  tree.link(id_of(kCurveNode, k), id_of(kModel, static_cast<std::size_t>(curve.model)), curve.property);
  tree.link(id_of(kCurve, k), id_of(kCurveNode, k), std::string("d|") + "XYZ"[curve.axis]);
}

Node settings(const WrittenFbx& file) {
  Node properties{"Properties70", {}, {property("UnitScaleFactor", {file.unit})}};
  const char* const names[] = {"CoordAxis", "UpAxis", "FrontAxis"};
  for (int k = 0; k < 3; ++k) {
    properties.children.push_back(property(names[k], {std::int64_t{file.axes[k]}}));
    properties.children.push_back(property(std::string(names[k]) + "Sign", {std::int64_t{file.signs[k]}}));
  }
  return {"GlobalSettings", {}, {properties}};
}

std::vector<Node> tree_of(const WrittenFbx& file, std::int64_t version) {
  Tree tree;
  for (std::size_t k = 0; k < file.models.size(); ++k) add_model(tree, file.models[k], k);
  for (std::size_t k = 0; k < file.meshes.size(); ++k) add_mesh(tree, file.meshes[k], k);
  for (std::size_t k = 0; k < file.materials.size(); ++k) add_material(tree, file.materials[k], k);
  if (!file.curves.empty()) {
    Node& stack = tree.add(object("AnimationStack", id_of(kStack, 0), "take", ""));
    stack.children = {
        {"Properties70", {}, {property("LocalStart", {ticks(file.begin)}), property("LocalStop", {ticks(file.end)})}}};
    for (std::size_t k = 0; k < file.layers.size(); ++k) {
      tree.add(object("AnimationLayer", id_of(kLayer, k), file.layers[k], ""));
      tree.link(id_of(kLayer, k), id_of(kStack, 0));
    }
    for (std::size_t k = 0; k < file.curves.size(); ++k) add_curve(tree, file.curves[k], k);
  }
  return {{"FBXHeaderExtension", {}, {{"FBXVersion", {version}, {}}}}, settings(file), tree.objects, tree.links};
}

void put_text(const Node& node, std::ostringstream& out) {
  out << node.name << ": ";
  const char* separator = "";
  bool has_array = false;
  const auto put_array = [&](const auto& numbers) {
    out << '*' << numbers.size() << " {\na: ";
    for (std::size_t k = 0; k < numbers.size(); ++k) out << (k == 0 ? "" : ",") << numbers[k];
    out << "\n}\n";
    has_array = true;
  };
  for (const Node::Value& value : node.values) {
    out << separator;
    separator = ", ";
    if (const auto* text = std::get_if<std::string>(&value)) {
      const std::size_t mark = text->find(std::string("\0\1", 2));
      out << '"' << (mark == std::string::npos ? *text : text->substr(mark + 2) + "::" + text->substr(0, mark)) << '"';
    } else if (const auto* whole = std::get_if<std::int64_t>(&value)) {
      out << *whole;
    } else if (const auto* real = std::get_if<double>(&value)) {
      out << *real;
    } else if (const auto* wholes = std::get_if<std::vector<std::int64_t>>(&value)) {
      put_array(*wholes);
    } else {
      put_array(std::get<std::vector<double>>(value));
    }
  }
  if (has_array) return;
  out << " {\n";
  for (const Node& child : node.children) put_text(child, out);
  out << "}\n";
}

template <class T>
void put(std::string& bytes, T value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

template <class T>
void put_packed(std::string& bytes, char type, const std::vector<T>& numbers, bool packed) {
  bytes += type;
  put(bytes, static_cast<std::uint32_t>(numbers.size()));
  put(bytes, std::uint32_t{packed});
  std::string content(reinterpret_cast<const char*>(numbers.data()), numbers.size() * sizeof(T));
  if (packed) {
    uLongf size = compressBound(content.size());
    std::string smaller(size, '\0');
    compress(reinterpret_cast<Bytef*>(smaller.data()), &size, reinterpret_cast<const Bytef*>(content.data()),
             content.size());
    content = smaller.substr(0, size);
  }
  put(bytes, static_cast<std::uint32_t>(content.size()));
  bytes += content;
}

void put_value(std::string& bytes, const Node::Value& value, bool packed) {
  if (const auto* text = std::get_if<std::string>(&value)) {
    bytes += 'S';
    put(bytes, static_cast<std::uint32_t>(text->size()));
    bytes += *text;
  } else if (const auto* whole = std::get_if<std::int64_t>(&value)) {
    bytes += 'L';
    put(bytes, *whole);
  } else if (const auto* real = std::get_if<double>(&value)) {
    bytes += 'D';
    put(bytes, *real);
  } else if (const auto* wholes = std::get_if<std::vector<std::int64_t>>(&value)) {
    put_packed(bytes, 'l', *wholes, packed);
  } else {
    put_packed(bytes, 'd', std::get<std::vector<double>>(value), packed);
  }
}

void put_binary(const Node& node, bool wide, bool packed, std::string& bytes) {
  const auto put_offset = [&](std::size_t offset, std::string& to) {
    wide ? put(to, std::uint64_t{offset}) : put(to, static_cast<std::uint32_t>(offset));
  };
  const std::size_t begin = bytes.size(), head = wide ? 24 : 12;
  bytes.append(head, '\0');
  bytes += static_cast<char>(node.name.size());
  bytes += node.name;
  const std::size_t values = bytes.size();
  for (const Node::Value& value : node.values) put_value(bytes, value, packed);
  const std::size_t length = bytes.size() - values;
  for (const Node& child : node.children) put_binary(child, wide, packed, bytes);
  if (!node.children.empty()) bytes.append(head + 1, '\0');
  std::string header;
  put_offset(bytes.size(), header);
  put_offset(node.values.size(), header);
  put_offset(length, header);
  bytes.replace(begin, head, header);
}

// In degrees; the axis that is turned about first stands first.
Eigen::Affine3d turned(const Vector& degrees, int order) {
  const char* const orders[] = {"XYZ", "XZY", "YZX", "YXZ", "ZXY", "ZYX"};
  Eigen::Affine3d turn = Eigen::Affine3d::Identity();
  for (const char axis : std::string(orders[order])) {
    const int k = axis - 'X';
    turn = Eigen::AngleAxisd(degrees[k] * std::numbers::pi / 180, Vector::Unit(k)) * turn;
  }
  return turn;
}

}  // namespace

std::string WrittenFbx::text() const {
  std::ostringstream out;
  out.precision(17);
  out << "; FBX 7.4.0 project file\n";
  for (const Node& node : tree_of(*this, 7400)) put_text(node, out);
  return out.str();
}

std::string WrittenFbx::binary(std::uint32_t version, bool packed) const {
  std::string bytes("Kaydara FBX Binary  \0\x1a\0", 23);
  put(bytes, version);
  for (const Node& node : tree_of(*this, version)) put_binary(node, version >= 7500, packed, bytes);
  return bytes + std::string(version >= 7500 ? 25 : 13, '\0');
}

double value_at(const WrittenCurve& curve, double seconds) {
  if (seconds <= curve.seconds.front()) return curve.values.front();
  for (std::size_t k = 1; k < curve.seconds.size(); ++k) {
    if (seconds >= curve.seconds[k]) continue;
    const double x = (seconds - curve.seconds[k - 1]) / (curve.seconds[k] - curve.seconds[k - 1]);
    return curve.flags == 2 ? curve.values[k - 1] : (1 - x) * curve.values[k - 1] + x * curve.values[k];
  }
  return curve.values.back();
}

Eigen::Affine3d WrittenFbx::world(int place, double seconds) const {
  WrittenModel m = models[static_cast<std::size_t>(place)];
  for (const WrittenCurve& curve : curves) {
    if (curve.model != place) continue;
    Vector& moved =
        curve.property == "Lcl Rotation" ? m.degrees : (curve.property == "Lcl Scaling" ? m.scale : m.translation);
    moved[curve.axis] = value_at(curve, seconds);
  }
  const auto by = [](const Vector& v) { return Eigen::Translation3d(v); };
  const Eigen::Affine3d local = by(m.translation) * by(m.rotation_offset) * by(m.rotation_pivot) * turned(m.before, 0) *
                                turned(m.degrees, m.order) * turned(m.after, 0).inverse() * by(-m.rotation_pivot) *
                                by(m.scale_offset) * by(m.scale_pivot) * Eigen::Scaling(m.scale) * by(-m.scale_pivot);
  return m.parent < 0 ? local : world(m.parent, seconds) * local;
}

Eigen::Affine3d WrittenFbx::to_ours() const {
  Eigen::Matrix3d turn = Eigen::Matrix3d::Zero();
  for (int k = 0; k < 3; ++k) turn(k, axes[k]) = signs[k];
  return Eigen::Affine3d(unit / 100 * turn);
}

}  // namespace bodyopt::testing
