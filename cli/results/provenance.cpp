#include "cli/results/provenance.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "assets/frame_range.h"
#include "dataset/file_hashes.h"
#include "runtime/basis/safetensors.h"
#include "runtime/core/hexadecimal.h"

namespace bodyopt::cli {
namespace {

// Those of a take among some samples, ascending.
std::vector<int> frames_of(const std::vector<Sample>& samples, std::size_t take) {
  std::vector<int> frames;
  for (const Sample& sample : samples) {
    if (static_cast<std::size_t>(sample.take) == take) frames.push_back(sample.frame);
  }
  std::ranges::sort(frames);
  return frames;
}

ProvenanceReport::Take take_of(const DatasetTake& take, std::size_t index, const SampleSet& set) {
  const std::vector<int> trained = frames_of(set.train, index), heldout = frames_of(set.heldout, index);
  std::vector<int> left_out;
  for (const int frame : take.frames) {
    const bool used = std::ranges::binary_search(trained, frame) || std::ranges::binary_search(heldout, frame);
    if (!used) left_out.push_back(frame);
  }
  std::ranges::sort(left_out);
  return {take.name, format_frame_range(trained), format_frame_range(heldout), format_frame_range(left_out)};
}

std::vector<std::pair<std::string, std::string>> options_of(const Json& provenance, const TrainOptions& options,
                                                            double unit) {
  std::vector<std::pair<std::string, std::string>> list;
  for (const char* name :
       {"smoothing_radius_m", "smoothing_steps", "components", "centres", "surface_curves", "seed"}) {
    list.emplace_back(name, provenance.at(name).dump());
  }
  for (const char* name : {"budget", "tolerance_mm"}) {
    list.emplace_back(name, provenance.at(name) > 0.0 ? provenance.at(name).dump() : "none");
  }
  if (provenance.value("updated", false)) list.emplace_back("updated", "from an earlier training of other frames");
  list.emplace_back("memory_gib", format("{:.9g}", options.memory_gib));
  if (unit > 0) list.emplace_back("unit_m", format("{:.9g}", unit));
  return list;
}

}  // namespace

ProvenanceReport provenance_of(const Dataset& dataset, const std::filesystem::path& dataset_file, const SampleSet& set,
                               const TrainOptions& options, const std::filesystem::path& basis_file) {
  const Metadata metadata = read_safetensors(basis_file).metadata;
  const Json own = Json::parse(metadata.at("provenance"));
  ProvenanceReport report;
  report.program = own.at("program");
  report.command_line = command_line();
  report.options = options_of(own, options, dataset.unit);
  report.basis_checksum = metadata.at("checksum");
  report.topology_hash = metadata.at("topology_hash");
  report.skeleton_hash = metadata.at("skeleton_hash");
  report.files.push_back({"dataset", dataset_file.string(), hexadecimal(file_hash(dataset_file))});
  for (const HashedFile& file : hashed_files(dataset)) {
    report.files.push_back({file.what, file.path, hexadecimal(file.xxh3)});
  }
  for (std::size_t k = 0; k < dataset.takes.size(); ++k) report.takes.push_back(take_of(dataset.takes[k], k, set));
  return report;
}

}  // namespace bodyopt::cli
