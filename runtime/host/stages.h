// The stages of a frame, once: both backends walk this list. Timers, the check and the table in docs/pipeline/README.md
// have its names.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

namespace bodyopt {

struct Basis;
struct Batch;

enum class Stage { rig, strain, residual, modify, pose, diffuse, jiggle, output };

struct StageDescription {
  Stage stage;
  const char* name;
  const char* applies;  // to which frames; see stages_of
  const char* reads;    // of what came before
  const char* writes;
};

// The stages, in the order in which they run.
inline constexpr std::array<StageDescription, 8> kStages = {{
    {Stage::rig, "rig", "always, on the host", "pose", "skinning, joint features, fades"},
    {Stage::strain, "strain", "always", "skinning", "strains"},
    {Stage::residual, "residual", "always", "joint features, strains, controls, fades", "displacements"},
    {Stage::modify, "modify", "with modifiers", "displacements, weights of modifiers", "displacements"},
    {Stage::pose, "pose", "always", "skinning, displacements", "positions"},
    {Stage::diffuse, "diffuse", "with dynamics", "positions", "nodes"},
    {Stage::jiggle, "jiggle", "with dynamics", "positions, nodes, strains, controls, motion", "positions, motion"},
    {Stage::output, "output", "always", "positions, weights of modifiers",
     "positions, normals, tangents, output order"},
}};

template <typename Value>
using PerStage = std::array<Value, kStages.size()>;

// The index into a PerStage.
constexpr std::size_t index_of(Stage stage) { return static_cast<std::size_t>(stage); }
constexpr const char* name_of(Stage stage) { return kStages[index_of(stage)].name; }

// Seconds by stage, summed over threads: none of a stage that did not run, or that a device without timestamps ran.
class StageSeconds {
 public:
  std::optional<double> of(Stage stage) const { return seconds_[index_of(stage)]; }
  double sum() const;
  // Calls visit(const StageDescription&, seconds) for the stages that have any, in their order.
  template <typename Visit>
  void for_each(const Visit& visit) const {
    for (const StageDescription& description : kStages) {
      if (const auto seconds = of(description.stage)) visit(description, *seconds);
    }
  }
  void add(Stage stage, double seconds);
  void add(const StageSeconds& other);

 private:
  PerStage<std::optional<double>> seconds_;
};

// The stages that a backend runs for a batch, in their order. Rig is none of them: the batch is what it left. `stages`:
// memory that is used again.
std::vector<Stage> stages_of(const Basis& basis, const Batch& batch, std::vector<Stage> stages = {});

}  // namespace bodyopt
