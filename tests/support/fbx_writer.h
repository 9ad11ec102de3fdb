// FBX files made by hand, independently of the reader, as text and as binary.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <string>
#include <variant>
#include <vector>

namespace bodyopt::testing {

using Vector = Eigen::Vector3d;

struct WrittenModel {
  std::string name, type = "LimbNode";
  int parent = -1, order = 0, inherit = 1;
  Vector translation{0, 0, 0}, degrees{0, 0, 0}, scale{1, 1, 1};
  Vector before{0, 0, 0}, after{0, 0, 0};  // turns, degrees
  Vector rotation_offset{0, 0, 0}, rotation_pivot{0, 0, 0}, scale_offset{0, 0, 0}, scale_pivot{0, 0, 0};
  Vector mesh_translation{0, 0, 0}, mesh_degrees{0, 0, 0}, mesh_scale{1, 1, 1};
};

struct WrittenCluster {
  int bone = 0;
  std::vector<std::int64_t> points;
  std::vector<double> weights;
  Eigen::Affine3d mesh_then, bone_then;  // in the world, as they were bound
};

struct WrittenMesh {
  int model = 0;
  std::vector<Vector> points;
  std::vector<std::int64_t> polygons;  // the last corner of each as its complement
  std::vector<WrittenCluster> clusters;
  std::vector<double> texture;                        // two numbers each
  std::vector<std::int64_t> texture_of, material_of;  // of each corner; of each polygon
};

struct WrittenMaterial {
  int model = 0;
  std::string name;
  Vector colour{1, 1, 1};
  std::string image{}, file{};  // bytes in the file; or a name
  int shares = -1;              // the texture of another material, by its number
};

struct WrittenCurve {
  int model = 0;
  std::string property = "Lcl Rotation";
  int axis = 0;
  std::vector<double> seconds, values;
  std::int64_t flags = 4;              // straight
  double slope_out = 0, slope_in = 0;  // of all keys, a second
  std::string beyond = "C";            // the last key
  int layer = 0;
};

struct WrittenFbx {
  double unit = 1;                                // centimetres
  int axes[3] = {0, 1, 2}, signs[3] = {1, 1, 1};  // to the right, up, to the front
  std::vector<WrittenModel> models;
  std::vector<WrittenMesh> meshes;
  std::vector<WrittenMaterial> materials;
  std::vector<WrittenCurve> curves;
  std::vector<std::string> layers = {"BaseLayer"};
  double begin = 0, end = 0;  // seconds, of the take

  std::string text() const;
  // `version` from 7500 on has wide offsets.
  std::string binary(std::uint32_t version, bool packed) const;

  // By FBX's formula, factor after factor: in units and axes of the file, all models with a channel as given.
  Eigen::Affine3d world(int model, double seconds) const;
  // From those to metres, X right, Y up.
  Eigen::Affine3d to_ours() const;
};

// Of straight and stepped curves.
double value_at(const WrittenCurve& curve, double seconds);

}  // namespace bodyopt::testing
