// bodyopt.h: a character.
#include <algorithm>
#include <cstddef>
#include <utility>

#include "runtime/basis/containers.h"
#include "runtime/library/guard.h"
#include "runtime/library/handles.h"
#include "runtime/library/strides.h"
#include "runtime/modifiers/skin_modifier_type.h"

namespace bodyopt {
namespace {

// A file of the character, on disk or in memory, and what errors call it.
struct GivenFile {
  std::string origin;
  Safetensors container;

  explicit GivenFile(const char* path) : origin(path), container(read_safetensors(origin)) {}
  GivenFile(const void* data, std::size_t size, const char* name)
      : origin(concat("'", name, "' in memory")),
        container(read_safetensors({static_cast<const std::byte*>(data), size}, origin)) {}
};

Level read_level(const GivenFile& file, std::uint32_t level) {
  std::vector<Level> levels = levels_in(file.container, file.origin);
  if (level >= levels.size()) {
    throw Error(ErrorKind::usage, file.origin, " has no level of detail ", level, ", only 0 to ", levels.size() - 1);
  }
  return std::move(levels[level]);
}

// Reads one of two options, a path and bytes, of which at most one is given. `name`: of the first.
std::optional<GivenFile> given_file(const char* path, const void* data, std::size_t size, const std::string& name) {
  if (path != nullptr && data != nullptr) {
    throw Error(ErrorKind::usage, "both '", name, "' and '", name, "_data' are given, expected one");
  }
  if (path != nullptr) return GivenFile(path);
  if (data != nullptr) return GivenFile(data, size, (name + "_data").c_str());
  return std::nullopt;
}

std::optional<Dynamics> read_dynamics(const bodyopt_load_options& options, const Basis& basis) {
  const auto file = given_file(options.dynamics, options.dynamics_data, options.dynamics_size, "options.dynamics");
  if (!file) return std::nullopt;
  return dynamics_in(file->container, file->origin, basis);
}

Attachments read_attachments(const bodyopt_load_options& options, const Basis& basis) {
  const auto file = given_file(options.attached, options.attached_data, options.attached_size, "options.attached");
  if (!file) return {};
  if (options.level > 0) {
    throw Error(ErrorKind::usage, file->origin, ": attached meshes follow level 0, not level ", options.level);
  }
  return attachments_in(file->container, file->origin, basis);
}

// A file of a newer version may have modifiers that this one cannot drive: the skin without them can be shown.
std::vector<ModifierChannel> known_channels(const SkinModifiers& modifiers) {
  try {
    return describe_channels(modifiers);
  } catch (const Error& error) {
    write_log(BODYOPT_LOG_WARNING, error.what());
    return {};
  }
}

// `read`(): the GivenFile of the basis.
bodyopt_result load(const bodyopt_load_options* given, bodyopt_model** model, const auto& read) {
  return guarded([&] {
    required(model, "model");
    bodyopt_load_options options{};
    if (given != nullptr) options = read_struct(given, BODYOPT_LOAD_OPTIONS_FIRST_SIZE, "options");
    const GivenFile file = read();
    Level level = read_level(file, options.level);
    std::optional<Dynamics> dynamics = read_dynamics(options, level.basis);
    Attachments attached = read_attachments(options, level.basis);
    auto loaded = std::make_unique<bodyopt_model>();
    const std::vector<float> texture = read_texture(options, level.basis);
    loaded->model = make_character_model(std::move(level.basis), std::move(dynamics), texture);
    loaded->following =
        std::make_shared<const FollowingMeshes>(loaded->model->basis, std::move(attached), std::move(level.carried));
    for (std::uint32_t f = 0; f < loaded->model->basis.residual.feature_count(); ++f) {
      loaded->features.push_back(feature_name(loaded->model->basis, f));
    }
    loaded->channels = known_channels(loaded->model->basis.modifiers);
    write_log(BODYOPT_LOG_INFO,
              concat("loaded ", file.origin, ": ", loaded->model->basis.mesh.output_count(), " vertices").c_str());
    *model = loaded.release();
  });
}

// Throws Error(usage) for a number that no attached mesh has.
const AttachedMesh& attached_mesh(const bodyopt_model* model, std::uint32_t mesh) {
  const std::vector<AttachedMesh>& all = required(model, "model").following->attached().meshes;
  if (mesh < all.size()) return all[mesh];
  throw Error(ErrorKind::usage, "the model has no attached mesh ", mesh, ", only ", all.size());
}

// The text of number k, or null.
const char* name_of(const std::vector<std::string>& names, std::uint32_t k) {
  return k < names.size() ? names[k].c_str() : nullptr;
}

// Copies all values to the caller's array of `size` bytes. Throws Error(usage) where it has no room.
template <typename T>
void copy_all(const std::vector<T>& values, T* to, std::size_t size, const char* name) {
  const std::size_t bytes = values.size() * sizeof(T);
  if (bytes == 0) return;
  require(to, name);
  if (size < bytes) throw Error(ErrorKind::usage, "'", name, "' has ", size, " bytes, ", bytes, " are needed");
  std::ranges::copy(values, to);
}

std::vector<double> joint_numbers(const Pose& pose) {
  std::vector<double> numbers;
  numbers.reserve(kJointNumbers * pose.joints.size());
  for (const JointTransform& joint : pose.joints) {
    numbers.insert(numbers.end(), joint.translation.begin(), joint.translation.end());
    numbers.insert(numbers.end(), joint.rotation.begin(), joint.rotation.end());
    numbers.insert(numbers.end(), joint.scale.begin(), joint.scale.end());
  }
  return numbers;
}

}  // namespace
}  // namespace bodyopt

