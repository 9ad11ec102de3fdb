#include "cli/results/pages.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>

#include "assets/caches/shape_reader.h"
#include "assets/caches/usda_part.h"
#include "base/frame_range.h"
#include "base/spread_evenly.h"
#include "draw/colours.h"
#include "farm/plan.h"
#include "geometry/mesh.h"
#include "report/page.h"
#include "report/pictures.h"
#include "runtime/basis/output_order.h"
#include "runtime/core/error.h"
#include "runtime/core/transformed.h"
#include "runtime/cpu/kernels.h"
#include "runtime/deformer/deformer.h"
#include "runtime/host/stages.h"
#include "shots/shot_files.h"
#include "trainer/train/coverage/coverage.h"
#include "trainer/transfer/correspondence.h"
#include "trainer/transfer/transfer_basis.h"

namespace bodyopt::cli {
namespace {

constexpr std::uint32_t kPictureWidth = 290, kPictureHeight = 330;

// `output`: O x 3.
draw::Image draw_output(draw::Renderer& renderer, const MeshTable& mesh, const std::vector<float>& output,
                        std::uint32_t width, std::uint32_t height) {
  const std::vector<float> skin = vertices_of(mesh, output);
  return report::draw_skin(renderer, mesh.triangles, skin, {},
                           {report::framed(skin, {0.35f, 0.15f, 1}, width, height), width, height});
}

// Characters, each read once.
class CacheDrawer {
 public:
  draw::Image draw(const farm::WorthyFrame& worthy) {
    const farm::FarmStep& step = *worthy.step;
    const std::vector<float> points = read(step.out, worthy.sample);
    const MeshTable& mesh = mesh_of(step);
    if (points.size() != 3 * mesh.output_vertex.size()) {
      throw Error(ErrorKind::mismatch, step.out, ": is of another mesh than its basis");
    }
    return draw_output(renderer_, mesh, points, kPictureWidth, kPictureHeight);
  }

 private:
  static std::vector<float> read(const std::string& cache, std::uint32_t sample) {
    if (cache.ends_with(".usda")) return UsdaPart(cache).points(sample);
    const ShapeReader reader(cache);
    if (sample >= reader.sample_count()) throw Error(ErrorKind::mismatch, cache, ": has fewer samples than frames");
    return reader.sample(sample);
  }

  const MeshTable& mesh_of(const farm::FarmStep& step) {
    const std::vector<std::string> session = step.option("--session"), level = step.option("--level");
    shots::ShotFiles files;
    if (!level.empty()) files.level = std::strtoul(level.front().c_str(), nullptr, 10);
    if (session.empty()) {
      files.basis = step.arguments.at(1);
    } else {
      shots::take_session(session.front(), files);
    }
    const std::pair key(files.basis, files.level);
    auto found = meshes_.find(key);
    if (found == meshes_.end()) {
      shots::OpenedCharacter opened = shots::open_level(files);
      found = meshes_.emplace(key, std::move(opened.levels.front().basis.mesh)).first;
    }
    return found->second;
  }

