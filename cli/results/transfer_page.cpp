#include "cli/results/transfer_page.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "assets/frame_range.h"
#include "cli/results/number_cell.h"
#include "cli/results/transfer_picture.h"
#include "geometry/closed_skin.h"
#include "report/pictures.h"
#include "trainer/train/coverage/coverage.h"
#include "trainer/transfer/transfer_parts.h"

namespace bodyopt::cli {
namespace {

constexpr std::size_t kShownPoses = 3, kFramesToSimulate = 20;
constexpr std::uint32_t kWidth = 190, kHeight = 330;  // of a body in a pose

// Runtime vertices from output vertices.
std::vector<float> without_seams(const MeshTable& mesh, const float* output) {
  std::vector<float> skin(mesh.rest.size());
  for (std::size_t o = 0; o < mesh.output_vertex.size(); ++o) {
    std::copy_n(output + 3 * o, 3, &skin[std::size_t{3} * mesh.output_vertex[o]]);
  }
  return skin;
}

double volume_of(const MeshTable& mesh, const std::vector<float>& skin) {
  using FloatRows = Eigen::Matrix<float, Eigen::Dynamic, 3, Eigen::RowMajor>;
  using Corners = Eigen::Matrix<std::uint32_t, Eigen::Dynamic, 3, Eigen::RowMajor>;
  const auto vertices = static_cast<Eigen::Index>(skin.size() / 3),
             triangles = static_cast<Eigen::Index>(mesh.triangles.size() / 3);
  return enclosed_volume(Eigen::Map<const FloatRows>(skin.data(), vertices, 3).cast<double>(),
                         Eigen::Map<const Corners>(mesh.triangles.data(), triangles, 3).cast<Triangles::Scalar>());
}

std::vector<float> skin_in(Deformer& deformer, const Pose& pose) {
  return without_seams(deformer.basis().mesh, deformer.evaluate({&pose, 1}).positions.data());
}

Image draw_pose(Renderer& renderer, const MeshTable& mesh, const std::vector<float>& skin) {
  const std::vector<float> normals = smooth_normals(mesh.triangles, skin);
  const DrawMesh drawn{skin, normals, mesh.triangles, {}};
  const Camera camera = frame_points(skin, {0.35f, 0.15f, 1}, static_cast<float>(kWidth) / kHeight);
  return renderer.draw(std::span(&drawn, 1), camera, kWidth, kHeight);
}

// Some, spread over all.
std::vector<const ComparedPose*> shown_of(const std::vector<ComparedPose>& poses) {
  std::vector<const ComparedPose*> shown;
  const std::size_t count = std::min(kShownPoses, poses.size());
  for (std::size_t k = 0; k < count; ++k) shown.push_back(&poses[(2 * k + 1) * poses.size() / (2 * count)]);
  return shown;
}

void add_poses(const MeshTable& source, const MeshTable& carried, const std::vector<ComparedPose>& poses, Page& page) {
  if (poses.empty()) return;
  Renderer renderer;
  std::vector<Image> row;
  std::vector<std::string> labels;
  for (const ComparedPose* pose : shown_of(poses)) {
    row.push_back(draw_pose(renderer, source, pose->source));
    row.push_back(draw_pose(renderer, carried, pose->target));
    labels.push_back(format("frame %d: source", pose->frame));
    labels.push_back("target");
  }
  page.picture(side_by_side(row), labels, "The same poses",
               "The source by its basis, the target by what was carried, each as large as the picture.", "");
  Table table{{{"frame"}, {"volume, source"}, {"volume, target"}, {"expected error, mm"}}, {}};
  for (const ComparedPose* pose : shown_of(poses)) {
    table.rows.push_back({{std::to_string(pose->frame), {}},
                          number_of("%+.1f %%", 100 * (pose->source_volume - 1)),
                          number_of("%+.1f %%", 100 * (pose->target_volume - 1)),
                          number_of("%.2f", pose->expected_rms_mm)});
  }
  page.table(table);
  page.paragraph("Volumes are what the skin encloses, against its rest.");
  if (const std::string frames = frames_to_simulate(poses); !frames.empty()) {
    page.paragraph("Worth simulating next on the target, by the error that is expected: --frames " + frames);
  }
}

std::vector<TransferPart> parts_of(const TransferPair& pair) {
  return transfer_parts(pair.source, pair.target, pair.match, pair.correspondence);
}

void add_parts(const TransferPair& pair, Page& page) {
  const std::vector<TransferPart> parts = parts_of(pair);
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
  const double source_rest = volume_of(pair.source.mesh, pair.source.mesh.rest),
               target_rest = volume_of(carried.mesh, carried.mesh.rest);
  std::vector<ComparedPose> poses;
  std::vector<Pose> moved;
  for (const int frame : frames) {
    const Pose& pose = clip.poses.at(static_cast<std::size_t>(frame - clip.first_frame));
    moved.push_back(transferred_pose(pair.match, pair.source.skeleton, pair.target.skeleton, pose));
    ComparedPose compared{frame, skin_in(source, pose), skin_in(target, moved.back()), 1, 1, 0};
    compared.source_volume = volume_of(pair.source.mesh, compared.source) / source_rest;
    compared.target_volume = volume_of(carried.mesh, compared.target) / target_rest;
    poses.push_back(std::move(compared));
  }
  if (!carried.coverage.empty()) {
    const std::vector<ExpectedError> errors = expected_errors(carried, moved);
    for (std::size_t k = 0; k < poses.size(); ++k) poses[k].expected_rms_mm = errors[k].rms_mm;
  }
  return poses;
}

std::string frames_to_simulate(const std::vector<ComparedPose>& poses) {
  std::vector<double> expected;
  for (const ComparedPose& pose : poses) expected.push_back(pose.expected_rms_mm);
  std::vector<int> frames;
  for (const std::size_t k :
       worth_simulating(expected, kFramesToSimulate, spreading_gap(poses.size(), kFramesToSimulate))) {
    if (expected[k] > 0) frames = unite_frames(frames, {poses[k].frame});
  }
  return format_frame_range(frames);
}

void add_transfer(const TransferPair& pair, const std::string& target, const MeshTable& carried,
                  const std::vector<ComparedPose>& poses, Page& page) {
  const Correspondence& match = pair.correspondence;
  page.heading(target);
  const std::array headlines{
      Headline{format("%.2f", match.mean_confidence()), "",
               match.same_topology ? "confidence: the same triangles" : "confidence of the match (1: surely the same)"},
      Headline{format("%.3g", pair.match.size), "times", "as large as the source"},
      Headline{std::to_string(pair.skin.unsure()), "of " + std::to_string(match.target.rows()),
               "vertices are filled in from around"}};
  page.headlines(headlines);
  const std::vector<std::string> labels{"source, by place", "target, by its matches", "target, hot where unsure"};
  page.picture(transfer_picture(pair), labels, "Which point is which",
               "The same colour is the same point. Both in the pose in which they were matched.", "");
  add_parts(pair, page);
  add_poses(pair.source.mesh, carried, poses, page);
}

Json to_json(const TransferPair& pair, const std::vector<ComparedPose>& poses) {
  Json parts = Json::array(), volumes = Json::array();
  for (const TransferPart& part : parts_of(pair)) {
    parts.push_back({{"joint", part.joint},
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
  return {{"parts", parts}, {"poses", volumes}, {"worth_simulating", frames_to_simulate(poses)}};
}

}  // namespace bodyopt::cli