using namespace bodyopt;

bodyopt_result bodyopt_load_model(const char* path, const bodyopt_load_options* options, bodyopt_model** model) {
  return load(options, model, [&] { return GivenFile(&required(path, "path")); });
}

bodyopt_result bodyopt_load_model_from_memory(const void* data, size_t size, const bodyopt_load_options* options,
                                              bodyopt_model** model) {
  return load(options, model, [&] {
    require(data, "data");
    return GivenFile(data, size, "data");
  });
}

void bodyopt_release_model(bodyopt_model* model) { delete model; }

bodyopt_result bodyopt_describe(const bodyopt_model* model, bodyopt_description* description) {
  return guarded([&] {
    const CharacterModel& character = *required(model, "model").model;
    const Basis& basis = character.basis;
    bodyopt_description all = read_struct(description, BODYOPT_DESCRIPTION_FIRST_SIZE, "description");
    all.vertex_count = basis.mesh.output_count();
    all.triangle_count = static_cast<std::uint32_t>(basis.mesh.output_triangles.size() / 3);
    all.joint_count = static_cast<std::uint32_t>(basis.skeleton.size());
    all.control_count = static_cast<std::uint32_t>(basis.residual.controls.size());
    all.strain_count = basis.strain.fibre_count();
    all.has_dynamics = character.dynamics ? 1 : 0;
    all.frames_per_second = character.dynamics ? character.dynamics->jiggle.step.frames_per_second : 0;
    all.knows_error = basis.coverage.empty() ? 0 : 1;
    all.has_tangents = character.tangents.vertices.empty() ? 0 : 1;
    all.channel_count = static_cast<std::uint32_t>(model->channels.size());
    all.attached_count = static_cast<std::uint32_t>(model->following->attached().meshes.size());
    all.full_vertex_count = static_cast<std::uint32_t>(model->following->full_skin().size());
    all.feature_count = static_cast<std::uint32_t>(model->features.size());
    std::memcpy(description, &all, all.struct_size);
  });
}

const char* bodyopt_joint_name(const bodyopt_model* model, uint32_t joint) {
  if (model == nullptr || joint >= model->model->basis.skeleton.size()) return nullptr;
  return model->model->basis.skeleton.joints[joint].name.c_str();
}

const char* bodyopt_control_name(const bodyopt_model* model, uint32_t control) {
  return model != nullptr ? name_of(model->model->basis.residual.controls, control) : nullptr;
}

const char* bodyopt_strain_name(const bodyopt_model* model, uint32_t strain) {
  return model != nullptr ? name_of(model->model->basis.strain.names, strain) : nullptr;
}

const char* bodyopt_feature_name(const bodyopt_model* model, uint32_t feature) {
  return model != nullptr ? name_of(model->features, feature) : nullptr;
}

int32_t bodyopt_joint_parent(const bodyopt_model* model, uint32_t joint) {
  if (model == nullptr || joint >= model->model->basis.skeleton.size()) return -1;
  return model->model->basis.skeleton.joints[joint].parent;
}

bodyopt_result bodyopt_describe_attached(const bodyopt_model* model, uint32_t mesh, bodyopt_attached* description) {
  return guarded([&] {
    const AttachedMesh& of = attached_mesh(model, mesh);
    bodyopt_attached all = read_struct(description, BODYOPT_ATTACHED_FIRST_SIZE, "description");
    all.name = of.name.c_str();
    all.vertex_count = of.vertex_count();
    all.triangle_count = of.triangle_count();
    std::memcpy(description, &all, all.struct_size);
  });
}

bodyopt_result bodyopt_get_attached_triangles(const bodyopt_model* model, uint32_t mesh, uint32_t* triangles,
                                              size_t size) {
  return guarded([&] { copy_all(attached_mesh(model, mesh).triangles, triangles, size, "triangles"); });
}

bodyopt_result bodyopt_describe_channel(const bodyopt_model* model, uint32_t channel, bodyopt_channel* description) {
  return guarded([&] {
    const std::vector<ModifierChannel>& channels = required(model, "model").channels;
    bodyopt_channel all = read_struct(description, BODYOPT_CHANNEL_FIRST_SIZE, "description");
    if (channel >= channels.size()) {
      throw Error(ErrorKind::usage, "the model has no channel ", channel, ", only ", channels.size());
    }
    const ModifierChannel& of = channels[channel];
    all.name = of.name.c_str();
    all.what = of.control->what;
    all.constant = of.constant;
    all.low = of.control->low;
    all.high = of.control->high;
    std::memcpy(description, &all, all.struct_size);
  });
}

bodyopt_result bodyopt_get_triangles(const bodyopt_model* model, uint32_t* triangles, size_t size) {
  return guarded(
      [&] { copy_all(required(model, "model").model->basis.mesh.output_triangles, triangles, size, "triangles"); });
}

bodyopt_result bodyopt_get_bind_pose(const bodyopt_model* model, double* joints, size_t size) {
  return guarded([&] {
    copy_all(joint_numbers(bind_pose(required(model, "model").model->basis.skeleton)), joints, size, "joints");
  });
}
