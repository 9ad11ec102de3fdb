// bodyopt attach: meshes that follow the skin of a basis.
#include <algorithm>
#include <nlohmann/json.hpp>

#include "base/wording.h"
#include "cli/arguments/common.h"
#include "cli/results/attachments.h"
#include "runtime/core/error.h"

namespace bodyopt::cli {
namespace {

struct AttachArguments {
  std::string mesh, basis, out, mode = "auto", joint;
  std::vector<std::string> only;
  double unit = 0;
  JsonOption json;
};

int named_joint(const std::string& name, const Skeleton& skeleton) {
  const int joint = skeleton.find(name);
  if (joint >= 0) return joint;
  throw Error(ErrorKind::usage, "--joint: the character has no joint '", name, "'; the nearest names are ",
              list_names(nearest_names(names_of(skeleton.joints), name)));
}

trainer::AttachOptions options_of(const AttachArguments& arguments, const Skeleton& skeleton) {
  trainer::AttachOptions options;
  if (arguments.mode == "skin") options.mode = trainer::AttachMode::skin;
  if (arguments.mode == "piece") options.mode = trainer::AttachMode::piece;
  if (arguments.mode == "joint") options.mode = trainer::AttachMode::joint;
  if (arguments.joint.empty()) return options;
  if (arguments.mode != "auto" && arguments.mode != "joint") {
    throw Error(ErrorKind::usage, "--joint fixes a mesh to a joint: it does not go with --mode ", arguments.mode);
  }
  options.mode = trainer::AttachMode::joint;
  options.joint = named_joint(arguments.joint, skeleton);
  return options;
}

// Keeps the meshes that were asked for.
std::vector<trainer::LooseMesh> chosen(std::vector<trainer::LooseMesh> meshes, const AttachArguments& arguments) {
  const std::vector<std::string> names = names_of(meshes);
  for (const std::string& name : arguments.only) {
    if (std::ranges::find(names, name) != names.end()) continue;
    throw Error(ErrorKind::file, arguments.mesh, ": has no mesh '", name, "' to attach; it has ", list_names(names));
  }
  if (!arguments.only.empty()) {
    std::erase_if(meshes, [&](const trainer::LooseMesh& mesh) {
      return std::ranges::find(arguments.only, mesh.name) == arguments.only.end();
    });
  }
  if (meshes.empty()) {
    throw Error(ErrorKind::file, arguments.mesh,
                ": has no mesh to attach, expected one besides the character's skin "
                "(meshes on that same skin are a part of it)");
  }
  return meshes;
}

void run(AttachArguments arguments) {
  const Basis basis = load_basis(arguments.basis);
  trainer::AttachOptions options = options_of(arguments, basis.skeleton);
  if (arguments.out.empty()) arguments.out = attachments_beside(arguments.basis).string();
  refuse_overwriting(arguments.out, arguments.basis);
  require_writable(arguments.out);
  arguments.json.require_writable();
  const double kept = kept_unit(basis);
  options.unit = arguments.unit > 0 ? arguments.unit : kept > 0 ? kept : 1;

  attachments_in(arguments.out, basis, arguments.basis);  // refused before any work
  std::vector<std::string> notes;
  std::vector<trainer::LooseMesh> meshes = trainer::read_loose_meshes(GltfFile(arguments.mesh), basis.skeleton,
                                                                      basis.mesh.output_count(), options.unit, notes);
  say(notes);
  const std::vector<AttachedMesh> bound = bind_meshes(chosen(std::move(meshes), arguments), basis, options);
  const Attachments attachments = attach(bound, arguments.out, basis, arguments.basis);
  arguments.json.emit(
      {{"attachments", arguments.out}, {"meshes", to_json(attachments.meshes)}},
      describe(bound) + format("wrote {}: {}\n", arguments.out, count_of(attachments.meshes.size(), "mesh", "meshes")));
}

}  // namespace

void add_attach(CLI::App& app) {
  const auto [verb, arguments] = add_verb<AttachArguments, AttachArguments>(
      app, "attach", "Attach meshes to a trained skin: eyes, teeth, nails, props, clothes", run);
  add_required(verb, "mesh", arguments.mesh, "MESH",
               "glTF file with the meshes, where they are at rest; of the character's own file those that are not "
               "its skin");
  add_required(verb, "basis", arguments.basis, "BASIS", "Basis whose skin they follow");
  add_option(verb, "--mode", arguments.mode,
             "skin: every vertex follows the skin (clothes); piece: each connected piece is fixed to the skin "
             "under it (nails, buttons); joint: to a joint (eyes, teeth, props); auto: what suits each piece")
      ->capture_default_str()
      ->check(CLI::IsMember({"auto", "skin", "piece", "joint"}));
  add_option(verb, "--joint", arguments.joint, "NAME",
             "Fix them to this joint (default: the one that moves the skin there)");
  add_option(verb, "--only", arguments.only, "NAME", "Of the file's meshes those of these names alone");
  add_option(verb, "--unit", arguments.unit, "Metres per unit of the file (default: that of the character)")
      ->check(above_zero);
  add_option(verb, "--out", arguments.out, "FILE.safetensors",
             "Attachments to write, or to add to: a mesh takes the place of one of its name (default: "
             "BASIS.attached.safetensors beside the basis)");
  arguments.json.add(verb);
}

}  // namespace bodyopt::cli
