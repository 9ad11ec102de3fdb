#include "shots/open_character.h"

#include <algorithm>
#include <filesystem>
#include <set>
#include <utility>

#include "assets/gltf_file.h"
#include "runtime/basis/character_unit.h"
#include "runtime/core/error.h"
#include "shots/session/actor_files.h"
#include "trainer/attach/bind_mesh.h"
#include "trainer/builtin/arm.h"
#include "trainer/train/features/strain.h"
#include "trainer/train/skinning/ddm_basis.h"

namespace bodyopt {
namespace {

OpenedCharacter with_ddm(Character character) {
  OpenedCharacter opened;
  opened.notes = std::move(character.notes);
  Level& level = opened.levels.emplace_back();
  level.basis = build_ddm_basis(character, {});
  keep_unit(level.basis, character.unit);
  opened.character = std::move(character);
  return opened;
}

// Its eyes, teeth, clothes: as `train` attaches them.
void attach_own_meshes(const std::string& path, OpenedCharacter& opened) {
  const Basis& basis = opened.levels.front().basis;
  try {
    const double unit = opened.character->unit > 0 ? opened.character->unit : 1;
    const std::vector<LooseMesh> meshes =
        read_loose_meshes(path, basis.skeleton, basis.mesh.output_count(), unit, opened.notes);
    opened.attached.meshes = bind_own_meshes(meshes, basis, opened.notes);
  } catch (const Error& error) {
    opened.notes.push_back(std::string("the character's other meshes are not shown: ") + error.what());
  }
}

void play_own_clip(const std::string& path, const ClipOptions& options, OpenedCharacter& opened) {
  if (clip_names(path).empty()) return;
  try {
    opened.clip = read_clip(path, opened.levels.front().basis.skeleton, options);
    std::ranges::copy(opened.clip->notes, std::back_inserter(opened.notes));
  } catch (const Error& error) {
    opened.notes.push_back(std::string("its own clip is not played: ") + error.what());
  }
}

OpenedCharacter open_untrained(const std::string& path, const ClipOptions& options) {
  OpenedCharacter opened = with_ddm(read_character(path, options.unit));
  attach_own_meshes(path, opened);
  play_own_clip(path, options, opened);
  opened.notes.push_back(path + " is shown by Direct Delta Mush, made just now: it is not trained");
  return opened;
}

OpenedCharacter open_arm(const ClipOptions& options) {
  BuiltinArm arm = build_arm();
  OpenedCharacter opened = with_ddm(std::move(arm.character));
  Basis& basis = opened.levels.front().basis;
  basis.strain = make_strain_table(basis, arm.muscles);
  opened.clip = arm_heldout(basis.skeleton, kArmHeldoutFrames);
  opened.clip->first_frame = options.first_frame;
  opened.notes.emplace_back(
      "the built-in arm is shown by Direct Delta Mush: `bodyopt demo --out demo` trains it, and `bodyopt view "
      "demo/basis.safetensors demo/heldout.glb` shows that");
  return opened;
}

// At least half of the joints of either, by their names: rigs of others share a few, as "Hips" and "Head".
bool is_of(const tinygltf::Model& model, const Skeleton& skeleton) {
  std::set<std::string> joints;
  for (const tinygltf::Skin& skin : model.skins) {
    for (const int joint : skin.joints) {
      if (joint < 0 || joint >= std::ssize(model.nodes)) continue;  // which who reads the character says
      joints.insert(model.nodes[static_cast<std::size_t>(joint)].name);
    }
  }
  const auto shared = std::ranges::count_if(joints, [&](const std::string& name) { return skeleton.find(name) >= 0; });
  const std::size_t fewer = std::min(joints.size(), skeleton.joints.size());
  return shared > 0 && 2 * static_cast<std::size_t>(shared) >= fewer;
}

}  // namespace

OpenedCharacter open_character(const std::string& path, const ClipOptions& options) {
  if (path.empty()) return open_arm(options);
  if (!is_basis(path)) return open_untrained(path, options);
  OpenedCharacter opened;
  opened.levels = load_levels(path);
  return opened;
}

bool is_another_character(const std::string& path, const Skeleton& skeleton) {
  if (!std::filesystem::exists(path)) return false;  // FILE.glb#name
  const GltfFile file(path);
  const tinygltf::Model& model = file.model();
  const bool has_skin =
      std::ranges::any_of(model.nodes, [](const auto& node) { return node.mesh >= 0 && node.skin >= 0; });
  if (!has_skin) return false;
  return model.animations.empty() || !is_of(model, skeleton);
}

}  // namespace bodyopt
