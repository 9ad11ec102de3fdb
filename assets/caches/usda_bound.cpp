#include "assets/caches/usda_bound.h"

#include <Eigen/Core>
#include <algorithm>
#include <utility>

#include "assets/caches/usda.h"
#include "assets/caches/usda_skeleton.h"
#include "assets/clips/gltf_motion.h"
#include "runtime/core/text.h"

namespace bodyopt {
namespace {

namespace fs = std::filesystem;

std::string shape_name(int frame) { return prim_name("frame_" + std::to_string(frame)); }

std::string names_of_shapes(const CacheLayout& layout) {
  return usda_list(layout.frames, [](int frame) { return '"' + shape_name(frame) + '"'; });
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
  const std::size_t most = most_weights(character);
  std::string joints, weights;
  for (const std::uint32_t vertex : character.output_vertex) {
    for (std::size_t k = 0; k < most; ++k) {
      const auto& own = character.weights[vertex];
      const bool is_there = k < own.size();
      joints += (joints.empty() ? "" : ", ") + std::to_string(is_there ? own[k].joint : 0);
      weights += (weights.empty() ? "" : ", ") + shortest(is_there ? own[k].weight : 0);
    }
  }
  const std::string each =
      "] (\n        elementSize = " + std::to_string(most) + "\n        interpolation = \"vertex\"\n    )\n";
  return "    int[] primvars:skel:jointIndices = [" + joints + each + "    float[] primvars:skel:jointWeights = [" +
         weights + each;
}

}  // namespace

UsdaBoundWriter::UsdaBoundWriter(const fs::path& path, CacheLayout layout)
    : path_(path), layout_(std::move(layout)), bound_(with_half_scales(*layout_.bound)), file_(path) {
  const std::string root = prim_name(layout_.name);
  file_.write(usda_head(root, bound_.clip.first_frame, bound_.clip.last_frame(), shortest(layout_.fps)) +
              "def SkelRoot \"" + root + "\"\n{\n" + usd_skeleton(bound_.clip, bound_.character.skeleton, root, path));
  write_shape_weights();
  file_.write("    }\n" + bound_mesh(root));
}

// Each frame shows its own shape alone.
void UsdaBoundWriter::write_shape_weights() {
  file_.write("        uniform token[] blendShapes = " + names_of_shapes(layout_) +
              "\n        float[] blendShapeWeights = " + usda_list(layout_.frames, [](int) { return "0"; }) +
              "\n        float[] blendShapeWeights.timeSamples = {\n");
  for (const int shown : layout_.frames) {
    file_.write("            " + std::to_string(shown) + ": " +
                usda_list(layout_.frames, [&](int frame) { return frame == shown ? "1" : "0"; }) + ",\n");
  }
  file_.write("        }\n");
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
         usda_list(layout_.frames, [&](int frame) { return "<" + prim + "/" + shape_name(frame) + ">"; }) + "\n";
}

void UsdaBoundWriter::append(std::span<const float> positions, std::span<const float> /*normals*/) {
  require_sample(path_, layout_, written_, positions);
  const int frame = layout_.frames[written_++];
  file_.write("    def BlendShape \"" + shape_name(frame) + "\"\n    {\n        uniform vector3f[] offsets = " +
              usda_points(blend_shape(bound_, frame, positions)) + "\n    }\n");
}

void UsdaBoundWriter::close() {
  require_all_samples(path_, layout_, written_);
  file_.write("    }\n}\n");
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
