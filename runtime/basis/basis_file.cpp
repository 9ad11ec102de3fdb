// A basis as safetensors: one tensor per array of basis.h, named <table>.<array>; names and other strings as metadata.
// Names of further levels of detail begin with "level1." and so on, in both.
#include <xxhash.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "runtime/basis/basis.h"
#include "runtime/basis/containers.h"
#include "runtime/basis/earlier_tables.h"
#include "runtime/basis/levels.h"
#include "runtime/basis/skin_modifiers.h"
#include "runtime/basis/table_file.h"
#include "runtime/core/error.h"
#include "runtime/core/json.h"
#include "runtime/core/transformed.h"

namespace bodyopt {
namespace {

constexpr const char *kSchema = "bodyopt-basis-3", *kEarlierSchema = "bodyopt-basis-2";
constexpr const char *kModifiers = "modifiers", *kModifierBegin = "modifiers.blend_begin",
                     *kModifierBlend = "modifiers.blend";
constexpr const char *kCoverageNames = "coverage_names", *kEarlierCoverage = "coverage",
                     *kCoverageBegin = "coverage.joint_begin";
constexpr const char *kFeatureJoints = "skeleton.feature_joints", *kFeatureTurns = "skeleton.feature_turns",
                     *kFeatureScales = "skeleton.feature_scales";
constexpr const char *kCarried = "carried.points", *kCarriedStep = "carried.step";
constexpr std::size_t kJointNumbers = 10 + 10 + 12;  // bind, default local, inverse bind
constexpr std::size_t kTurnNumbers = 4 + 4;          // turn above, own turn

// Applies `visit(name, array, values to a row)` to every array of mesh, ddm, strain and residual that the earlier
// schema has in the same form.
template <typename BasisType, typename Visit>
void for_each_lasting_array(BasisType& basis, Visit visit) {
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
  visit("residual.region_features", basis.residual.region_features, 1);
  visit("residual.centre_region", basis.residual.centre_region, 1);
  visit("residual.centres", basis.residual.centres, 1);
  visit("residual.coefficient_region", basis.residual.coefficient_region, 1);
  visit("residual.weights", basis.residual.weights, 1);
  visit("residual.blend_begin", basis.residual.blend_begin, 1);
  visit("residual.blend", basis.residual.blend, 1);
}

// Applies `visit` to the residual's newer arrays, too.
template <typename BasisType, typename Visit>
void for_each_array(BasisType& basis, Visit visit) {
  for_each_lasting_array(basis, visit);
  visit("residual.regions", basis.residual.regions, 1);
  visit("residual.coordinate_region", basis.residual.coordinate_region, 1);
  visit("residual.projections", basis.residual.projections, 1);
  auto& fade = basis.residual.fade;
  visit("residual.fade.joint_begin", fade.joint_begin, 1);
  visit("residual.fade.joints", fade.joints, 1);
  visit("residual.fade.direction_begin", fade.direction_begin, 1);
  visit("residual.fade.directions", fade.directions, 1);
  visit("residual.fade.tolerance", fade.tolerance, 1);
  visit("residual.fade.region_begin", fade.region_begin, 1);
  visit("residual.fade.region_joints", fade.region_joints, 1);
  visit("residual.fade.region_weights", fade.region_weights, 1);
}

// Applies `visit(name, array)` to the arrays of a basis that knows its error.
template <typename Table, typename Visit>
void for_each_coverage_array(Table& coverage, Visit visit) {
  visit(kCoverageBegin, coverage.joint_begin);
  visit("coverage.joints", coverage.joints);
  visit("coverage.sizes", coverage.sizes);
  visit("coverage.growth", coverage.growth);
  visit("coverage.usual", coverage.usual);
  visit("coverage.local", coverage.local);
  visit("coverage.motion", coverage.motion);
  visit("coverage.metric", coverage.metric);
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
  return strict_json_text(names, path.string());
}

std::vector<std::string> strings(const TableReader& reader, const std::string& key, const std::filesystem::path& path) {
  const auto list = parse_strict_json(reader.metadata(key), path.string() + ", metadata '" + key + "'");
  std::vector<std::string> values;
  if (!list.is_array()) reader.refuse("its metadata '", key, "' is not a list of strings");
  for (const auto& value : list) {
    if (!value.is_string()) reader.refuse("its metadata '", key, "' is not a list of strings");
    values.push_back(value.get<std::string>());
  }
  return values;
}

// A file whose features are those of its own joints stays as it was before there were others.
void add_joint_features(Safetensors& file, const std::vector<JointFeatures>& features) {
  if (features.empty()) return;
  std::vector<std::uint32_t> joints;
  std::vector<double> turns;
  for (const JointFeatures& of : features) {
    joints.insert(joints.end(), {of.joint, of.above});
    turns.insert(turns.end(), of.above_turn.begin(), of.above_turn.end());
    turns.insert(turns.end(), of.own_turn.begin(), of.own_turn.end());
  }
  file.tensors[kFeatureJoints] = tensor_from(joints, 2);
  file.tensors[kFeatureTurns] = tensor_from(turns, kTurnNumbers);
  const std::vector<double> scales = transformed(features, &JointFeatures::per_metre);
  const bool slide = std::ranges::any_of(scales, [](const double scale) { return scale != 0; });
  if (slide) file.tensors[kFeatureScales] = tensor_from(scales, 1);
}

std::vector<JointFeatures> read_joint_features(const Safetensors& file, TableReader& reader) {
  std::vector<std::uint32_t> joints;
  std::vector<double> turns, scales;
  reader.read(kFeatureJoints, joints, 2);
  reader.read(kFeatureTurns, turns, kTurnNumbers);
  if (file.tensors.contains(kFeatureScales)) reader.read(kFeatureScales, scales, 1);
  std::vector<JointFeatures> features(joints.size() / 2);
  if (!scales.empty() && scales.size() != features.size()) {
    reader.refuse("it has the joints of ", features.size(), " groups of features, and the scales of ", scales.size());
  }
  if (turns.size() != features.size() * kTurnNumbers) {
    reader.refuse("it has the joints of ", features.size(), " groups of features, and the turns of ",
                  turns.size() / kTurnNumbers);
  }
  for (std::size_t k = 0; k < features.size(); ++k) {
    const double* row = turns.data() + k * kTurnNumbers;
    features[k] = {joints[2 * k], joints[2 * k + 1]};
    std::copy(row, row + 4, features[k].above_turn.begin());
    std::copy(row + 4, row + 8, features[k].own_turn.begin());
    if (!scales.empty()) features[k].per_metre = scales[k];
  }
  return features;
}

Skeleton read_skeleton(const Safetensors& file, TableReader& reader, const std::filesystem::path& path) {
  Skeleton skeleton;
  const std::vector<std::string> names = strings(reader, "joint_names", path);
  std::vector<double> numbers;
  std::vector<std::uint32_t> parents;
  reader.read("skeleton.joints", numbers, kJointNumbers);
  reader.read("skeleton.parents", parents, 1);
  if (numbers.size() != names.size() * kJointNumbers || parents.size() != names.size()) {
    reader.refuse("it names ", names.size(), " joints, but has the numbers of ", numbers.size() / kJointNumbers);
  }
  for (std::size_t j = 0; j < names.size(); ++j) {
    const double* row = numbers.data() + j * kJointNumbers;
    Joint joint;
    joint.name = names[j];
    if (parents[j] > j) {
      reader.refuse("skeleton.parents[", j, "] is ", parents[j], ", expected at most ", j,
                    " (one more than a joint before it, 0 for a root)");
    }
    joint.parent = static_cast<int>(parents[j]) - 1;
    joint.bind = transform_at(row);
    joint.default_local = transform_at(row + 10);
    for (int i = 0; i < 3; ++i) std::copy(row + 20 + 4 * i, row + 24 + 4 * i, joint.inverse_bind.m[i]);
    skeleton.joints.push_back(joint);
  }
  if (file.tensors.contains(kFeatureJoints)) skeleton.features = read_joint_features(file, reader);
  return skeleton;
}

std::string prefix_of(std::size_t level) { return level == 0 ? "" : "level" + std::to_string(level) + "."; }

// Counts levels, whose tensors are numbered in order; a file without further levels has one.
std::size_t level_count(const Safetensors& file) {
  std::size_t count = 1;
  while (count < kMostLevels && file.tensors.contains(prefix_of(count) + "mesh.rest")) ++count;
  return count;
}

void add_skeleton(Safetensors& file, const Skeleton& skeleton, const std::filesystem::path& path) {
  std::vector<std::string> names;
  std::vector<std::uint32_t> parents;  // plus one, so that a root is 0
  for (const Joint& joint : skeleton.joints) {
    names.push_back(joint.name);
    parents.push_back(static_cast<std::uint32_t>(joint.parent + 1));
  }
  file.tensors["skeleton.joints"] = tensor_from(joint_numbers(skeleton), kJointNumbers);
  file.tensors["skeleton.parents"] = tensor_from(parents, 1);
  file.metadata["joint_names"] = list_text(names, path);
  add_joint_features(file, skeleton.features);
}

// A file without modifiers is what it was before there were any.
void add_modifiers(Safetensors& file, const SkinModifiers& modifiers, const std::string& prefix,
                   const std::filesystem::path& path) {
  if (modifiers.empty()) return;
  file.metadata[prefix + kModifiers] = text_of_stack(modifiers.stack, path.string());
  file.tensors[prefix + kModifierBegin] = tensor_from(modifiers.blend_begin, 1);
  file.tensors[prefix + kModifierBlend] = tensor_from(modifiers.blend, 1);
}

SkinModifiers read_modifiers(TableReader& reader, const std::string& prefix, const std::filesystem::path& path) {
  SkinModifiers modifiers;
  modifiers.stack = stack_from_text(reader.metadata(prefix + kModifiers), path.string() + ", metadata 'modifiers'");
  reader.read(prefix + kModifierBegin, modifiers.blend_begin, 1);
  reader.read(prefix + kModifierBlend, modifiers.blend, 1);
  return modifiers;
}

void add_coverage(Safetensors& file, const CoverageTable& coverage, const std::string& prefix,
                  const std::filesystem::path& path) {
  if (coverage.empty()) return;
  file.metadata[prefix + kCoverageNames] = list_text(coverage.names, path);
  for_each_coverage_array(
      coverage, [&](const char* name, const auto& values) { file.tensors[prefix + name] = tensor_from(values, 1); });
}

CoverageTable read_coverage(const Safetensors& file, TableReader& reader, const std::string& prefix,
                            const std::filesystem::path& path, const Basis& basis) {
  CoverageTable coverage;
  if (file.tensors.contains(prefix + kCoverageBegin)) {
    coverage.names = strings(reader, prefix + kCoverageNames, path);
    for_each_coverage_array(coverage, [&](const char* name, auto& values) { reader.read(prefix + name, values, 1); });
  } else if (file.metadata.contains(prefix + kEarlierCoverage)) {
    coverage = earlier_coverage(reader.metadata(prefix + kEarlierCoverage), basis,
                                path.string() + ", metadata '" + kEarlierCoverage + "'");
  }
  return coverage;
}

// All but the skeleton, which levels share.
void add_tables(Safetensors& file, const Basis& basis, const std::string& prefix, const std::filesystem::path& path) {
  for (const auto& [key, text] : basis.metadata) file.metadata[prefix + key] = text;
  for_each_array(basis, [&](const char* name, const auto& values, std::uint64_t width) {
    file.tensors[prefix + name] = tensor_from(values, width);
  });
  file.metadata[prefix + "fibre_names"] = list_text(basis.strain.names, path);
  file.metadata[prefix + "controls"] = list_text(basis.residual.controls, path);
  add_coverage(file, basis.coverage, prefix, path);
  add_modifiers(file, basis.modifiers, prefix, path);
}

CarriedSkin read_carried(TableReader& reader, const std::string& prefix) {
  CarriedSkin carried;
  std::vector<float> step;
  reader.read(prefix + kCarried, carried.points, 1);
  reader.read(prefix + kCarriedStep, step, 1);
  if (step.size() != 1) reader.refuse("tensor '", prefix, kCarriedStep, "' is not of one number");
  carried.step = step.front();
  return carried;
}

void read_tables(TableReader& reader, const std::string& prefix, bool earlier, Basis& basis) {
  const auto read = [&](const char* name, auto& values, std::uint64_t width) {
    reader.read(prefix + name, values, width);
  };
  if (!earlier) return for_each_array(basis, read);
  for_each_lasting_array(basis, read);
  std::vector<EarlierRegion> regions;
  read("residual.regions", regions, 1);
  for (const EarlierRegion& region : regions) {
    // Far more than a trainer gave one, and few enough to be rows of coordinates.
    constexpr std::uint32_t kMostFeatures = 4096;
    if (region.feature_count <= kMostFeatures) continue;
    reader.refuse("a region listens to ", region.feature_count, " features, expected at most ", kMostFeatures);
  }
  take_earlier_regions(regions, basis.residual);
}

void write(Safetensors& file, const std::filesystem::path& path) {
  file.metadata["schema"] = kSchema;
  file.metadata["checksum"] = content_checksum(file);
  write_safetensors(file, path);
}

// The metadata of one of `count` levels, by the names they have in an ordinary basis, without the file's own.
Metadata metadata_of(const Safetensors& file, std::size_t level, std::size_t count) {
  Metadata metadata;
  for (const auto& [key, text] : file.metadata) {
    std::size_t owner = 0;
    for (std::size_t k = 1; k < count; ++k) owner = key.starts_with(prefix_of(k)) ? k : owner;
    if (owner == level) metadata[key.substr(prefix_of(level).size())] = text;
  }
  for (const char* own :
       {"schema", "joint_names", "fibre_names", "controls", kCoverageNames, kEarlierCoverage, kModifiers, "checksum"})
    metadata.erase(own);
  return metadata;
}

}  // namespace

void save_basis(const Basis& basis, const std::filesystem::path& path) {
  validate(basis, "the basis to be saved");
  Safetensors file;
  add_skeleton(file, basis.skeleton, path);
  add_tables(file, basis, "", path);
  write(file, path);
}

void save_levels(const std::vector<Level>& levels, const std::filesystem::path& path) {
  validate(levels, "the levels to be saved");
  Safetensors file;
  add_skeleton(file, levels.front().basis.skeleton, path);
  for (std::size_t k = 0; k < levels.size(); ++k) {
    add_tables(file, levels[k].basis, prefix_of(k), path);
    if (levels[k].carried.empty()) continue;
    file.tensors[prefix_of(k) + kCarried] = tensor_from(levels[k].carried.points, 1);
    file.tensors[prefix_of(k) + kCarriedStep] = tensor_from(std::vector<float>{levels[k].carried.step}, 1);
  }
  write(file, path);
}

std::filesystem::path proxy_beside(std::filesystem::path basis) {
  return basis.replace_extension(".proxy.safetensors");
}

std::vector<Level> load_levels(const std::filesystem::path& path) { return levels_in(read_safetensors(path), path); }

std::vector<Level> levels_in(const Safetensors& file, const std::filesystem::path& path) {
  TableReader reader(file, path, "a basis");
  const bool earlier = reader.metadata("schema") == kEarlierSchema;
  reader.require_schema(earlier ? kEarlierSchema : kSchema);
  std::vector<Level> levels(level_count(file));
  levels.front().basis.skeleton = read_skeleton(file, reader, path);
  for (std::size_t k = 0; k < levels.size(); ++k) {
    const std::string prefix = prefix_of(k);
    Basis& basis = levels[k].basis;
    if (k > 0) basis.skeleton = levels.front().basis.skeleton;
    read_tables(reader, prefix, earlier, basis);
    basis.strain.names = strings(reader, prefix + "fibre_names", path);
    basis.residual.controls = strings(reader, prefix + "controls", path);
    basis.coverage = read_coverage(file, reader, prefix, path, basis);
    if (file.metadata.contains(prefix + kModifiers)) basis.modifiers = read_modifiers(reader, prefix, path);
    basis.metadata = metadata_of(file, k, levels.size());
    if (file.tensors.contains(prefix + kCarried) || file.tensors.contains(prefix + kCarriedStep)) {
      levels[k].carried = read_carried(reader, prefix);
    }
  }
  reader.refuse_unknown_tensors();
  validate(levels, path.string());
  return levels;
}

// The first level on its own has no others for its metadata to name.
Basis load_basis(const std::filesystem::path& path) {
  Basis basis = std::move(load_levels(path).front().basis);
  basis.metadata.erase("levels");
  return basis;
}

std::map<std::string, std::size_t> table_bytes(const Basis& basis) {
  std::map<std::string, std::size_t> bytes = {{"ddm", 0}, {"strain", 0}, {"residual", 0}};
  for_each_array(basis, [&](const std::string& name, const auto& values, std::uint64_t) {
    const auto stage = bytes.find(name.substr(0, name.find('.')));
    if (stage != bytes.end()) stage->second += values.size() * sizeof(values[0]);
  });
  const SkinModifiers& modifiers = basis.modifiers;
  if (!modifiers.empty()) {
    bytes["modify"] =
        modifiers.blend_begin.size() * sizeof(std::uint32_t) + modifiers.blend.size() * sizeof(BlendEntry);
  }
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
