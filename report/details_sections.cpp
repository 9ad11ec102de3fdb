// Figures for the record, and what it takes to repeat them.
#include <cmath>

#include "report/plots.h"
#include "report/report_sections.h"

namespace bodyopt {
namespace {

std::string seconds_text(double seconds) {
  if (seconds < 90) return number_text(seconds) + " s";
  const long whole = std::lround(seconds);
  return std::to_string(whole / 60) + " min " + std::to_string(whole % 60) + " s";
}

// Rows of two cells.
class Facts {
 public:
  Facts() { table_.columns = {{"what"}, {"value"}}; }
  void add(const std::string& what, const std::string& value) { table_.rows.push_back({{what, {}}, {value, {}}}); }
  const Table& table() const { return table_; }

 private:
  Table table_;
};

void add_demo(const DemoReport& demo, Facts& facts) {
  facts.add("simulation", std::to_string(demo.converged) + " of " + plural(demo.frames, "frame") +
                              " converged; force left over, relative to the elastic forces: median " +
                              number_text(demo.median_residual, 2) + ", worst " + number_text(demo.worst_residual, 2) +
                              "; on average " + number_text(demo.mean_iterations) + " iterations a frame");
  facts.add("draft of the held-out motion", "in " + seconds_text(demo.seconds.draft) + ", " +
                                                millimetres(demo.draft_rms_mm) + " RMS from the simulation, " +
                                                millimetres(demo.draft_max_mm) + " at most");
  facts.add("GPU against CPU", "at most " + number_text(1e6 * demo.cpu_gpu_max_difference_m) +
                                   " micrometres apart, over all held-out frames and vertices");
  facts.add("time besides", "character " + seconds_text(demo.seconds.build_character) + ", simulation " +
                                seconds_text(demo.seconds.simulate) + ", evaluation of the held-out frames " +
                                seconds_text(demo.seconds.eval));
}

}  // namespace

void add_warnings(const ReportData& data, Page& page) {
  if (data.warnings.empty()) return;
  page.heading("Warnings of the data");
  for (const std::string& warning : data.warnings) page.paragraph(warning);
}

void add_details(const ReportData& data, Page& page) {
  page.heading("Details");
  Facts facts;
  const auto& box = data.character.bounding_box_m;
  facts.add("character", data.character.name + ": " + std::to_string(data.character.vertices) + " vertices" + ", " +
                             plural(data.character.joints, "joint") + ", " + plural(data.character.muscles, "muscle") +
                             "; " + number_text(box[0]) + " x " + number_text(box[1]) + " x " + number_text(box[2]) +
                             " m");
  facts.add("training frames", std::to_string(data.dataset.train_frames));
  facts.add("held-out frames", std::to_string(data.dataset.heldout_frames));
  facts.add("frames left out", std::to_string(data.dataset.unconverged) + " whose simulation did not converge");
  std::string stages;
  for (const auto& [stage, bytes] : data.bytes_by_stage) {
    stages += (stages.empty() ? ": " : ", ") + stage + " " + number_text(bytes);
  }
  facts.add("tables", number_text(data.bytes_per_vertex) + " bytes per vertex" + stages);
  if (!data.methods.empty()) facts.add("evaluated on", data.device);
  facts.add("training", "in " + seconds_text(data.train_seconds));
  facts.add("peak memory", number_text(data.peak_memory_mib) + " MiB");
  if (data.demo) add_demo(*data.demo, facts);
  page.table(facts.table());
}

void add_provenance(const ReportData& data, Page& page) {
  const ProvenanceReport& provenance = data.provenance;
  page.heading("To repeat it");
  Facts facts;
  facts.add("program", provenance.program);
  facts.add("command line", provenance.command_line);
  for (const auto& [name, value] : provenance.options) facts.add(name, value);
  facts.add("checksum of the basis", provenance.basis_checksum);
  facts.add("hash of the topology", provenance.topology_hash);
  facts.add("hash of the skeleton", provenance.skeleton_hash);
  page.table(facts.table());
  Table files;
  files.columns = {{"file"}, {"path"}, {"xxh3"}};
  for (const auto& file : provenance.files) files.rows.push_back({{file.what, {}}, {file.path, {}}, {file.xxh3, {}}});
  page.table(files);
  Table takes;
  takes.columns = {{"take"}, {"trained on"}, {"held out"}, {"left out"}};
  for (const auto& take : provenance.takes) {
    takes.rows.push_back({{take.name, {}}, {take.trained, {}}, {take.heldout, {}}, {take.left_out, {}}});
  }
  page.table(takes);
}

}  // namespace bodyopt
