// The types behind the opaque handles of bodyopt.h.
#pragma once

#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "include/bodyopt/bodyopt.h"
#include "runtime/coverage/expected_error.h"
#include "runtime/deformer/deformer.h"
#include "runtime/deformer/following_meshes.h"
#include "runtime/host/character_model.h"
#include "runtime/host/jiggle.h"
#include "runtime/modifiers/drive_modifiers.h"
#include "runtime/vulkan/backend/attached_meshes.h"
#include "runtime/vulkan/backend/device_model.h"
#include "runtime/vulkan/device.h"

namespace bodyopt {

// What the outputs of one call that follow the skin leave to the next: their memory.
struct FollowingMemory {
  std::vector<bodyopt_floats> attached;  // the caller's, of each mesh; empty: none is wanted
  std::vector<float> skin, normals;      // without gaps
  FollowingMeshes::Memory meshes;
};

// Likewise of expected errors.
struct ErrorMemory {
  ExpectedError expected;
  std::vector<float> vertices, outputs;
};

}  // namespace bodyopt

// The tables on a device, as long as an instance uses them there.
struct bodyopt_device {
  std::shared_ptr<const bodyopt::vulkan::Device> device;
};

struct bodyopt_model {
  std::shared_ptr<const bodyopt::CharacterModel> model;
  // The model on the device of its latest instance there: instances of one device share it.
  mutable std::mutex mutex;
  mutable std::weak_ptr<const bodyopt::vulkan::DeviceModel> on_device;
  std::shared_ptr<const bodyopt::FollowingMeshes> following;  // they go with its skin
  std::vector<std::string> features;                          // names of what the learned part reads
  std::vector<bodyopt::ModifierChannel> channels;  // empty, too, where a modifier is of a type that is not known
};

struct bodyopt_instance {
  std::shared_ptr<const bodyopt::CharacterModel> model;
  std::unique_ptr<bodyopt::Deformer> deformer;
  std::shared_ptr<const bodyopt::FollowingMeshes> following;
  std::optional<bodyopt::vulkan::AttachedMeshes> attached;  // of one that is to record them
  std::optional<bodyopt::ErrorExpectation> expectation;     // made when it is first asked for
  std::optional<bodyopt::RegionShares> shares;              // likewise
  std::vector<std::string> channels;                        // names of the model's
  std::uint32_t recorded_frames = 1;                        // most of a bodyopt_record
  bodyopt::ModifierState modifiers;                         // after the last frame that was shown with them
  std::vector<bodyopt::Pose> poses;                         // of the last part of a call, kept for their memory
  bodyopt::Evaluation evaluation;                           // likewise
  bodyopt::FollowingMemory following_memory;
  bodyopt::ErrorMemory error_memory;
  bodyopt::vulkan::Recording recording;  // the last, kept for its memory
};

struct bodyopt_state {
  bodyopt::JiggleState state;
  std::shared_ptr<const bodyopt::CharacterModel> model;  // of the instance that it is of: it has dynamics
};
