// Meshes that follow the skin: eyes, teeth, nails, props, clothes. An optional file beside the basis, made by
// `bodyopt attach`, constant afterwards. Rest space, metres; skin vertices are in the basis' runtime order.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "runtime/basis/basis.h"

namespace bodyopt {

// A frame that turns with the skin around its points, or with its joint where it has none.
struct AttachmentAnchor {
  std::uint32_t joint;  // of anchors with points: what says how it turns where the skin under it has collapsed
  float x, y, z;        // at rest: the mean of its points, or anywhere
};

struct AttachedMesh {
  std::string name;                          // a part of a file's name: no slashes, no control characters
  std::string bound;                         // to what, for people: "2 pieces fixed to joint 'Head'"
  std::vector<float> rest;                   // N x 3
  std::vector<std::uint32_t> triangles;      // T x 3
  std::vector<std::uint32_t> vertex_anchor;  // N
  std::vector<AttachmentAnchor> anchors;     // K
  std::vector<std::uint32_t> point_begin;    // K + 1, into points
  std::vector<SurfacePoint> points;          // barycentric on the skin

  std::uint32_t vertex_count() const { return static_cast<std::uint32_t>(rest.size() / 3); }
  std::uint32_t triangle_count() const { return static_cast<std::uint32_t>(triangles.size() / 3); }
};

struct Attachments {
  std::vector<AttachedMesh> meshes;
  Metadata metadata;  // topology_hash and skeleton_hash of the basis they belong to
};

constexpr std::size_t kMostAttachedMeshes = 4096, kLongestAttachedName = 100;

// `name` with underscores for what file systems refuse, cut to kLongestAttachedName bytes; "_" for nothing.
std::string attachment_name(const std::string& name);

// Checks every count, index, number and name. Throws Error(file) whose text starts with `origin`.
void validate(const Attachments& attachments, const std::string& origin);
// Checks them, and that they belong to the basis, called `basis_name`. Throws Error(file), Error(mismatch).
void validate(const Attachments& attachments, const Basis& basis, const std::string& origin,
              const std::string& basis_name = "this basis");

// Safetensors, as save_basis. Throws Error(file).
void save_attachments(const Attachments& attachments, const std::filesystem::path& path);
// Checks what it reads, against the basis where one is given. Throws Error(file), Error(mismatch).
Attachments load_attachments(const std::filesystem::path& path);
Attachments load_attachments(const std::filesystem::path& path, const Basis& basis,
                             const std::string& basis_name = "this basis");

// The path of a basis' attached geometry: hero.attached.safetensors beside hero.safetensors.
std::filesystem::path attachments_beside(std::filesystem::path basis);

}  // namespace bodyopt
