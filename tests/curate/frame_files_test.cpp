// Meshes of frames, there and back through other programs.
#include "trainer/curate/frame_files.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <numeric>
#include <random>
#include <sstream>

#include "assets/gltf/gltf_skin.h"
#include "runtime/core/error.h"
#include "tests/curate/curated_limb.h"
#include "tests/support/error_kind.h"
#include "tests/support/read_bytes.h"

namespace bodyopt::trainer {
namespace {

using testing::kind_of;

std::vector<float> read_mesh(const Character& character, const std::vector<double>& texture, const Positions& exported,
                             const std::filesystem::path& path) {
  const WrittenSkin written{exported};
  return read_frame_mesh(character, texture, {&written, 1}, path).positions;
}

// A mesh whose vertices stand in another order, sculpted by a bulge.
struct Shuffled {
  Positions sculpted;  // V x 3, in the character's order
  std::string obj;
};

// `texture`: O x 2, with as many output vertices as welded ones; empty: none.
Shuffled shuffled(const Character& character, const Positions& frame, const std::vector<double>& texture = {}) {
  Shuffled result{frame + bulge(character), ""};
  std::vector<std::size_t> order(character.vertices.rows()), place(order.size());
  std::iota(order.begin(), order.end(), 0);
  std::shuffle(order.begin(), order.end(), std::mt19937(5));
  std::ostringstream obj;
  obj.precision(9);
  for (std::size_t k = 0; k < order.size(); ++k) {
    place[order[k]] = k + 1;
    const auto at = result.sculpted.row(static_cast<Eigen::Index>(order[k]));
    obj << "v " << at[0] << ' ' << at[1] << ' ' << at[2] << '\n';
    if (!texture.empty()) obj << "vt " << texture[2 * order[k]] << ' ' << 1 - texture[2 * order[k] + 1] << '\n';
  }
  const auto corner = [&](std::uint32_t vertex) {
    const std::string number = std::to_string(place[vertex]);
    return texture.empty() ? number : number + "/" + number;
  };
  for (Eigen::Index t = character.triangles.rows(); t-- > 0;) {
    obj << "f " << corner(character.triangles(t, 1)) << ' ' << corner(character.triangles(t, 2)) << ' '
        << corner(character.triangles(t, 0)) << '\n';
  }
  result.obj = obj.str();
  return result;
}

TEST(FrameFiles, AMeshComesBackInAnyOrderAndAnotherIsRefused) {
  const CuratedLimb limb;
  const auto path = limb.folder() / "frame.obj";
  const Positions frame = limb.truth(0, 5);
  const std::vector<float> shape = output_from_welded(limb.character(), frame);
  write_frame_obj(limb.character(), {}, shape, path);
  EXPECT_EQ(read_mesh(limb.character(), {}, frame, path), shape);
  const Shuffled sculpt = shuffled(limb.character(), frame);
  std::ofstream(path) << sculpt.obj;
  const std::vector<float> back = read_mesh(limb.character(), {}, frame, path);
  EXPECT_LT(rms_mm(welded_from_output(limb.character(), back.data()), sculpt.sculpted), 1e-4);
  std::ofstream(path, std::ios::app) << "v 0 0 0\n";
  EXPECT_EQ(kind_of([&] { read_mesh(limb.character(), {}, frame, path); }), ErrorKind::mismatch);
  const std::size_t faces = sculpt.obj.find("f "), half = sculpt.obj.find("f ", (faces + sculpt.obj.size()) / 2);
  std::ofstream(path) << sculpt.obj.substr(0, half);  // what was moved has too few neighbours
  EXPECT_EQ(kind_of([&] { read_mesh(limb.character(), {}, frame, path); }), ErrorKind::mismatch);
  std::ofstream(path) << "v 0 0 nan\n";
  EXPECT_EQ(kind_of([&] { read_mesh(limb.character(), {}, frame, path); }), ErrorKind::file);
}

// Whatever its vertices' order, a mesh tells by what was not moved which skin it was made of.
TEST(FrameFiles, AMeshIsOfTheSkinThatMostOfItLiesOn) {
  const CuratedLimb limb;
  const auto path = limb.folder() / "frame.obj";
  const Positions frame = limb.truth(0, 5);
  std::vector<WrittenSkin> exported(3, {frame});
  for (Eigen::Index v = 0; v < frame.rows(); ++v) {
    exported[0].skin.row(v) *= 1.001;
    if (v % 2 == 0) exported[2].skin.row(v) *= 1.001;
  }
  std::ofstream(path) << shuffled(limb.character(), frame).obj;
  EXPECT_EQ(read_frame_mesh(limb.character(), {}, exported, path).of, 1u);
  write_frame_obj(limb.character(), {}, output_from_welded(limb.character(), exported[2].skin), path);
  EXPECT_EQ(read_frame_mesh(limb.character(), {}, exported, path).of, 2u);
  write_frame_obj(limb.character(), {}, output_from_welded(limb.character(), 1.01 * frame), path);
  EXPECT_EQ(read_frame_mesh(limb.character(), {}, exported, path).of, 0u) << "of none: the first";
}

// A sculpt that covers what differs between two exports lies on both alike: the mesh's name tells, whatever another
// program adds to it; without it, how many more there are is told.
TEST(FrameFiles, AMeshIsOfTheSkinWhoseMarkItHas) {
  const CuratedLimb limb;
  const Character& character = limb.character();
  const Positions frame = limb.truth(0, 5);
  const auto with_upper_half_moved = [&](double distance) {
    Positions moved = frame;
    for (Eigen::Index v = 0; v < moved.rows(); ++v) {
      if (character.vertices(v, 1) > 0) moved(v, 0) += distance;
    }
    return moved;
  };
  std::vector<WrittenSkin> written;
  for (const int k : {0, 1, 2}) {
    written.push_back({with_upper_half_moved(0.003 * k), export_mark(static_cast<std::uint64_t>(k))});
  }
  const Positions sculpted = with_upper_half_moved(0.02);
  for (const char* name : {"frame.obj", "frame.glb"}) {
    const auto read_marked = [&, path = limb.folder() / name](const std::string& mark) {
      if (path.extension() == ".obj") {
        write_frame_obj(character, {}, output_from_welded(character, sculpted), path, mark);
      } else {
        write_frame_gltf(character, {}, sculpted, limb.pose(0, 5), path, mark);
      }
      return read_frame_mesh(character, {}, written, path);
    };
    const FrameMesh marked = read_marked("Body_" + written[1].mark + ".001"), unmarked = read_marked("");
    EXPECT_EQ(marked.of, 1u) << name;
    EXPECT_EQ(marked.alike, 0u) << name;
    EXPECT_EQ(unmarked.of, 0u) << name;
    EXPECT_EQ(unmarked.alike, 2u) << name;
    EXPECT_EQ(read_marked(export_mark(7)).alike, 2u) << name << ": of an export that is not known any more";
  }
}

// Written with Z up: turned back, in its own order and in another. Where all of it was moved nothing tells how it lay.
TEST(FrameFiles, AMeshWithAnotherAxisUpIsTurnedBackOrRefused) {
  const CuratedLimb limb;
  const Character& character = limb.character();
  const auto path = limb.folder() / "frame.obj";
  const Positions frame = limb.truth(0, 5), sculpt = frame + bulge(character);
  const auto z_up = [](const Positions& shape) {
    Positions turned(shape.rows(), 3);
    turned << shape.col(0), -shape.col(2), shape.col(1);
    return turned;
  };
  const WrittenSkin written{frame};
  write_frame_obj(character, {}, output_from_welded(character, z_up(sculpt)), path);
  const FrameMesh in_order = read_frame_mesh(character, {}, {&written, 1}, path);
  EXPECT_TRUE(in_order.was_turned);
  EXPECT_LT(rms_mm(welded_from_output(character, in_order.positions.data()), sculpt), 1e-4);
  write_frame_gltf(character, {}, z_up(sculpt), limb.pose(0, 5), limb.folder() / "frame.glb");
  const FrameMesh any = read_frame_mesh(character, {}, {&written, 1}, limb.folder() / "frame.glb");
  EXPECT_TRUE(any.was_turned);
  EXPECT_LT(rms_mm(welded_from_output(character, any.positions.data()), sculpt), 1e-4);
  write_frame_obj(character, {}, output_from_welded(character, sculpt), path);
  EXPECT_FALSE(read_frame_mesh(character, {}, {&written, 1}, path).was_turned);
  write_frame_obj(character, {}, output_from_welded(character, z_up(1.01 * frame)), path);
  try {
    read_frame_mesh(character, {}, {&written, 1}, path);
    ADD_FAILURE() << "nothing tells how it lay, and it was read";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::mismatch) << error.what();
    EXPECT_NE(std::string(error.what()).find("another axis up"), std::string::npos) << error.what();
  }
}

// In centimetres, or in hundreds of metres: refused, whatever the order of its vertices.
TEST(FrameFiles, AMeshOfAnotherUnitIsRefused) {
  const CuratedLimb limb;
  const Positions frame = limb.truth(0, 5);
  for (const double unit : {100.0, 0.01}) {
    for (const char* name : {"frame.obj", "frame.glb"}) {
      const auto path = limb.folder() / name;
      if (path.extension() == ".obj") {
        write_frame_obj(limb.character(), {}, output_from_welded(limb.character(), unit * frame), path);
      } else {
        write_frame_gltf(limb.character(), {}, unit * frame, limb.pose(0, 5), path);
      }
      try {
        read_mesh(limb.character(), {}, frame, path);
        ADD_FAILURE() << name << " times " << unit << " was read";
      } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::mismatch) << error.what();
        EXPECT_NE(std::string(error.what()).find("another unit"), std::string::npos) << error.what();
      }
    }
  }
}

