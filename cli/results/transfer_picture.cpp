#include "cli/results/transfer_picture.h"

#include <algorithm>

#include "draw/heat_colour.h"
#include "geometry/extent.h"
#include "geometry/table_rows.h"
#include "runtime/cpu/kernels.h"
#include "trainer/transfer/match_colours.h"

namespace bodyopt::cli {
namespace {

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

Positions confidence_colours(const Correspondence& correspondence) {
  Positions result(correspondence.target.rows(), 3);
  for (Eigen::Index v = 0; v < result.rows(); ++v) {
    const auto colour = heat_colour(static_cast<float>(1 - std::clamp(correspondence.confidence[v], 0.0, 1.0)));
    result.row(v) << double{colour[0]}, double{colour[1]}, double{colour[2]};
  }
  return result;
}

}  // namespace

Image transfer_picture(const TransferPair& pair) {
  const MeshTable &from = pair.source.mesh, &to = pair.target.mesh;
  const Positions rest = rows_of(from.rest);
  const Correspondence& correspondence = pair.correspondence;
  const Positions colours = place_colours(rest);
  const auto width_of = [](const Positions& p) {
    const Eigen::RowVector3d extent = box_sides(p);
    return extent[0] / std::max(extent.maxCoeff(), 1e-9);
  };
  const double step = 0.1 + std::max(width_of(rest), width_of(correspondence.target));
  const Body bodies[] = {body_of(from, rest, -step, colours),
                         body_of(to, correspondence.target, 0, matched_colours(correspondence, colours)),
                         body_of(to, correspondence.target, step, confidence_colours(correspondence))};
  std::vector<DrawMesh> meshes;
  std::vector<float> points;
  for (const Body& body : bodies) {
    meshes.push_back({body.positions, body.normals, body.triangles, body.colours});
    points.insert(points.end(), body.positions.begin(), body.positions.end());
  }
  constexpr std::uint32_t kWidth = 1280, kHeight = 560;
  const Camera camera = frame_points(points, {0, 0.15f, 1}, float{kWidth} / kHeight);
  return Renderer().draw(meshes, camera, kWidth, kHeight);
}

}  // namespace bodyopt::cli
