// Dynamics as safetensors: one tensor per array of dynamics.h, named <table>.<array>; strings as metadata.
#include <algorithm>

#include "runtime/basis/containers.h"
#include "runtime/basis/dynamics.h"
#include "runtime/basis/table_file.h"

namespace bodyopt {
namespace {

constexpr const char* kDynamicsSchema = "bodyopt-dynamics-1";
constexpr const char* kSkinLimit = "tets.skin_limit";
constexpr const char* kSprings = "jiggle.springs";

template <typename Inverse, typename Visit>
void for_each_array_of(Inverse& inverse, const std::string& table, Visit visit) {
  visit(table + ".inverse.levels", inverse.levels, 1);
  visit(table + ".inverse.slot_unknown", inverse.slot_unknown, 1);
  visit(table + ".inverse.child_slots", inverse.child_slots, 2);
  visit(table + ".inverse.up", inverse.up, 1);
  visit(table + ".inverse.down", inverse.down, 1);
  visit(table + ".inverse.values", inverse.values, 1);
}

// Applies `visit(name, array, values to a row)` to every array of the tables.
template <typename DynamicsType, typename Visit>
void for_each_dynamics_array(DynamicsType& dynamics, Visit visit) {
  auto& tets = dynamics.tets;
  visit("tets.nodes", tets.nodes, 3);
  visit("tets.tets", tets.tets, 4);
  visit("tets.shapes", tets.shapes, 1);
  visit("tets.corner_begin", tets.corner_begin, 1);
  visit("tets.corners", tets.corners, 1);
  visit("tets.surface", tets.surface, 1);
  visit("tets.skin", tets.skin, 1);
  visit(kSkinLimit, tets.skin_limit, 1);
  auto& diffuse = dynamics.diffuse;
  visit("diffuse.row_begin", diffuse.row_begin, 1);
  visit("diffuse.columns", diffuse.columns, 1);
  visit("diffuse.values", diffuse.values, 1);
  for_each_array_of(diffuse.inverse, "diffuse", visit);
  auto& jiggle = dynamics.jiggle;
  visit("jiggle.nodes", jiggle.nodes, 1);
  for_each_array_of(jiggle.inverse, "jiggle", visit);
  visit(kSprings, jiggle.springs, 1);
}

// The step as a row of numbers.
std::vector<float> step_numbers(const JiggleStep& step) {
  return {step.frames_per_second, static_cast<float>(step.substeps), step.implicit_euler ? 1.0f : 0.0f,
          step.stiffness_damping};
}

JiggleStep read_step(TableReader& reader) {
  constexpr float kMostSubsteps = 1024;
  std::vector<float> numbers;
  reader.read("jiggle.step", numbers, 4);
  if (numbers.size() != 4) reader.refuse("jiggle.step has ", numbers.size() / 4, " rows, expected 1");
  JiggleStep step;
  step.frames_per_second = numbers[0];
  step.substeps = numbers[1] >= 1 && numbers[1] <= kMostSubsteps ? static_cast<std::uint32_t>(numbers[1]) : 0;
  step.implicit_euler = numbers[2] == 1;
  step.stiffness_damping = numbers[3];
  if (step_numbers(step) != numbers) {
    reader.refuse("jiggle.step is not of finite numbers with 1 to 1024 substeps and 0 or 1 for implicit Euler");
  }
  return step;
}

// Files of earlier versions have the springs as rows of the matrix that a solver of theirs took, with inertia and
// damping in them.
void read_rows_of_springs(TableReader& reader, JiggleTable& jiggle) {
  std::vector<std::uint32_t> begin;
  std::vector<float> values;
  reader.read("jiggle.held_begin", begin, 1);
  reader.read("jiggle.held_values", values, 1);
  for (const char* unused : {"jiggle.held_columns", "jiggle.elasticity"}) reader.pass_over(unused);
  if (begin.size() != jiggle.nodes.size() + 1 || !std::ranges::is_sorted(begin) || begin.back() > values.size()) {
    reader.refuse("jiggle.held_begin does not fit jiggle.nodes and jiggle.held_values");
  }
  const double damped = 1 + static_cast<double>(jiggle.step.stiffness_damping / jiggle.step.stage());
  for (std::size_t n = 0; n < jiggle.nodes.size(); ++n) {
    double row = -static_cast<double>(jiggle.nodes[n].inertia);
    for (std::uint32_t k = begin[n]; k < begin[n + 1]; ++k) row += static_cast<double>(values[k]);
    jiggle.springs.push_back(static_cast<float>(row / damped));
  }
}

Safetensors container(const Dynamics& dynamics) {
  Safetensors file;
  file.metadata = dynamics.metadata;
  for_each_dynamics_array(dynamics, [&](const std::string& name, const auto& values, std::uint64_t width) {
    file.tensors[name] = tensor_from(values, width);
  });
  // As files of earlier versions are, so that a state that belongs to one still does.
  if (std::ranges::all_of(dynamics.tets.skin_limit, [](float limit) { return limit == kNoLimit; })) {
    file.tensors.erase(kSkinLimit);
  }
  file.tensors["jiggle.step"] = tensor_from(step_numbers(dynamics.jiggle.step), 4);
  file.metadata["schema"] = kDynamicsSchema;
  return file;
}

}  // namespace

JiggleStep read_step(const Safetensors& file, const std::filesystem::path& path) {
  TableReader reader(file, path, "dynamics");
  return read_step(reader);
}

void save_dynamics(const Dynamics& dynamics, const std::filesystem::path& path) {
  Safetensors file = container(dynamics);
  file.metadata["checksum"] = content_checksum(file);
  write_safetensors(file, path);
}

std::filesystem::path dynamics_beside(std::filesystem::path basis) {
  return basis.replace_extension(".dynamics.safetensors");
}

std::string checksum(const Dynamics& dynamics) {
  return dynamics.file_checksum.empty() ? content_checksum(container(dynamics)) : dynamics.file_checksum;
}

Dynamics load_dynamics(const std::filesystem::path& path, const Basis& basis) {
  return dynamics_in(read_safetensors(path), path, basis);
}

Dynamics dynamics_in(const Safetensors& file, const std::filesystem::path& path, const Basis& basis) {
  TableReader reader(file, path, "dynamics");
  reader.require_schema(kDynamicsSchema);
  Dynamics dynamics;
  const bool has_rows = file.tensors.contains("jiggle.held_begin");
  for_each_dynamics_array(dynamics, [&](const std::string& name, auto& values, std::uint64_t width) {
    const bool may_lack = name == kSkinLimit || (name == kSprings && has_rows);
    if (!may_lack || file.tensors.contains(name)) reader.read(name, values, width);
  });
  if (!file.tensors.contains(kSkinLimit)) dynamics.tets.skin_limit.assign(dynamics.tets.skin.size(), kNoLimit);
  dynamics.jiggle.step = read_step(reader);
  if (has_rows) read_rows_of_springs(reader, dynamics.jiggle);
  reader.refuse_unknown_tensors();
  dynamics.diffuse.inverse.unknown_count = dynamics.tets.node_count();
  dynamics.jiggle.inverse.unknown_count = 3 * dynamics.tets.node_count();
  dynamics.metadata = file.metadata;
  dynamics.file_checksum = reader.metadata("checksum");
  for (const char* own : {"schema", "checksum"}) dynamics.metadata.erase(own);
  validate(dynamics, basis, path.string());
  return dynamics;
}

std::map<std::string, std::size_t> table_bytes(const Dynamics& dynamics) {
  std::map<std::string, std::size_t> bytes = {{"diffuse", 0}, {"jiggle", 0}};
  for_each_dynamics_array(dynamics, [&](const std::string& name, const auto& values, std::uint64_t) {
    bytes[name.starts_with("jiggle.") ? "jiggle" : "diffuse"] += values.size() * sizeof(values[0]);
  });
  return bytes;
}

}  // namespace bodyopt
