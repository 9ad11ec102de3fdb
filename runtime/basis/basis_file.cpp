// A basis as safetensors: one tensor per array of basis.h, named <table>.<array>; names and other strings as metadata.
#include <xxhash.h>

#include <cstring>
#include <nlohmann/json.hpp>
#include <type_traits>

#include "runtime/basis/basis.h"
#include "runtime/basis/error.h"
#include "runtime/basis/safetensors.h"

namespace bodyopt {
namespace {

constexpr const char* kSchema = "bodyopt-basis-1";
constexpr std::size_t kJointNumbers = 10 + 10 + 12;  // bind, default local, inverse bind

// A record of 4-byte scalars is stored as rows of U32 or F32 words; mixed records as U32.
template <typename T>
constexpr const char* dtype_of() {
  if constexpr (std::is_same_v<T, float> || std::is_same_v<T, FeatureRange>) return "F32";
  if constexpr (std::is_same_v<T, double>) return "F64";
  return "U32";
}

template <typename T>
Tensor tensor_from(const std::vector<T>& values) {
  static_assert(std::is_trivially_copyable_v<T>);
  Tensor tensor;
  tensor.dtype = dtype_of<T>();
  tensor.shape = {values.size()};
  constexpr std::size_t words = sizeof(T) / (std::is_same_v<T, double> ? 8 : 4);
  if (words > 1) tensor.shape.push_back(words);
  tensor.bytes.resize(values.size() * sizeof(T));
  if (!values.empty()) std::memcpy(tensor.bytes.data(), values.data(), tensor.bytes.size());
  return tensor;
}

// Applies `visit(name, array)` to every array of the tables.
template <typename BasisType, typename Visit>
void for_each_array(BasisType& basis, Visit visit) {
  visit("mesh.rest", basis.mesh.rest);
  visit("mesh.triangles", basis.mesh.triangles);
  visit("mesh.output_vertex", basis.mesh.output_vertex);
  visit("mesh.output_triangles", basis.mesh.output_triangles);
  visit("mesh.vertex_triangle_begin", basis.mesh.vertex_triangle_begin);
  visit("mesh.vertex_triangles", basis.mesh.vertex_triangles);
  visit("ddm.block_begin", basis.ddm.block_begin);
  visit("ddm.block_joints", basis.ddm.block_joints);
  visit("ddm.moments", basis.ddm.moments);
  visit("ddm.vertices", basis.ddm.vertices);
  visit("strain.vertices", basis.strain.vertices);
  visit("strain.points", basis.strain.points);
  visit("strain.fibre_begin", basis.strain.fibre_begin);
  visit("strain.rest_length", basis.strain.rest_length);
  visit("residual.features", basis.residual.features);
  visit("residual.regions", basis.residual.regions);
  visit("residual.region_features", basis.residual.region_features);
  visit("residual.centre_region", basis.residual.centre_region);
  visit("residual.centres", basis.residual.centres);
  visit("residual.coefficient_region", basis.residual.coefficient_region);
  visit("residual.weights", basis.residual.weights);
  visit("residual.blend_begin", basis.residual.blend_begin);
  visit("residual.blend", basis.residual.blend);
}

void append_transform(std::vector<double>& values, const JointTransform& t) {
  values.insert(values.end(), t.translation.begin(), t.translation.end());
  values.insert(values.end(), t.rotation.begin(), t.rotation.end());
  values.insert(values.end(), t.scale.begin(), t.scale.end());
}

JointTransform transform_at(const double* values) {
  JointTransform t;
  std::copy(values, values + 3, t.translation.begin());
  std::copy(values + 3, values + 7, t.rotation.begin());
  std::copy(values + 7, values + 10, t.scale.begin());
  return t;
}

Tensor joint_tensor(const Skeleton& skeleton) {
  std::vector<double> values;
  for (const Joint& joint : skeleton.joints) {
    append_transform(values, joint.bind);
    append_transform(values, joint.default_local);
    for (const auto& row : joint.inverse_bind.m) values.insert(values.end(), row, row + 4);
  }
  Tensor tensor = tensor_from(values);
  tensor.shape = {skeleton.size(), kJointNumbers};
  return tensor;
}

class BasisReader {
 public:
  BasisReader(const Safetensors& file, const std::filesystem::path& path) : file_(file), path_(path) {}

  template <typename T>
  void read(const std::string& name, std::vector<T>& values) const {
    const auto found = file_.tensors.find(name);
    if (found == file_.tensors.end()) refuse("tensor '" + name + "' is missing");
    const Tensor& tensor = found->second;
    if (tensor.dtype != dtype_of<T>()) {
      refuse("tensor '" + name + "' has type " + tensor.dtype + ", expected " + dtype_of<T>());
    }
    if (tensor.bytes.size() % sizeof(T) != 0) {
      refuse("tensor '" + name + "' has " + std::to_string(tensor.bytes.size()) + " bytes, expected a multiple of " +
             std::to_string(sizeof(T)));
    }
    values.resize(tensor.bytes.size() / sizeof(T));
    if (!values.empty()) std::memcpy(static_cast<void*>(values.data()), tensor.bytes.data(), tensor.bytes.size());
  }

