// What of a level of detail never changes, on the device once for all of the cast who show it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "runtime/basis/levels.h"
#include "runtime/coverage/expected_error.h"
#include "runtime/coverage/region_shares.h"
#include "runtime/host/character_model.h"
#include "runtime/vulkan/backend/device_model.h"
#include "runtime/vulkan/buffer.h"

namespace bodyopt {

struct LevelOnDevice {
  // `dynamics`: of the same basis, where there are any. Throws Error(device).
  LevelOnDevice(const std::shared_ptr<const vulkan::Device>& device, Level level, std::optional<Dynamics> dynamics);

  const Basis& basis() const { return model->basis; }

  std::shared_ptr<const CharacterModel> model;
  std::shared_ptr<const vulkan::DeviceModel> tables;
  CarriedSkin carried;  // empty in an ordinary basis
  double distance = 0;  // of the full skin's vertices from the level's at rest, RMS, metres
  vulkan::Buffer triangles, fibre_segments, fibre_points;
  std::uint32_t fibre_segment_count = 0;
  std::optional<ErrorExpectation> expectation;  // where there is coverage
  RegionShares shares;                          // of the regions, where there is coverage
};

// The levels of bases that are shown. Those of the same files, unchanged, are made once.
class LevelPool {
 public:
  using Levels = std::vector<std::shared_ptr<const LevelOnDevice>>;

  // What `make` gives of the files, or gave before, while somebody shows it.
  Levels get(const std::vector<std::filesystem::path>& files, const std::function<Levels()>& make);

 private:
  std::map<std::string, std::vector<std::weak_ptr<const LevelOnDevice>>> made_;  // by names, sizes and times
};

}  // namespace bodyopt
