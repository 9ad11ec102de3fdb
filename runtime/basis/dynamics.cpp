#include "runtime/basis/dynamics.h"

#include <algorithm>
#include <cmath>

#include "runtime/basis/containers.h"
#include "runtime/basis/table_checks.h"
#include "runtime/basis/table_file.h"
#include "runtime/core/text.h"

namespace bodyopt {
namespace {

// Dynamics as safetensors: one tensor per array of dynamics.h, named <table>.<array>; strings as metadata.

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

// Files of earlier versions have the springs as rows of their solver's matrix, with inertia and damping in them.
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
  // Files of earlier versions have none: the checksum stays, so that a state that belongs to one still does.
  if (std::ranges::all_of(dynamics.tets.skin_limit, [](float limit) { return limit == kNoLimit; })) {
    file.tensors.erase(kSkinLimit);
  }
  file.tensors["jiggle.step"] = tensor_from(step_numbers(dynamics.jiggle.step), 4);
  file.metadata["schema"] = kDynamicsSchema;
  return file;
}

constexpr std::size_t kMostNodes = std::size_t{1} << 24;

struct InverseName {
  const char *levels, *slots, *children, *up, *down, *values;
};
constexpr InverseName kDiffuse = {"diffuse.inverse.levels",      "diffuse.inverse.slot_unknown",
                                  "diffuse.inverse.child_slots", "diffuse.inverse.up",
                                  "diffuse.inverse.down",        "diffuse.inverse.values"};
constexpr InverseName kJiggle = {"jiggle.inverse.levels", "jiggle.inverse.slot_unknown", "jiggle.inverse.child_slots",
                                 "jiggle.inverse.up",     "jiggle.inverse.down",         "jiggle.inverse.values"};

// A solve reads only what is there and was made before, and makes every unknown from `first` on once.
class InverseValidator : TableChecks {
 public:
  InverseValidator(const BlockInverse& inverse, const InverseName& name, std::size_t first, std::size_t unknowns,
                   const std::string& origin)
      : TableChecks(origin), inverse_(inverse), name_(name), first_(first), unknowns_(unknowns) {}

  void run() const {
    if (inverse_.unknown_count != unknowns_) {
      refuse(name_.slots, " is of ", inverse_.unknown_count, " unknowns, expected ", unknowns_);
    }
    expect_below(name_.slots, inverse_.slot_unknown, unknowns_);
    expect_size(name_.children, inverse_.child_slots.size(), 2 * inverse_.slot_unknown.size());
    expect_numbers(name_.values, inverse_.values);
    check_levels();
    check_owners();
    for (const InverseLevel& level : inverse_.levels) {
      check_children(level);
      check_panels(name_.up, inverse_.up, {level.up_begin, level.up_end}, {level.first_slot, level.end_slot},
                   {level.first_slot, level.own_end});
      check_panels(name_.down, inverse_.down, {level.down_begin, level.down_end}, {level.first_slot, level.own_end},
                   {level.own_end, level.end_slot});
    }
  }

 private:
  struct Range {
    std::uint32_t begin, end;
  };

  void check_levels() const {
    std::uint32_t slots = 0, up = 0, down = 0;
    for (std::size_t k = 0; k < inverse_.levels.size(); ++k) {
      const InverseLevel& level = inverse_.levels[k];
      if (level.first_slot != slots || level.own_end < slots || level.end_slot < level.own_end ||
          level.up_begin != up || level.up_end < up || level.down_begin != down || level.down_end < down) {
        refuse(element(name_.levels, k), " has ranges that do not follow the level before it");
      }
      slots = level.end_slot;
      up = level.up_end;
      down = level.down_end;
    }
    expect_size(name_.slots, inverse_.slot_unknown.size(), slots);
    expect_size(name_.up, inverse_.up.size(), up);
    expect_size(name_.down, inverse_.down.size(), down);
  }

