#include "trainer/tets/tets.h"

#include <Eigen/LU>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <memory>
#include <string>

#include "base/child_process.h"
#include "geometry/closed_skin.h"
#include "runtime/core/error.h"
#include "trainer/tets/netgen.h"

namespace bodyopt {
namespace {

// Cubes of the tetrahedra's size in a body: beyond this many, memory runs out and Netgen does not return.
constexpr double kMostCells = 1e6;
// Below this mean-ratio quality an element is too flat for the solver.
constexpr double kMinQuality = 1e-3;
// How fast elements may grow away from the skin. On the 13,380-vertex body 0.7 gives 54k tets of quality 0.05 at worst,
// Netgen's own 0.3 gives 82k of 0.004.
constexpr double kGrading = 0.7;

struct MeshDeleter {
  void operator()(nglib::Ng_Mesh* mesh) const { netgen().delete_mesh(mesh); }
};
using NetgenMesh = std::unique_ptr<nglib::Ng_Mesh, MeshDeleter>;

NetgenMesh surface_mesh(const Positions& vertices, const Triangles& triangles) {
  NetgenMesh mesh(netgen().new_mesh());
  for (Eigen::Index v = 0; v < vertices.rows(); ++v) {
    double p[3] = {vertices(v, 0), vertices(v, 1), vertices(v, 2)};
    netgen().add_point(mesh.get(), p);
  }
  const bool inside_out = enclosed_volume(vertices, triangles) < 0;
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    int corner[3];
    for (int k = 0; k < 3; ++k) corner[k] = static_cast<int>(triangles(t, inside_out ? 2 - k : k)) + 1;
    netgen().add_surface_element(mesh.get(), nglib::NG_TRIG, corner);
  }
  return mesh;
}

template <typename Matrix>
void append(std::string& bytes, const Matrix& values) {
  bytes.append(reinterpret_cast<const char*>(values.data()),
               static_cast<std::size_t>(values.size()) * sizeof(typename Matrix::Scalar));
}

template <typename Matrix>
const char* read(const char* bytes, Matrix& values) {
  const std::size_t size = static_cast<std::size_t>(values.size()) * sizeof(typename Matrix::Scalar);
  std::memcpy(values.data(), bytes, size);
  return bytes + size;
}

// Counts, nodes, tets: as the child hands them over.
using Counts = Eigen::Matrix<std::int64_t, 2, 1>;

std::string volume_bytes(nglib::Ng_Mesh* mesh) {
  TetMesh volume;
  volume.nodes.resize(netgen().point_count(mesh), 3);
  for (Eigen::Index n = 0; n < volume.nodes.rows(); ++n) {
    netgen().point(mesh, static_cast<int>(n) + 1, volume.nodes.row(n).data());
  }
  volume.tets.resize(netgen().element_count(mesh), 4);
  for (Eigen::Index t = 0; t < volume.tets.rows(); ++t) {
    int corner[NG_VOLUME_ELEMENT_MAXPOINTS];
    netgen().volume_element(mesh, static_cast<int>(t) + 1, corner);
    for (int k = 0; k < 4; ++k) volume.tets(t, k) = corner[k] - 1;
  }
  std::string bytes;
  append(bytes, Counts(volume.nodes.rows(), volume.tets.rows()));
  append(bytes, volume.nodes);
  append(bytes, volume.tets);
  return bytes;
}

TetMesh read_volume(const std::string& bytes) {
  Counts counts;
  const char* next = read(bytes.data(), counts);
  TetMesh volume;
  volume.nodes.resize(counts[0], 3);
  volume.tets.resize(counts[1], 4);
  read(read(next, volume.nodes), volume.tets);
  return volume;
}

// Empty: Netgen gave up.
std::string fill(const Positions& vertices, const Triangles& triangles, double size) {
  netgen().init();
  const NetgenMesh mesh = surface_mesh(vertices, triangles);
  NetgenParameters parameters;
  parameters.values.maxh = size;
  parameters.values.grading = kGrading;
  const bool filled = netgen().generate_volume_mesh(mesh.get(), &parameters.values) == nglib::NG_OK;
  return filled ? volume_bytes(mesh.get()) : "";
}

[[noreturn]] void refuse(const std::string& reason) {
  throw Error(ErrorKind::mismatch,
              "the skin cannot be filled with tetrahedra: " + reason +
                  "; the likely cause is a skin that intersects itself or has slivers between close sheets",
              ErrorCause::unfillable);
}

}  // namespace

TetMesh tetrahedralise(const Positions& vertices, const Triangles& triangles, double size) {
  require_closed(vertices, triangles);
  if (std::abs(enclosed_volume(vertices, triangles)) > kMostCells * size * size * size) {
    throw Error(ErrorKind::usage, "tetrahedra of " + std::to_string(size) +
                                      " m would be too many in a body of this volume: use larger ones (--tet-size)");
  }
  netgen();  // or the child would load it each time, and refuse it in silence
  const ChildResult filled = run_in_child([&] { return fill(vertices, triangles, size); });
  if (!filled.crash.empty()) refuse("Netgen ended with '" + filled.crash + "'");
  if (filled.bytes.empty()) refuse("Netgen gave up");
  TetMesh result = read_volume(filled.bytes);
  if (result.tets.rows() == 0) refuse("Netgen made no tetrahedra");
  if (result.nodes.rows() < vertices.rows() || result.nodes.topRows(vertices.rows()) != vertices) {
    refuse("Netgen moved vertices of the skin");
  }
  orient(result);
  if (!(result.worst_quality > kMinQuality)) {
    refuse("the worst tetrahedron is flat (quality " + std::to_string(result.worst_quality) + ")");
  }
  return result;
}

}  // namespace bodyopt
