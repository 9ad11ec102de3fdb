#include "tests/support/small_dynamics.h"

#include <cstdint>

#include "runtime/core/text.h"
#include "trainer/dynamics/dynamics_tets.h"
#include "trainer/dynamics/jiggle.h"
#include "trainer/dynamics/jiggle_fields.h"
#include "trainer/train/skinning/ddm.h"

namespace bodyopt::testing {
namespace {

Basis with_fibres(Basis basis) {
  basis.strain.vertices = {0, 1, 2};
  basis.strain.points.assign(4, {0, 1, 2, 0.5f, 0.25f, 0.25f});
  basis.strain.fibre_begin = {0, 2, 4};
  basis.strain.rest_length = {1, 1};
  basis.strain.names = {"flexor/1", "flexor/2"};
  return basis;
}

}  // namespace

SmallDynamics::SmallDynamics()
    : basis(with_fibres(trainer::build_ddm_basis(character, {}))),
      dynamics(trainer::build_dynamics(character, muscles, basis, options).dynamics) {}

const SmallDynamics& small_dynamics() {
  static const SmallDynamics small;
  return small;
}

OneTet::OneTet() {
  Character character;
  character.skeleton.joints.resize(1);
  character.skeleton.joints[0].name = "root";
  character.vertices.resize(4, 3);
  character.vertices << 0, 0, 0, 0.1, 0, 0, 0, 0.1, 0, 0, 0, 0.1;
  character.triangles.resize(4, 3);
  character.triangles << 0, 2, 1, 0, 1, 3, 1, 2, 3, 0, 3, 2;
  character.weights.assign(4, {{0, 1.0}});
  character.output_vertex = {0, 1, 2, 3};
  character.output_triangles = character.triangles;
  basis = trainer::build_ddm_basis(character, {});
  trainer::DynamicsTets tets;
  tets.cage.mesh.nodes =
      Eigen::Map<const Eigen::Matrix<float, 4, 3, Eigen::RowMajor>>(basis.mesh.rest.data()).cast<double>();
  tets.cage.mesh.tets.resize(1, 4);
  tets.cage.mesh.tets << 0, 1, 2, 3;
  orient(tets.cage.mesh);
  for (std::uint32_t v = 0; v < 4; ++v) {
    SkinPoint& point = tets.surface.emplace_back();
    point.vertices = {v, v, v};
    point.weights = {1, 0, 0};
    tets.cage.skin.push_back({0, Eigen::Vector4d::Zero()});
    for (int a = 0; a < 4; ++a) tets.cage.skin[v].weights[a] = tets.cage.mesh.tets(0, a) == static_cast<int>(v);
  }
  trainer::SparseMatrix springs(4, 4);
  springs.setIdentity();
  const trainer::JiggleSystem system{
      {{1e3, 9e3}}, trainer::lumped_mass(tets.cage.mesh, 1000), Eigen::VectorXd::Ones(4), 1e-3, springs};
  dynamics.tets = trainer::make_tet_table(tets, {1, 1, 1, 0}, {1, 1, 1, 1});
  dynamics.diffuse = trainer::make_diffuse_table(tets.cage.mesh, 4);
  dynamics.jiggle = trainer::make_jiggle_table(tets.cage.mesh, system, {});
  dynamics.metadata["topology_hash"] = hexadecimal(topology_hash(basis.mesh));
  dynamics.metadata["skeleton_hash"] = hexadecimal(skeleton_hash(basis.skeleton));
}

}  // namespace bodyopt::testing
