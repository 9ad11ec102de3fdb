#include "trainer/tets/tets.h"

#include <fcntl.h>
#include <unistd.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>
#include <cstdio>
#include <exception>
#include <iostream>
#include <memory>
#include <mutex>

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

// Netgen talks on standard output, where the program writes its results, and on standard error.
class SilencedOutput {
 public:
  SilencedOutput() {
    flush();
    const int nowhere = open("/dev/null", O_WRONLY | O_CLOEXEC);
    for (int stream = 0; stream < 2; ++stream) {
      saved_[stream] = dup(STDOUT_FILENO + stream);
      if (nowhere >= 0) dup2(nowhere, STDOUT_FILENO + stream);
    }
    if (nowhere >= 0) close(nowhere);
  }
  ~SilencedOutput() {
    flush();
    for (int stream = 0; stream < 2; ++stream) {
      if (saved_[stream] < 0) continue;
      dup2(saved_[stream], STDOUT_FILENO + stream);
      close(saved_[stream]);
    }
  }
  SilencedOutput(const SilencedOutput&) = delete;
  SilencedOutput& operator=(const SilencedOutput&) = delete;

 private:
  static void flush() {
    std::cout.flush();
    std::cerr.flush();
    std::fflush(nullptr);
  }
  int saved_[2];
};

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

TetMesh read_volume(nglib::Ng_Mesh* mesh) {
  TetMesh result;
  result.nodes.resize(netgen().point_count(mesh), 3);
  for (Eigen::Index n = 0; n < result.nodes.rows(); ++n) {
    netgen().point(mesh, static_cast<int>(n) + 1, result.nodes.row(n).data());
  }
  result.tets.resize(netgen().element_count(mesh), 4);
  for (Eigen::Index t = 0; t < result.tets.rows(); ++t) {
    int corner[NG_VOLUME_ELEMENT_MAXPOINTS];
    netgen().volume_element(mesh, static_cast<int>(t) + 1, corner);
    for (int k = 0; k < 4; ++k) result.tets(t, k) = corner[k] - 1;
  }
  return result;
}

[[noreturn]] void refuse(const std::string& reason) {
  throw Error(ErrorKind::mismatch,
              "the skin cannot be filled with tetrahedra: " + reason +
                  "; the likely cause is a skin that intersects itself or has slivers between close sheets");
}

}  // namespace

TetMesh tetrahedralise(const Positions& vertices, const Triangles& triangles, double size) {
  require_closed(vertices, triangles);
  if (std::abs(enclosed_volume(vertices, triangles)) > kMostCells * size * size * size) {
    throw Error(ErrorKind::usage, "tetrahedra of " + std::to_string(size) +
                                      " m would be too many in a body of this volume: use larger ones (--tet-size)");
  }
  static std::mutex mutex;  // Netgen's globals are not safe for two threads
  const std::lock_guard<std::mutex> lock(mutex);
  netgen();  // or it is refused in the clear
  TetMesh result;
  std::string failure;
  {
    const SilencedOutput silence;
    netgen().init();
    try {
      const NetgenMesh mesh = surface_mesh(vertices, triangles);
      NetgenParameters parameters;
      parameters.values.maxh = size;
      parameters.values.grading = kGrading;
      if (netgen().generate_volume_mesh(mesh.get(), &parameters.values) != nglib::NG_OK) {
        failure = "Netgen gave up";
      } else {
        result = read_volume(mesh.get());
      }
    } catch (const std::exception& error) {
      failure = std::string("Netgen says '") + error.what() + "'";
    } catch (...) {
      failure = "Netgen failed";
    }
    netgen().exit();
  }
  if (!failure.empty()) refuse(failure);
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
