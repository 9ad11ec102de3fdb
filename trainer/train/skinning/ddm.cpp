#include "trainer/train/skinning/ddm.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <numeric>

#include "base/linear_algebra.h"
#include "base/parallel.h"
#include "geometry/surface_distance.h"
#include "runtime/core/error.h"
#include "runtime/core/half.h"
#include "runtime/core/json.h"
#include "runtime/core/text.h"
#include "trainer/train/skinning/near_smoother.h"

namespace bodyopt::trainer {
namespace {

// The low 21 bits of x, two zero bits after each.
std::uint64_t spread_bits(std::uint64_t x) {
  x &= 0x1fffff;
  x = (x | x << 32) & 0x1f00000000ffff;
  x = (x | x << 16) & 0x1f0000ff0000ff;
  x = (x | x << 8) & 0x100f00f00f00f00f;
  x = (x | x << 4) & 0x10c30c30c30c30c3;
  return (x | x << 2) & 0x1249249249249249;
}

// One (vertex, joint) entry before it is centred.
struct RawMoments {
  std::uint32_t joint;
  Eigen::Matrix<double, 10, 1> values;
};

// omega, three first, six second moments (xx xy xz yy yz zz) of a weight.
Eigen::Matrix<double, 1, 10> weighted_moments(const Eigen::RowVector3d& at, double weight) {
  const double x = at.x(), y = at.y(), z = at.z();
  Eigen::Matrix<double, 1, 10> moments;
  moments << 1, x, y, z, x * x, x * y, x * z, y * y, y * z, z * z;
  return weight * moments;
}

Eigen::Matrix3d symmetric(const Eigen::Matrix<double, 6, 1>& m) {
  Eigen::Matrix3d s;
  s << m[0], m[1], m[2], m[1], m[3], m[4], m[2], m[4], m[5];
  return s;
}

std::vector<std::vector<RawMoments>> smooth_moments(const Positions& rest, const Triangles& triangles,
                                                    const std::vector<std::vector<JointWeight>>& weights,
                                                    const DdmOptions& options) {
  const double lambda = options.radius * options.radius / (2.0 * options.steps);
  const NearSmoother smoother(lumped_areas(rest, triangles), lambda * cotangent_laplacian(rest, triangles),
                              options.steps);
  if (!smoother.is_solvable()) {
    throw Error(ErrorKind::mismatch, "the smoothing of the skin could not be factorised: its positions are not finite",
                ErrorCause::damaged);
  }

  std::vector<std::map<int, double>> columns;  // weights of each joint by vertex
  for (std::size_t v = 0; v < weights.size(); ++v) {
    for (const JointWeight& w : weights[v]) {
      if (columns.size() <= w.joint) columns.resize(w.joint + 1);
      columns[w.joint][static_cast<int>(v)] += w.weight;
    }
  }
  std::vector<TenColumns> smoothed(columns.size());
  parallel_for(columns.size(), [&](std::size_t j) {
    TenColumns moments;
    moments.values.resize(static_cast<Eigen::Index>(columns[j].size()), 10);
    for (const auto& [v, weight] : columns[j]) {
      moments.values.row(static_cast<Eigen::Index>(moments.vertices.size())) = weighted_moments(rest.row(v), weight);
      moments.vertices.push_back(v);
    }
    smoothed[j] = smoother(moments);
  });

  std::vector<std::vector<RawMoments>> raw(weights.size());
  for (std::size_t j = 0; j < smoothed.size(); ++j) {
    for (std::size_t k = 0; k < smoothed[j].vertices.size(); ++k) {
      const auto values = smoothed[j].values.row(static_cast<Eigen::Index>(k));
      if (!(values[0] > options.prune)) continue;
      raw[static_cast<std::size_t>(smoothed[j].vertices[k])].push_back(
          {static_cast<std::uint32_t>(j), values.transpose()});
    }
  }
  for (std::size_t v = 0; v < raw.size(); ++v) {
    if (raw[v].empty()) {
      throw Error(ErrorKind::mismatch,
                  "vertex " + std::to_string(v) + " of the skin follows no joint: it has no skin weights",
                  ErrorCause::unweighted);
    }
  }
  return raw;
}

// `tiny` is the radius2 below which a vertex has no neighbourhood.
VertexMoments centre_moments(const std::vector<RawMoments>& raw, const Eigen::Vector3d& position, double tiny) {
  VertexMoments vertex;
  Eigen::Matrix<double, 10, 1> sum = Eigen::Matrix<double, 10, 1>::Zero();
  for (const RawMoments& m : raw) sum += m.values;
  const Eigen::Vector3d p = sum.segment<3>(1) / sum[0];
  vertex.kept = sum[0];
  vertex.centre = p;
  vertex.offset = position - p;
  Eigen::Matrix3d total = Eigen::Matrix3d::Zero();
  for (const RawMoments& m : raw) {
    const Eigen::Matrix<double, 10, 1> values = m.values / sum[0];
    JointMoments joint;
    joint.joint = m.joint;
    joint.omega = values[0];
    const Eigen::Vector3d first = values.segment<3>(1);
    joint.first = first - joint.omega * p;
    joint.second = symmetric(values.tail<6>()) - first * p.transpose() - p * joint.first.transpose();
    total += joint.second;
    vertex.joints.push_back(joint);
  }
  vertex.radius2 = total.trace() > tiny ? total.trace() : 0;
  const double scale = vertex.radius2 > 0 ? 1 / vertex.radius2 : 0;
  for (JointMoments& joint : vertex.joints) {
    joint.first *= scale;
    joint.second *= scale;
  }
  // Flat or thin neighbourhoods fall back to the blended rotation of the joints.
  constexpr double kGap = 0.05, kIsotropic = 1e-2;
  const Eigen::Vector3d s = symmetric_eigen_3(scale * total).values;
  if (!(s[0] + s[1] >= kGap * s[2]) || vertex.radius2 == 0) {
    for (JointMoments& joint : vertex.joints) joint.second += kIsotropic * joint.omega * Eigen::Matrix3d::Identity();
  }
  return vertex;
}

std::uint32_t halves(double low, double high) {
  return half_from_float(static_cast<float>(low)) | half_from_float(static_cast<float>(high)) << 16;
}

DdmVertex pack_vertex(const VertexMoments& vertex) {
  DdmVertex packed{};
  const Eigen::Vector3f p = vertex.centre.cast<float>();
  // The offset absorbs the rounding of the centre, so that the rest pose stays the rest pose.
  const Eigen::Vector3f d = (vertex.centre + vertex.offset - p.cast<double>()).cast<float>();
  packed.centre_x = p.x(), packed.centre_y = p.y(), packed.centre_z = p.z();
  packed.offset_x = d.x(), packed.offset_y = d.y(), packed.offset_z = d.z();
  packed.radius2 = static_cast<float>(vertex.radius2);
  const auto base = std::max_element(vertex.joints.begin(), vertex.joints.end(),
                                     [](const JointMoments& a, const JointMoments& b) { return a.omega < b.omega; });
  packed.base_joint = base->joint;
  return packed;
}

}  // namespace

std::vector<std::uint32_t> morton_order(const Positions& vertices) {
  std::vector<std::uint32_t> order = all_vertices(vertices.rows());
  if (order.empty()) return order;
  const Eigen::RowVector3d low = vertices.colwise().minCoeff();
  const double extent = (vertices.colwise().maxCoeff() - low).maxCoeff();
  const double scale = extent > 0 ? 0x1fffff / extent : 0;
  std::vector<std::uint64_t> codes;
  for (Eigen::Index v = 0; v < vertices.rows(); ++v) {
    std::uint64_t code = 0;
    for (int i = 0; i < 3; ++i) code |= spread_bits(static_cast<std::uint64_t>((vertices(v, i) - low[i]) * scale)) << i;
    codes.push_back(code);
  }
  std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) { return codes[a] < codes[b]; });
  return order;
}

