#include "trainer/curate/frame_files.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <set>
#include <sstream>

#include "runtime/basis/read_file.h"
#include "runtime/core/atomic_file.h"
#include "runtime/core/error.h"

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

void check_faces(const Character& character, const ObjMesh& mesh, const std::filesystem::path& path) {
  const std::set<std::vector<Corner>> known = sorted_triangles(character);
  for (std::vector<Corner> face : mesh.faces) {
    if (face.size() != 3) continue;
    std::sort(face.begin(), face.end());
    if (known.contains(face)) continue;
    throw Error(ErrorKind::mismatch, path.string() + ": the face of the vertices " + std::to_string(face[0] + 1) +
                                         ", " + std::to_string(face[1] + 1) + " and " + std::to_string(face[2] + 1) +
                                         " is none of the character's: its vertices stand in another order, or it was "
                                         "triangulated anew");
  }
}

}  // namespace

void write_obj(const Character& character, const std::vector<float>& positions, const std::filesystem::path& path) {
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

std::vector<float> read_obj(const Character& character, const std::filesystem::path& path) {
  ObjMesh mesh = parse_obj(path);
  const std::size_t found = mesh.positions.size() / 3, expected = character.output_count();
  if (found != expected) {
    std::string cause =
        found > expected ? "it was subdivided, or holds more than the skin" : "vertices were merged or deleted";
    if (found == static_cast<std::size_t>(character.vertices.rows())) cause = "vertices along UV seams were merged";
    throw Error(ErrorKind::mismatch, path.string() + ": it has " + std::to_string(found) +
                                         " vertices, the character's skin " + std::to_string(expected) + ": " + cause);
  }
  check_faces(character, mesh, path);
  return std::move(mesh.positions);
}

}  // namespace bodyopt
