#include "trainer/curate/frame_files.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <map>
#include <set>
#include <sstream>

#include "assets/clip_source.h"
#include "assets/notes.h"
#include "runtime/basis/read_file.h"
#include "runtime/core/atomic_file.h"
#include "runtime/core/error.h"
#include "trainer/curate/match_vertices.h"

namespace bodyopt {
namespace {

using Corner = std::uint32_t;

constexpr std::uint64_t kLargestObj = std::uint64_t{1} << 30;  // bytes

std::string place_of(const std::filesystem::path& path, std::size_t line) {
  return path.string() + ", line " + std::to_string(line);
}

float coordinate(const std::string& word, const std::string& place) {
  float value = 0;
  const auto [end, failure] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (failure != std::errc() || end != word.data() + word.size() || !std::isfinite(value)) {
    throw Error(ErrorKind::file, place + ": '" + word.substr(0, 40) + "' is no coordinate: damaged, or exploded?");
  }
  return value;
}

// "3", "3/1/7", "-1".
Corner corner(const std::string& word, std::size_t vertices, const std::string& place) {
  long number = 0;
  std::from_chars(word.data(), word.data() + word.size(), number);
  if (number < 0) number += static_cast<long>(vertices) + 1;
  if (number < 1 || static_cast<std::size_t>(number) > vertices) {
    throw Error(ErrorKind::file, place + ": the face's corner '" + word.substr(0, 40) + "' is no vertex of the file");
  }
  return static_cast<Corner>(number - 1);
}

struct ObjMesh {
  std::vector<float> positions;
  std::vector<std::vector<Corner>> faces;
};

ObjMesh parse_obj(const std::filesystem::path& path) {
  std::istringstream text(read_file(path, kLargestObj, "a Wavefront OBJ"));
  ObjMesh mesh;
  std::string line, word;
  for (std::size_t number = 1; std::getline(text, line); ++number) {
    std::istringstream words(line);
    if (!(words >> word)) continue;
    if (word == "v") {
      for (int i = 0; i < 3; ++i) {
        if (!(words >> word))
          throw Error(ErrorKind::file, place_of(path, number) + ": a vertex of fewer than 3 numbers");
        mesh.positions.push_back(coordinate(word, place_of(path, number)));
      }
    } else if (word == "f") {
      std::vector<Corner> face;
      while (words >> word) face.push_back(corner(word, mesh.positions.size() / 3, place_of(path, number)));
      mesh.faces.push_back(std::move(face));
    }
  }
  return mesh;
}

std::set<std::vector<Corner>> sorted_triangles(const Character& character) {
  std::set<std::vector<Corner>> triangles;
  for (Eigen::Index t = 0; t < character.output_triangles.rows(); ++t) {
    std::vector<Corner> corners(3);
    for (int k = 0; k < 3; ++k) corners[static_cast<std::size_t>(k)] = character.output_triangles(t, k);
    std::sort(corners.begin(), corners.end());
    triangles.insert(std::move(corners));
  }
  return triangles;
}

bool has_its_faces(const Character& character, const ObjMesh& mesh) {
  const std::set<std::vector<Corner>> known = sorted_triangles(character);
  const auto has = [&](Corner a, Corner b, Corner c) {
    std::vector<Corner> triangle{a, b, c};
    std::sort(triangle.begin(), triangle.end());
    return known.contains(triangle);
  };
  return std::all_of(mesh.faces.begin(), mesh.faces.end(), [&](const std::vector<Corner>& f) {
    if (f.size() == 3) return has(f[0], f[1], f[2]);
    if (f.size() != 4) return false;
    return (has(f[0], f[1], f[2]) && has(f[0], f[2], f[3])) || (has(f[0], f[1], f[3]) && has(f[1], f[2], f[3]));
  });
}

std::string likely_cause(const Character& character, std::size_t found) {
  if (found == static_cast<std::size_t>(character.vertices.rows())) return "vertices along UV seams were merged";
  return found > character.output_count() ? "it was subdivided, or holds more than the skin"
                                          : "vertices were merged or deleted";
}

std::string both_counts(const Character& character, const std::filesystem::path& path, std::size_t found) {
  return path.string() + ": it has " + std::to_string(found) + " vertices, the character's skin " +
         std::to_string(character.output_count()) + " (" + std::to_string(character.vertices.rows()) +
         " without seams): ";
}

// A surface whose vertices stand in an order of their own.
struct GivenSurface {
  Positions vertices;
  Triangles triangles;
};

// Without what a file repeats along seams. Faces of more corners become fans.
GivenSurface surface_of(const ObjMesh& mesh) {
  const std::size_t count = mesh.positions.size() / 3;
  std::map<std::array<float, 3>, Corner> places;
  std::vector<Corner> welded(count);
  for (std::size_t v = 0; v < count; ++v) {
    const std::array<float, 3> place{mesh.positions[3 * v], mesh.positions[3 * v + 1], mesh.positions[3 * v + 2]};
    welded[v] = places.emplace(place, static_cast<Corner>(places.size())).first->second;
  }
  GivenSurface surface;
  surface.vertices.resize(static_cast<Eigen::Index>(places.size()), 3);
  for (const auto& [place, number] : places) {
    surface.vertices.row(number) << double{place[0]}, double{place[1]}, double{place[2]};
  }
  std::vector<Corner> corners;
  for (const std::vector<Corner>& face : mesh.faces) {
    for (std::size_t k = 2; k < face.size(); ++k) {
      corners.insert(corners.end(), {welded[face[0]], welded[face[k - 1]], welded[face[k]]});
    }
  }
  surface.triangles = Eigen::Map<const Triangles>(corners.data(), static_cast<Eigen::Index>(corners.size() / 3), 3);
  return surface;
}

Positions in_own_order(const Character& character, const Positions& exported, const GivenSurface& given,
                       const std::filesystem::path& path) {
  const auto found = static_cast<std::size_t>(given.vertices.rows());
  if (given.vertices.rows() != exported.rows()) {
    throw Error(ErrorKind::mismatch, both_counts(character, path, found) + likely_cause(character, found));
  }
  constexpr double kUnmoved = 1e-6;  // of the size: files round
  const double size = (exported.colwise().maxCoeff() - exported.colwise().minCoeff()).norm();
  const std::vector<int> match =
      match_vertices(exported, character.triangles, given.vertices, given.triangles, kUnmoved * size);
  Positions result = exported;
  const auto lost = static_cast<std::size_t>(std::count(match.begin(), match.end(), -1));
  if (lost > 0) {
    throw Error(ErrorKind::mismatch,
                both_counts(character, path, found) + "which of them " + count_of(lost, "vertex is", "vertices are") +
                    " is not to be told: their order is not the character's, nor are the faces, or all of it was moved "
                    "(keep the vertex order, or another pose was exported)");
  }
  for (std::size_t v = 0; v < match.size(); ++v)
    result.row(match[v]) = given.vertices.row(static_cast<Eigen::Index>(v));
  return result;
}

}  // namespace

void write_frame_obj(const Character& character, const std::vector<float>& positions,
                     const std::filesystem::path& path) {
  std::string text = "# " + character.name + "\n";
  char line[96];
  for (std::size_t v = 0; v < positions.size(); v += 3) {
    std::snprintf(line, sizeof(line), "v %.9g %.9g %.9g\n", double{positions[v]}, double{positions[v + 1]},
                  double{positions[v + 2]});
    text += line;
  }
  for (Eigen::Index t = 0; t < character.output_triangles.rows(); ++t) {
    std::snprintf(line, sizeof(line), "f %u %u %u\n", character.output_triangles(t, 0) + 1,
                  character.output_triangles(t, 1) + 1, character.output_triangles(t, 2) + 1);
    text += line;
  }
  write_file_atomically(path, std::as_bytes(std::span(text)));
}

void write_frame_gltf(const Character& character, const Positions& skin, const Pose& pose,
                      const std::filesystem::path& path) {
  Character posed = character;
  posed.vertices = skin;
  const std::vector<Affine> joints = posed_joints(character.skeleton, pose.joints);
  for (std::size_t j = 0; j < joints.size(); ++j) {
    Joint& joint = posed.skeleton.joints[j];
    joint.bind = joint.default_local = pose.joints[j];
    joint.inverse_bind = inverse(joints[j]);
  }
  write_character(posed, path);
}

std::vector<float> read_frame_mesh(const Character& character, const Positions& exported,
                                   const std::filesystem::path& path) {
  GivenSurface given;
  if (lower_case_extension(path) == ".obj") {
    ObjMesh mesh = parse_obj(path);
    if (mesh.positions.size() == 3 * std::size_t{character.output_count()} && has_its_faces(character, mesh)) {
      return std::move(mesh.positions);
    }
    given = surface_of(mesh);
  } else {
    const Character read = read_character(path, 1);
    given = {read.vertices, read.triangles};
  }
  return output_from_welded(character, in_own_order(character, exported, given, path));
}

}  // namespace bodyopt