  // One level solves every unknown from first_ on, and none solves others. A level above solves boundary unknowns.
  void check_owners() const {
    const std::size_t nobody = inverse_.levels.size();
    std::vector<std::size_t> owner(unknowns_, nobody);
    for (std::size_t k = 0; k < inverse_.levels.size(); ++k) {
      for (std::uint32_t slot = inverse_.levels[k].first_slot; slot < inverse_.levels[k].own_end; ++slot) {
        const std::uint32_t unknown = inverse_.slot_unknown[slot];
        if (unknown < first_ || owner[unknown] != nobody) {
          refuse(element(name_.slots, slot), " is ", unknown, ", expected an unknown that is solved for, once");
        }
        owner[unknown] = k;
      }
    }
    const auto missing =
        std::find(owner.begin() + static_cast<std::ptrdiff_t>(std::min(first_, unknowns_)), owner.end(), nobody);
    if (missing != owner.end()) {
      refuse(name_.slots, " does not hold unknown ", missing - owner.begin(), " as any front's own");
    }
    for (std::size_t k = 0; k < inverse_.levels.size(); ++k) {
      for (std::uint32_t slot = inverse_.levels[k].own_end; slot < inverse_.levels[k].end_slot; ++slot) {
        const std::size_t solved = owner[inverse_.slot_unknown[slot]];
        if (solved > k && solved != nobody) continue;
        refuse(element(name_.slots, slot), " is ", inverse_.slot_unknown[slot],
               ", expected an unknown that a level above solves");
      }
    }
  }

  void check_children(const InverseLevel& level) const {
    for (std::size_t k = 2 * std::size_t{level.first_slot}; k < 2 * std::size_t{level.end_slot}; ++k) {
      const std::uint32_t child = inverse_.child_slots[k];
      if (child == kNoSlot) continue;
      if (child < level.first_slot && inverse_.slot_unknown[child] == inverse_.slot_unknown[k / 2]) continue;
      refuse(element(name_.children, k), " is ", child, ", expected a slot of the same unknown of a level below");
    }
  }

  // Panels, or strips, give every slot of `rows` once, from `inputs` alone.
  template <typename Panel>
  void check_panels(const char* name, const std::vector<Panel>& panels, Range of_level, Range rows,
                    Range inputs) const {
    std::vector<bool> given(rows.end - rows.begin, false);
    std::size_t count = 0;
    for (std::size_t k = of_level.begin; k < of_level.end; ++k) {
      const Panel& panel = panels[k];
      const auto within = [](std::uint64_t first, std::uint64_t size, Range range) {
        return first >= range.begin && first + size <= range.end;
      };
      if (panel.row_count == 0 || panel.row_count > kBlockSize || !within(panel.first_slot, panel.row_count, rows) ||
          (panel.input_count > 0 && !within(panel.first_input, panel.input_count, inputs))) {
        refuse(element(name, k), " has rows or columns that are not slots of its level");
      }
      if (panel.first_slot < inputs.end && inputs.begin == rows.begin &&
          panel.first_slot + panel.row_count > inputs.end) {
        refuse(element(name, k), " has rows of own and of boundary slots, expected one kind");
      }
      if (end_value(panel) > inverse_.values.size()) {
        refuse(element(name, k), " needs numbers up to ", end_value(panel), ", there are ", inverse_.values.size());
      }
      for (std::uint32_t row = 0; row < panel.row_count; ++row) {
        auto slot = given[panel.first_slot + row - rows.begin];
        if (slot) refuse(element(name, k), " gives slot ", panel.first_slot + row, " once more");
        slot = true;
        ++count;
      }
    }
    if (count == given.size()) return;
    refuse(name, " gives ", count, " of the ", given.size(), " slots of the level that begins at slot ", rows.begin);
  }

  const BlockInverse& inverse_;
  const InverseName& name_;
  std::size_t first_, unknowns_;
};

class DynamicsValidator : TableChecks {
 public:
  DynamicsValidator(const Dynamics& dynamics, const Basis& basis, const std::string& origin)
      : TableChecks(origin),
        dynamics_(dynamics),
        basis_(basis),
        origin_(origin),
        nodes_(dynamics.tets.node_count()),
        tets_(dynamics.tets.tet_count()) {}

  void run() const {
    check_owner();
    check_tets();
    check_corners();
    check_surface();
    check_skin();
    check_diffuse();
    check_step();
    check_jiggle();
  }

 private:
  [[noreturn]] void refuse_basis(const auto&... what) const {
    throw Error(ErrorKind::mismatch, origin_, ": these dynamics are not of this basis: ", what...,
                " (made for another character, or before it was edited?)");
  }

