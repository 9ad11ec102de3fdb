// A basis as safetensors: one tensor per array of basis.h, named <table>.<array>; names and other strings as metadata.
#include <xxhash.h>

#include <cstring>
#include <nlohmann/json.hpp>
#include <set>
#include <type_traits>

#include "runtime/basis/basis.h"
#include "runtime/basis/error.h"
#include "runtime/basis/safetensors.h"
#include "runtime/basis/strict_json.h"

namespace bodyopt {
namespace {

constexpr const char* kSchema = "bodyopt-basis-2";
constexpr std::size_t kJointNumbers = 10 + 10 + 12;  // bind, default local, inverse bind

// A record of 4-byte scalars is stored as rows of U32 or F32 words; mixed records as U32.
template <typename T>
constexpr const char* dtype_of() {
  if constexpr (std::is_same_v<T, float> || std::is_same_v<T, FeatureRange>) return "F32";
  if constexpr (std::is_same_v<T, double>) return "F64";
  return "U32";
}

template <typename T>
constexpr std::uint64_t words_of() {
  return sizeof(T) / (std::is_same_v<T, double> ? 8 : 4);
}

// The shape of `count` values, `width` of them to a row: count, or rows x words.
template <typename T>
std::vector<std::uint64_t> shape_of(std::size_t count, std::uint64_t width) {
  const std::uint64_t words = width * words_of<T>();
  if (words == 1) return {count};
  return {count / width, words};
}

template <typename T>
Tensor tensor_from(const std::vector<T>& values, std::uint64_t width) {
  static_assert(std::is_trivially_copyable_v<T>);
  Tensor tensor{dtype_of<T>(), shape_of<T>(values.size(), width), {}};
  tensor.bytes.resize(values.size() * sizeof(T));
  if (!values.empty()) std::memcpy(tensor.bytes.data(), values.data(), tensor.bytes.size());
  return tensor;
}

// Applies `visit(name, array, values to a row)` to every array of the tables.
template <typename BasisType, typename Visit>
void for_each_array(BasisType& basis, Visit visit) {
  visit("mesh.rest", basis.mesh.rest, 3);
  visit("mesh.triangles", basis.mesh.triangles, 3);
  visit("mesh.output_vertex", basis.mesh.output_vertex, 1);
  visit("mesh.output_triangles", basis.mesh.output_triangles, 3);
  visit("mesh.vertex_triangle_begin", basis.mesh.vertex_triangle_begin, 1);
  visit("mesh.vertex_triangles", basis.mesh.vertex_triangles, 1);
  visit("ddm.block_begin", basis.ddm.block_begin, 1);
  visit("ddm.block_joints", basis.ddm.block_joints, 1);
  visit("ddm.moments", basis.ddm.moments, kMomentWords * kBlockSize);
  visit("ddm.vertices", basis.ddm.vertices, 1);
  visit("strain.vertices", basis.strain.vertices, 1);
  visit("strain.points", basis.strain.points, 1);
  visit("strain.fibre_begin", basis.strain.fibre_begin, 1);
  visit("strain.rest_length", basis.strain.rest_length, 1);
  visit("residual.features", basis.residual.features, 1);
  visit("residual.regions", basis.residual.regions, 1);
  visit("residual.region_features", basis.residual.region_features, 1);
  visit("residual.centre_region", basis.residual.centre_region, 1);
  visit("residual.centres", basis.residual.centres, 1);
  visit("residual.coefficient_region", basis.residual.coefficient_region, 1);
  visit("residual.weights", basis.residual.weights, 1);
  visit("residual.blend_begin", basis.residual.blend_begin, 1);
  visit("residual.blend", basis.residual.blend, 1);
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

std::vector<double> joint_numbers(const Skeleton& skeleton) {
  std::vector<double> values;
  for (const Joint& joint : skeleton.joints) {
    append_transform(values, joint.bind);
    append_transform(values, joint.default_local);
    for (const auto& row : joint.inverse_bind.m) values.insert(values.end(), row, row + 4);
  }
  return values;
}

std::string list_text(const std::vector<std::string>& names, const std::filesystem::path& path) {
  try {
    return nlohmann::json(names).dump();
  } catch (const nlohmann::json::exception& error) {
    throw Error(ErrorKind::file,
                path.string() + ": cannot be written: a name is not UTF-8 text (" + error.what() + ")");
  }
}

class BasisReader {
 public:
  BasisReader(const Safetensors& file, const std::filesystem::path& path) : file_(file), path_(path) {}

  template <typename T>
  void read(const std::string& name, std::vector<T>& values, std::uint64_t width) {
    const auto found = file_.tensors.find(name);
    if (found == file_.tensors.end()) refuse("tensor '" + name + "' is missing");
    const Tensor& tensor = found->second;
    if (tensor.dtype != dtype_of<T>()) {
      refuse("tensor '" + name + "' has type " + tensor.dtype + ", expected " + dtype_of<T>());
    }
    const std::size_t count = tensor.bytes.size() / sizeof(T);
    if (tensor.shape != shape_of<T>(count, width)) {
      refuse("tensor '" + name + "' has a shape of " + std::to_string(tensor.shape.size()) +
             " dimensions whose rows are not of " + std::to_string(width * words_of<T>()) + " values");
    }
    known_.insert(name);
    values.resize(count);
    if (!values.empty()) std::memcpy(static_cast<void*>(values.data()), tensor.bytes.data(), tensor.bytes.size());
  }

  std::string metadata(const std::string& key) const {
    const auto found = file_.metadata.find(key);
    if (found == file_.metadata.end()) refuse("its metadata lacks '" + key + "'");
    return found->second;
  }

  std::vector<std::string> strings(const std::string& key) const {
    const auto list = parse_strict_json<nlohmann::json>(metadata(key), path_.string() + ", metadata '" + key + "'");
    std::vector<std::string> values;
    if (!list.is_array()) refuse("its metadata '" + key + "' is not a list of strings");
    for (const auto& value : list) {
      if (!value.is_string()) refuse("its metadata '" + key + "' is not a list of strings");
      values.push_back(value.get<std::string>());
    }
    return values;
  }

  void refuse_unknown_tensors() const {
    for (const auto& [name, tensor] : file_.tensors) {
      if (!known_.contains(name)) refuse("tensor '" + name + "' is not one of a basis");
    }
  }

  [[noreturn]] void refuse(const std::string& what) const {
    throw Error(ErrorKind::file, path_.string() + ": " + what + " (not a basis, or one of another version)");
  }

 private:
  const Safetensors& file_;
  const std::filesystem::path& path_;
  std::set<std::string> known_;  // tensors read so far
};

Skeleton read_skeleton(BasisReader& reader) {
  Skeleton skeleton;
  const std::vector<std::string> names = reader.strings("joint_names");
  std::vector<double> numbers;
  std::vector<std::uint32_t> parents;
  reader.read("skeleton.joints", numbers, kJointNumbers);
  reader.read("skeleton.parents", parents, 1);
  if (numbers.size() != names.size() * kJointNumbers || parents.size() != names.size()) {
    reader.refuse("it names " + std::to_string(names.size()) + " joints, but has the numbers of " +
                  std::to_string(numbers.size() / kJointNumbers));
  }
  for (std::size_t j = 0; j < names.size(); ++j) {
    const double* row = numbers.data() + j * kJointNumbers;
    Joint joint;
    joint.name = names[j];
    if (parents[j] > j) {
      reader.refuse("skeleton.parents[" + std::to_string(j) + "] is " + std::to_string(parents[j]) +
                    ", expected at most " + std::to_string(j) + " (one more than a joint before it, 0 for a root)");
    }
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
  file.tensors["skeleton.joints"] = tensor_from(joint_numbers(basis.skeleton), kJointNumbers);
  file.tensors["skeleton.parents"] = tensor_from(parents, 1);
  for_each_array(basis, [&](const char* name, const auto& values, std::uint64_t width) {
    file.tensors[name] = tensor_from(values, width);
  });
  file.metadata["schema"] = kSchema;
  file.metadata["joint_names"] = list_text(names, path);
  file.metadata["fibre_names"] = list_text(basis.strain.names, path);
  file.metadata["controls"] = list_text(basis.residual.controls, path);
  file.metadata["checksum"] = content_checksum(file);
  write_safetensors(file, path);
}

Basis load_basis(const std::filesystem::path& path) {
  const Safetensors file = read_safetensors(path);
  BasisReader reader(file, path);
  if (reader.metadata("schema") != kSchema) {
    reader.refuse("its schema is '" + reader.metadata("schema") + "', expected '" + kSchema + "'");
  }
  reader.metadata("checksum");
  Basis basis;
  basis.skeleton = read_skeleton(reader);
  for_each_array(basis, [&](const char* name, auto& values, std::uint64_t width) { reader.read(name, values, width); });
  reader.refuse_unknown_tensors();
  basis.strain.names = reader.strings("fibre_names");
  basis.residual.controls = reader.strings("controls");
  basis.metadata = file.metadata;
  for (const char* own : {"schema", "joint_names", "fibre_names", "controls", "checksum"}) basis.metadata.erase(own);
  validate(basis, path.string());
  return basis;
}

std::map<std::string, std::size_t> table_bytes(const Basis& basis) {
  std::map<std::string, std::size_t> bytes = {{"ddm", 0}, {"strain", 0}, {"residual", 0}};
  for_each_array(basis, [&](const std::string& name, const auto& values, std::uint64_t) {
    const auto stage = bytes.find(name.substr(0, name.find('.')));
    if (stage != bytes.end()) stage->second += values.size() * sizeof(values[0]);
  });
  return bytes;
}

std::size_t total_bytes(const Basis& basis) {
  std::size_t bytes = 0;
  for (const auto& [stage, size] : table_bytes(basis)) bytes += size;
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
