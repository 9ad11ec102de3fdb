#include "trainer/simulate/tets.h"

#include <fcntl.h>
#include <unistd.h>

#include <Eigen/Geometry>
#include <cmath>
#include <cstdio>
#include <map>
#include <mutex>
#include <string>

#include "runtime/basis/error.h"

namespace nglib {
#include <nglib.h>
}

namespace bodyopt {
namespace {

// Netgen reports on standard output and standard error; what it says is no result of ours.
class SilencedOutput {
 public:
  SilencedOutput() {
    std::fflush(nullptr);
    const int null = open("/dev/null", O_WRONLY | O_CLOEXEC);
    for (int k = 0; k < 2; ++k) {
      saved_[k] = dup(kStreams[k]);
      dup2(null, kStreams[k]);
    }
    close(null);
  }
  ~SilencedOutput() {
    std::fflush(nullptr);
    for (int k = 0; k < 2; ++k) {
      dup2(saved_[k], kStreams[k]);
      close(saved_[k]);
    }
  }
  SilencedOutput(const SilencedOutput&) = delete;
  SilencedOutput& operator=(const SilencedOutput&) = delete;

 private:
  static constexpr int kStreams[2] = {STDOUT_FILENO, STDERR_FILENO};
  int saved_[2];
};

[[noreturn]] void refuse(const std::string& what) {
  throw Error(ErrorKind::mismatch, "the skin cannot be filled with tetrahedra: " + what);
}

void check_closed(const Triangles& triangles) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;  // directed
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    for (int k = 0; k < 3; ++k) ++edges[{triangles(t, k), triangles(t, (k + 1) % 3)}];
  }
  int open = 0, crowded = 0;
  for (const auto& [edge, count] : edges) {
    crowded += count > 1 ? 1 : 0;
    open += edges.contains({edge.second, edge.first}) ? 0 : 1;
  }
  if (open > 0) {
    refuse("it is open, with " + std::to_string(open) +
           " boundary edges; expected a closed surface (holes at eyes, mouth or wrists?)");
  }
  if (crowded > 0) {
    refuse(std::to_string(crowded) +
           " edges have several triangles on one side; expected a manifold, evenly oriented "
           "surface");
  }
}

double signed_volume(const Positions& vertices, const Triangles& triangles) {
  double volume = 0;
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    const Eigen::Vector3d a = vertices.row(triangles(t, 0)), b = vertices.row(triangles(t, 1)),
                          c = vertices.row(triangles(t, 2));
    volume += a.dot(b.cross(c)) / 6;
  }
  return volume;
}

// Mean ratio: 12 (3 V)^(2/3) / sum of squared edges; 1 for a regular tet.
double quality(const Eigen::Vector3d (&x)[4], double volume) {
  double edges = 0;
  for (int a = 0; a < 4; ++a) {
    for (int b = a + 1; b < 4; ++b) edges += (x[a] - x[b]).squaredNorm();
  }
  return 12 * std::cbrt(9 * volume * volume) / edges;
}

// Netgen keeps its state in globals: one mesh at a time.
class NetgenMesh {
 public:
  NetgenMesh() : lock_(mutex()) {
    nglib::Ng_Init();
    mesh_ = nglib::Ng_NewMesh();
  }
  ~NetgenMesh() {
    nglib::Ng_DeleteMesh(mesh_);
    nglib::Ng_Exit();
  }
  NetgenMesh(const NetgenMesh&) = delete;
  NetgenMesh& operator=(const NetgenMesh&) = delete;

  void generate(const Positions& vertices, const Triangles& triangles, bool flip, double size) {
    for (Eigen::Index v = 0; v < vertices.rows(); ++v) {
      double x[3] = {vertices(v, 0), vertices(v, 1), vertices(v, 2)};
      nglib::Ng_AddPoint(mesh_, x);
    }
    for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
      int corners[3];
      for (int k = 0; k < 3; ++k) corners[k] = static_cast<int>(triangles(t, flip ? 2 - k : k)) + 1;
      nglib::Ng_AddSurfaceElement(mesh_, nglib::NG_TRIG, corners);
    }
    nglib::Ng_Meshing_Parameters parameters;
    parameters.maxh = size;
    parameters.grading = 0.5;
    parameters.optvolmeshenable = 1;
    parameters.optsteps_3d = 3;
    nglib::Ng_Result result = nglib::NG_ERROR;
    try {
      result = nglib::Ng_GenerateVolumeMesh(mesh_, &parameters);
    } catch (...) {  // Netgen throws its own types, on overlapping surfaces among others
    }
    if (result != nglib::NG_OK) refuse("Netgen gives up; the surface probably intersects itself");
  }

  TetMesh tets(Eigen::Index skin_vertices) const {
    TetMesh result;
    result.nodes.resize(nglib::Ng_GetNP(mesh_), 3);
    for (Eigen::Index n = 0; n < result.nodes.rows(); ++n) {
      double x[3];
      nglib::Ng_GetPoint(mesh_, static_cast<int>(n) + 1, x);
      result.nodes.row(n) << x[0], x[1], x[2];
    }
    result.tets.resize(nglib::Ng_GetNE(mesh_), 4);
    result.worst_quality = 1;
    for (Eigen::Index e = 0; e < result.tets.rows(); ++e) {
      int corners[NG_VOLUME_ELEMENT_MAXPOINTS];
      nglib::Ng_GetVolumeElement(mesh_, static_cast<int>(e) + 1, corners);
      Eigen::Vector3d x[4];
      for (int k = 0; k < 4; ++k) {
        result.tets(e, k) = corners[k] - 1;
        x[k] = result.nodes.row(corners[k] - 1);
      }
      const double volume = (x[1] - x[0]).cross(x[2] - x[0]).dot(x[3] - x[0]) / 6;
      if (volume < 0) std::swap(result.tets(e, 2), result.tets(e, 3));
      result.worst_quality = std::min(result.worst_quality, quality(x, std::abs(volume)));
    }
    if (result.tets.rows() == 0 || result.nodes.rows() < skin_vertices) refuse("Netgen made no tetrahedra");
    return result;
  }

 private:
  static std::mutex& mutex() {
    static std::mutex instance;
    return instance;
  }
  std::lock_guard<std::mutex> lock_;
  nglib::Ng_Mesh* mesh_;
};

}  // namespace

TetMesh tetrahedralise(const Positions& vertices, const Triangles& triangles, double size) {
  check_closed(triangles);
  const double volume = signed_volume(vertices, triangles);
  if (!(std::abs(volume) > 0)) refuse("it encloses no volume");
  TetMesh mesh;
  {
    const SilencedOutput silenced;
    NetgenMesh netgen;
    netgen.generate(vertices, triangles, volume < 0, size);
    mesh = netgen.tets(vertices.rows());
  }
  if (!mesh.nodes.topRows(vertices.rows()).isApprox(vertices, 1e-9)) refuse("Netgen moved the skin's vertices");
  constexpr double kWorstUsable = 1e-3;
  if (mesh.worst_quality < kWorstUsable) {
    refuse("its worst tetrahedron has a quality of " + std::to_string(mesh.worst_quality) +
           ": needle-like or nearly intersecting triangles in the skin");
  }
  return mesh;
}

}  // namespace bodyopt
