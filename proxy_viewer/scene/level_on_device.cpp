#include "proxy_viewer/scene/level_on_device.h"

#include <cmath>

#include "draw/view.h"

namespace bodyopt {
namespace {

namespace fs = std::filesystem;

// Fibre points name strain vertices; drawing needs those of the skin.
std::vector<FibrePoint> points_on_skin(const StrainTable& strain) {
  std::vector<FibrePoint> points = strain.points;
  for (FibrePoint& point : points) {
    point.a = strain.vertices[point.a];
    point.b = strain.vertices[point.b];
    point.c = strain.vertices[point.c];
  }
  return points;
}

std::vector<FibreSegment> segments_of(const StrainTable& strain) {
  std::vector<FibreSegment> segments;
  for (std::uint32_t fibre = 0; fibre < strain.fibre_count(); ++fibre) {
    for (std::uint32_t p = strain.fibre_begin[fibre] + 1; p < strain.fibre_begin[fibre + 1]; ++p) {
      segments.push_back({p - 1, p, fibre});
    }
  }
  return segments;
}

double rms_distance(const CarriedSkin& carried) {
  double sum = 0;
  for (const CarriedPoint& point : carried.points) {
    for (const std::int16_t steps : {point.along_normal, point.along_edge, point.across})
      sum += static_cast<double>(steps) * steps;
  }
  return carried.empty() ? 0 : double{carried.step} * std::sqrt(sum / static_cast<double>(carried.size()));
}

// Another where a file is another.
std::string stamp_of(const std::vector<fs::path>& files) {
  std::string stamp;
  for (const fs::path& file : files) {
    std::error_code absent;
    const fs::file_time_type time = fs::last_write_time(file, absent);
    stamp += fs::weakly_canonical(file, absent).string() + '\n';
    if (fs::exists(file, absent)) {
      stamp += std::to_string(fs::file_size(file, absent)) + ' ' + std::to_string(time.time_since_epoch().count());
    }
    stamp += '\n';
  }
  return stamp;
}

}  // namespace

LevelOnDevice::LevelOnDevice(const std::shared_ptr<const vulkan::Device>& device, Level level,
                             std::optional<Dynamics> dynamics)
    : model(make_character_model(std::move(level.basis), std::move(dynamics))),
      tables(std::make_shared<const vulkan::DeviceModel>(device, model)),
      carried(std::move(level.carried)),
      distance(rms_distance(carried)) {
  triangles = vulkan::upload(*device, basis().mesh.triangles, "the triangles");
  const std::vector<FibreSegment> segments = segments_of(basis().strain);
  fibre_segments = vulkan::upload(*device, segments, "the fibres");
  fibre_points = vulkan::upload(*device, points_on_skin(basis().strain), "the fibre points");
  fibre_segment_count = static_cast<std::uint32_t>(segments.size());
  if (basis().coverage.empty()) return;
  expectation.emplace(basis());
  shares = RegionShares(basis());
}

LevelPool::Levels LevelPool::get(const std::vector<fs::path>& files, const std::function<Levels()>& make) {
  std::erase_if(made_, [](const auto& entry) { return entry.second.front().expired(); });
  const std::string stamp = stamp_of(files);
  Levels levels;
  if (const auto known = made_.find(stamp); known != made_.end()) {
    for (const auto& level : known->second) levels.push_back(level.lock());
    return levels;
  }
  levels = make();
  made_[stamp].assign(levels.begin(), levels.end());
  return levels;
}

}  // namespace bodyopt