// Moved as a whole, in another order and with other faces first: the texture alone tells which vertex is which.
TEST(FrameFiles, ATextureTellsVerticesThatWereAllMoved) {
  const CuratedLimb limb;
  const Character& character = limb.character();
  const auto path = limb.folder() / "frame.obj";
  const Positions frame = limb.truth(0, 5);
  SkinSurface surface = frame_surface(limb.stack().database());
  EXPECT_TRUE(surface.texture.empty());  // of a character without
  std::mt19937 random(7);
  for (std::uint32_t o = 0; o < 2 * character.output_count(); ++o) {
    surface.texture.push_back(std::uniform_real_distribution<>(0, 1)(random));
  }
  const Positions moved = frame.rowwise() + Eigen::RowVector3d(0.3, 0, 0);
  const Shuffled sculpt = shuffled(character, moved, surface.texture);
  std::ofstream(path) << sculpt.obj;
  const std::vector<float> back = read_mesh(character, surface.texture, frame, path);
  EXPECT_LT(rms_mm(welded_from_output(character, back.data()), sculpt.sculpted), 1e-4);
  EXPECT_EQ(kind_of([&] { read_mesh(character, {}, frame, path); }), ErrorKind::mismatch);
  std::ofstream(path) << "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0.5\nf 1/1 2/1 3/1\n";
  EXPECT_EQ(kind_of([&] { read_mesh(character, {}, frame, path); }), ErrorKind::file);
  std::ofstream(path) << "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0.5 0.5\nf 1/1 2/2 3/1\n";
  EXPECT_EQ(kind_of([&] { read_mesh(character, {}, frame, path); }), ErrorKind::file);
}