std::vector<std::uint32_t> inverse_of(const std::vector<std::uint32_t>& order) {
  std::vector<std::uint32_t> inverse(order.size());
  for (std::size_t v = 0; v < order.size(); ++v) inverse[order[v]] = static_cast<std::uint32_t>(v);
  return inverse;
}

std::vector<std::uint32_t> all_vertices(Eigen::Index count) {
  std::vector<std::uint32_t> all(static_cast<std::size_t>(count));
  std::iota(all.begin(), all.end(), 0u);
  return all;
}

Positions in_order(const Positions& welded, const std::vector<std::uint32_t>& order) {
  return welded(order, Eigen::all);
}

Character in_order(const Character& character, const std::vector<std::uint32_t>& order) {
  Character result = character;
  result.vertices = in_order(character.vertices, order);
  for (std::size_t v = 0; v < order.size(); ++v) result.weights[v] = character.weights[order[v]];
  const std::vector<std::uint32_t> runtime = inverse_of(order);
  for (std::uint32_t& vertex : result.output_vertex) vertex = runtime[vertex];
  for (Eigen::Index k = 0; k < result.triangles.size(); ++k) {
    result.triangles.data()[k] = runtime[result.triangles.data()[k]];
  }
  return result;
}

MeshTable make_mesh_table(const Character& character) {
  MeshTable mesh;
  mesh.rest = floats_of(character.vertices);
  const Triangles &skin = character.triangles, &output = character.output_triangles;
  mesh.triangles.assign(skin.data(), skin.data() + skin.size());
  mesh.output_vertex = character.output_vertex;
  mesh.output_triangles.assign(output.data(), output.data() + output.size());

  mesh.vertex_triangle_begin.assign(mesh.vertex_count() + 1, 0);
  for (const std::uint32_t v : mesh.triangles) ++mesh.vertex_triangle_begin[v + 1];
  std::partial_sum(mesh.vertex_triangle_begin.begin(), mesh.vertex_triangle_begin.end(),
                   mesh.vertex_triangle_begin.begin());
  mesh.vertex_triangles.resize(mesh.triangles.size());
  std::vector<std::uint32_t> next = mesh.vertex_triangle_begin;
  for (std::size_t k = 0; k < mesh.triangles.size(); ++k) {
    mesh.vertex_triangles[next[mesh.triangles[k]]++] = static_cast<std::uint32_t>(k / 3);
  }
  return mesh;
}

