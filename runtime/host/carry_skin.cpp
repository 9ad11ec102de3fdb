#include "runtime/host/carry_skin.h"

#include <algorithm>
#include <cmath>

#include "runtime/core/error.h"
#include "runtime/host/rig.h"
#include "shaders/include/rotation.h"

namespace bodyopt {
namespace {

float dot(const float* a, const float* b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

void normalise(float* v) {
  const float length = std::sqrt(dot(v, v));
  const float scale = length > 1e-20f ? 1.0f / length : 0.0f;
  for (int i = 0; i < 3; ++i) v[i] *= scale;
}

// How much of R is the joint's: nothing that could be seen, all of it where the skin says nothing.
constexpr double kJointShare = 1e-6;

Vec3 row_at(std::span<const float> values, std::uint32_t row) {
  const float* x = values.data() + 3 * std::size_t{row};
  return {static_cast<double>(x[0]), static_cast<double>(x[1]), static_cast<double>(x[2])};
}

Vec3 unit(const Vec3& v) {
  const double size = length(v);
  return size > 1e-30 ? (1 / size) * v : Vec3{0, 0, 0};
}

// matrix += weight posed rest^T
void add_outer(double weight, const Vec3& posed, const Vec3& rest, std::array<double, 9>& matrix) {
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) matrix[3 * i + j] += weight * posed[i] * rest[j];
  }
}

}  // namespace

CarryFrame carry_frame(const MeshTable& mesh, std::span<const float> positions, std::span<const float> normals,
                       const CarriedPoint& point) {
  const std::uint32_t* corners = mesh.output_triangles.data() + 3 * std::size_t{point.triangle};
  constexpr float kUnit = 1.0f / 255;
  const float weights[] = {1.0f - kUnit * (point.b + point.c), kUnit * point.b, kUnit * point.c};
  CarryFrame frame{};
  for (int k = 0; k < 3; ++k) {
    const float *x = positions.data() + 3 * std::size_t{corners[k]}, *n = normals.data() + 3 * std::size_t{corners[k]};
    for (int i = 0; i < 3; ++i) {
      frame.position[i] += weights[k] * x[i];
      frame.normal[i] += weights[k] * n[i];
    }
  }
  normalise(frame.normal);
  const float *a = positions.data() + 3 * std::size_t{corners[0]}, *b = positions.data() + 3 * std::size_t{corners[1]};
  for (int i = 0; i < 3; ++i) frame.edge[i] = b[i] - a[i];
  const float along = dot(frame.edge, frame.normal);
  for (int i = 0; i < 3; ++i) frame.edge[i] -= along * frame.normal[i];
  normalise(frame.edge);
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    frame.across[i] = frame.normal[j] * frame.edge[k] - frame.normal[k] * frame.edge[j];
  }
  return frame;
}

std::vector<float> carry_skin(const MeshTable& mesh, const CarriedSkin& carried, std::span<const float> positions,
                              std::span<const float> normals, Executor& threads) {
  constexpr std::size_t kLeastPoints = 1024;  // that are worth a thread
  const std::size_t stride = 3 * std::size_t{mesh.output_count()};
  const std::size_t frames = stride == 0 ? 0 : positions.size() / stride;
  std::vector<float> full(3 * frames * carried.size());
  parallel_each(threads, frames * carried.size(), kLeastPoints, [&](std::size_t k) {
    const std::size_t f = k / carried.size();
    const CarriedPoint& point = carried.points[k % carried.size()];
    const CarryFrame frame =
        carry_frame(mesh, positions.subspan(f * stride, stride), normals.subspan(f * stride, stride), point);
    const float along_normal = carried.step * point.along_normal, along_edge = carried.step * point.along_edge,
                across = carried.step * point.across;
    for (std::size_t i = 0; i < 3; ++i) {
      full[3 * k + i] =
          frame.position[i] + along_normal * frame.normal[i] + along_edge * frame.edge[i] + across * frame.across[i];
    }
  });
  return full;
}

AttachmentCarrier::AttachmentCarrier(const Basis& basis, const Attachments& attachments)
    : basis_(basis),
      attachments_(attachments),
      output_of_(basis.mesh.vertex_count(), 0),
      slot_of_(basis.mesh.vertex_count(), 0) {
  for (std::uint32_t o = basis.mesh.output_count(); o-- > 0;) output_of_[basis.mesh.output_vertex[o]] = o;
  for (const AttachedMesh& mesh : attachments.meshes) {
    for (const SurfacePoint& point : mesh.points) corners_.insert(corners_.end(), {point.a, point.b, point.c});
  }
  std::ranges::sort(corners_);
  corners_.erase(std::unique(corners_.begin(), corners_.end()), corners_.end());
  for (std::uint32_t k = 0; k < corners_.size(); ++k) slot_of_[corners_[k]] = k;
}

Vec3 AttachmentCarrier::rest(std::uint32_t vertex) const { return row_at(basis_.mesh.rest, vertex); }

Vec3 AttachmentCarrier::posed(std::uint32_t vertex, std::span<const float> positions) const {
  return row_at(positions, output_of_[vertex]);
}