  void check_owner() const {
    const auto expect = [&](const char* key, std::uint64_t hash, const char* what) {
      const auto found = dynamics_.metadata.find(key);
      if (found == dynamics_.metadata.end()) refuse("its metadata lack '", key, "'");
      if (found->second != hexadecimal(hash)) refuse_basis("the ", what, " is another");
    };
    expect("topology_hash", topology_hash(basis_.mesh), "mesh");
    expect("skeleton_hash", skeleton_hash(basis_.skeleton), "skeleton");
  }

  void check_tets() const {
    const TetTable& tets = dynamics_.tets;
    if (tets.nodes.size() % 3 != 0 || tets.nodes.empty() || nodes_ > kMostNodes) {
      refuse("tets.nodes has ", tets.nodes.size(), " entries, expected three to a node, of 1 to 2^24");
    }
    expect_size("tets.tets", tets.tets.size(), 4 * tets_);
    expect_numbers("tets.nodes", tets.nodes);
    expect_below("tets.tets", tets.tets, nodes_);
    for (std::size_t t = 0; t < tets_; ++t) {
      const TetShape& shape = tets.shapes[t];
      for (const float x : shape.inverse_edges) expect_number("tets.shapes", t, static_cast<double>(x));
      expect_number("tets.shapes", t, static_cast<double>(shape.volume));
      if (!(shape.volume > 0)) {
        refuse(element("tets.shapes", t), " has a volume of ", shape.volume, ", expected above 0");
      }
    }
  }

  void check_corners() const {
    const TetTable& tets = dynamics_.tets;
    expect_offsets("tets.corner_begin", tets.corner_begin, nodes_, tets.corners.size());
    expect_size("tets.corners", tets.corners.size(), tets.tets.size());
    Indices next = tets.corner_begin;  // where the next corner of each node must stand
    for (std::size_t c = 0; c < tets.tets.size(); ++c) {
      const std::uint32_t node = tets.tets[c], k = next[node]++;
      if (k < tets.corner_begin[node + 1] && tets.corners[k] == c) continue;
      refuse("tets.corners does not list corner ", c, " at node ", node, " in ascending order, expected at ", k);
    }
    for (std::size_t n = 0; n < nodes_; ++n) {
      if (tets.corner_begin[n] == tets.corner_begin[n + 1]) {
        refuse("tets.nodes: node ", n, " belongs to no tetrahedron");
      }
    }
  }

  void check_surface() const {
    const TetTable& tets = dynamics_.tets;
    if (tets.surface.empty() || tets.surface.size() > nodes_) {
      refuse("tets.surface has ", tets.surface.size(), " entries, expected 1 to ", nodes_);
    }
    const std::vector<float>& rest = basis_.mesh.rest;
    const auto [low, high] = std::minmax_element(rest.begin(), rest.end());
    const double tolerance = kSamePlace * static_cast<double>(*high - *low);
    for (std::size_t n = 0; n < tets.surface.size(); ++n) {
      const SurfacePoint& point = tets.surface[n];
      const Indices vertices = {point.a, point.b, point.c};
      const float weights[3] = {point.wa, point.wb, point.wc};
      expect_below("tets.surface", vertices, basis_.mesh.vertex_count());
      expect_weights("tets.surface", n, weights);
      for (std::size_t i = 0; i < 3; ++i) {
        double x = -static_cast<double>(tets.nodes[3 * n + i]);
        for (std::size_t k = 0; k < 3; ++k) {
          x += static_cast<double>(weights[k]) * static_cast<double>(rest[3 * std::size_t{vertices[k]} + i]);
        }
        if (!(std::abs(x) <= tolerance)) refuse_basis("its skin stands elsewhere at rest");
      }
    }
  }

