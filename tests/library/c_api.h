// What tests of bodyopt.h share: the library is the shared one, the references beside it are the rooms'.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include "include/bodyopt/bodyopt.hpp"
#include "runtime/basis/basis.h"
#include "runtime/deformer/deformer.h"
#include "tests/support/paths.h"

namespace bodyopt::testing {

// A trained limb that is kept with the sources, and its dynamics.
inline std::string kept_file(const std::string& name) { return kSourceFolder + "/tests/old_files/" + name; }
inline std::string hero() { return kept_file("hero.safetensors"); }
inline std::string hero_dynamics() { return kept_file("hero.dynamics.safetensors"); }

// Frames in which all joints but the root turn, each further than before.
inline std::vector<Pose> turning_poses(const Basis& basis, std::size_t count) {
  std::vector<Pose> poses;
  for (std::size_t f = 0; f < count; ++f) {
    Pose pose = bind_pose(basis.skeleton);
    for (std::size_t j = 1; j < pose.joints.size(); ++j) {
      const double angle = 0.05 * static_cast<double>(f + 1) / static_cast<double>(j);
      pose.joints[j].rotation = pose.joints[j].rotation * axis_angle({0, 0, 1}, angle);
    }
    pose.joints[0].translation[1] += 0.01 * static_cast<double>(f);
    pose.controls.assign(basis.residual.controls.size(), 0.1f * static_cast<float>(f));
    poses.push_back(std::move(pose));
  }
  return poses;
}

// Poses as a caller of C has them, with gaps of `gap` numbers after every joint.
struct PoseArrays {
  PoseArrays(const std::vector<Pose>& poses, std::size_t gap = 0) {
    all = api::make<bodyopt_poses>();
    all.frame_count = static_cast<std::uint32_t>(poses.size());
    all.joint_count = static_cast<std::uint32_t>(poses[0].joints.size());
    all.control_count = static_cast<std::uint32_t>(poses[0].controls.size());
    all.joint_stride = (10 + gap) * sizeof(double);
    for (std::size_t f = 0; f < poses.size(); ++f) {
      for (const JointTransform& t : poses[f].joints) {
        joints.insert(joints.end(), t.translation.begin(), t.translation.end());
        joints.insert(joints.end(), t.rotation.begin(), t.rotation.end());
        joints.insert(joints.end(), t.scale.begin(), t.scale.end());
        joints.insert(joints.end(), gap, std::nan(""));
      }
      controls.insert(controls.end(), poses[f].controls.begin(), poses[f].controls.end());
      numbers.push_back(static_cast<int>(f));
    }
    all.joints = joints.data();
    all.controls = controls.data();
    all.frame_numbers = numbers.data();
  }

  std::vector<double> joints;
  std::vector<float> controls;
  std::vector<int> numbers;
  bodyopt_poses all;
};

inline bodyopt_floats floats_in(std::vector<float>& values) {
  return {values.data(), values.size() * sizeof(float), 0, 0};
}

// The outputs of a call, without gaps.
struct Arrays {
  explicit Arrays(const Basis& basis, std::size_t frames)
      : positions(3 * basis.mesh.output_count() * frames),
        normals(positions.size()),
        strains(basis.strain.fibre_count() * frames),
        outside(frames),
        fades(frames) {
    all = api::make<bodyopt_skin>();
    all.positions = floats_in(positions);
    all.normals = floats_in(normals);
    all.strains = floats_in(strains);
    all.outside = floats_in(outside);
    all.fades = floats_in(fades);
  }

  std::vector<float> positions, normals, strains, outside, fades;
  bodyopt_skin all;
};

// Texture coordinates of its output vertices: the skin at rest, seen from the front.
inline std::vector<float> texture_of(const Basis& basis) {
  std::vector<float> texture;
  for (const std::uint32_t v : basis.mesh.output_vertex) {
    const float* x = &basis.mesh.rest[3 * std::size_t{v}];
    texture.insert(texture.end(), {x[0] + 0.3f * x[2], x[1] - 0.2f * x[2]});
  }
  return texture;
}

// The limb with these.
inline api::Model load_textured(const std::string& dynamics = {}) {
  const std::vector<float> texture = texture_of(load_basis(hero()));
  auto options = api::make<bodyopt_load_options>();
  if (!dynamics.empty()) options.dynamics = dynamics.c_str();
  options.texture = texture.data();
  options.texture_size = texture.size() * sizeof(float);
  options.texture_count = texture.size() / 2;
  bodyopt_model* model = nullptr;
  api::check(bodyopt_load_model(hero().c_str(), &options, &model));
  return api::Model(model);
}

inline api::Instance make_instance(const api::Model& model, bool jiggles = false, const api::Device& device = {}) {
  auto options = api::make<bodyopt_instance_options>();
  options.jiggles = jiggles;
  options.device = device.get();
  return api::create_instance(model, options);
}

}  // namespace bodyopt::testing
