// despike: a vertex that is far from where it is in the frames just before and after, while these agree with each
// other, is put on their median.
#include <algorithm>
#include <array>

#include "base/parallel.h"
#include "base/progress.h"
#include "trainer/curate/modifier_type.h"

namespace bodyopt {
namespace {

using Eigen::Index;

constexpr double kFar = 5;  // times as far as the frames around it are spread, too: fast motion is no spike
constexpr std::array<int, 4> kAround = {-2, -1, 1, 2};

struct Spike {
  std::uint32_t vertex;
  Eigen::RowVector3d change;
};

class Despike : public ShapeModifier {
 public:
  explicit Despike(std::vector<std::vector<Spike>> spikes) : spikes_(std::move(spikes)) {}
  void apply(const FrameInHand& frame, Positions& offsets) const override {
    for (const Spike& spike : spikes_[frame.number]) offsets.row(spike.vertex) += spike.change;
  }

 private:
  std::vector<std::vector<Spike>> spikes_;  // of every frame
};

// The frames of one take around one of it that are there.
std::vector<std::size_t> frames_around(const PoseDatabase& database, std::size_t frame) {
  std::vector<std::size_t> around;
  for (const int step : kAround) {
    const std::size_t other = frame + static_cast<std::size_t>(step);
    if (other < database.frames.size() && database.frames[other].take == database.frames[frame].take) {
      around.push_back(other);
    }
  }
  return around;
}

std::vector<Spike> spikes_of(const Positions& own, const std::vector<Positions>& around, double limit) {
  std::vector<Spike> spikes;
  std::vector<double> values(around.size());
  const auto middle = [&](auto&& value) {
    for (std::size_t k = 0; k < around.size(); ++k) values[k] = value(around[k]);
    std::sort(values.begin(), values.end());
    return 0.5 * (values[(values.size() - 1) / 2] + values[values.size() / 2]);
  };
  for (Index v = 0; v < own.rows(); ++v) {
    Eigen::RowVector3d median;
    for (Index i = 0; i < 3; ++i) median[i] = middle([&](const Positions& there) { return there(v, i); });
    const double apart = (own.row(v) - median).norm();
    if (!(apart > limit)) continue;
    const double spread = middle([&](const Positions& there) { return (there.row(v) - median).norm(); });
    if (apart > kFar * spread) spikes.push_back({static_cast<std::uint32_t>(v), median - own.row(v)});
  }
  return spikes;
}

}  // namespace

std::unique_ptr<ShapeModifier> prepare_despike(const ModifierInput& input) {
  const double limit = 1e-3 * parameter(input, "limit_mm", 5, 0.01, 1e4);
  std::vector<std::vector<Spike>> spikes(input.database.frames.size());
  Progress progress("curate: despike", spikes.size());
  parallel_for(spikes.size(), [&](std::size_t n) {
    const std::vector<std::size_t> around = frames_around(input.database, n);
    if (input.selected[n] && around.size() >= 3) {
      std::vector<Positions> shapes;
      for (const std::size_t other : around) shapes.push_back(input.below(other));
      spikes[n] = spikes_of(input.below(n), shapes, limit);
    }
    progress.advance();
  });
  return std::make_unique<Despike>(std::move(spikes));
}

}  // namespace bodyopt