// Near the linear map of the skin around a vertex: the sum of posed times rest edges, relative to the rest edges'
// squared lengths, and of the normals, which stand for the direction that edges of a flat skin do not have.
AttachmentCarrier::Matrix AttachmentCarrier::motion_around(std::uint32_t vertex,
                                                           std::span<const float> positions) const {
  const MeshTable& mesh = basis_.mesh;
  Matrix motion{};
  Vec3 rest_normal{0, 0, 0}, normal{0, 0, 0};
  const std::uint32_t begin = mesh.vertex_triangle_begin[vertex], end = mesh.vertex_triangle_begin[vertex + 1];
  const Vec3 rest_here = rest(vertex), here = posed(vertex, positions);
  for (std::uint32_t k = begin; k < end; ++k) {
    const std::uint32_t* corner = mesh.triangles.data() + 3 * std::size_t{mesh.vertex_triangles[k]};
    const std::size_t own = corner[0] == vertex ? 0 : corner[1] == vertex ? 1 : 2;
    Vec3 rest_edge[2], edge[2];
    for (std::size_t i = 0; i < 2; ++i) {
      const std::uint32_t other = corner[(own + 1 + i) % 3];
      rest_edge[i] = rest(other) - rest_here;
      edge[i] = posed(other, positions) - here;
      const double squared = dot(rest_edge[i], rest_edge[i]);
      if (squared > 0) add_outer(1 / squared, edge[i], rest_edge[i], motion);
    }
    rest_normal = rest_normal + cross(rest_edge[0], rest_edge[1]);
    normal = normal + cross(edge[0], edge[1]);
  }
  const double edges = 2.0 * (end - begin);
  add_outer(0.5 * edges, unit(normal), unit(rest_normal), motion);
  for (double& x : motion) x /= std::max(1.0, edges);
  return motion;
}

// Rest space to world.
Affine AttachmentCarrier::frame(const AttachedMesh& mesh, std::size_t anchor, std::span<const float> positions,
                                std::span<const Matrix> motions, const Affine& joint) const {
  const std::uint32_t begin = mesh.point_begin[anchor], end = mesh.point_begin[anchor + 1];
  if (begin == end) return joint;
  Matrix motion{};
  Vec3 centre{0, 0, 0};
  const double share = 1.0 / (end - begin);
  for (std::uint32_t p = begin; p < end; ++p) {
    const SurfacePoint& point = mesh.points[p];
    const std::pair<std::uint32_t, float> corners[] = {{point.a, point.wa}, {point.b, point.wb}, {point.c, point.wc}};
    for (const auto& [vertex, barycentric] : corners) {
      const double weight = share * static_cast<double>(barycentric);
      centre = centre + weight * posed(vertex, positions);
      for (std::size_t i = 0; i < 9; ++i) motion[i] += weight * motions[slot_of_[vertex]][i];
    }
  }
  float matrix[9], r[9];
  for (std::size_t i = 0; i < 9; ++i) {
    matrix[i] = static_cast<float>(motion[i] + kJointShare * joint.m[i / 3][i % 3]);
  }
  rot(matrix, r);
  const AttachmentAnchor& at = mesh.anchors[anchor];
  const Vec3 rest_centre{static_cast<double>(at.x), static_cast<double>(at.y), static_cast<double>(at.z)};
  Affine result;
  for (std::size_t i = 0; i < 3; ++i) {
    result.m[i][3] = centre[i];
    for (std::size_t j = 0; j < 3; ++j) {
      result.m[i][j] = static_cast<double>(r[3 * i + j]);
      result.m[i][3] -= result.m[i][j] * rest_centre[j];
    }
  }
  return result;
}

std::vector<std::vector<float>> AttachmentCarrier::carry(std::span<const float> positions,
                                                         std::span<const JointTransform> joints) const {
  if (positions.size() != 3 * std::size_t{basis_.mesh.output_count()} || joints.size() != basis_.skeleton.size()) {
    throw Error(ErrorKind::mismatch, "geometry attached to a skin of ", basis_.mesh.output_count(), " points and ",
                basis_.skeleton.size(), " joints was given ", positions.size() / 3, " points and ", joints.size(),
                " joints: those of another character");
  }
  const std::vector<Affine> skinning = skinning_matrices(basis_.skeleton, joints);
  std::vector<Matrix> motions;
  for (const std::uint32_t vertex : corners_) motions.push_back(motion_around(vertex, positions));
  std::vector<std::vector<float>> carried;
  for (const AttachedMesh& mesh : attachments_.meshes) {
    std::vector<Affine> frames;
    for (std::size_t k = 0; k < mesh.anchors.size(); ++k) {
      frames.push_back(frame(mesh, k, positions, motions, skinning[mesh.anchors[k].joint]));
    }
    std::vector<float>& out = carried.emplace_back();
    out.reserve(mesh.rest.size());
    for (std::uint32_t v = 0; v < mesh.vertex_count(); ++v) {
      for (const double x : frames[mesh.vertex_anchor[v]] * row_at(mesh.rest, v)) {
        out.push_back(static_cast<float>(x));
      }
    }
  }
  return carried;
}

}  // namespace bodyopt
