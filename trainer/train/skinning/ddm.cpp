#include "trainer/train/skinning/ddm.h"

#include <algorithm>
#include <bit>
#include <string>

#include "base/linear_algebra.h"
#include "base/parallel.h"
#include "geometry/extent.h"
#include "geometry/laplacian.h"
#include "runtime/core/error.h"
#include "runtime/core/half.h"

namespace bodyopt {
namespace {

using Moments10 =
    Eigen::Matrix<double, Eigen::Dynamic, 10>;  // omega, three first, six second moments (xx xy xz yy yz zz)

// One (vertex, joint) entry before it is centred.
struct RawMoments {
  std::uint32_t joint;
  Eigen::Matrix<double, 10, 1> values;
};

Moments10 weighted_moments(const Positions& rest, const Eigen::VectorXd& weights) {
  Moments10 moments(rest.rows(), 10);
  for (Eigen::Index v = 0; v < rest.rows(); ++v) {
    const double x = rest(v, 0), y = rest(v, 1), z = rest(v, 2);
    moments.row(v) << 1, x, y, z, x * x, x * y, x * z, y * y, y * z, z * z;
    moments.row(v) *= weights[v];
  }
  return moments;
}

Eigen::Matrix3d symmetric(const Eigen::Matrix<double, 6, 1>& m) {
  Eigen::Matrix3d s;
  s << m[0], m[1], m[2], m[1], m[3], m[4], m[2], m[4], m[5];
  return s;
}

std::vector<std::vector<RawMoments>> smooth_moments(const Positions& rest, const Triangles& triangles,
                                                    const std::vector<std::vector<JointWeight>>& weights,
                                                    const DdmOptions& options) {
  const Eigen::VectorXd areas = lumped_areas(rest, triangles);
  const double lambda = options.radius * options.radius / (2.0 * options.steps);
  Eigen::SparseMatrix<double> matrix = lambda * cotangent_laplacian(rest, triangles);
  matrix.diagonal() += areas;
  const SparseSolver solver(matrix);
  if (!solver.is_solvable()) {
    throw Error(ErrorKind::mismatch, "the smoothing of the skin could not be factorised: its positions are not finite");
  }

  std::vector<Eigen::VectorXd> columns;  // weights of each joint over the vertices
  for (std::size_t v = 0; v < weights.size(); ++v) {
    for (const JointWeight& w : weights[v]) {
      while (columns.size() <= w.joint) columns.push_back(Eigen::VectorXd::Zero(rest.rows()));
      columns[w.joint][static_cast<Eigen::Index>(v)] += w.weight;
    }
  }
  std::vector<Moments10> smoothed(columns.size());
  parallel_for(columns.size(), [&](std::size_t j) {
    if (columns[j].cwiseAbs().maxCoeff() == 0) return;
    Moments10 moments = weighted_moments(rest, columns[j]);
    for (int step = 0; step < options.steps; ++step) {
      const Moments10 right = areas.asDiagonal() * moments;
      moments = solver.solve(right);
    }
    smoothed[j] = std::move(moments);
  });

  std::vector<std::vector<RawMoments>> raw(weights.size());
  for (std::size_t j = 0; j < smoothed.size(); ++j) {
    for (Eigen::Index v = 0; v < smoothed[j].rows(); ++v) {
      if (!(smoothed[j](v, 0) > options.prune)) continue;
      raw[static_cast<std::size_t>(v)].push_back({static_cast<std::uint32_t>(j), smoothed[j].row(v).transpose()});
    }
  }
  for (std::size_t v = 0; v < raw.size(); ++v) {
    if (raw[v].empty()) {
      throw Error(ErrorKind::mismatch,
                  "vertex " + std::to_string(v) + " of the skin follows no joint: it has no skin weights");
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

std::vector<VertexMoments> ddm_moments(const Positions& rest, const Triangles& triangles,
                                       const std::vector<std::vector<JointWeight>>& weights,
                                       const DdmOptions& options) {
  if (rest.rows() == 0) return {};
  // Around the middle of the skin, for the sake of the second moments' digits.
  const Eigen::RowVector3d middle = rest.colwise().mean();
  const Positions local = rest.rowwise() - middle;
  const double extent = longest_extent(rest);
  const std::vector<std::vector<RawMoments>> raw = smooth_moments(local, triangles, weights, options);
  std::vector<VertexMoments> moments;
  for (std::size_t v = 0; v < raw.size(); ++v) {
    const Eigen::Vector3d position = local.row(static_cast<Eigen::Index>(v));
    moments.push_back(centre_moments(raw[v], position, 1e-12 * extent * extent));
    moments.back().centre += middle.transpose();
  }
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

}  // namespace bodyopt
