#include "cli/results/show_page.h"

#include <algorithm>
#include <array>
#include <map>
#include <nlohmann/json.hpp>

#include "assets/frame_range.h"
#include "assets/shape_reader.h"
#include "assets/usda_part.h"
#include "cli/results/number_cell.h"
#include "farm/shell_word.h"
#include "report/html.h"
#include "report/pictures.h"
#include "report/report_sections.h"
#include "runtime/basis/levels.h"
#include "runtime/basis/output_order.h"
#include "runtime/core/error.h"

namespace bodyopt::cli {
namespace {

constexpr std::size_t kMostRows = 25, kPicturesInARow = 4;
constexpr std::uint32_t kPictureWidth = 290, kPictureHeight = 330;

double hours(double seconds) { return seconds / 3600; }

double milliseconds_per_frame(const ElementSummary& element) {
  return element.frames == 0 ? 0 : 1e3 * element.seconds / static_cast<double>(element.frames);
}

void add_headlines(const ShowSummary& summary, Page& page) {
  std::map<StepState, std::size_t> counts;
  std::size_t flagged = 0;
  double seconds = 0;
  for (const ElementSummary& element : summary.elements) {
    ++counts[element.state];
    flagged += element.outside.empty() ? 0u : 1u;
    seconds += element.seconds;
  }
  const std::size_t all = summary.elements.size(), done = counts[StepState::done], failed = counts[StepState::failed];
  const std::array headlines{Headline{std::to_string(done), "of " + std::to_string(all), "elements are done"},
                             Headline{std::to_string(failed), "", "failed"},
                             Headline{std::to_string(all - done - failed), "", "are stale, stopped or not begun"},
                             Headline{std::to_string(flagged), "", "leave the trained range"},
                             Headline{format("%.2f", hours(seconds)), "h", "that tasks took for what is done"}};
  page.headlines(headlines);
}

// The rows that fit, and how many are left out.
void add_table(Table table, std::size_t all, Page& page) {
  page.table(table);
  if (all > kMostRows) page.paragraph(format("%zu more are in the JSON of the report.", all - kMostRows));
}

void add_open(const ShowSummary& summary, Page& page) {
  Table table{{{"shot"}, {"element"}, {"state"}, {"why"}, {"host"}}, {}};
  std::size_t open = 0;
  for (const ElementSummary& element : summary.elements) {
    if (element.state == StepState::done) continue;
    if (++open > kMostRows) continue;
    table.rows.push_back({{element.shot, {}},
                          {element.element, {}},
                          {name_of(element.state), {}},
                          {element.failure ? element.failure->message : "", {}},
                          {element.failure ? element.failure->host : "", {}}});
  }
  if (open == 0) return;
  page.heading("Not done");
  add_table(table, open, page);
}

std::vector<const ElementSummary*> those_with(const ShowSummary& summary,
                                              bool (*is_wanted)(const ElementSummary& element),
                                              bool (*is_before)(const ElementSummary& a, const ElementSummary& b)) {
  std::vector<const ElementSummary*> list;
  for (const ElementSummary& element : summary.elements) {
    if (is_wanted(element)) list.push_back(&element);
  }
  std::stable_sort(list.begin(), list.end(),
                   [&](const ElementSummary* a, const ElementSummary* b) { return is_before(*a, *b); });
  return list;
}

void add_flagged(const ShowSummary& summary, Page& page) {
  const auto flagged = those_with(
      summary, [](const ElementSummary& e) { return !e.outside.empty(); },
      [](const ElementSummary& a, const ElementSummary& b) { return a.worst_outside > b.worst_outside; });
  if (flagged.empty()) return;
  page.heading("Outside the trained range");
  Table table{{{"shot"}, {"element"}, {"frames"}, {"standard deviations"}, {"which"}}, {}};
  for (std::size_t k = 0; k < std::min(kMostRows, flagged.size()); ++k) {
    const ElementSummary& e = *flagged[k];
    table.rows.push_back({{e.shot, {}},
                          {e.element, {}},
                          number_of("%.0f", static_cast<double>(e.outside.size())),
                          number_of("%.1f", e.worst_outside),
                          {format_frame_range(e.outside), {}}});
  }
  add_table(table, flagged.size(), page);
}

void add_slowest(const ShowSummary& summary, Page& page) {
  const auto done = those_with(
      summary, [](const ElementSummary& e) { return e.frames > 0; },
      [](const ElementSummary& a, const ElementSummary& b) { return a.seconds > b.seconds; });
  if (done.empty()) return;
  page.heading("Slowest");
  Table table{{{"shot"}, {"element"}, {"seconds"}, {"frames"}, {"ms a frame"}, {"MiB"}, {"device"}}, {}};
  for (std::size_t k = 0; k < std::min(kMostRows, done.size()); ++k) {
    const ElementSummary& e = *done[k];
    table.rows.push_back({{e.shot, {}},
                          {e.element, {}},
                          number_of("%.1f", e.seconds),
                          number_of("%.0f", static_cast<double>(e.frames)),
                          number_of("%.1f", milliseconds_per_frame(e)),
                          number_of("%.0f", e.peak_memory_mib),
                          {e.device, {}}});
  }
  add_table(table, done.size(), page);
}

void add_hours(const ShowSummary& summary, Page& page) {
  struct Sum {
    std::size_t shots = 0, frames = 0;
    double seconds = 0;
  };
  std::map<std::string, Sum> sums;
  for (const ElementSummary& element : summary.elements) {
    Sum& sum = sums[element.element];
    ++sum.shots;
    sum.frames += element.frames;
    sum.seconds += element.seconds;
  }
  page.heading("Hours of each element");
  Table table{{{"element"}, {"shots"}, {"frames"}, {"hours"}}, {}};
  for (const auto& [name, sum] : sums) {
    if (table.rows.size() == kMostRows) break;
    table.rows.push_back({{name, {}},
                          number_of("%.0f", static_cast<double>(sum.shots)),
                          number_of("%.0f", static_cast<double>(sum.frames)),
                          number_of("%.4f", hours(sum.seconds))});
  }
  add_table(table, sums.size(), page);
}

// Characters, each read once.
class CacheDrawer {
 public:
  Image draw(const WorthyFrame& worthy) {
    const FarmStep& step = *worthy.step;
    const std::vector<float> points = read(step.out, worthy.sample);
    const MeshTable& mesh = mesh_of(step);
    if (points.size() != 3 * mesh.output_vertex.size()) {
      throw Error(ErrorKind::mismatch, step.out + ": is of another mesh than its basis");
    }
    const std::vector<float> skin = vertices_of(mesh, points);
    const std::vector<float> normals = smooth_normals(mesh.triangles, skin);
    const Camera camera = frame_points(skin, {0.35f, 0.15f, 1}, static_cast<float>(kPictureWidth) / kPictureHeight);
    const DrawMesh drawn{skin, normals, mesh.triangles, {}};
    return renderer_.draw(std::span(&drawn, 1), camera, kPictureWidth, kPictureHeight);
  }

