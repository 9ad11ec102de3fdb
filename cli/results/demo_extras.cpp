#include "cli/results/demo_extras.h"

#include <algorithm>
#include <map>

#include "assets/clips/clip.h"
#include "cli/arguments/common.h"
#include "cli/results/pages.h"
#include "dataset/dataset.h"
#include "draw/animation.h"
#include "geometry/mesh.h"
#include "report/page.h"
#include "report/pictures.h"
#include "runtime/core/atomic_file.h"
#include "runtime/host/stages.h"
#include "trainer/builtin/arm.h"
#include "trainer/dynamics/build_dynamics.h"
#include "trainer/dynamics/jiggle.h"
#include "trainer/transfer/transfer_basis.h"
#include "trainer/transfer/transfer_pair.h"

namespace bodyopt::cli {
namespace {

namespace fs = std::filesystem;

using Skins = std::vector<std::vector<float>>;  // per frame V x 3, world, metres

// Skins of all frames are welded: seams would show as edges.
Skins skins_of(const Character& character, const Evaluation& evaluation) {
  const std::size_t stride = 3 * std::size_t{character.output_count()};
  Skins skins;
  for (std::size_t begin = 0; begin < evaluation.positions.size(); begin += stride) {
    skins.push_back(floats_of(welded_from_output(character, evaluation.positions.data() + begin)));
  }
  return skins;
}

// Frame by frame: the state that each leaves is what is measured.
Skins jiggle(const Character& character, const Clip& clip, Deformer& deformer, report::JiggleReport& report) {
  Skins skins;
  StageSeconds seconds;
  for (std::size_t f = 0; f < report.frames.size(); ++f) {
    const Evaluation frame = deformer.jiggle({&clip.poses[f], 1}, {&report.frames[f], 1});
    skins.push_back(skins_of(character, frame).front());
    const trainer::JiggleMeasure measure = trainer::measure_jiggle(*deformer.dynamics(), deformer.state().motion);
    report.rms_mm.push_back(measure.rms_mm);
    report.max_mm.push_back(measure.max_mm);
    report.inverted_tets.push_back(measure.inverted_tets);
    seconds.add(frame.stage_seconds);
  }
  // A device without timestamps gives no times.
  const double per_frame = 1000 / static_cast<double>(report.frames.size());
  report.diffuse_ms = per_frame * seconds.of(Stage::diffuse).value_or(0);
  report.jiggle_ms = per_frame * seconds.of(Stage::jiggle).value_or(0);
  return skins;
}

void describe_tables(const trainer::BuiltDynamics& built, report::JiggleReport& report) {
  const std::map<std::string, std::size_t> bytes = table_bytes(built.dynamics);
  report.tets = built.report.tets;
  report.nodes = built.report.nodes;
  report.worst_quality = built.report.quality.worst;
  report.diffuse_mb = static_cast<double>(bytes.at("diffuse")) / 1e6;
  report.jiggle_mb = static_cast<double>(bytes.at("jiggle")) / 1e6;
}

// Vertices that go with the joints from one to another, in the skeleton's order, more than with any other.
std::vector<std::size_t> vertices_between(const Character& character, const char* first, const char* last) {
  const auto begin = static_cast<std::uint32_t>(character.skeleton.find(first));
  const auto end = static_cast<std::uint32_t>(character.skeleton.find(last));
  std::vector<std::size_t> vertices;
  for (std::size_t v = 0; v < character.weights.size(); ++v) {
    const std::uint32_t joint = character.weights[v].front().joint;
    if (joint >= begin && joint <= end) vertices.push_back(v);
  }
  return vertices;
}

report::Panel panel_of(const Skins& skins, std::size_t begin, const std::vector<std::size_t>& vertices,
                       std::uint32_t width, std::uint32_t height) {
  std::vector<float> points;
  for (std::size_t f = begin; f < skins.size(); ++f) {
    for (const std::size_t v : vertices) points.insert(points.end(), &skins[f][3 * v], &skins[f][3 * v] + 3);
  }
  constexpr std::array<float, 3> kDirection = {0.0f, 0.1f, 1.0f};
  return {draw::frame_points(points, kDirection, static_cast<float>(width) / static_cast<float>(height)), width,
          height};
}

// Frames around the stop are close together where flesh moves fastest.
std::vector<std::size_t> strip_frames() {
  std::vector<std::size_t> frames;
  for (const int after : {-1, 0, 1, 2, 3, 4, 6, 9})
    frames.push_back(static_cast<std::size_t>(trainer::kStopEnds + after - 1));
  return frames;
}

void draw(const Character& character, const Skins& still, const Skins& jiggling, const std::string& device,
          const fs::path& folder, report::JiggleReport& report) {
  draw::Renderer renderer(device);
  const report::FlipBook book{report::flat(character.triangles), still, jiggling};
  const std::vector<std::size_t> frames = strip_frames();
  const std::vector<std::size_t> arm = vertices_between(character, "shoulder", "thumb"),
                                 flesh = vertices_between(character, "shoulder", "forearm");
  report::JiggleReport::Pictures pictures;
  pictures.heat_scale_mm = report::heat_scale(*std::ranges::max_element(report.max_mm));
  pictures.strip = report::flip_book_strip(renderer, book, frames, pictures.heat_scale_mm,
                                           panel_of(jiggling, frames.front(), flesh, 400, 260));
  for (const std::size_t k : frames) pictures.strip_frames.push_back(report.frames[k]);
  draw::write_png(pictures.strip, folder / "stop_strip.png");

  const std::vector<draw::Image> animated =
      report::flip_book_frames(renderer, book, panel_of(jiggling, 0, arm, 560, 600));
  pictures.width = animated.front().width;
  pictures.height = animated.front().height;
  const double milliseconds = 1000 / report.frames_per_second;
  pictures.animation = draw::encode_animation(animated, milliseconds);
  pictures.slow_animation = draw::encode_animation(animated, 2 * milliseconds);
  write_file_atomically(folder / "stop.webp", std::as_bytes(std::span(pictures.animation)));
  write_file_atomically(folder / "stop_slow.webp", std::as_bytes(std::span(pictures.slow_animation)));
  report.pictures = std::move(pictures);
}

constexpr int kFrameStep = 6;  // of the held-out clip

void write_page(const trainer::TransferPair& pair, const Basis& carried, const fs::path& folder) {
  const Clip clip = read_clip((folder / "heldout.glb").string(), pair.source.skeleton, {});
  std::vector<int> frames;
  for (int frame = clip.first_frame; frame <= clip.last_frame(); frame += kFrameStep) frames.push_back(frame);
  const std::vector<ComparedPose> poses = compare_poses(pair, carried, clip, frames);
  Json target = {{"target", "stocky.glb"}, {"vertices", carried.mesh.vertex_count()}};
  target.update(to_json(pair, trainer::likeness(pair)));
  target.update(to_json(trainer::transfer_parts(pair.source, pair.target, pair.match, pair.correspondence), poses));
  const Json figures = {{"title", "A stockier arm"},
                        {"subtitle", "What the built-in arm learned, on one of thicker flesh and other triangles"},
                        {"targets", Json::array({target})}};
  const std::string page =
      report::page_text("transfer", figures, Json::array({transfer_pictures(pair, carried.mesh, poses)}));
  write_file_atomically(folder / "transfer.html", std::as_bytes(std::span(page)));
}

}  // namespace

report::JiggleReport demo_jiggle(const trainer::SampleSet& set, const Basis& basis, const DeviceChoice& device,
                                 const std::string& pictures_on, const fs::path& folder) {
  report::JiggleReport report;
  const trainer::BuiltDynamics built = trainer::build_dynamics(
      set.character, set.muscles, basis,
      {.settings = trainer::read_jiggle(folder / "jiggle.json"), .poses = trainer::training_poses(set)});
  save_dynamics(built.dynamics, dynamics_beside(folder / "basis.safetensors"));
  describe_tables(built, report);

  const Clip clip = read_clip((folder / "stop.glb").string(), basis.skeleton, {});
  report.moves_after = trainer::kStopBegins;
  report.stops = trainer::kStopEnds;
  report.frames_per_second = clip.fps;
  for (int frame = clip.first_frame; frame <= clip.last_frame(); ++frame) report.frames.push_back(frame);
  Deformer deformer(basis, built.dynamics, {}, device);
  const Skins still = skins_of(set.character, deformer.evaluate(clip.poses));
  const Skins jiggling = jiggle(set.character, clip, deformer, report);
  report.device = deformer.device_name();
  if (!pictures_on.empty()) draw(set.character, still, jiggling, pictures_on, folder, report);
  return report;
}

std::string demo_transfer(const fs::path& folder, bool has_pictures) {
  write_character(trainer::build_stocky_arm(), folder / "stocky.glb");
  const Character stocky = read_character(folder / "stocky.glb");
  const Basis source = load_basis(folder / "basis.safetensors");
  const trainer::TransferOptions options;
  const trainer::TransferPair pair(source, stocky, options);
  std::vector<std::string> notes;
  const Basis carried = trainer::transfer_basis(pair, options, notes);
  say(notes);
  save_basis(carried, folder / "stocky.safetensors");
  if (has_pictures) write_page(pair, carried, folder);
  return format("carried to a stockier arm of {} vertices (this one: {}), matched with a confidence of {:.2f}\n",
                carried.mesh.vertex_count(), source.mesh.vertex_count(), pair.correspondence.mean_confidence());
}

}  // namespace bodyopt::cli