TEST(FrameFiles, AnObjHasATextureAndAMaterialForEveryRegion) {
  const CuratedLimb limb;
  const Character& character = limb.character();
  const auto path = limb.folder() / "frame.obj";
  const std::vector<float> shape = output_from_welded(character, limb.truth(0, 5));
  SkinSurface surface = frame_surface(limb.stack().database());
  surface.texture.assign(2 * std::size_t{character.output_count()}, 0.25);
  write_frame_obj(character, surface, shape, path);
  EXPECT_EQ(read_mesh(character, surface.texture, limb.truth(0, 5), path), shape);
  std::ifstream file(path);
  std::map<std::string, int> faces;
  std::string line, material;
  int textured = 0;
  while (std::getline(file, line)) {
    if (line.starts_with("usemtl ")) material = line.substr(7);
    if (line.starts_with("f ")) ++faces[material];
    if (line == "vt 0.25 0.75") ++textured;
  }
  EXPECT_EQ(textured, static_cast<int>(character.output_count()));
  int sum = 0;
  for (const SurfaceMaterial& region : surface.materials) sum += faces[region.name];
  EXPECT_EQ(sum, character.output_triangles.rows());
  // A triangle of which one joint holds all is of that joint's material.
  EXPECT_GT(faces.at(character.skeleton.joints[0].name), 0);
  EXPECT_GT(faces.at(character.skeleton.joints[1].name), 0);
}