 private:
  static std::vector<float> read(const std::string& cache, std::uint32_t sample) {
    if (cache.ends_with(".usda")) return UsdaPart(cache).points(sample);
    const ShapeReader reader(cache);
    if (sample >= reader.sample_count()) throw Error(ErrorKind::mismatch, cache + ": has fewer samples than frames");
    return reader.sample(sample);
  }

  const MeshTable& mesh_of(const FarmStep& step) {
    const auto level = std::find(step.arguments.begin(), step.arguments.end(), "--level");
    const std::string number = level == step.arguments.end() || level + 1 == step.arguments.end() ? "0" : *(level + 1);
    const std::string key = step.arguments.at(1) + '\0' + number;
    auto found = meshes_.find(key);
    if (found == meshes_.end()) {
      std::vector<Level> levels = load_levels(step.arguments.at(1));
      const std::size_t index = std::strtoul(number.c_str(), nullptr, 10);
      if (index >= levels.size()) throw Error(ErrorKind::mismatch, step.arguments.at(1) + ": has no level " + number);
      found = meshes_.emplace(key, std::move(levels[index].basis.mesh)).first;
    }
    return found->second;
  }

  Renderer renderer_;
  std::map<std::string, MeshTable> meshes_;
};

std::string label_of(const WorthyFrame& worthy) {
  std::string text = worthy.step->shot + ", " + worthy.step->element + ", frame " + std::to_string(worthy.frame);
  if (worthy.expected_rms_mm > 0) text += format(", %.1f mm expected", worthy.expected_rms_mm);
  if (worthy.outside > 0) text += format(", %.1f out", worthy.outside);
  return text;
}

void add_contact_sheet(const ShowSummary& summary, Page& page) {
  if (summary.worth_a_look.empty()) return;
  page.heading("Worth a look");
  page.paragraph(
      "The frames that the basis is expected to be furthest off in, worst first: by the error that it expects "
      "(millimetres, root mean square), then by how far they leave the trained range (standard deviations). "
      "As they stand in the caches.");
  std::vector<Image> row;
  std::vector<std::string> labels;
  const auto flush = [&] {
    if (!row.empty()) page.picture(side_by_side(row), labels, "", "", "");
    row.clear();
    labels.clear();
  };
  std::string missing;
  try {
    CacheDrawer drawer;
    for (const WorthyFrame& worthy : summary.worth_a_look) {
      try {
        row.push_back(drawer.draw(worthy));
        labels.push_back(label_of(worthy));
      } catch (const Error& error) {
        if (error.kind() == ErrorKind::device) throw;
        missing += label_of(worthy) + ": " + error.what() + "\n";
      }
      if (row.size() == kPicturesInARow) flush();
    }
    flush();
  } catch (const Error& error) {
    missing += std::string("nothing is drawn: ") + error.what();
  }
  if (!missing.empty()) page.paragraph(missing);
}

void add_simulate_next(const ShowSummary& summary, Page& page) {
  if (summary.simulate_next.empty()) return;
  page.heading("Worth simulating next");
  page.paragraph(
      "Simulate these frames into the dataset of the basis, and train it again: bodyopt simulate CHARACTER "
      "--out DATASET, and the options below.");
  Table table{{{"basis"}, {"frames"}, {"options of simulate"}}, {}};
  for (const FramesToSimulate& next : summary.simulate_next) {
    table.rows.push_back(
        {{next.basis, {}}, number_of("%.0f", static_cast<double>(next.frames.size())), {simulate_options(next), {}}});
  }
  page.table(table);
}

}  // namespace

std::string show_page(const FarmPlan& plan, const ShowSummary& summary) {
  Page page(plan.show, "What the show has come to: " + plural(plan.tasks.size(), "task") + ", " +
                           plural(summary.elements.size(), "element"));
  add_headlines(summary, page);
  add_open(summary, page);
  add_contact_sheet(summary, page);
  add_simulate_next(summary, page);
  add_flagged(summary, page);
  add_slowest(summary, page);
  add_hours(summary, page);
  return page.text();
}

Json to_json(const ShowSummary& summary) {
  Json elements = Json::array(), frames = Json::array(), next = Json::array();
  for (const ElementSummary& element : summary.elements) {
    elements.push_back({{"shot", element.shot},
                        {"element", element.element},
                        {"out", element.out},
                        {"state", name_of(element.state)},
                        {"message", element.failure ? element.failure->message : ""},
                        {"frames", element.frames},
                        {"seconds", element.seconds},
                        {"peak_memory_mib", element.peak_memory_mib},
                        {"device", element.device},
                        {"outside_frames", format_frame_range(element.outside)},
                        {"worst_outside", element.worst_outside}});
  }
  for (const WorthyFrame& worthy : summary.worth_a_look) {
    frames.push_back({{"shot", worthy.step->shot},
                      {"element", worthy.step->element},
                      {"frame", worthy.frame},
                      {"expected_rms_mm", worthy.expected_rms_mm},
                      {"outside", worthy.outside}});
  }
  for (const FramesToSimulate& entry : summary.simulate_next) {
    next.push_back({{"basis", entry.basis},
                    {"clip", entry.clip},
                    {"frames", format_frame_range(entry.frames)},
                    {"options", simulate_options(entry)}});
  }
  return {{"elements", elements}, {"worth_a_look", frames}, {"simulate_next", next}};
}

std::string simulate_options(const FramesToSimulate& next) {
  std::string text = "--clip " + quoted_for_shell(next.clip) + " --frames " + format_frame_range(next.frames);
  for (const std::string& word : next.options) text += " " + (word.starts_with("--") ? word : quoted_for_shell(word));
  return text;
}

}  // namespace bodyopt::cli
