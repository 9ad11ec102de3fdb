// despike: a vertex that is far from where it is in the frames just before and after, while these agree with each
// other, is put on their median.
#include <algorithm>
#include <array>

#include "base/content_hash.h"
#include "trainer/curate/modifier_type.h"

namespace bodyopt {
namespace {

using Eigen::Index;

constexpr double kFar = 5;  // times as far as the frames around it are spread, too: fast motion is no spike
constexpr std::array<int, 4> kAround = {-2, -1, 1, 2};
constexpr std::size_t kFewest = 3;  // of these

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

// Puts the vertices of a frame that are further than the limit from where those around it have them on their median.
void put_back(const std::vector<Positions>& around, double limit, Positions& own) {
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
    if (apart > kFar * spread) own.row(v) = median;
  }
}

class Despike : public ShapeModifier {
 public:
  Despike(const ModifierInput& input, double limit)
      : database_(input.database), below_(input.below), key_below_(input.key_below), limit_(limit) {}

  std::optional<std::uint64_t> cause(std::size_t frame) const override {
    const std::vector<std::size_t> around = frames_around(database_, frame);
    if (around.size() < kFewest) return std::nullopt;
    ContentHash hash;
    hash.add(limit_);
    for (const std::size_t other : around) hash.add(key_below_(other));
    return hash.value();
  }

  void apply(const FrameInHand& frame, Positions& offsets) const override {
    const std::vector<std::size_t> around = frames_around(database_, frame.number);
    if (around.size() < kFewest) return;
    std::vector<Positions> shapes;
    for (const std::size_t other : around) shapes.push_back(below_(other));
    put_back(shapes, limit_, offsets);
  }

 private:
  const PoseDatabase& database_;
  std::function<Positions(std::size_t frame)> below_;
  std::function<std::uint64_t(std::size_t frame)> key_below_;
  double limit_;  // metres
};

}  // namespace

std::unique_ptr<ShapeModifier> prepare_despike(const ModifierInput& input) {
  return std::make_unique<Despike>(input, 1e-3 * parameter(input, "limit_mm", 5, 0.01, 1e4));
}

}  // namespace bodyopt
