#include "cli/results/transfer_page.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

#include "cli/results/number_cell.h"
#include "cli/results/transfer_picture.h"
#include "report/pictures.h"
#include "runtime/basis/output_order.h"
#include "trainer/train/coverage/coverage.h"
#include "trainer/transfer/likeness.h"
#include "trainer/transfer/motion_of_target.h"

namespace bodyopt::cli {
namespace {

constexpr std::size_t kShownPoses = 3;
constexpr std::uint32_t kWidth = 190, kHeight = 330;  // of a body in a pose

Image draw_pose(Renderer& renderer, const MeshTable& mesh, const std::vector<float>& output) {
  const std::vector<float> skin = vertices_of(mesh, output);
  const std::vector<float> normals = smooth_normals(mesh.triangles, skin);
  const DrawMesh drawn{skin, normals, mesh.triangles, {}};
  const Camera camera = frame_points(skin, {0.35f, 0.15f, 1}, static_cast<float>(kWidth) / kHeight);
  return renderer.draw(std::span(&drawn, 1), camera, kWidth, kHeight);
}

// Some, spread over all.
std::vector<std::size_t> shown_of(std::size_t poses) {
  std::vector<std::size_t> shown;
  const std::size_t count = std::min(kShownPoses, poses);
  for (std::size_t k = 0; k < count; ++k) shown.push_back((2 * k + 1) * poses / (2 * count));
  return shown;
}

std::string next_frames(const std::vector<ComparedPose>& poses) {
  std::vector<int> frames;
  std::vector<double> expected;
  for (const ComparedPose& pose : poses) {
    frames.push_back(pose.frame);
    expected.push_back(pose.expected_rms_mm);
  }
  return frames_to_simulate(frames, expected);
}

void add_poses(const MeshTable& source, const MeshTable& carried, const std::vector<ComparedPose>& poses, Page& page) {
  if (poses.empty()) return;
  Renderer renderer;
  std::vector<Image> row;
  std::vector<std::string> labels;
  for (const std::size_t k : shown_of(poses.size())) {
    row.push_back(draw_pose(renderer, source, poses[k].source));
    row.push_back(draw_pose(renderer, carried, poses[k].target));
    labels.push_back(format("frame %d: source", poses[k].frame));
    labels.push_back("target");
  }
  page.picture(side_by_side(row), labels, "The same poses",
               "The source by its basis, the target by what was carried, each as large as the picture.", "");
  Table table{{{"frame"}, {"volume, source"}, {"volume, target"}, {"expected error, mm"}}, {}};
  for (const std::size_t k : shown_of(poses.size())) {
    table.rows.push_back({{std::to_string(poses[k].frame), {}},
                          number_of("%+.1f %%", 100 * (poses[k].source_volume - 1)),
                          number_of("%+.1f %%", 100 * (poses[k].target_volume - 1)),
                          number_of("%.2f", poses[k].expected_rms_mm)});
  }
  page.table(table);
  page.paragraph("Volumes are what the skin encloses, against its rest.");
  if (const std::string frames = next_frames(poses); !frames.empty()) {
    page.paragraph("Worth simulating next on the target, by the error that is expected: --frames " + frames);
  }
}

void add_parts(const std::vector<TransferPart>& parts, Page& page) {
  Table table{{{"held by"}, {"vertices"}, {"confidence"}, {"size"}, {"uneven by"}, {""}}, {}};
  for (const TransferPart& part : parts) {
    table.rows.push_back({{part.joint, {}},
                          number_of("%.0f", static_cast<double>(part.vertices)),
                          number_of("%.2f", part.confidence),
                          number_of("%.2f", part.size),
                          number_of("%.0f %%", 100 * part.unevenness),
                          {part.breaks_assumption ? "another anatomy: a guess" : "", {}}});
  }
  page.table(table);
  page.paragraph(
      "Size: lengths along the skin, target over source. Uneven: how much that differs within the part. What "
      "is carried rests on parts being alike but for their size; where they are not, simulate or sculpt.");
}

}  // namespace

std::vector<ComparedPose> compare_poses(const TransferPair& pair, const Basis& carried, const Clip& clip,
                                        const std::vector<int>& frames) {
  Deformer source(pair.source, {.name = "cpu"}), target(carried, {.name = "cpu"});
  const std::vector<std::size_t> shown = shown_of(frames.size());
  std::vector<ComparedPose> poses;
  std::vector<Pose> moved;
  for (const int frame : frames) {
    const Pose& pose = clip.poses.at(static_cast<std::size_t>(frame - clip.first_frame));
    moved.push_back(transferred_pose(pair.match, pair.source.skeleton, pair.target.skeleton, pose));
    ComparedPose compared;
    compared.frame = frame;
    compared.source = source.evaluate({&pose, 1}).positions;
    compared.target = target.evaluate({&moved.back(), 1}).positions;
    compared.source_volume = relative_volume(pair.source.mesh, compared.source);
    compared.target_volume = relative_volume(carried.mesh, compared.target);
    if (!std::ranges::binary_search(shown, poses.size())) compared.source = compared.target = {};
    poses.push_back(std::move(compared));
  }
  if (!carried.coverage.empty()) {
    const std::vector<ExpectedError> errors = expected_errors(carried, moved);
    for (std::size_t k = 0; k < poses.size(); ++k) poses[k].expected_rms_mm = errors[k].rms_mm;
  }
  return poses;
}

void add_transfer(const TransferPair& pair, double alike, const std::vector<TransferPart>& parts,
                  const std::string& target, const MeshTable& carried, const std::vector<ComparedPose>& poses,
                  Page& page) {
  const Correspondence& match = pair.correspondence;
  page.heading(target);
  const std::array headlines{
      Headline{format("%.2f", alike), "", format("likeness: under %.2f are unlike bodies", kLeastLikeness)},
      Headline{format("%.2f", match.mean_confidence()), "",
               match.same_topology ? "confidence: the same triangles" : "confidence of the match (1: surely the same)"},
      Headline{format("%.3g", pair.match.size), "times", "as large as the source"},
      Headline{std::to_string(pair.skin.unsure()), "of " + std::to_string(match.target.rows()),
               "vertices are filled in from around"}};
  page.headlines(headlines);
  const std::vector<std::string> labels{"source, by place", "target, by its matches", "target, hot where unsure"};
  page.picture(transfer_picture(pair), labels, "Which point is which",
               "The same colour is the same point. Both in the pose in which they were matched.", "");
  add_parts(parts, page);
  add_poses(pair.source.mesh, carried, poses, page);
}

Json to_json(const std::vector<TransferPart>& parts, const std::vector<ComparedPose>& poses) {
  Json list = Json::array(), volumes = Json::array();
  for (const TransferPart& part : parts) {
    list.push_back({{"joint", part.joint},
                    {"vertices", part.vertices},
                    {"confidence", part.confidence},
                    {"size", part.size},
                    {"unevenness", part.unevenness},
                    {"breaks_assumption", part.breaks_assumption}});
  }
  for (const ComparedPose& pose : poses) {
    volumes.push_back({{"frame", pose.frame},
                       {"source_volume", pose.source_volume},
                       {"target_volume", pose.target_volume},
                       {"expected_rms_mm", pose.expected_rms_mm}});
  }
  return {{"parts", list}, {"poses", volumes}, {"worth_simulating", next_frames(poses)}};
}

}  // namespace bodyopt::cli