// The JSON of a .glb.
Json json_of_glb(const std::filesystem::path& path) {
  const std::string bytes = testing::read_bytes(path);
  std::uint32_t size = 0;
  std::memcpy(&size, bytes.data() + 12, sizeof(size));
  return Json::parse(bytes.substr(20, size));
}

TEST(FrameFiles, AGltfRestsInThePoseAndComesBack) {
  const CuratedLimb limb;
  const auto path = limb.folder() / "frame.glb";
  const Positions frame = limb.truth(0, 12);
  SkinSurface surface = frame_surface(limb.stack().database());
  for (std::uint32_t k = 0; k < 2 * limb.character().output_count(); ++k) surface.texture.push_back(k / 8192.0);
  write_frame_gltf(limb.character(), surface, frame, limb.pose(0, 12), path);
  const Character read = read_character(path);
  // A primitive of every region, all of them of the same vertices: nothing is torn along their borders.
  const Json json = json_of_glb(path);
  const Json& primitives = json["meshes"][0]["primitives"];
  ASSERT_EQ(primitives.size(), surface.materials.size());
  std::size_t corners = 0;
  for (std::size_t m = 0; m < primitives.size(); ++m) {
    EXPECT_EQ(json["materials"][primitives[m]["material"].get<std::size_t>()]["name"], surface.materials[m].name);
    EXPECT_EQ(primitives[m]["attributes"], primitives[0]["attributes"]);
    corners += json["accessors"][primitives[m]["indices"].get<std::size_t>()]["count"].get<std::size_t>();
  }
  EXPECT_EQ(corners, 3 * static_cast<std::size_t>(limb.character().output_triangles.rows()));
  EXPECT_EQ(read.vertices.rows(), limb.character().vertices.rows());
  EXPECT_EQ(read.triangles.rows(), limb.character().triangles.rows());
  const std::vector<double> texture = read_texture_coordinates(path);
  ASSERT_EQ(texture.size(), primitives.size() * surface.texture.size());
  for (std::size_t k = 0; k < texture.size(); ++k) EXPECT_EQ(texture[k], surface.texture[k % surface.texture.size()]);
  EXPECT_LT(rms_mm(read.vertices, frame), 1e-3);
  // The skeleton rests in the pose: its own bind pose leaves the skin where it is.
  EXPECT_LT(rms_mm(skin_linear(read, bind_pose(read.skeleton)), frame), 1e-3);
  for (int k = 0; k < 4; ++k) {
    EXPECT_NEAR(read.skeleton.joints[1].bind.rotation[k], limb.pose(0, 12).joints[1].rotation[k], 1e-6);
  }
  const std::vector<float> back = read_mesh(limb.character(), {}, frame, path);
  EXPECT_LT(rms_mm(welded_from_output(limb.character(), back.data()), frame), 1e-3);
}

}  // namespace
}  // namespace bodyopt::trainer
