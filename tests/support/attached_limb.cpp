#include "tests/support/attached_limb.h"

#include <cmath>
#include <numbers>

#include "runtime/core/text.h"
#include "trainer/train/skinning/ddm.h"

namespace bodyopt {

const Basis& limb_basis() {
  static const Basis basis = trainer::build_ddm_basis(limb_character(), {});
  return basis;
}

trainer::LooseMesh sphere_at(const std::string& name, const Vec3& centre, double radius) {
  constexpr std::uint32_t kRings = 6, kSides = 8;
  trainer::LooseMesh mesh;
  mesh.name = name;
  for (std::uint32_t i = 0; i <= kRings; ++i) {
    for (std::uint32_t k = 0; k < kSides; ++k) {
      const double a = std::numbers::pi * i / kRings, b = 2 * std::numbers::pi * k / kSides;
      mesh.vertices.push_back(centre +
                              radius * Vec3{std::sin(a) * std::cos(b), std::sin(a) * std::sin(b), std::cos(a)});
    }
  }
  for (std::uint32_t i = 0; i < kRings; ++i) {
    for (std::uint32_t k = 0; k < kSides; ++k) {
      const std::uint32_t p = i * kSides + k, q = i * kSides + (k + 1) % kSides;
      mesh.triangles.push_back({p, p + kSides, q + kSides});
      mesh.triangles.push_back({p, q + kSides, q});
    }
  }
  return mesh;
}

trainer::LooseMesh sleeve(double offset) {
  constexpr std::uint32_t kRings = 31, kSides = 24;
  trainer::LooseMesh mesh;
  mesh.name = "sleeve";
  for (std::uint32_t i = 0; i < kRings; ++i) {
    for (std::uint32_t k = 0; k < kSides; ++k) {
      const double angle = 2 * std::numbers::pi * k / kSides, radius = kLimbRadius + offset;
      mesh.vertices.push_back({radius * std::cos(angle), radius * std::sin(angle), 0.15 + 0.01 * i});
    }
  }
  for (std::uint32_t i = 0; i + 1 < kRings; ++i) {
    for (std::uint32_t k = 0; k < kSides; ++k) {
      const std::uint32_t p = i * kSides + k, q = i * kSides + (k + 1) % kSides;
      mesh.triangles.push_back({p, q, q + kSides});
      mesh.triangles.push_back({p, q + kSides, p + kSides});
    }
  }
  return mesh;
}

trainer::LooseMesh blade() {
  trainer::LooseMesh mesh;
  mesh.name = "blade";
  mesh.vertices = {{0.05, 0, 0.53}, {0.05, 0, 0.55}, {0.35, 0, 0.53}, {0.35, 0, 0.55}, {0.2, 0.01, 0.54}};
  mesh.triangles = {{0, 1, 4}, {1, 3, 4}, {3, 2, 4}, {2, 0, 4}};
  return mesh;
}

Attachments attached_to_limb(const std::vector<trainer::LooseMesh>& meshes, const trainer::AttachOptions& options) {
  const trainer::RestSkin skin(limb_basis());
  Attachments attachments;
  for (const trainer::LooseMesh& mesh : meshes) attachments.meshes.push_back(trainer::bind_mesh(mesh, skin, options));
  attachments.metadata["topology_hash"] = hexadecimal(topology_hash(limb_basis().mesh));
  attachments.metadata["skeleton_hash"] = hexadecimal(skeleton_hash(limb_basis().skeleton));
  return attachments;
}

Attachments limb_outfit() {
  return attached_to_limb(
      {sphere_at("eye", {0, 0, 0.1}, 0.008), sphere_at("button", {0.057, 0, 0.31}, 0.006), sleeve(0.008), blade()});
}

}  // namespace bodyopt
