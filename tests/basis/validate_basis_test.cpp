#include <gtest/gtest.h>

#include <bit>
#include <functional>
#include <limits>

#include "runtime/basis/basis.h"
#include "runtime/core/error.h"
#include "tests/support/small_basis.h"

namespace bodyopt {
namespace {

using testing::small_basis;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

struct Case {
  const char* named;  // what the message must contain
  std::function<void(Basis&)> change;
};

void expect_refused(const std::vector<Case>& cases, const Basis& sound = small_basis()) {
  for (const Case& c : cases) {
    Basis basis = sound;
    c.change(basis);
    try {
      validate(basis, "here.safetensors");
      ADD_FAILURE() << "accepted: " << c.named;
    } catch (const Error& error) {
      const std::string text = error.what();
      EXPECT_EQ(error.kind(), ErrorKind::file);
      EXPECT_EQ(text.rfind("here.safetensors: ", 0), 0u) << text;
      EXPECT_NE(text.find(c.named), std::string::npos) << "expected '" << c.named << "' in: " << text;
    }
  }
}

TEST(ValidateBasis, Skeleton) {
  expect_refused({
      {"0 joints", [](Basis& b) { b.skeleton.joints.clear(); }},
      {"joint 0 ('lower') has parent 0", [](Basis& b) { b.skeleton.joints[0].parent = 0; }},
      {"joint 1 ('upper') has parent 1", [](Basis& b) { b.skeleton.joints[1].parent = 1; }},
      {"parent -2", [](Basis& b) { b.skeleton.joints[1].parent = -2; }},
      {"joint 1 ('upper') has a transform",
       [](Basis& b) {
         b.skeleton.joints[1].bind.rotation = {0, 0, 0, 0};
       }},
      {"joint 1 ('upper') has a transform", [](Basis& b) { b.skeleton.joints[1].bind.rotation[3] += 0.1; }},
      {"joint 0 ('lower') has a transform", [](Basis& b) { b.skeleton.joints[0].bind.rotation[1] = std::nan(""); }},
      {"joint 0 ('lower') has a transform", [](Basis& b) { b.skeleton.joints[0].default_local.scale[1] = 1e300; }},
      {"joint 0 ('lower') has a transform",
       [](Basis& b) { b.skeleton.joints[0].default_local.translation[2] = std::nan(""); }},
      {"inverse bind", [](Basis& b) { b.skeleton.joints[1].inverse_bind.m[2][3] = HUGE_VAL; }},
  });
}

TEST(ValidateBasis, JointFeatures) {
  Basis carried = small_basis();
  carried.skeleton.features = {{1, 0, axis_angle({1, 0, 0}, 0.3), axis_angle({0, 1, 0}, 0.3)}};
  EXPECT_NO_THROW(validate(carried, "here"));
  const auto one = [](Basis& b) -> JointFeatures& { return b.skeleton.features.emplace_back(JointFeatures{1, 0}); };
  expect_refused({
      {"skeleton.features[0] is of joint 2", [&](Basis& b) { one(b).joint = 2; }},
      {"skeleton.features[0] is of joint 1 seen from 2", [&](Basis& b) { one(b).above = 2; }},
      {"skeleton.features[0] has -1.0", [&](Basis& b) { one(b).per_metre = -1; }},
      {"skeleton.features[0] has nan", [&](Basis& b) { one(b).per_metre = std::nan(""); }},
      {"skeleton.features[0] turns by no rotation", [&](Basis& b) { one(b).above_turn[3] = 2; }},
      {"skeleton.features[0] turns by no rotation", [&](Basis& b) { one(b).own_turn[1] = std::nan(""); }},
      {"residual.features",
       [&](Basis& b) {
         b.skeleton.features = {{1, 0}, {1, 0}};
       }},
  });
}

TEST(ValidateBasis, Mesh) {
  expect_refused({
      {"mesh.rest has 0", [](Basis& b) { b.mesh.rest.clear(); }},
      {"mesh.rest has 607", [](Basis& b) { b.mesh.rest.push_back(0); }},
      {"mesh.triangles has", [](Basis& b) { b.mesh.triangles.pop_back(); }},
      {"mesh.output_triangles has", [](Basis& b) { b.mesh.output_triangles.pop_back(); }},
      {"mesh.rest[7] is nan", [](Basis& b) { b.mesh.rest[7] = kNan; }},
      {"mesh.rest[7] is", [](Basis& b) { b.mesh.rest[7] = 3e38f; }},
      {"mesh.triangles[4] is 202", [](Basis& b) { b.mesh.triangles[4] = 202; }},
      {"mesh.output_vertex[3] is 4294967295", [](Basis& b) { b.mesh.output_vertex[3] = ~0u; }},
      {"mesh.output_triangles[3] is 222", [](Basis& b) { b.mesh.output_triangles[3] = 222; }},
      {"mesh.vertex_triangle_begin has", [](Basis& b) { b.mesh.vertex_triangle_begin.pop_back(); }},
      {"mesh.vertex_triangle_begin starts", [](Basis& b) { b.mesh.vertex_triangle_begin[0] = 1; }},
      {"mesh.vertex_triangle_begin[6]", [](Basis& b) { b.mesh.vertex_triangle_begin[5] = 1000; }},
      {"mesh.vertex_triangle_begin ends", [](Basis& b) { b.mesh.vertex_triangle_begin.back() += 1; }},
      {"mesh.vertex_triangles has",
       [](Basis& b) {
         b.mesh.vertex_triangles.push_back(0);
         b.mesh.vertex_triangle_begin.back() += 1;
       }},
      {"mesh.vertex_triangles does not list",
       [](Basis& b) { std::swap(b.mesh.vertex_triangles[0], b.mesh.vertex_triangles[1]); }},
      {"mesh.vertex_triangles does not list", [](Basis& b) { b.mesh.vertex_triangles.back() = ~0u; }},
      {"mesh.vertex_triangles does not list", [](Basis& b) { b.mesh.vertex_triangle_begin[3] += 1; }},
  });
}

TEST(ValidateBasis, Ddm) {
  const auto set_word = [](std::size_t k, float value) {
    return [k, value](Basis& b) { b.ddm.moments[k] = std::bit_cast<std::uint32_t>(value); };
  };
  expect_refused({
      {"ddm.block_begin has", [](Basis& b) { b.ddm.block_begin.pop_back(); }},
      {"ddm.block_begin[3]", [](Basis& b) { b.ddm.block_begin[2] = 100; }},
      {"ddm.block_begin ends", [](Basis& b) { b.ddm.block_joints.push_back(0); }},
      {"ddm.block_joints[1] is 2", [](Basis& b) { b.ddm.block_joints[1] = 2; }},
      {"ddm.moments has", [](Basis& b) { b.ddm.moments.pop_back(); }},
      {"ddm.vertices has", [](Basis& b) { b.ddm.vertices.pop_back(); }},
      {"ddm.moments[0] holds a half", [](Basis& b) { b.ddm.moments[0] = 0x7c00; }},
      {"ddm.moments[47] holds a half", [](Basis& b) { b.ddm.moments[47] = 0xfe000000; }},
      {"ddm.moments[48] is nan", set_word(48, kNan)},
      {"ddm.moments[111] is inf", set_word(111, kInfinity)},
      {"ddm.vertices[5] is nan", [](Basis& b) { b.ddm.vertices[5].offset_z = kNan; }},
      {"ddm.vertices[207] is inf", [](Basis& b) { b.ddm.vertices[207].centre_x = kInfinity; }},
      {"ddm.vertices[5] has the squared radius", [](Basis& b) { b.ddm.vertices[5].radius2 = -1e-6f; }},
      {"ddm.vertices[5] has base joint 2", [](Basis& b) { b.ddm.vertices[5].base_joint = 2; }},
      {"ddm.vertices[207] has base joint 2", [](Basis& b) { b.ddm.vertices[207].base_joint = 2; }},
      {"ddm.vertices[5] has base joint 1", [](Basis& b) { b.ddm.vertices[5].base_joint = 1; }},  // not in its block
  });
}

TEST(ValidateBasis, Strain) {
  expect_refused({
      {"strain.fibre_begin has", [](Basis& b) { b.strain.fibre_begin.pop_back(); }},
      {"strain.fibre_begin ends", [](Basis& b) { b.strain.points.pop_back(); }},
      {"fibres' names has 1", [](Basis& b) { b.strain.names.pop_back(); }},
      {"strain.vertices[3] is 202", [](Basis& b) { b.strain.vertices[3] = 202; }},
      {"strain.points[4] names strain vertex 54", [](Basis& b) { b.strain.points[4].c = 54; }},
      {"strain.points[4] is nan", [](Basis& b) { b.strain.points[4].wb = kNan; }},
      {"strain.points[4] has weights", [](Basis& b) { b.strain.points[4].wb += 2e-4f; }},
      {"strain.rest_length[1] is 0", [](Basis& b) { b.strain.rest_length[1] = 0; }},
      {"strain.rest_length[1] is -", [](Basis& b) { b.strain.rest_length[1] = -1; }},
      {"strain.rest_length[1] is nan", [](Basis& b) { b.strain.rest_length[1] = kNan; }},
      {"fibre 1 ('flexor/1')", [](Basis& b) { b.strain.fibre_begin[1] = 17; }},
  });
}

TEST(ValidateBasis, Residual) {
  expect_refused({
      {"residual.features has 12", [](Basis& b) { b.residual.controls.push_back("more"); }},
      {"residual.features has 0", [](Basis& b) { b.residual.features.clear(); }},
      {"residual.features[2] is nan", [](Basis& b) { b.residual.features[2].mean = kNan; }},
      {"residual.features[2] has a range", [](Basis& b) { b.residual.features[2].low = 2; }},
      {"residual.features[2] has the inverse scale", [](Basis& b) { b.residual.features[2].inverse_scale = -1; }},
      {"residual.features[2] has the inverse scale", [](Basis& b) { b.residual.features[2].inverse_scale = 1e8f; }},
      {"residual.region_features[9] is 12", [](Basis& b) { b.residual.region_features[9] = 12; }},
      {"residual.region_features has", [](Basis& b) { b.residual.region_features.push_back(0); }},
      {"residual.regions[1] has offsets", [](Basis& b) { b.residual.regions[1].feature_begin += 1; }},
      {"residual.regions[1] has offsets", [](Basis& b) { b.residual.regions[1].weight_values -= 1; }},
      {"residual.regions[1] has offsets", [](Basis& b) { b.residual.regions[0].feature_count += 1; }},
      {"residual.centre_region has 5", [](Basis& b) { b.residual.regions[1].centre_count = ~0u; }},
      {"expected at most 65536", [](Basis& b) { b.residual.regions[1].coefficient_count = ~0u; }},
      {"residual.coefficient_region has 7", [](Basis& b) { b.residual.regions[1].coefficient_count = 5; }},
      {"residual.regions[1] has the inverse width", [](Basis& b) { b.residual.regions[1].inverse_width2 = -1; }},
      {"residual.regions[1] has the inverse width", [](Basis& b) { b.residual.regions[1].inverse_width2 = kNan; }},
      {"residual.centre_region[2] is 0", [](Basis& b) { b.residual.centre_region[2] = 0; }},
      {"residual.coefficient_region[2] is 1", [](Basis& b) { b.residual.coefficient_region[2] = 1; }},
      {"residual.regions[1] has offsets", [](Basis& b) { b.residual.regions[1].centre_values += 1; }},
      {"residual.regions[1] has offsets", [](Basis& b) { b.residual.regions[1].coordinate_begin += 1; }},
      {"residual.regions[1] has offsets", [](Basis& b) { b.residual.regions[1].projection_values -= 1; }},
      {"residual.coordinate_region has 7", [](Basis& b) { b.residual.regions[1].coordinate_count = ~0u; }},
      {"residual.coordinate_region has 7", [](Basis& b) { b.residual.regions[1].coordinate_count = 4; }},
      {"residual.coordinate_region[5] is 0", [](Basis& b) { b.residual.coordinate_region[5] = 0; }},
      {"residual.projections[21] holds a half", [](Basis& b) { b.residual.projections[21] = 0x7c00; }},
      {"residual.projections has 27 entries, expected 26", [](Basis& b) { b.residual.projections.push_back(0); }},
      {"residual.projections has 0 entries, expected 26", [](Basis& b) { b.residual.projections.clear(); }},
      {"residual.centres[3] holds a half", [](Basis& b) { b.residual.centres[3] = 0x7c00; }},
      {"residual.centres[4] holds a half", [](Basis& b) { b.residual.centres[4] = 0xfc000000; }},
      {"residual.centres[9] holds a half", [](Basis& b) { b.residual.centres[9] = 0x7e017e01; }},
      {"residual.centres has 11 entries, expected 10", [](Basis& b) { b.residual.centres.push_back(0); }},
      {"residual.centres has 8 entries, expected 10", [](Basis& b) { b.residual.centres.resize(8); }},  // no padding
      {"residual.centres has 0 entries, expected 10", [](Basis& b) { b.residual.centres.clear(); }},
      {"residual.weights[3] is nan", [](Basis& b) { b.residual.weights[3] = kNan; }},
      {"residual.weights has", [](Basis& b) { b.residual.weights.pop_back(); }},
      {"residual.blend_begin has", [](Basis& b) { b.residual.blend_begin.clear(); }},
      {"residual.blend_begin has 203 entries, expected 14", [](Basis& b) { b.residual.blend_begin.resize(203); }},
      {"residual.blend_begin starts", [](Basis& b) { b.residual.blend_begin[0] = 1; }},
      {"residual.blend_begin[3]", [](Basis& b) { b.residual.blend_begin[2] = ~0u; }},
      {"residual.blend_begin ends", [](Basis& b) { b.residual.blend.pop_back(); }},
      {"residual.blend[1] names coefficient 7",
       [](Basis& b) { b.residual.blend[1].scale_coefficient = 0x3c00u | 7u << 16; }},
      {"residual.blend[1] names coefficient 65535",
       [](Basis& b) { b.residual.blend[1].scale_coefficient |= ~0xffffu; }},
      {"residual.blend[1] has a scale", [](Basis& b) { b.residual.blend[1].scale_coefficient = 0x7c00u; }},
      {"residual.blend[1] has a scale", [](Basis& b) { b.residual.blend[1].scale_coefficient = 0xfe00u; }},
  });
}

TEST(ValidateBasis, Fade) {
  expect_refused({
      {"residual.fade.joint_begin has 0 entries", [](Basis& b) { b.residual.fade.joint_begin.clear(); }},
      {"residual.fade.joint_begin has 3", [](Basis& b) { b.residual.fade.joint_begin.push_back(1); }},
      {"residual.fade.joint_begin ends", [](Basis& b) { b.residual.fade.joints.push_back(0); }},
      {"residual.fade.joints[0] is 1", [](Basis& b) { b.residual.fade.joints[0] = 1; }},
      {"residual.fade.direction_begin has 1", [](Basis& b) { b.residual.fade.direction_begin.pop_back(); }},
      {"residual.fade.direction_begin starts", [](Basis& b) { b.residual.fade.direction_begin[0] = 1; }},
      {"residual.fade.directions has 9", [](Basis& b) { b.residual.fade.direction_begin[1] = 2; }},
      {"residual.fade.directions has 8", [](Basis& b) { b.residual.fade.directions.pop_back(); }},
      {"residual.fade.directions[2] is nan", [](Basis& b) { b.residual.fade.directions[2] = kNan; }},
      {"residual.fade.tolerance has 0", [](Basis& b) { b.residual.fade.tolerance.clear(); }},
      {"residual.fade.tolerance[0] is -1", [](Basis& b) { b.residual.fade.tolerance[0] = -1; }},
      {"residual.fade.tolerance[0] is nan", [](Basis& b) { b.residual.fade.tolerance[0] = kNan; }},
      {"residual.fade.region_begin has 2", [](Basis& b) { b.residual.fade.region_begin.pop_back(); }},
      {"residual.fade.region_begin ends", [](Basis& b) { b.residual.fade.region_joints.push_back(0); }},
      {"residual.fade.region_joints[0] is 1", [](Basis& b) { b.residual.fade.region_joints[0] = 1; }},
      {"residual.fade.region_weights has 0", [](Basis& b) { b.residual.fade.region_weights.clear(); }},
      {"residual.fade.region_weights[0] is -2", [](Basis& b) { b.residual.fade.region_weights[0] = -2; }},
      {"residual.fade.region_weights[0] is inf", [](Basis& b) { b.residual.fade.region_weights[0] = kInfinity; }},
  });
  Basis without = small_basis();
  without.residual.fade = {};
  EXPECT_NO_THROW(validate(without, "basis"));
}

TEST(ValidateBasis, Coverage) {
  const Basis sound = testing::knowing_basis();
  EXPECT_NO_THROW(validate(sound, "basis"));
  expect_refused(
      {
          {"coverage.joint_begin has 0 entries", [](Basis& b) { b.coverage.joint_begin.clear(); }},
          {"coverage.joint_begin has 4", [](Basis& b) { b.coverage.joint_begin.push_back(3); }},
          {"region 1: no joint moves it", [](Basis& b) { b.coverage.joint_begin[1] = 3; }},
          {"coverage.joints[2] is 2", [](Basis& b) { b.coverage.joints[2] = 2; }},
          {"coverage_names has 1", [](Basis& b) { b.coverage.names.pop_back(); }},
          {"coverage.sizes has 1", [](Basis& b) { b.coverage.sizes.pop_back(); }},
          {"coverage.sizes[1] is 0", [](Basis& b) { b.coverage.sizes[1] = 0; }},
          {"coverage.growth has 3", [](Basis& b) { b.coverage.growth.push_back(0); }},
          {"coverage.growth[0] is -1", [](Basis& b) { b.coverage.growth[0] = -1; }},
          {"coverage.usual[1] is inf", [](Basis& b) { b.coverage.usual[1] = kInfinity; }},
          {"coverage.local has", [](Basis& b) { b.coverage.local.pop_back(); }},
          {"coverage.local[0] is nan", [](Basis& b) { b.coverage.local[0] = kNan; }},
          {"coverage.motion has", [](Basis& b) { b.coverage.motion.push_back(0); }},
          {"coverage.metric has 1", [](Basis& b) { b.coverage.metric = {1}; }},
          {"coverage.metric[2] is -2",
           [](Basis& b) {
             b.coverage.metric.assign(b.residual.coordinate_count(), 1);
             b.coverage.metric[2] = -2;
           }},
      },
      sound);
}

// 65,536 coefficients fill the 16-bit index; one more is one too many.
TEST(ValidateBasis, CoefficientsFillTheirIndexAndNoMore) {
  Basis basis = small_basis();
  const auto grow_to = [&](std::uint32_t count) {
    ResidualTable& residual = basis.residual;
    Region& region = residual.regions[1];
    region.coefficient_count = count - region.coefficient_begin;
    residual.coefficient_region.resize(count, 1);
    residual.weights.resize(region.weight_values + std::size_t{region.coefficient_count} *
                                                       (1 + region.coordinate_count + region.centre_count));
  };
  grow_to(65536);
  EXPECT_NO_THROW(validate(basis, "basis"));
  grow_to(65537);
  EXPECT_THROW(validate(basis, "basis"), Error);
}

}  // namespace
}  // namespace bodyopt