void require_same_character(const MeshTable& mesh, const Skeleton& skeleton, const Basis& basis) {
  constexpr double kSamePlace = 1e-5;  // metres
  const auto refuse = [](const std::string& what) {
    throw Error(ErrorKind::mismatch, "the basis is not of this character: " + what +
                                         "; was the character edited since the training, or is it another one?");
  };
  if (topology_hash(mesh) != topology_hash(basis.mesh)) refuse("its vertices or triangles are others");
  if (skeleton_hash(skeleton) != skeleton_hash(basis.skeleton)) refuse("its skeleton is another");
  for (std::size_t k = 0; k < mesh.rest.size(); ++k) {
    if (std::abs(static_cast<double>(mesh.rest[k] - basis.mesh.rest[k])) <= kSamePlace) continue;
    refuse("its vertices stand elsewhere at rest");
  }
}

std::vector<VertexMoments> ddm_moments(const Positions& rest, const Triangles& triangles,
                                       const std::vector<std::vector<JointWeight>>& weights,
                                       const DdmOptions& options) {
  if (rest.rows() == 0) return {};
  // Around the middle of the skin, for the sake of the second moments' digits.
  const Eigen::RowVector3d middle = rest.colwise().mean();
  const Positions local = rest.rowwise() - middle;
  const double extent = longest_extent(rest);
  const std::vector<std::vector<RawMoments>> raw = smooth_moments(local, triangles, weights, options);
  std::vector<VertexMoments> moments(raw.size());
  parallel_for(raw.size(), [&](std::size_t v) {
    const Eigen::Vector3d position = local.row(static_cast<Eigen::Index>(v));
    moments[v] = centre_moments(raw[v], position, 1e-12 * extent * extent);
    moments[v].centre += middle.transpose();
  });
  return moments;
}

