// dataset.json, and the side-car of a simulation.
#include "dataset/dataset.h"

#include "tests/fuzz/fuzz_target.h"

namespace bodyopt::fuzz {
namespace {

std::vector<std::string> dataset_seeds() {
  return {R"({"schema": "bodyopt-dataset-1", "character": "../c.glb", "muscles": "../m.json", "materials": "a.json",
 "regions": "r.json", "unit": 0.01, "takes": [{"name": "rom", "clip": "../rom.glb#walk", "controls": "c.json",
 "joint_map": "j.json", "fps": 24.0, "first_frame": 1, "frames": "1-40,50-60x2", "shapes": "rom.pc2",
 "shapes_status": "rom.status.json", "heldout": "4-8"}]})"};
}

void read_manifest(const std::string& bytes) {
  const Dataset dataset = read_dataset(as_file("dataset.json", bytes));
  require_finite(std::vector{dataset.unit}, "the unit");
  for (const DatasetTake& take : dataset.takes) require_finite(std::vector{take.fps}, "frames a second");
}

std::vector<std::string> status_seeds() {
  return {R"({"schema": "bodyopt-frame-status-1", "frames": [{"frame": 1, "residual": 1e-5, "converged": true,
 "iterations": 12, "seconds": 0.5, "inverted_tets": 0, "contact_depth": null, "volume_change": 0.01,
 "inputs": "00000000000000ff"}]})"};
}

void read_status(const std::string& bytes) {
  for (const FrameStatus& status : read_frame_status(as_file("take.status.json", bytes))) {
    require_finite(std::vector{status.residual, status.seconds}, "residuals and seconds");
  }
}

const bool added =
    add_target({"dataset", dataset_seeds, read_manifest}) && add_target({"frame_status", status_seeds, read_status});

}  // namespace
}  // namespace bodyopt::fuzz
