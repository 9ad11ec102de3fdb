#include <Eigen/Core>
#include <algorithm>
#include <charconv>
#include <cmath>
#include <set>
#include <sstream>
#include <utility>
#include <vector>

#include "assets/gltf_write.h"
#include "assets/usda.h"
#include "runtime/core/atomic_file.h"
#include "runtime/core/error.h"
#include "runtime/core/transform.h"

namespace bodyopt {
namespace {

// Returns the shortest text that reads back to the same number of single precision.
std::string text_of(double value) {
  char digits[32];
  return {digits, std::to_chars(digits, digits + sizeof(digits), static_cast<float>(value)).ptr};
}

std::string tuple_of(std::initializer_list<double> values) {
  std::string text;
  for (const double value : values) text += (text.empty() ? "(" : ", ") + text_of(value);
  return text + ")";
}

// A comma-separated list in brackets.
template <class Items, class Print>
std::string listed(const Items& items, const Print& print) {
  std::string text = "[";
  for (const auto& item : items) text += (text.size() > 1 ? std::string(", ") : "") + print(item);
  return text + "]";
}

// USD multiplies rows from the left.
std::string matrix_of(const Affine& a) {
  std::string text = "( ";
  for (std::size_t c = 0; c < 4; ++c) {
    text += (c == 0 ? "" : ", ") + tuple_of({a.m[0][c], a.m[1][c], a.m[2][c], c == 3 ? 1.0 : 0.0});
  }
  return text + " )";
}

// A path of prim names, each joint's below its parent's; those of two joints are never the same.
std::vector<std::string> joint_paths(const Skeleton& skeleton) {
  std::vector<std::string> paths;
  std::set<std::string> taken;
  for (const Joint& joint : skeleton.joints) {
    const std::string above = joint.parent < 0 ? "" : paths[static_cast<std::size_t>(joint.parent)] + "/",
                      name = above + prim_name(joint.name);
    std::string path = name;
    for (int k = 2; !taken.insert(path).second; ++k) path = name + "_" + std::to_string(k);
    paths.push_back(path);
  }
  return paths;
}

// Writes one property of all joints, a line for each frame.
template <class Element>
void write_samples(const Clip& clip, const char* declared, const Element& element, std::ostringstream& text) {
  text << "        " << declared << ".timeSamples = {\n";
  for (std::size_t k = 0; k < clip.poses.size(); ++k) {
    const std::vector<JointTransform>& joints = clip.poses[k].joints;
    text << "            " << clip.first_frame + static_cast<int>(k) << ": " << listed(joints, element) << ",\n";
  }
  text << "        }\n";
}

void require_finite(const Clip& clip, const std::filesystem::path& path) {
  for (std::size_t k = 0; k < clip.poses.size(); ++k) {
    for (const JointTransform& joint : clip.poses[k].joints) {
      if (is_finite(joint)) continue;
      throw Error(ErrorKind::file, path, ": not written; frame ", clip.first_frame + static_cast<int>(k),
                  " has a joint whose numbers are not finite");
    }
  }
}

namespace fs = std::filesystem;

std::string shape_name(int frame) { return prim_name("frame_" + std::to_string(frame)); }

std::string names_of_shapes(const CacheLayout& layout) {
  return listed(layout.frames, [](int frame) { return '"' + shape_name(frame) + '"'; });
}

BoundSkin with_half_scales(const BoundSkin& skin) {
  BoundSkin rounded{skin.character, with_continuous_rotations(skin.clip)};
  for (Pose& pose : rounded.clip.poses) {
    for (JointTransform& joint : pose.joints) {
      for (double& scale : joint.scale) scale = static_cast<double>(Eigen::half(static_cast<float>(scale)));
    }
  }
  return rounded;
}

// Every output vertex has as many weights as the one with the most; the others end in zeros.
std::string joint_weights(const Character& character) {
  std::size_t most = 1;
  for (const auto& weights : character.weights) most = std::max(most, weights.size());
  std::string joints, weights;
  for (const std::uint32_t vertex : character.output_vertex) {
    for (std::size_t k = 0; k < most; ++k) {
      const auto& own = character.weights[vertex];
      const bool is_there = k < own.size();
      joints += (joints.empty() ? "" : ", ") + std::to_string(is_there ? own[k].joint : 0);
      weights += (weights.empty() ? "" : ", ") + usda_number(is_there ? own[k].weight : 0);
    }
  }
  const std::string each =
      "] (\n        elementSize = " + std::to_string(most) + "\n        interpolation = \"vertex\"\n    )\n";
  return "    int[] primvars:skel:jointIndices = [" + joints + each + "    float[] primvars:skel:jointWeights = [" +
         weights + each;
}

}  // namespace

std::string usd_skeleton(const Clip& clip, const Skeleton& skeleton, const std::string& root,
                         const std::filesystem::path& path) {
  require_finite(clip, path);
  const std::vector<std::string> paths = joint_paths(skeleton);
  const std::vector<Joint>& joints = skeleton.joints;
  const std::string tokens =
      "        uniform token[] joints = " + listed(paths, [](const std::string& joint) { return '"' + joint + '"'; }) +
      "\n";
  std::ostringstream text;
  text << "    def Skeleton \"skeleton\" (\n        prepend apiSchemas = [\"SkelBindingAPI\"]\n    )\n    {\n"
       << tokens << "        uniform matrix4d[] bindTransforms = "
       << listed(joints, [](const Joint& joint) { return matrix_of(inverse(joint.inverse_bind)); })
       << "\n        uniform matrix4d[] restTransforms = "
       << listed(joints, [](const Joint& joint) { return matrix_of(affine_from(joint.default_local)); })
       << "\n        rel skel:animationSource = </" << root << "/motion>\n    }\n\n"
       << "    def SkelAnimation \"motion\"\n    {\n"
       << tokens;
  const auto vector_of = [](const Vec3& v) { return tuple_of({v[0], v[1], v[2]}); };
  write_samples(
      clip, "float3[] translations", [&](const auto& joint) { return vector_of(joint.translation); }, text);
  write_samples(
      clip, "quatf[] rotations",  // the real part first
      [](const auto& joint) {
        const Quat q = normalized(joint.rotation);
        return tuple_of({q[3], q[0], q[1], q[2]});
      },
      text);
  write_samples(
      clip, "half3[] scales", [&](const auto& joint) { return vector_of(joint.scale); }, text);
  return text.str();
}

void write_usd_skeleton(const Clip& clip, const Skeleton& skeleton, const std::filesystem::path& path) {
  const std::string root = prim_name(clip.name),
                    whole = usda_head(root, clip.first_frame, clip.last_frame(), text_of(clip.fps)) +
                            "def SkelRoot \"" + root + "\"\n{\n" + usd_skeleton(clip, skeleton, root, path) +
                            "    }\n}\n";
  write_file_atomically(path, std::as_bytes(std::span(whole)));
}

UsdaBoundWriter::UsdaBoundWriter(const fs::path& path, CacheLayout layout)
    : path_(path), layout_(std::move(layout)), bound_(with_half_scales(*layout_.bound)), file_(path) {
  const std::string root = prim_name(layout_.name);
  write_text(file_, usda_head(root, bound_.clip.first_frame, bound_.clip.last_frame(), usda_number(layout_.fps)) +
                        "def SkelRoot \"" + root + "\"\n{\n" +
                        usd_skeleton(bound_.clip, bound_.character.skeleton, root, path));
  write_shape_weights();
  write_text(file_, "    }\n" + bound_mesh(root));
}

// Each frame shows its own shape alone.
void UsdaBoundWriter::write_shape_weights() {
  write_text(file_, "        uniform token[] blendShapes = " + names_of_shapes(layout_) +
                        "\n        float[] blendShapeWeights = " + listed(layout_.frames, [](int) { return "0"; }) +
                        "\n        float[] blendShapeWeights.timeSamples = {\n");
  for (const int shown : layout_.frames) {
    write_text(file_, "            " + std::to_string(shown) + ": " +
                          listed(layout_.frames, [&](int frame) { return frame == shown ? "1" : "0"; }) + ",\n");
  }
  write_text(file_, "        }\n");
}

std::string UsdaBoundWriter::bound_mesh(const std::string& root) const {
  const Character& character = bound_.character;
  const std::string prim = "/" + root + "/skin";
  return "\n    def Mesh \"skin\" (\n        prepend apiSchemas = [\"SkelBindingAPI\"]\n    )\n    {\n" +
         usda_mesh(layout_, prim) +
         "    point3f[] points = " + usda_points(output_from_welded(character, character.vertices)) + "\n" +
         joint_weights(character) + "    rel skel:skeleton = </" + root +
         "/skeleton>\n    uniform token[] skel:blendShapes = " + names_of_shapes(layout_) +
         "\n    rel skel:blendShapeTargets = " +
         listed(layout_.frames, [&](int frame) { return "<" + prim + "/" + shape_name(frame) + ">"; }) + "\n";
}

void UsdaBoundWriter::append(std::span<const float> positions, std::span<const float> /*normals*/) {
  require_sample(path_, layout_, written_, positions);
  const int frame = layout_.frames[written_++];
  write_text(file_, "    def BlendShape \"" + shape_name(frame) + "\"\n    {\n        uniform vector3f[] offsets = " +
                        usda_points(blend_shape(bound_, frame, positions)) + "\n    }\n");
}

void UsdaBoundWriter::close() {
  require_all_samples(path_, layout_, written_);
  write_text(file_, "    }\n}\n");
  write_usd_images(layout_.surface, layout_.name, path_.parent_path());
  file_.commit();
}

std::vector<fs::path> UsdaBoundWriter::put_aside(const fs::path& stem) {
  file_.put_aside(stem);
  return {stem};
}

void UsdaBoundWriter::take_up(const fs::path& stem, std::size_t frames) {
  file_.restart();
  file_.write_file(stem);
  written_ = frames;
}

}  // namespace bodyopt