  draw::Renderer renderer_;
  std::map<std::pair<std::string, std::size_t>, MeshTable> meshes_;  // by character and level
};

// Draws every frame worth a look, or says why it cannot.
Json looks_of(const farm::ShowSummary& summary) {
  Json looks = Json::array();
  std::optional<CacheDrawer> drawer;
  for (const farm::WorthyFrame& worthy : summary.worth_a_look) {
    try {
      if (!drawer) drawer.emplace();
      looks.push_back(report::page_picture(drawer->draw(worthy)));
    } catch (const Error& error) {
      looks.push_back({{"problem", error.what()}});
    }
  }
  return looks;
}

constexpr std::size_t kShownPoses = 3;
constexpr std::uint32_t kWidth = 190, kHeight = 330;  // of a body in a pose

std::string next_frames(const std::vector<ComparedPose>& poses) {
  return trainer::frames_to_simulate(transformed(poses, &ComparedPose::frame),
                                     transformed(poses, &ComparedPose::expected_rms_mm));
}

// Source and target in turn, in every pose that is shown.
draw::Image poses_picture(const MeshTable& source, const MeshTable& carried, const std::vector<ComparedPose>& poses) {
  draw::Renderer renderer;
  std::vector<draw::Image> row;
  for (const std::size_t k : spread_in_middles(poses.size(), kShownPoses)) {
    row.push_back(draw_output(renderer, source, poses[k].source, kWidth, kHeight));
    row.push_back(draw_output(renderer, carried, poses[k].target, kWidth, kHeight));
  }
  return report::side_by_side(row);
}

Json names_without(const std::vector<int>& match, const Skeleton& skeleton) {
  Json names = Json::array();
  for (std::size_t j = 0; j < match.size(); ++j) {
    if (match[j] < 0) names.push_back(skeleton.joints[j].name);
  }
  return names;
}

struct Body {
  std::vector<float> positions, normals, colours;
  const std::vector<std::uint32_t>& triangles;
};

// Each as large as the others, on one ground, `shift` (of its size) along x.
Body body_of(const MeshTable& mesh, const Positions& skin, double shift, const Positions& colours) {
  Body body{{}, std::vector<float>(mesh.rest.size()), {}, mesh.triangles};
  const Eigen::RowVector3d low = skin.colwise().minCoeff(), high = skin.colwise().maxCoeff(), middle = (low + high) / 2;
  const double size = std::max((high - low).maxCoeff(), 1e-9);
  const Eigen::RowVector3d origin(middle[0], low[1], middle[2]);
  for (Eigen::Index v = 0; v < skin.rows(); ++v) {
    const Eigen::RowVector3d point = (skin.row(v) - origin) / size;
    for (int i = 0; i < 3; ++i) {
      body.positions.push_back(static_cast<float>(point[i] + (i == 0 ? shift : 0)));
      body.colours.push_back(static_cast<float>(colours(v, i)));
    }
  }
  cpu::output_normals(mesh, body.positions, body.normals);
  return body;
}

Positions confidence_colours(const trainer::Correspondence& correspondence) {
  Positions result(correspondence.target.rows(), 3);
  for (Eigen::Index v = 0; v < result.rows(); ++v) {
    const auto colour = draw::heat_colour(static_cast<float>(1 - std::clamp(correspondence.confidence[v], 0.0, 1.0)));
    result.row(v) << double{colour[0]}, double{colour[1]}, double{colour[2]};
  }
  return result;
}

}  // namespace

std::string show_page(const farm::FarmPlan& plan, const farm::ShowSummary& summary) {
  return report::page_text("show", to_json(plan, summary), {{"looks", looks_of(summary)}});
}

Json to_json(const farm::FarmPlan& plan, const farm::ShowSummary& summary) {
  const Json elements = transformed(summary.elements, [](const farm::ElementSummary& element) {
    return Json{{"shot", element.shot},
                {"element", element.element},
                {"out", element.out},
                {"state", farm::name_of(element.state)},
                {"message", element.failure ? element.failure->message : ""},
                {"host", element.failure ? element.failure->host : ""},
                {"frames", element.frames},
                {"seconds", element.seconds},
                {"peak_memory_mib", element.peak_memory_mib},
                {"device", element.device},
                {"outside_frames", format_frame_range(element.outside)},
                {"outside_count", element.outside.size()},
                {"worst_outside", element.worst_outside}};
  });
  const Json frames = transformed(summary.worth_a_look, [](const farm::WorthyFrame& worthy) {
    return Json{{"shot", worthy.step->shot},
                {"element", worthy.step->element},
                {"frame", worthy.frame},
                {"expected_rms_mm", worthy.expected_rms_mm},
                {"outside", worthy.outside}};
  });
  const Json next = transformed(summary.simulate_next, [](const farm::FramesToSimulate& entry) {
    return Json{{"basis", entry.basis},
                {"clip", entry.clip},
                {"frames", format_frame_range(entry.frames)},
                {"frame_count", entry.frames.size()},
                {"options", simulate_options(entry)}};
  });
  return {{"show", plan.show},
          {"tasks", plan.tasks.size()},
          {"elements", elements},
          {"worth_a_look", frames},
          {"simulate_next", next}};
}

std::string simulate_options(const farm::FramesToSimulate& next) {
  std::string text = "--clip " + farm::quoted_for_shell(next.clip) + " --frames " + format_frame_range(next.frames);
  for (const std::string& word : next.options)
    text += " " + (word.starts_with("--") ? word : farm::quoted_for_shell(word));
  return text;
}

std::vector<ComparedPose> compare_poses(const trainer::TransferPair& pair, const Basis& carried, const Clip& clip,
                                        const std::vector<int>& frames) {
  Deformer source(pair.source, {.name = "cpu"}), target(carried, {.name = "cpu"});
  const std::vector<std::size_t> shown = spread_in_middles(frames.size(), kShownPoses);
  std::vector<ComparedPose> poses;
  std::optional<ErrorExpectation> expectation;
  if (!carried.coverage.empty()) expectation.emplace(carried);
  for (const int frame : frames) {
    const Pose& pose = clip.poses.at(static_cast<std::size_t>(frame - clip.first_frame));
    const Pose moved = trainer::transferred_pose(pair.match, pair.source.skeleton, pair.target.skeleton, pose);
    ComparedPose compared;
    compared.frame = frame;
    compared.source = source.evaluate({&pose, 1}).positions;
    Evaluation on_target = target.evaluate({&moved, 1});
    if (expectation) compared.expected_rms_mm = expectation->of(on_target, 0).rms_mm;
    compared.target = std::move(on_target.positions);
    compared.source_volume = trainer::relative_volume(pair.source.mesh, compared.source);
    compared.target_volume = trainer::relative_volume(carried.mesh, compared.target);
    if (!std::ranges::binary_search(shown, poses.size())) compared.source = compared.target = {};
    poses.push_back(std::move(compared));
  }
  return poses;
}

Json transfer_pictures(const trainer::TransferPair& pair, const MeshTable& carried,
                       const std::vector<ComparedPose>& poses) {
  Json pictures = {{"match", report::page_picture(transfer_picture(pair))}};
  if (!poses.empty()) pictures["poses"] = report::page_picture(poses_picture(pair.source.mesh, carried, poses));
  return pictures;
}

Json to_json(const trainer::TransferPair& pair, double alike) {
  const trainer::Correspondence& correspondence = pair.correspondence;
  const double count = static_cast<double>(std::max<Eigen::Index>(1, correspondence.distance.size()));
  return {{"same_topology", correspondence.same_topology},
          {"size_ratio", pair.match.size},
          {"matched_joints", std::ranges::count_if(pair.match.source_joint, [](int joint) { return joint >= 0; })},
          {"unmatched_source_joints", names_without(pair.match.target_joint, pair.source.skeleton)},
          {"unmatched_target_joints", names_without(pair.match.source_joint, pair.target.skeleton)},
          {"posed_to_the_source", pair.match.is_aligned()},
          {"likeness", alike},
          {"least_likeness", trainer::kLeastLikeness},
          {"confidence", correspondence.mean_confidence()},
          {"filled_in_vertices", pair.skin.unsure()},
          {"fit_rms_mm", 1e3 * std::sqrt(correspondence.distance.squaredNorm() / count)}};
}

Json to_json(const std::vector<trainer::TransferPart>& parts, const std::vector<ComparedPose>& poses) {
  const Json list = transformed(parts, [](const trainer::TransferPart& part) {
    return Json{{"joint", part.joint}, {"vertices", part.vertices},     {"confidence", part.confidence},
                {"size", part.size},   {"unevenness", part.unevenness}, {"breaks_assumption", part.breaks_assumption}};
  });
  const Json volumes = transformed(poses, [](const ComparedPose& pose) {
    return Json{{"frame", pose.frame},
                {"is_shown", !pose.source.empty()},
                {"source_volume", pose.source_volume},
                {"target_volume", pose.target_volume},
                {"expected_rms_mm", pose.expected_rms_mm}};
  });
  return {{"parts", list}, {"poses", volumes}, {"worth_simulating", next_frames(poses)}};
}

draw::Image transfer_picture(const trainer::TransferPair& pair) {
  const MeshTable &from = pair.source.mesh, &to = pair.target.mesh;
  const Positions rest = rows_of(from.rest);
  const trainer::Correspondence& correspondence = pair.correspondence;
  const Positions colours = trainer::place_colours(rest);
  const auto width_of = [](const Positions& p) {
    const Eigen::RowVector3d extent = box_sides(p);
    return extent[0] / std::max(extent.maxCoeff(), 1e-9);
  };
  const double step = 0.1 + std::max(width_of(rest), width_of(correspondence.target));
  const Body bodies[] = {body_of(from, rest, -step, colours),
                         body_of(to, correspondence.target, 0, trainer::matched_colours(correspondence, colours)),
                         body_of(to, correspondence.target, step, confidence_colours(correspondence))};
  std::vector<draw::DrawMesh> meshes;
  std::vector<float> points;
  for (const Body& body : bodies) {
    meshes.push_back({body.positions, body.normals, body.triangles, body.colours});
    points.insert(points.end(), body.positions.begin(), body.positions.end());
  }
  constexpr std::uint32_t kWidth = 1280, kHeight = 560;
  const draw::Camera camera = draw::frame_points(points, {0, 0.15f, 1}, float{kWidth} / kHeight);
  return draw::Renderer().draw(meshes, camera, kWidth, kHeight);
}

}  // namespace bodyopt::cli
