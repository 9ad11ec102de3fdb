#include "proxy_viewer/open_character.h"

#include <algorithm>
#include <filesystem>
#include <utility>

#include "runtime/basis/character_unit.h"
#include "runtime/basis/error.h"
#include "trainer/attach/bind_mesh.h"
#include "trainer/builtin/arm.h"
#include "trainer/dataset/gltf_file.h"
#include "trainer/train/strain.h"
#include "trainer/train/train.h"

namespace bodyopt {
namespace {

constexpr int kArmFrames = 144;  // six seconds

OpenedCharacter with_ddm(Character character, double unit) {
  OpenedCharacter opened;
  opened.notes = std::move(character.notes);
  Level& level = opened.levels.emplace_back();
  level.basis = build_ddm_basis(character, {});
  keep_unit(level.basis, unit);
  opened.character = std::move(character);
  return opened;
}

// Its eyes, teeth, clothes: as `train` attaches them.
void attach_own_meshes(const std::string& path, const ClipOptions& options, OpenedCharacter& opened) {
  const Basis& basis = opened.levels.front().basis;
  try {
    const double unit = options.unit > 0 ? options.unit : 1;
    const RestSkin skin(basis);
    for (const LooseMesh& mesh :
         read_loose_meshes(path, basis.skeleton, basis.mesh.output_count(), unit, opened.notes)) {
      opened.attached.meshes.push_back(bind_mesh(mesh, skin, {.unit = unit}));
    }
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
  OpenedCharacter opened = with_ddm(read_character(path, options.unit), options.unit);
  attach_own_meshes(path, options, opened);
  play_own_clip(path, options, opened);
  opened.notes.push_back(path + " is shown by Direct Delta Mush, made just now: it is not trained");
  return opened;
}

OpenedCharacter open_arm(const ClipOptions& options) {
  BuiltinArm arm = build_arm();
  OpenedCharacter opened = with_ddm(std::move(arm.character), 0);
  Basis& basis = opened.levels.front().basis;
  basis.strain = make_strain_table(basis, arm.muscles);
  opened.clip = arm_heldout(basis.skeleton, kArmFrames);
  opened.clip->first_frame = options.first_frame;
  opened.notes.push_back(
      "the built-in arm is shown by Direct Delta Mush: `bodyopt demo --out demo` trains it, and `bodyopt view "
      "demo/basis.safetensors demo/heldout.glb` shows that");
  return opened;
}

}  // namespace

bool is_basis(const std::string& path) { return path.ends_with(".safetensors"); }

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
  if (model.skins.empty()) return false;
  return model.animations.empty() ||
         std::ranges::none_of(model.nodes, [&](const auto& node) { return skeleton.find(node.name) >= 0; });
}

}  // namespace bodyopt
