// What a training keeps: its layout, and a region.
#include "trainer/train/fit/training_store.h"

#include "tests/fuzz/fuzz_target.h"
#include "tests/support/temporary_folder.h"

namespace bodyopt::fuzz {
namespace {

using namespace trainer;

constexpr std::uint64_t kKey = 42;
const char* const kLayoutFile = "layout.safetensors";
const char* const kRegionFile = "region_0_000000000000002a.safetensors";

KeptLayout kept_layout() {
  KeptLayout kept;
  kept.key = kKey;
  kept.from = {1, {2, 3}, 4, {}};
  kept.smoothing_radius = 0.1;
  kept.curves = {{"curve", {{0, {0, 0, 0}}, {1, {0, 1, 0}}}}};
  kept.features = RawFeatures::Zero(2, 3);
  kept.layout = {{{"region", {0, 1}, {0.5, 1}}}, {{{0, 2}}}};
  return kept;
}

RegionModel kept_region() {
  RegionModel model;
  model.region = {"region", {0, 1}, {0.5, 1}};
  model.features = {0, 2};
  model.explained = {1, 0.5};
  model.projection = Eigen::MatrixXd::Ones(1, 2);
  model.components = {Eigen::MatrixXd::Ones(2, 1), Eigen::MatrixXd::Ones(1, 6), Eigen::VectorXd::Ones(2),
                      Eigen::VectorXd::Zero(2)};
  Regression fit;
  fit.centres = Eigen::MatrixXd::Zero(1, 1);
  fit.weights = Eigen::MatrixXd::Ones(2, 1);
  fit.errors = Eigen::MatrixXd::Zero(2, 1);
  fit.centre_frames = {-1};
  model.fits = {fit};
  return model;
}

template <typename Keep>
std::vector<std::string> seed_of(const char* name, Keep keep) {
  const TemporaryFolder folder;
  keep(TrainingStore(folder.path()));
  return {testing::read_bytes(folder / name)};
}

std::vector<std::string> layout_seeds() {
  return seed_of(kLayoutFile, [](const TrainingStore& store) { store.keep(kept_layout()); });
}
std::vector<std::string> region_seeds() {
  return seed_of(kRegionFile, [](const TrainingStore& store) { store.keep(0, kKey, kept_region()); });
}

void read_layout(const std::string& bytes) {
  TrainingStore(as_file(kLayoutFile, with_checksum(bytes)).parent_path()).layout();
}
void read_region(const std::string& bytes) {
  TrainingStore(as_file(kRegionFile, with_checksum(bytes)).parent_path()).region(0, kKey);
}

const bool added = add_target({"training_layout", layout_seeds, read_layout}) &&
                   add_target({"training_region", region_seeds, read_region});

}  // namespace
}  // namespace bodyopt::fuzz
