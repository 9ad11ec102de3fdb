#include "trainer/tets/tets.h"

#include <dlfcn.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <iomanip>
#include <memory>
#include <new>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include "base/child_process.h"
#include "geometry/mend_surface.h"
#include "geometry/mesh.h"
#include "geometry/remesh.h"
#include "geometry/self_intersections.h"
#include "geometry/thickness.h"
#include "runtime/core/error.h"
#include "runtime/core/transformed.h"

// Netgen's nglib is loaded when a skin is first filled. With Open CASCADE, which it brings along, it would take most of
// the time in which the program starts.
namespace nglib {
#include <nglib.h>
}

namespace bodyopt::trainer {
namespace {

// The functions of nglib.h that are used, without their prefix Ng_.
struct Netgen {
  decltype(&nglib::Ng_Init) init;
  decltype(&nglib::Ng_NewMesh) new_mesh;
  decltype(&nglib::Ng_DeleteMesh) delete_mesh;
  decltype(&nglib::Ng_AddPoint) add_point;
  decltype(&nglib::Ng_AddSurfaceElement) add_surface_element;
  decltype(&nglib::Ng_GenerateVolumeMesh) generate_volume_mesh;
  decltype(&nglib::Ng_GetNP) point_count;
  decltype(&nglib::Ng_GetPoint) point;
  decltype(&nglib::Ng_GetNE) element_count;
  decltype(&nglib::Ng_GetVolumeElement) volume_element;
  void (*reset_parameters)(nglib::Ng_Meshing_Parameters*);  // to Netgen's own
};

constexpr const char* kLibrary = BODYOPT_NETGEN;

// Why the library was not loaded. Throws std::bad_alloc where memory ran out, which the loader tells in words alone.
std::string loader_error() {
  const std::string reason = dlerror();
  for (const char* told : {"Cannot allocate memory", "cannot allocate memory", "failed to map segment"}) {
    if (reason.find(told) != std::string::npos) throw std::bad_alloc();
  }
  return reason;
}

[[noreturn]] void refuse_library() {
  const std::string reason = loader_error();
  throw Error(ErrorKind::file, kLibrary, ": expected Netgen's library, which fills skins with ", "tetrahedra: ", reason,
              "; is the package libnglib-6.2 installed?");
}

// `name`: as compilers write a C++ function's name into a library.
template <typename Function>
void find(void* library, const char* name, Function& function) {
  function = reinterpret_cast<Function>(dlsym(library, name));
  if (function == nullptr) refuse_library();
}

Netgen load() {
  void* library = dlopen(kLibrary, RTLD_LAZY | RTLD_LOCAL);
  if (library == nullptr) {
    loader_error();
    library = dlopen(std::strrchr(kLibrary, '/') + 1, RTLD_LAZY | RTLD_LOCAL);  // a wheel's own
  }
  if (library == nullptr) refuse_library();
  Netgen functions{};
  find(library, "_ZN5nglib7Ng_InitEv", functions.init);
  find(library, "_ZN5nglib10Ng_NewMeshEv", functions.new_mesh);
  find(library, "_ZN5nglib13Ng_DeleteMeshEPPv", functions.delete_mesh);
  find(library, "_ZN5nglib11Ng_AddPointEPPvPd", functions.add_point);
  find(library, "_ZN5nglib20Ng_AddSurfaceElementEPPvNS_23Ng_Surface_Element_TypeEPi", functions.add_surface_element);
  find(library, "_ZN5nglib21Ng_GenerateVolumeMeshEPPvPNS_21Ng_Meshing_ParametersE", functions.generate_volume_mesh);
  find(library, "_ZN5nglib8Ng_GetNPEPPv", functions.point_count);
  find(library, "_ZN5nglib11Ng_GetPointEPPviPd", functions.point);
  find(library, "_ZN5nglib8Ng_GetNEEPPv", functions.element_count);
  find(library, "_ZN5nglib19Ng_GetVolumeElementEPPviPi", functions.volume_element);
  find(library, "_ZN5nglib21Ng_Meshing_Parameters16Reset_ParametersEv", functions.reset_parameters);
  return functions;
}

// One library serves all threads. Throws Error(file) when it cannot be loaded.
const Netgen& netgen() {
  static const Netgen functions = load();
  return functions;
}

// Begins as Netgen's own: the constructor of nglib.h is not linked.
union NetgenParameters {
  NetgenParameters() { netgen().reset_parameters(&values); }
  nglib::Ng_Meshing_Parameters values;
};

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

constexpr int kRemeshRounds = 8;
constexpr int kAttempts = 8, kMostRefused = 3;
constexpr double kLeastQuality = 0.05;
constexpr double kCloseEnough = 0.92;  // of what the limit allows
constexpr double kLittleFiner = 0.97;  // after a skin that cannot be filled
constexpr double kOnSkin = 0.8;        // about this share of the nodes
constexpr double kInside = 1.5;        // longest edges inside the body over those of the skin
constexpr double kTetsPerNode = 3.2;   // about

Triangles wound_outwards(const Positions& vertices, const Triangles& triangles) {
  require_closed(vertices, triangles);
  return enclosed_volume(vertices, triangles) < 0 ? triangles.rowwise().reverse().eval() : triangles;
}

CoarseSkin coarser(const FineSkin& fine, double scale) {
  Surface surface;
  for (Eigen::Index v = 0; v < fine.vertices.rows(); ++v) surface.points.push_back(fine.vertices.row(v));
  for (Eigen::Index t = 0; t < fine.triangles.rows(); ++t) {
    const auto corners = fine.triangles.row(t).cast<int>();
    surface.triangles.push_back({corners[0], corners[1], corners[2]});
  }
  surface = remesh(
      surface, [&](const Eigen::Vector3d& p) { return fine.nearest(p).position; },
      [&](const Eigen::Vector3d& p) { return scale * fine.edge_at(p); }, kRemeshRounds);
  CoarseSkin skin{Positions(static_cast<Eigen::Index>(surface.points.size()), 3), {}};
  for (Eigen::Index v = 0; v < skin.vertices.rows(); ++v) {
    skin.vertices.row(v) = surface.points[static_cast<std::size_t>(v)].transpose();
  }
  skin.triangles =
      triangles_of(transformed(surface.triangles, [](const std::array<int, 3>& t) -> std::array<std::uint32_t, 3> {
        return {static_cast<std::uint32_t>(t[0]), static_cast<std::uint32_t>(t[1]), static_cast<std::uint32_t>(t[2])};
      }));
  return skin;
}

void require_quality(const TetMesh& mesh) {
  if (mesh.worst_quality >= kLeastQuality) return;
  throw Error(ErrorKind::mismatch, "its worst tetrahedron has a quality of ", mesh.worst_quality);
}

// Area of the fine skin in squared edges.
double relative_area(const FineSkin& fine) {
  double sum = 0;
  for (Eigen::Index t = 0; t < fine.triangles.rows(); ++t) {
    const auto corner = fine.triangles.row(t);
    const double edge = (fine.edge[corner[0]] + fine.edge[corner[1]] + fine.edge[corner[2]]) / 3;
    sum += triangle_area(fine.vertices, fine.triangles, t) / (edge * edge);
  }
  return sum;
}

// Empty where it does not pass through itself.
std::string where_it_passes_through_itself(const CoarseSkin& skin) {
  const std::vector<TrianglePair> pairs = self_intersections(skin.vertices, skin.triangles);
  if (pairs.empty()) return "";
  const Eigen::RowVector3d place = skin.vertices.row(skin.triangles(pairs.front().first, 0));
  std::ostringstream text;
  text << std::fixed << std::setprecision(3) << "; the coarser skin passes through itself at " << place << " m";
  return text.str();
}

double share_of(const FillLimit& limit, const TetMesh& mesh) {
  return std::max(static_cast<double>(mesh.nodes.rows()) / static_cast<double>(limit.nodes),
                  static_cast<double>(mesh.tets.rows()) / static_cast<double>(limit.tets));
}

}  // namespace

TetMesh tetrahedralise(const Positions& vertices, const Triangles& triangles, double size) {
  require_closed(vertices, triangles);
  if (std::abs(enclosed_volume(vertices, triangles)) > kMostCells * size * size * size) {
    throw Error(ErrorKind::usage, "tetrahedra of ", size,
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

FineSkin::FineSkin(const Positions& v, const Triangles& wound)
    : vertices(v),
      triangles(wound_outwards(v, wound)),
      normals(vertex_normals(v, triangles)),
      edge(thickness(v, triangles).cwiseSqrt()),
      nearest(v, triangles) {}

double FineSkin::edge_at(const Eigen::Vector3d& point) const { return at_point(edge, nearest(point)); }

FilledSkin fill_coarser(const FineSkin& fine, FillLimit limit, const std::function<void(CoarseSkin&)>& adjust) {
  limit.nodes = std::min(limit.nodes, static_cast<Eigen::Index>(static_cast<double>(fine.vertices.rows()) / kOnSkin));
  const double nodes = std::min(static_cast<double>(limit.nodes), static_cast<double>(limit.tets) / kTetsPerNode);
  // A node of a skin of regular triangles has sqrt(3) / 2 squared edges of it.
  double scale = std::sqrt(relative_area(fine) / (kOnSkin * nodes * std::sqrt(3) / 2));
  if (!(scale > 0)) throw Error(ErrorKind::mismatch, "the skin has no area");
  std::optional<FilledSkin> best;
  double best_share = 0;
  std::string refusal = "every one tried had too many nodes or tetrahedra";
  ErrorCause cause = ErrorCause::other;
  int refused = 0;
  for (int attempt = 0; attempt < kAttempts && refused < kMostRefused; ++attempt) {
    CoarseSkin skin = coarser(fine, scale);
    adjust(skin);
    try {
      TetMesh mesh = tetrahedralise(skin.vertices, skin.triangles, kInside * scale * fine.edge.maxCoeff());
      require_quality(mesh);
      const double share = share_of(limit, mesh);
      if (share <= 1 && share > best_share) {
        best = FilledSkin{std::move(skin), std::move(mesh)};
        best_share = share;
      }
      if (share <= 1 && share > kCloseEnough) break;
      scale *= std::sqrt(share / (0.5 + 0.5 * kCloseEnough));
    } catch (const Error& error) {
      if (error.kind() != ErrorKind::mismatch && error.kind() != ErrorKind::usage) throw;  // too fine, or not filled
      refusal = error.what() + where_it_passes_through_itself(skin);
      cause = error.cause();
      ++refused;
      scale *= kLittleFiner;
    }
  }
  if (!best) throw Error(ErrorKind::mismatch, "no coarser skin can be filled: " + refusal, cause);
  return std::move(*best);
}

}  // namespace bodyopt::trainer