  void check_skin() const {
    const TetTable& tets = dynamics_.tets;
    expect_size("tets.skin", tets.skin.size(), basis_.mesh.vertex_count());
    for (std::size_t v = 0; v < tets.skin.size(); ++v) {
      const TetPoint& point = tets.skin[v];
      if (point.tet >= tets_) {
        refuse(element("tets.skin", v), " names tetrahedron ", point.tet, ", expected an index below ", tets_);
      }
      expect_weights("tets.skin", v, std::array{point.w0, point.w1, point.w2, point.w3});
      expect_number("tets.skin", v, static_cast<double>(point.amount));
      if (point.amount < 0) {
        refuse(element("tets.skin", v), " takes an amount of ", point.amount, ", expected 0 or more");
      }
    }
    expect_size("tets.skin_limit", tets.skin_limit.size(), basis_.mesh.vertex_count());
    for (std::size_t v = 0; v < tets.skin_limit.size(); ++v) {
      const float limit = tets.skin_limit[v];
      if (!(limit > 0 && limit <= kNoLimit)) {
        refuse(element("tets.skin_limit", v), " is ", limit, ", expected metres above 0");
      }
    }
  }

  // Barycentric: rounding grows with weights of points far outside.
  void expect_weights(const char* name, std::size_t k, std::span<const float> weights) const {
    float sum = 0, size = 1;
    for (const float w : weights) {
      expect_number(name, k, static_cast<double>(w));
      sum += w;
      size = std::max(size, std::abs(w));
    }
    if (std::abs(sum - 1) <= kWeightTolerance * size) return;
    refuse(element(name, k), " has weights that sum to ", sum, ", expected 1");
  }

  void check_diffuse() const {
    const DiffuseTable& diffuse = dynamics_.diffuse;
    const std::size_t surface = dynamics_.tets.surface.size();
    expect_offsets("diffuse.row_begin", diffuse.row_begin, nodes_, diffuse.columns.size());
    if (diffuse.row_begin[surface] != 0) refuse("diffuse.row_begin has entries for nodes on the skin, expected none");
    expect_below("diffuse.columns", diffuse.columns, surface);
    expect_size("diffuse.values", diffuse.values.size(), diffuse.columns.size());
    expect_numbers("diffuse.values", diffuse.values);
    InverseValidator(diffuse.inverse, kDiffuse, surface, nodes_, origin_).run();
  }

  void check_step() const {
    constexpr float kMostFrames = 1e6f;
    constexpr std::uint32_t kMostSubsteps = 1024;  // the steps of a second, the longest gap, are 32 bits
    const JiggleStep& step = dynamics_.jiggle.step;
    if (!(step.frames_per_second > 0 && step.frames_per_second <= kMostFrames) || step.substeps == 0 ||
        step.substeps > kMostSubsteps) {
      refuse("jiggle.step has ", step.frames_per_second, " frames a second of ", step.substeps,
             " substeps, expected numbers above 0, of at most 1000000 and 1024");
    }
    expect_number("jiggle.step", 3, static_cast<double>(step.stiffness_damping));
    if (step.stiffness_damping < 0) refuse("jiggle.step has a damping below 0");
  }

  void check_jiggle() const {
    const JiggleTable& jiggle = dynamics_.jiggle;
    expect_size("jiggle.nodes", jiggle.nodes.size(), nodes_);
    for (std::size_t n = 0; n < nodes_; ++n) check_node(n);
    InverseValidator(jiggle.inverse, kJiggle, 0, 3 * nodes_, origin_).run();
    expect_size("jiggle.springs", jiggle.springs.size(), nodes_);
    expect_numbers("jiggle.springs", jiggle.springs);
  }

  void check_node(std::size_t n) const {
    const JiggleNode& node = dynamics_.jiggle.nodes[n];
    for (const float x : {node.mass, node.inertia, node.stiffening}) {
      expect_number("jiggle.nodes", n, static_cast<double>(x));
      if (x < 0) refuse(element("jiggle.nodes", n), " has a number of ", x, ", expected 0 or more");
    }
    if (std::uint64_t{node.first_fibre} + node.fibre_count > basis_.strain.fibre_count()) {
      refuse_basis(element("jiggle.nodes", n), " is of fibres that its strain table does not have");
    }
    if (node.control != kNoControl && node.control >= basis_.residual.controls.size()) {
      refuse_basis(element("jiggle.nodes", n), " is flexed by a control that it does not have");
    }
  }

  const Dynamics& dynamics_;
  const Basis& basis_;
  const std::string& origin_;
  std::size_t nodes_, tets_;
};

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

void validate(const Dynamics& dynamics, const Basis& basis, const std::string& origin) {
  DynamicsValidator(dynamics, basis, origin).run();
}

}  // namespace bodyopt