  std::string metadata(const std::string& key) const {
    const auto found = file_.metadata.find(key);
    if (found == file_.metadata.end()) refuse("its metadata lacks '" + key + "'");
    return found->second;
  }

  std::vector<std::string> strings(const std::string& key) const {
    const nlohmann::json list = nlohmann::json::parse(metadata(key), nullptr, false);
    std::vector<std::string> values;
    if (!list.is_array()) refuse("its metadata '" + key + "' is not a list of strings");
    for (const auto& value : list) {
      if (!value.is_string()) refuse("its metadata '" + key + "' is not a list of strings");
      values.push_back(value.get<std::string>());
    }
    return values;
  }

  [[noreturn]] void refuse(const std::string& what) const {
    throw Error(ErrorKind::file, path_.string() + ": " + what + " (not a basis, or one of another version)");
  }

 private:
  const Safetensors& file_;
  const std::filesystem::path& path_;
};

Skeleton read_skeleton(const BasisReader& reader) {
  Skeleton skeleton;
  const std::vector<std::string> names = reader.strings("joint_names");
  std::vector<double> numbers;
  std::vector<std::uint32_t> parents;
  reader.read("skeleton.joints", numbers);
  reader.read("skeleton.parents", parents);
  if (numbers.size() != names.size() * kJointNumbers || parents.size() != names.size()) {
    reader.refuse("it names " + std::to_string(names.size()) + " joints, but has the numbers of " +
                  std::to_string(numbers.size() / kJointNumbers));
  }
  for (std::size_t j = 0; j < names.size(); ++j) {
    const double* row = numbers.data() + j * kJointNumbers;
    Joint joint;
    joint.name = names[j];
    joint.parent = static_cast<int>(parents[j]) - 1;
    joint.bind = transform_at(row);
    joint.default_local = transform_at(row + 10);
    for (int i = 0; i < 3; ++i) std::copy(row + 20 + 4 * i, row + 24 + 4 * i, joint.inverse_bind.m[i]);
    skeleton.joints.push_back(joint);
  }
  return skeleton;
}

}  // namespace

void save_basis(const Basis& basis, const std::filesystem::path& path) {
  validate(basis, "the basis to be saved");
  Safetensors file;
  file.metadata = basis.metadata;
  std::vector<std::string> names;
  std::vector<std::uint32_t> parents;  // plus one, so that a root is 0
  for (const Joint& joint : basis.skeleton.joints) {
    names.push_back(joint.name);
    parents.push_back(static_cast<std::uint32_t>(joint.parent + 1));
  }
  file.tensors["skeleton.joints"] = joint_tensor(basis.skeleton);
  file.tensors["skeleton.parents"] = tensor_from(parents);
  for_each_array(basis, [&](const char* name, const auto& values) { file.tensors[name] = tensor_from(values); });
  file.metadata["schema"] = kSchema;
  file.metadata["joint_names"] = nlohmann::json(names).dump();
  file.metadata["fibre_names"] = nlohmann::json(basis.strain.names).dump();
  file.metadata["controls"] = nlohmann::json(basis.residual.controls).dump();
  file.metadata["checksum"] = tensor_checksum(file);
  write_safetensors(file, path);
}

Basis load_basis(const std::filesystem::path& path) {
  const Safetensors file = read_safetensors(path);
  const BasisReader reader(file, path);
  if (reader.metadata("schema") != kSchema) {
    reader.refuse("its schema is '" + reader.metadata("schema") + "', expected '" + kSchema + "'");
  }
  reader.metadata("checksum");
  Basis basis;
  basis.skeleton = read_skeleton(reader);
  for_each_array(basis, [&](const char* name, auto& values) { reader.read(name, values); });
  basis.strain.names = reader.strings("fibre_names");
  basis.residual.controls = reader.strings("controls");
  basis.metadata = file.metadata;
  for (const char* own : {"schema", "joint_names", "fibre_names", "controls", "checksum"}) basis.metadata.erase(own);
  validate(basis, path.string());
  return basis;
}

std::map<std::string, std::size_t> table_bytes(const Basis& basis) {
  std::map<std::string, std::size_t> bytes = {{"ddm", 0}, {"strain", 0}, {"residual", 0}};
  for_each_array(basis, [&](const std::string& name, const auto& values) {
    const auto stage = bytes.find(name.substr(0, name.find('.')));
    if (stage != bytes.end()) stage->second += values.size() * sizeof(values[0]);
  });
  return bytes;
}

std::uint64_t topology_hash(const MeshTable& mesh) {
  XXH3_state_t* state = XXH3_createState();
  XXH3_64bits_reset(state);
  for (const auto* array : {&mesh.triangles, &mesh.output_vertex, &mesh.output_triangles}) {
    const std::uint64_t size = array->size();
    XXH3_64bits_update(state, &size, sizeof(size));
    XXH3_64bits_update(state, array->data(), array->size() * sizeof(std::uint32_t));
  }
  const std::uint64_t digest = XXH3_64bits_digest(state);
  XXH3_freeState(state);
  return digest;
}

}  // namespace bodyopt