DdmTable pack_ddm(const std::vector<VertexMoments>& moments) {
  DdmTable table;
  const std::size_t blocks = (moments.size() + kBlockSize - 1) / kBlockSize;
  table.vertices.resize(blocks * kBlockSize);
  table.block_begin.push_back(0);
  for (std::size_t block = 0; block < blocks; ++block) {
    const std::size_t first = block * kBlockSize, last = std::min(moments.size(), first + kBlockSize);
    std::vector<std::uint32_t> joints;
    for (std::size_t v = first; v < last; ++v) {
      table.vertices[v] = pack_vertex(moments[v]);
      for (const JointMoments& m : moments[v].joints) joints.push_back(m.joint);
    }
    std::sort(joints.begin(), joints.end());
    joints.erase(std::unique(joints.begin(), joints.end()), joints.end());
    const std::size_t entry = table.block_joints.size();
    table.block_joints.insert(table.block_joints.end(), joints.begin(), joints.end());
    table.block_begin.push_back(static_cast<std::uint32_t>(table.block_joints.size()));
    table.moments.resize(table.block_joints.size() * kMomentWords * kBlockSize, 0u);
    for (std::size_t v = first; v < last; ++v) {
      for (const JointMoments& m : moments[v].joints) {
        const auto place = std::lower_bound(joints.begin(), joints.end(), m.joint) - joints.begin();
        std::uint32_t* word =
            table.moments.data() + (entry + static_cast<std::size_t>(place)) * kMomentWords * kBlockSize + (v - first);
        const Eigen::Matrix3d& s = m.second;
        word[0] = halves(s(0, 0), s(0, 1));
        word[kBlockSize] = halves(s(0, 2), s(1, 1));
        word[2 * kBlockSize] = halves(s(1, 2), s(2, 2));
        for (std::uint32_t i = 0; i < 3; ++i) {
          word[(3 + i) * kBlockSize] = std::bit_cast<std::uint32_t>(static_cast<float>(m.first[static_cast<int>(i)]));
        }
        word[6 * kBlockSize] = std::bit_cast<std::uint32_t>(static_cast<float>(m.omega));
      }
    }
  }
  return table;
}

double default_smoothing_radius(const Positions& rest) { return rest.rows() > 0 ? 0.025 * longest_extent(rest) : 0; }

std::string provenance_text(const Character& character, double radius, const TrainOptions& options, bool updated) {
  Json provenance = {{"program", "bodyopt " BODYOPT_VERSION},
                     {"character", character.name},
                     {"smoothing_radius_m", radius},
                     {"smoothing_steps", options.smoothing_steps},
                     {"components", options.components},
                     {"centres", options.centres},
                     {"budget", options.budget},
                     {"tolerance_mm", options.tolerance_mm},
                     {"surface_curves", options.surface_curves},
                     {"seed", options.seed}};
  if (updated) provenance["updated"] = true;
  return provenance.dump(-1, ' ', false, Json::error_handler_t::replace);
}

DdmBase make_ddm_base(const Character& ordered, double radius, const TrainOptions& options) {
  DdmBase base{{},
               ddm_moments(ordered.vertices, ordered.triangles, ordered.weights,
                           {.radius = radius, .steps = options.smoothing_steps}),
               radius};
  Basis& basis = base.basis;
  basis.skeleton = ordered.skeleton;
  basis.mesh = make_mesh_table(ordered);
  basis.ddm = pack_ddm(base.moments);
  basis.strain.fibre_begin = {0};
  basis.residual.blend_begin.assign(basis.mesh.block_count() + 1, 0);
  basis.metadata["units"] = "metres";
  basis.metadata["topology_hash"] = hexadecimal(topology_hash(basis.mesh));
  basis.metadata["skeleton_hash"] = hexadecimal(skeleton_hash(basis.skeleton));
  basis.metadata["provenance"] = provenance_text(ordered, radius, options, false);
  return base;
}

Basis build_ddm_basis(const Character& character, const TrainOptions& options) {
  const Character ordered = in_order(character, morton_order(character.vertices));
  const double radius =
      options.smoothing_radius > 0 ? options.smoothing_radius : default_smoothing_radius(ordered.vertices);
  return make_ddm_base(ordered, radius, options).basis;
}

}  // namespace bodyopt::trainer
