#include "trainer/curate/frame_files.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <map>
#include <set>
#include <sstream>

#include "assets/clips/clip_source.h"
#include "assets/gltf/gltf_skin.h"
#include "base/wording.h"
#include "geometry/mesh.h"
#include "runtime/basis/read_file.h"
#include "runtime/core/atomic_file.h"
#include "runtime/core/error.h"
#include "runtime/core/text.h"
#include "runtime/core/transformed.h"
#include "trainer/curate/local_models.h"
#include "trainer/curate/match_vertices.h"

namespace bodyopt::trainer {
namespace {

using Corner = std::uint32_t;

constexpr std::uint64_t kLargestObj = std::uint64_t{1} << 30;  // bytes
constexpr double kUnmoved = 1e-6;                              // of the size: files round
constexpr const char* kMark = "exported-";                     // and 16 hexadecimal digits

// The mark that is in a name; other programs add to names.
std::string mark_in(const std::string& name) {
  const std::string begun = kMark;
  const std::size_t at = name.find(begun);
  return at == std::string::npos ? "" : name.substr(at, begun.size() + 16);
}

std::string place_of(const std::filesystem::path& path, std::size_t line) {
  return path.string() + ", line " + std::to_string(line);
}

float coordinate(const std::string& word, const std::string& place) {
  float value = 0;
  const auto [end, failure] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (failure != std::errc() || end != word.data() + word.size() || !std::isfinite(value)) {
    throw Error(ErrorKind::file, place, ": '", word.substr(0, 40), "' is no coordinate: damaged, or exploded?");
  }
  return value;
}

// The index of one of `count` things, which the file numbers from 1, or backwards from -1: "3".
Corner number_of(const std::string& word, std::size_t count, const char* what, const std::string& place) {
  long number = 0;
  std::from_chars(word.data(), word.data() + word.size(), number);
  if (number < 0) number += static_cast<long>(count) + 1;
  if (number < 1 || static_cast<std::size_t>(number) > count) {
    throw Error(ErrorKind::file, place, ": the face's corner '", word.substr(0, 40), "' is no ", what, " of the file");
  }
  return static_cast<Corner>(number - 1);
}

struct ObjMesh {
  std::vector<float> positions;
  std::vector<std::array<double, 2>> texture;
  std::vector<std::vector<Corner>> faces;
  std::vector<std::array<Corner, 2>> textured;  // vertices, and what of the texture corners give them
  std::string mark;                             // of an object's or group's name; empty: none has one
};

// "3", "3/1/7", "3//7", "-1".
Corner read_corner(const std::string& word, const std::string& place, ObjMesh& mesh) {
  const std::size_t slash = word.find('/');
  const Corner vertex = number_of(word.substr(0, slash), mesh.positions.size() / 3, "vertex", place);
  if (slash == std::string::npos || slash + 1 == word.size() || word[slash + 1] == '/') return vertex;
  const std::string uv = word.substr(slash + 1, word.find('/', slash + 1) - slash - 1);
  mesh.textured.push_back({vertex, number_of(uv, mesh.texture.size(), "texture coordinate", place)});
  return vertex;
}

ObjMesh parse_obj(const std::filesystem::path& path) {
  std::istringstream text(read_file(path, kLargestObj, "a Wavefront OBJ"));
  ObjMesh mesh;
  std::string line, word;
  for (std::size_t number = 1; std::getline(text, line); ++number) {
    std::istringstream words(line);
    if (!(words >> word)) continue;
    const auto coordinates = [&](int count, const char* of) {
      std::array<float, 3> values{};
      for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
        if (!(words >> word)) {
          throw Error(ErrorKind::file, place_of(path, number), ": ", of, " of fewer than ", count, " numbers");
        }
        values[i] = coordinate(word, place_of(path, number));
      }
      return values;
    };
    if (word == "v") {
      const std::array<float, 3> at = coordinates(3, "a vertex");
      mesh.positions.insert(mesh.positions.end(), at.begin(), at.end());
    } else if (word == "vt") {
      const std::array<float, 3> at = coordinates(2, "a texture coordinate");
      mesh.texture.push_back({double{at[0]}, 1 - double{at[1]}});  // glTF counts from the top
    } else if (word == "f") {
      std::vector<Corner> face;
      while (words >> word) face.push_back(read_corner(word, place_of(path, number), mesh));
      mesh.faces.push_back(std::move(face));
    } else if ((word == "o" || word == "g") && mesh.mark.empty()) {
      mesh.mark = mark_in(line);
    }
  }
  return mesh;
}

std::set<std::vector<Corner>> sorted_triangles(const Character& character) {
  std::set<std::vector<Corner>> triangles;
  for (Eigen::Index t = 0; t < character.output_triangles.rows(); ++t) {
    std::vector<Corner> corners(3);
    for (int k = 0; k < 3; ++k) corners[static_cast<std::size_t>(k)] = character.output_triangles(t, k);
    std::ranges::sort(corners);
    triangles.insert(std::move(corners));
  }
  return triangles;
}

bool has_its_faces(const Character& character, const ObjMesh& mesh) {
  const std::set<std::vector<Corner>> known = sorted_triangles(character);
  const auto has = [&](Corner a, Corner b, Corner c) {
    std::vector<Corner> triangle{a, b, c};
    std::ranges::sort(triangle);
    return known.contains(triangle);
  };
  return std::ranges::all_of(mesh.faces, [&](const std::vector<Corner>& f) {
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

// Without what a file repeats along seams. Faces of more corners become fans.
TexturedSurface surface_of(const ObjMesh& mesh) {
  const std::size_t count = mesh.positions.size() / 3;
  std::map<std::array<float, 3>, Corner> places;
  std::vector<Corner> welded(count);
  for (std::size_t v = 0; v < count; ++v) {
    const std::array<float, 3> place{mesh.positions[3 * v], mesh.positions[3 * v + 1], mesh.positions[3 * v + 2]};
    welded[v] = places.emplace(place, static_cast<Corner>(places.size())).first->second;
  }
  TexturedSurface surface;
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
  for (const auto& [vertex, uv] : mesh.textured) {
    surface.texture.push_back({welded[vertex], mesh.texture[uv][0], mesh.texture[uv][1]});
  }
  return surface;
}

// `texture`: O x 2, or empty.
std::vector<TexturedVertex> textured(const Character& character, const std::vector<double>& texture) {
  std::vector<TexturedVertex> all;
  for (std::size_t o = 0; 2 * o + 1 < texture.size(); ++o) {
    all.push_back({character.output_vertex[o], texture[2 * o], texture[2 * o + 1]});
  }
  return all;
}

// The region that weighs most at the corners of each output triangle.
std::vector<std::size_t> heaviest_regions(const Character& character, const std::vector<RegionWeights>& regions) {
  const Eigen::Index count = character.output_triangles.rows();
  std::vector<std::size_t> heaviest(static_cast<std::size_t>(count), 0);
  std::vector<double> most(heaviest.size(), 0);
  std::vector<double> weight(static_cast<std::size_t>(character.vertices.rows()));
  for (std::size_t r = 0; r < regions.size(); ++r) {
    std::ranges::fill(weight, 0.0);
    for (std::size_t k = 0; k < regions[r].vertices.size(); ++k) weight[regions[r].vertices[k]] = regions[r].weights[k];
    for (Eigen::Index t = 0; t < count; ++t) {
      double sum = 0;
      for (int k = 0; k < 3; ++k) sum += weight[character.output_vertex[character.output_triangles(t, k)]];
      if (sum <= most[static_cast<std::size_t>(t)]) continue;
      most[static_cast<std::size_t>(t)] = sum;
      heaviest[static_cast<std::size_t>(t)] = r;
    }
  }
  return heaviest;
}

// The mark is first: other programs cut long names.
std::string marked_name(const Character& character, const std::string& mark) { return mark + " " + character.name; }

std::string face_line(const Character& character, Eigen::Index triangle, bool has_texture) {
  std::string line = "f";
  for (int k = 0; k < 3; ++k) {
    const std::string number = std::to_string(character.output_triangles(triangle, k) + 1);
    line += " " + number + (has_texture ? "/" + number : "");
  }
  return line + "\n";
}

std::string face_lines(const Character& character, const SkinSurface& surface) {
  std::string text;
  for (std::size_t m = 0; m < std::max<std::size_t>(1, surface.materials.size()); ++m) {
    if (!surface.materials.empty()) text += "usemtl " + surface.materials[m].name + "\n";
    for (Eigen::Index t = 0; t < character.output_triangles.rows(); ++t) {
      const bool own = surface.materials.empty() || surface.material_of[static_cast<std::size_t>(t)] == m;
      if (own) text += face_line(character, t, !surface.texture.empty());
    }
  }
  return text;
}

// A mesh of another unit is no sculpt, whatever order its vertices have.
void check_size(const Positions& exported, const Positions& given, const std::filesystem::path& path) {
  constexpr double kLargest = 5;
  if (given.rows() == 0) return;
  const double own = box_diagonal(exported), found = box_diagonal(given);
  if (found < kLargest * own && own < kLargest * found) return;
  throw Error(ErrorKind::mismatch, path,
              formatted(": the mesh measures %.4g m from corner to corner, the frame %.4g m, %.3g times as much: ",
                        found, own, found / own),
              "was it written in another unit (metres are expected), or scaled, or is it of another character?");
}

// Finds the skin that the mesh was made of; the result's positions stay empty.
FrameMesh made_of(std::span<const WrittenSkin> written, const Positions& given, const std::string& mark) {
  const auto marked = std::ranges::find(written, mark, &WrittenSkin::mark);
  if (!mark.empty() && marked != written.end()) return {{}, static_cast<std::size_t>(marked - written.begin())};
  if (written.size() == 1) return {};
  std::vector<std::size_t> unmoved = transformed(
      written, [&](const WrittenSkin& one) { return vertices_in_place(one.skin, given, unmoved_distance(one.skin)); });
  const std::size_t best = static_cast<std::size_t>(std::ranges::max_element(unmoved) - unmoved.begin());
  const Positions& taken = written[best].skin;
  FrameMesh mesh{{}, best};
  for (std::size_t k = 0; k < written.size(); ++k) {
    const double apart = (written[k].skin - taken).rowwise().norm().maxCoeff();
    if (unmoved[k] == unmoved[best] && apart > unmoved_distance(taken)) ++mesh.alike;
  }
  return mesh;
}

Positions in_own_order(const Character& character, const TexturedSurface& exported, const TexturedSurface& given,
                       const std::filesystem::path& path) {
  const auto found = static_cast<std::size_t>(given.vertices.rows());
  if (given.vertices.rows() != exported.vertices.rows()) {
    throw Error(ErrorKind::mismatch, both_counts(character, path, found), likely_cause(character, found));
  }
  const std::vector<int> match = match_vertices(exported, given, unmoved_distance(exported.vertices));
  Positions result = exported.vertices;
  const auto lost = static_cast<std::size_t>(std::ranges::count(match, -1));
  if (lost > 0) {
    throw Error(ErrorKind::mismatch, both_counts(character, path, found), "which of them ",
                count_of(lost, "vertex is", "vertices are"),
                " is not to be told: their order is not the character's, nor are the faces or the texture coordinates, "
                "or all of it was moved (keep the vertex order or the UVs, or another pose was exported)");
  }
  for (std::size_t v = 0; v < match.size(); ++v)
    result.row(match[v]) = given.vertices.row(static_cast<Eigen::Index>(v));
  return result;
}

}  // namespace

SkinSurface frame_surface(const PoseDatabase& database) {
  SkinSurface surface{read_texture_coordinates(database.dataset.folder / database.dataset.character), {}, {}};
  std::vector<RegionWeights> regions;
  for (SkinPart& part : skin_parts(database)) {
    surface.materials.push_back({part.region.name});
    regions.push_back(std::move(part.region));
  }
  surface.material_of = heaviest_regions(database.character, regions);
  return surface;
}

double unmoved_distance(const Positions& skin) { return kUnmoved * box_diagonal(skin); }

std::string export_mark(std::uint64_t hash) { return kMark + hexadecimal(hash); }

void write_frame_obj(const Character& character, const SkinSurface& surface, const std::vector<float>& positions,
                     const std::filesystem::path& path, const std::string& mark) {
  std::string text = "# " + character.name + "\n";
  if (!mark.empty()) text += "o " + marked_name(character, mark) + "\n";
  for (std::size_t v = 0; v < positions.size(); v += 3) {
    text += formatted("v %.9g %.9g %.9g\n", double{positions[v]}, double{positions[v + 1]}, double{positions[v + 2]});
  }
  for (std::size_t k = 0; k + 1 < surface.texture.size(); k += 2) {
    text += formatted("vt %.9g %.9g\n", surface.texture[k], 1 - surface.texture[k + 1]);
  }
  text += face_lines(character, surface);
  write_file_atomically(path, std::as_bytes(std::span(text)));
}

void write_frame_gltf(const Character& character, const SkinSurface& surface, const Positions& skin, const Pose& pose,
                      const std::filesystem::path& path, const std::string& mark) {
  Character posed = character;
  if (!mark.empty()) posed.name = marked_name(character, mark);
  posed.vertices = skin;
  const std::vector<Affine> joints = posed_joints(character.skeleton, pose.joints);
  for (std::size_t j = 0; j < joints.size(); ++j) {
    Joint& joint = posed.skeleton.joints[j];
    joint.bind = joint.default_local = pose.joints[j];
    joint.inverse_bind = inverse(joints[j]);
  }
  write_character(posed, surface, path);
}

FrameMesh read_frame_mesh(const Character& character, const std::vector<double>& texture,
                          std::span<const WrittenSkin> written, const std::filesystem::path& path) {
  TexturedSurface given;
  std::string mark;
  std::vector<float> in_order;  // O x 3, of a mesh that kept its numbers
  if (lower_case_extension(path) == ".obj") {
    ObjMesh mesh = parse_obj(path);
    mark = mesh.mark;
    given = surface_of(mesh);
    const bool kept = mesh.positions.size() == 3 * std::size_t{character.output_count()};
    if (kept && has_its_faces(character, mesh)) in_order = std::move(mesh.positions);
  } else {
    const Character read = read_character(path, 1);
    mark = mark_in(read.name);
    given = {read.vertices, read.triangles, textured(read, read_texture_coordinates(path))};
  }
  check_size(written.front().skin, given.vertices, path);
  const Eigen::Matrix3d turn = turn_back(written, given.vertices, path);
  given.vertices *= turn.transpose();
  FrameMesh result = made_of(written, given.vertices, mark);
  result.was_turned = !turn.isIdentity();
  if (!in_order.empty()) {
    Eigen::Map<Eigen::Matrix<float, Eigen::Dynamic, 3, Eigen::RowMajor>> points(
        in_order.data(), static_cast<Eigen::Index>(in_order.size() / 3), 3);
    points *= turn.transpose().cast<float>();
    result.positions = std::move(in_order);
    return result;
  }
  const TexturedSurface own{written[result.of].skin, character.triangles, textured(character, texture)};
  result.positions = output_from_welded(character, in_own_order(character, own, given, path));
  return result;
}

}  // namespace bodyopt::trainer
