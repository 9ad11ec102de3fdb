#include "assets/caches/usda_skeleton.h"

#include <cmath>
#include <set>
#include <sstream>
#include <vector>

#include "assets/caches/usda.h"
#include "runtime/core/atomic_file.h"
#include "runtime/core/error.h"
#include "runtime/core/text.h"
#include "runtime/core/transform.h"

namespace bodyopt {
namespace {

std::string tuple_of(std::initializer_list<double> values) {
  std::string text;
  for (const double value : values) text += (text.empty() ? "(" : ", ") + shortest(static_cast<float>(value));
  return text + ")";
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
    text << "            " << clip.first_frame + static_cast<int>(k) << ": " << usda_list(joints, element) << ",\n";
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

}  // namespace

std::string usd_skeleton(const Clip& clip, const Skeleton& skeleton, const std::string& root,
                         const std::filesystem::path& path) {
  require_finite(clip, path);
  const std::vector<std::string> paths = joint_paths(skeleton);
  const std::vector<Joint>& joints = skeleton.joints;
  const std::string tokens =
      "        uniform token[] joints = " +
      usda_list(paths, [](const std::string& path_of_joint) { return '"' + path_of_joint + '"'; }) + "\n";
  std::ostringstream text;
  text << "    def Skeleton \"skeleton\" (\n        prepend apiSchemas = [\"SkelBindingAPI\"]\n    )\n    {\n"
       << tokens << "        uniform matrix4d[] bindTransforms = "
       << usda_list(joints, [](const Joint& joint) { return matrix_of(inverse(joint.inverse_bind)); })
       << "\n        uniform matrix4d[] restTransforms = "
       << usda_list(joints, [](const Joint& joint) { return matrix_of(affine_from(joint.default_local)); })
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
                    whole =
                        usda_head(root, clip.first_frame, clip.last_frame(), shortest(static_cast<float>(clip.fps))) +
                        "def SkelRoot \"" + root + "\"\n{\n" + usd_skeleton(clip, skeleton, root, path) + "    }\n}\n";
  write_file_atomically(path, whole);
}

}  // namespace bodyopt
