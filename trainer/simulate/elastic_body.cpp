#include "trainer/simulate/elastic_body.h"

#include <Eigen/LU>
#include <cmath>
#include <limits>

#include "trainer/simulate/laplacian.h"
#include "trainer/simulate/materials.h"

namespace bodyopt {

ElasticBody::ElasticBody(const TetMesh& mesh, const Tissue& tissue, const std::vector<Attachment>& attachments)
    : mesh_(mesh), attachments_(attachments) {
  for (Eigen::Index e = 0; e < mesh.tets.rows(); ++e) {
    const std::size_t k = static_cast<std::size_t>(e);
    Element element;
    Eigen::Matrix3d edges;
    for (int a = 0; a < 4; ++a) element.node[a] = mesh.tets(e, a);
    for (int a = 0; a < 3; ++a) {
      edges.col(a) = (mesh.nodes.row(element.node[a + 1]) - mesh.nodes.row(element.node[0])).transpose();
    }
    const Eigen::Matrix3d inverse = edges.inverse();
    for (int i = 0; i < 9; ++i) element.inverse_edges[i] = inverse(i / 3, i % 3);
    element.volume = edges.determinant() / 6;
    element.muscle = tissue.muscle[k];
    element.shear = element.muscle >= 0 ? kMuscleShear : kFatShear;
    for (int i = 0; i < 3; ++i) element.fibre[i] = tissue.fibre[k](i);
    elements_.push_back(element);
  }
}

bool ElasticBody::add_element(const Element& element, const Positions& x, const Drive& drive, Positions& gradient,
                              ElasticForces& forces) const {
  const double* corner[4];
  for (int a = 0; a < 4; ++a) corner[a] = x.data() + 3 * element.node[a];
  double ds[9];  // edges as columns
  for (int i = 0; i < 3; ++i) {
    for (int a = 0; a < 3; ++a) ds[3 * i + a] = corner[a + 1][i] - corner[0][i];
  }
  const double* dm = element.inverse_edges;
  double f[9];
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      f[3 * i + j] = ds[3 * i] * dm[j] + ds[3 * i + 1] * dm[3 + j] + ds[3 * i + 2] * dm[6 + j];
    }
  }
  const double cofactor[9] = {f[4] * f[8] - f[5] * f[7], f[5] * f[6] - f[3] * f[8], f[3] * f[7] - f[4] * f[6],
                              f[2] * f[7] - f[1] * f[8], f[0] * f[8] - f[2] * f[6], f[1] * f[6] - f[0] * f[7],
                              f[1] * f[5] - f[2] * f[4], f[2] * f[3] - f[0] * f[5], f[0] * f[4] - f[1] * f[3]};
  const double jacobian = f[0] * cofactor[0] + f[1] * cofactor[1] + f[2] * cofactor[2];
  if (!(jacobian > 0)) return false;

  double norm2 = 0;
  for (const double value : f) norm2 += value * value;
  const double excess = jacobian - 1 - element.shear / kBulk;
  double energy = 0.5 * element.shear * (norm2 - 3) + 0.5 * kBulk * excess * excess;
  double pressure = kBulk * excess;  // derivative by J
  if (jacobian < kBarrierStart) {
    const double gap = jacobian - kBarrierStart, logarithm = -std::log(jacobian / kBarrierStart);
    energy += kBarrier * gap * gap * logarithm;
    pressure += kBarrier * (2 * gap * logarithm - gap * gap / jacobian);
  }
  double stress[9];
  for (int i = 0; i < 9; ++i) stress[i] = element.shear * f[i] + pressure * cofactor[i];

  if (element.muscle >= 0) {
    const double* a = element.fibre;
    double fa[3];
    for (int i = 0; i < 3; ++i) fa[i] = f[3 * i] * a[0] + f[3 * i + 1] * a[1] + f[3 * i + 2] * a[2];
    const double stretch = std::sqrt(fa[0] * fa[0] + fa[1] * fa[1] + fa[2] * fa[2]);
    const double active = std::max(0.0, stretch - kContracted), passive = std::max(0.0, stretch - 1);
    const double stiffness = kActiveFibre * drive.activation[static_cast<std::size_t>(element.muscle)];
    energy += 0.5 * stiffness * active * active + 0.5 * kPassiveFibre * passive * passive;
    const double tension = stretch > 0 ? (stiffness * active + kPassiveFibre * passive) / stretch : 0;
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) stress[3 * i + j] += tension * fa[i] * a[j];
    }
  }

  forces.energy += element.volume * energy;
  double first[3] = {0, 0, 0};
  for (int a = 0; a < 3; ++a) {
    double* target = gradient.data() + 3 * element.node[a + 1];
    for (int i = 0; i < 3; ++i) {
      const double g = element.volume * (stress[3 * i] * dm[3 * a] + stress[3 * i + 1] * dm[3 * a + 1] +
                                         stress[3 * i + 2] * dm[3 * a + 2]);
      target[i] += g;
      first[i] -= g;
      forces.element_norm += g * g;
    }
  }
  double* target = gradient.data() + 3 * element.node[0];
  for (int i = 0; i < 3; ++i) {
    target[i] += first[i];
    forces.element_norm += first[i] * first[i];
  }
  return true;
}

ElasticForces ElasticBody::evaluate(const Positions& x, const Drive& drive, Positions& gradient) const {
  gradient.setZero(x.rows(), 3);
  ElasticForces forces;
  for (const Element& element : elements_) {
    if (!add_element(element, x, drive, gradient, forces)) ++forces.inverted;
  }
  for (std::size_t k = 0; k < attachments_.size(); ++k) {
    const Attachment& attachment = attachments_[k];
    Eigen::RowVector3d pull = -drive.targets[k].transpose();
    for (int a = 0; a < 4; ++a) pull += attachment.weights(a) * x.row(mesh_.tets(attachment.tet, a));
    forces.energy += 0.5 * kBoneSpring * pull.squaredNorm();
    for (int a = 0; a < 4; ++a) {
      gradient.row(mesh_.tets(attachment.tet, a)) += kBoneSpring * attachment.weights(a) * pull;
    }
  }
  if (forces.inverted > 0) forces.energy = std::numeric_limits<double>::infinity();
  forces.element_norm = std::sqrt(forces.element_norm);
  return forces;
}

Eigen::SparseMatrix<double> ElasticBody::metric() const {
  // The volumetric term acts in one direction of three; 0.6 was measured best in the source's scheme.
  constexpr double kBulkShare = 0.6;
  std::vector<double> stiffness;
  for (const Element& element : elements_) {
    stiffness.push_back(element.shear + kBulkShare * kBulk + (element.muscle >= 0 ? kPassiveFibre : 0));
  }
  Eigen::SparseMatrix<double> metric = tet_laplacian(mesh_, stiffness);
  std::vector<Eigen::Triplet<double>> springs;
  for (const Attachment& attachment : attachments_) {
    for (int a = 0; a < 4; ++a) {
      for (int b = 0; b < 4; ++b) {
        springs.emplace_back(mesh_.tets(attachment.tet, a), mesh_.tets(attachment.tet, b),
                             kBoneSpring * attachment.weights(a) * attachment.weights(b));
      }
    }
  }
  Eigen::SparseMatrix<double> spring_matrix(metric.rows(), metric.cols());
  spring_matrix.setFromTriplets(springs.begin(), springs.end());
  return metric + spring_matrix;
}

}  // namespace bodyopt
