#include "trainer/curate/stored_offsets.h"

#include <algorithm>

#include "assets/pc2.h"
#include "runtime/core/error.h"
#include "trainer/curate/prune.h"

namespace bodyopt {
namespace {

constexpr std::uint64_t kLargestCache = std::uint64_t{4} << 30;  // bytes, of all together

class InMemory : public ShapeModifier {
 public:
  InMemory(Displacements changes, std::vector<int> rows) : changes_(std::move(changes)), rows_(std::move(rows)) {}
  void apply(const FrameInHand& frame, Positions& offsets) const override {
    const int row = rows_[frame.number];
    if (row >= 0) {
      const Eigen::RowVectorXd change = changes_.row(row).cast<double>();
      offsets += Eigen::Map<const Positions>(change.data(), offsets.rows(), 3);
    }
  }

 private:
  Displacements changes_;
  std::vector<int> rows_;
};

class OnDisk : public ShapeModifier {
 public:
  OnDisk(Pc2Reader reader, std::vector<int> rows) : reader_(std::move(reader)), rows_(std::move(rows)) {}
  void apply(const FrameInHand& frame, Positions& offsets) const override {
    const int row = rows_[frame.number];
    if (row < 0) return;
    const std::vector<float> change = reader_.sample(static_cast<std::uint32_t>(row));
    offsets +=
        Eigen::Map<const Eigen::Matrix<float, Eigen::Dynamic, 3, Eigen::RowMajor>>(change.data(), offsets.rows(), 3)
            .cast<double>();
  }

 private:
  Pc2Reader reader_;
  std::vector<int> rows_;
};

}  // namespace

std::unique_ptr<ShapeModifier> stored_offsets(Displacements changes, std::vector<int> rows) {
  return std::make_unique<InMemory>(std::move(changes), std::move(rows));
}

std::unique_ptr<ShapeModifier> cached_offsets(const std::filesystem::path& cache, std::size_t vertices,
                                              const std::vector<int>& rows) {
  if (cache.empty() || !std::filesystem::exists(cache)) return nullptr;
  try {
    Pc2Reader reader(cache);
    const auto count =
        static_cast<std::size_t>(std::count_if(rows.begin(), rows.end(), [](int row) { return row >= 0; }));
    if (reader.point_count() != vertices || reader.sample_count() != count) return nullptr;
    return std::make_unique<OnDisk>(std::move(reader), rows);
  } catch (const Error&) {  // damaged: worked out anew
    return nullptr;
  }
}

void cache_offsets(const Displacements& changes, const std::filesystem::path& cache) {
  if (cache.empty() || changes.rows() == 0) return;
  std::filesystem::create_directories(cache.parent_path());
  Pc2Writer writer(cache, static_cast<std::uint32_t>(changes.cols() / 3), static_cast<std::uint32_t>(changes.rows()));
  for (Eigen::Index n = 0; n < changes.rows(); ++n) {
    writer.append({changes.row(n).data(), static_cast<std::size_t>(changes.cols())});
  }
  writer.close();
  bound_cache(cache.parent_path(), kLargestCache, cache);
}

}  // namespace bodyopt
