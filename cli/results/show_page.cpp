#include "cli/results/show_page.h"

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>

#include "assets/frame_range.h"
#include "assets/shape_reader.h"
#include "assets/usda_part.h"
#include "farm/plan.h"
#include "report/page.h"
#include "report/pictures.h"
#include "runtime/basis/levels.h"
#include "runtime/basis/output_order.h"
#include "runtime/core/error.h"
#include "runtime/host/stages.h"

namespace bodyopt::cli {
namespace {

constexpr std::uint32_t kPictureWidth = 290, kPictureHeight = 330;

// Characters, each read once.
class CacheDrawer {
 public:
  Image draw(const WorthyFrame& worthy) {
    const FarmStep& step = *worthy.step;
    const std::vector<float> points = read(step.out, worthy.sample);
    const MeshTable& mesh = mesh_of(step);
    if (points.size() != 3 * mesh.output_vertex.size()) {
      throw Error(ErrorKind::mismatch, step.out, ": is of another mesh than its basis");
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
    if (sample >= reader.sample_count()) throw Error(ErrorKind::mismatch, cache, ": has fewer samples than frames");
    return reader.sample(sample);
  }

  const MeshTable& mesh_of(const FarmStep& step) {
    const auto level = std::ranges::find(step.arguments, "--level");
    const std::string number = level == step.arguments.end() || level + 1 == step.arguments.end() ? "0" : *(level + 1);
    const std::string key = step.arguments.at(1) + '\0' + number;
    auto found = meshes_.find(key);
    if (found == meshes_.end()) {
      std::vector<Level> levels = load_levels(step.arguments.at(1));
      const std::size_t index = std::strtoul(number.c_str(), nullptr, 10);
      if (index >= levels.size()) throw Error(ErrorKind::mismatch, step.arguments.at(1), ": has no level ", number);
      found = meshes_.emplace(key, std::move(levels[index].basis.mesh)).first;
    }
    return found->second;
  }

  Renderer renderer_;
  std::map<std::string, MeshTable> meshes_;
};

// Of every frame worth a look, or why there is none.
Json looks_of(const ShowSummary& summary) {
  Json looks = Json::array();
  std::optional<CacheDrawer> drawer;
  for (const WorthyFrame& worthy : summary.worth_a_look) {
    try {
      if (!drawer) drawer.emplace();
      looks.push_back(page_picture(drawer->draw(worthy)));
    } catch (const Error& error) {
      looks.push_back({{"problem", error.what()}});
    }
  }
  return looks;
}

}  // namespace

std::string show_page(const FarmPlan& plan, const ShowSummary& summary) {
  return page_text("show", to_json(plan, summary), {{"looks", looks_of(summary)}});
}

Json to_json(const FarmPlan& plan, const ShowSummary& summary) {
  Json elements = Json::array(), frames = Json::array(), next = Json::array();
  for (const ElementSummary& element : summary.elements) {
    elements.push_back({{"shot", element.shot},
                        {"element", element.element},
                        {"out", element.out},
                        {"state", name_of(element.state)},
                        {"message", element.failure ? element.failure->message : ""},
                        {"host", element.failure ? element.failure->host : ""},
                        {"frames", element.frames},
                        {"seconds", element.seconds},
                        {"peak_memory_mib", element.peak_memory_mib},
                        {"device", element.device},
                        {"outside_frames", format_frame_range(element.outside)},
                        {"outside_count", element.outside.size()},
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
                    {"frame_count", entry.frames.size()},
                    {"options", simulate_options(entry)}});
  }
  return {{"show", plan.show},
          {"tasks", plan.tasks.size()},
          {"elements", elements},
          {"worth_a_look", frames},
          {"simulate_next", next}};
}

std::string simulate_options(const FramesToSimulate& next) {
  std::string text = "--clip " + quoted_for_shell(next.clip) + " --frames " + format_frame_range(next.frames);
  for (const std::string& word : next.options) text += " " + (word.starts_with("--") ? word : quoted_for_shell(word));
  return text;
}

}  // namespace bodyopt::cli
