#include "trainer/train/pack/trade_off.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <nlohmann/json.hpp>
#include <numeric>

#include "base/parallel.h"
#include "base/progress.h"
#include "base/spread_evenly.h"
#include "runtime/core/error.h"
#include "runtime/core/json.h"
#include "runtime/host/rig.h"
#include "trainer/train/data/samples.h"

namespace bodyopt::trainer {
namespace {

using Eigen::Index;

// Prices of a byte, in mean squared displacements of a vertex: without a budget, and so low that all is worth it.
constexpr double kUsualPrice = 3e-6, kLowestPrice = 1e-7;
// Nanoseconds of one core per byte, measured by `bodyopt bench` on the built-in arm with AVX-512.
constexpr double kDdmNanoseconds = 0.1, kResidualNanoseconds = 0.045;
constexpr int kCurvePoints = 14;

bool is_empty(const Selection& selection) {
  return std::ranges::all_of(selection, [](const SelectedRegion& region) { return region.blocks.empty(); });
}

// The time of a frame on one core, which reads the tables of Direct Delta Mush and of the residual once.
double estimated_microseconds(const Basis& basis) {
  const auto bytes = table_bytes(basis);
  return 1e-3 * (kDdmNanoseconds * static_cast<double>(bytes.at("ddm")) +
                 kResidualNanoseconds * static_cast<double>(bytes.at("residual")));
}

// A region in some frames: what is off where a component is kept, and where it is not.
struct SampledRegion {
  Eigen::MatrixXf kept, dropped;  // frames x K, metres
  Eigen::MatrixXf basis;
};

// 3 x kBlockSize columns: the displacements that are left of a block's vertices, a row per frame.
class BlockError {
 public:
  BlockError(std::uint32_t block, Index frames) : block_(block), left_(Eigen::MatrixXf::Zero(frames, 3 * kBlockSize)) {}

  void add(const RegionModel& model, const SampledRegion& sampled, const SelectedRegion& selected) {
    const std::vector<std::uint32_t>& vertices = model.region.vertices;
    const auto begin = std::lower_bound(vertices.begin(), vertices.end(), block_ * kBlockSize);
    const auto end = std::lower_bound(begin, vertices.end(), (block_ + 1) * kBlockSize);
    if (begin == end) return;
    Eigen::MatrixXf off = sampled.dropped;
    for (std::size_t k = 0; k < selected.blocks.size(); ++k) {
      const std::vector<std::uint32_t>& blocks = selected.blocks[k];
      const auto column = static_cast<Index>(k);
      if (std::binary_search(blocks.begin(), blocks.end(), block_)) off.col(column) = sampled.kept.col(column);
    }
    const Eigen::MatrixXf moved = off * sampled.basis.middleCols(3 * (begin - vertices.begin()), 3 * (end - begin));
    for (auto v = begin; v != end; ++v)
      left_.middleCols<3>(3 * Index{*v % kBlockSize}) += moved.middleCols<3>(3 * (v - begin));
  }

  double energy() const { return left_.cast<double>().squaredNorm(); }

 private:
  std::uint32_t block_;
  Eigen::MatrixXf left_;
};

}  // namespace

double expected_error(const ResidualModel& model, const Selection& selection) {
  constexpr std::size_t kMostFrames = 400;
  const std::vector<Index> heldout = heldout_frames(model);
  std::vector<Index> frames;
  for (const std::size_t n : spread_evenly(heldout.size(), kMostFrames)) frames.push_back(heldout[n]);
  std::vector<SampledRegion> sampled;
  double beyond = 0;  // square metres, what no component has
  for (std::size_t r = 0; r < model.regions.size(); ++r) {
    const RegionModel& region = model.regions[r];
    const Components& components = region.components;
    sampled.push_back({region.fits[selection[r].fit].errors(frames, Eigen::all).cast<float>(),
                       -components.coefficients(frames, Eigen::all).cast<float>(), components.basis.cast<float>()});
    beyond += components.truncated.mean();
  }
  std::vector<double> energies((model.vertices + kBlockSize - 1) / kBlockSize);
  parallel_for(energies.size(), [&](std::size_t b) {
    BlockError error(static_cast<std::uint32_t>(b), static_cast<Index>(frames.size()));
    for (std::size_t r = 0; r < sampled.size(); ++r) error.add(model.regions[r], sampled[r], selection[r]);
    energies[b] = error.energy();
  });
  const double energy = std::accumulate(energies.begin(), energies.end(), 0.0) / static_cast<double>(frames.size());
  return std::sqrt((energy + beyond) / model.vertices);
}

std::vector<double> frame_energies(const RegionModel& region, const SelectedRegion& selected, const Regression& fit) {
  const Components& components = region.components;
  std::vector<double> energies(components.truncated.begin(), components.truncated.end());
  for (std::size_t k = 0; k < selected.blocks.size(); ++k) {
    const auto column = static_cast<Index>(k);
    double kept = 0, dropped = 0;  // squared lengths of the component's vectors, weighted by the region
    for (std::size_t v = 0; v < region.region.vertices.size(); ++v) {
      const std::vector<std::uint32_t>& blocks = selected.blocks[k];
      const bool is_kept = std::binary_search(blocks.begin(), blocks.end(), region.region.vertices[v] / kBlockSize);
      const auto vector = components.basis.row(column).segment<3>(3 * static_cast<Index>(v));
      (is_kept ? kept : dropped) += vector.squaredNorm() / region.region.weights[v];
    }
    for (std::size_t n = 0; n < energies.size(); ++n) {
      const double error = fit.errors(static_cast<Index>(n), column);
      const double motion = components.coefficients(static_cast<Index>(n), column);
      energies[n] += kept * error * error + dropped * motion * motion;
    }
  }
  return energies;
}

ByteAllocation::ByteAllocation(const ResidualModel& model) {
  const std::vector<Index> frames = heldout_frames(model);
  for (const RegionModel& region : model.regions) {
    std::vector<Candidate>& candidates = regions_.emplace_back();
    for (const Regression& fit : region.fits) candidates.push_back(candidate(region, fit, frames));
    vertex_motion_ += region.components.energy.mean() / model.vertices;
  }
}

ByteAllocation::Candidate ByteAllocation::candidate(const RegionModel& region, const Regression& fit,
                                                    const std::vector<Index>& frames) {
  const Eigen::MatrixXd& basis = region.components.basis;
  const Eigen::RowVectorXd motion =
      region.components.coefficients(frames, Eigen::all).colwise().squaredNorm() / static_cast<double>(frames.size());
  const Eigen::RowVectorXd saved = motion - fit.errors.colwise().squaredNorm() / static_cast<double>(frames.size());
  const auto features = static_cast<double>(region.features.size());
  const auto coordinates = static_cast<double>(region.projection.rows());
  const auto centres = static_cast<double>(fit.centres.rows());
  constexpr double kWord = 4;
  Candidate result;
  result.bytes = sizeof(Region) + kWord * (features + coordinates * (1 + std::ceil(features / 2)) +
                                           centres * (1 + std::ceil(coordinates / 2)));
  result.component_bytes = kWord * (2 + coordinates + centres);
  for (Index k = 0; k < basis.rows(); ++k) {
    std::vector<Entry>& entries = result.components.emplace_back();
    for (std::size_t v = 0; v < region.region.vertices.size(); ++v) {
      const std::uint32_t block = region.region.vertices[v] / kBlockSize;
      if (entries.empty() || entries.back().block != block) entries.push_back({block, 0, 0});
      entries.back().saved += saved[k] * basis.row(k).segment<3>(3 * static_cast<Index>(v)).squaredNorm();
    }
    const std::vector<BlockRounding> rounding = rounding_of(region, k);
    for (std::size_t e = 0; e < entries.size(); ++e) entries[e].fine_saved = motion[k] * rounding[e].left;
  }
  return result;
}

ByteAllocation::Bid ByteAllocation::bid(const Candidate& candidate, double per_byte) {
  const double entry_cost = per_byte * sizeof(BlendEntry);
  Bid bid{{}, -per_byte * candidate.bytes};
  bid.region.fine.resize(candidate.components.size());
  for (const std::vector<Entry>& entries : candidate.components) {
    std::vector<std::uint32_t>& blocks = bid.region.blocks.emplace_back();
    std::vector<std::uint32_t>& fine = bid.region.fine[bid.region.blocks.size() - 1];
    double gain = -per_byte * candidate.component_bytes;
    for (const Entry& entry : entries) {
      if (!(entry.saved > entry_cost)) continue;
      blocks.push_back(entry.block);
      gain += entry.saved - entry_cost;
      if (!(entry.fine_saved > entry_cost)) continue;
      fine.push_back(entry.block);
      gain += entry.fine_saved - entry_cost;
    }
    if (!(gain > 0)) {
      blocks.clear();
      fine.clear();
    }
    bid.gain += std::max(0.0, gain);
  }
  return bid;
}

Selection ByteAllocation::at(double price) const { return best(price, std::numeric_limits<std::size_t>::max()); }

Selection ByteAllocation::with_all_centres(double price) const { return best(price, 1); }

Selection ByteAllocation::best(double price, std::size_t most_fits) const {
  Selection selection;
  for (const std::vector<Candidate>& fits : regions_) {
    SelectedRegion& region = selection.emplace_back();
    double gain = 0;
    for (std::size_t f = 0; f < std::min(fits.size(), most_fits); ++f) {
      Bid offer = bid(fits[f], price * vertex_motion_);
      if (!(offer.gain > gain)) continue;
      gain = offer.gain;
      region = {f, std::move(offer.region.blocks), std::move(offer.region.fine)};
    }
  }
  return selection;
}

TradeOff::TradeOff(const Basis& bare, const ResidualModel& model)
    : bare_(bare), model_(model), allocation_(model), highest_(kLowestPrice) {
  while (!is_empty(allocation_.at(highest_))) highest_ *= 2;
}

Selection TradeOff::choose(const TrainOptions& options) const {
  if (options.budget > 0) return within(options.budget);
  if (options.tolerance_mm <= 0) {
    return model_.folds.size() <= kFewFrames ? allocation_.at(kLowestPrice) : allocation_.with_all_centres(kUsualPrice);
  }
  const auto misses = [&](const Selection& selection) {
    return 1e3 * expected_error(model_, selection) > options.tolerance_mm;
  };
  return allocation_.at(turn_of(misses).below);
}

Selection TradeOff::within(double budget) const {
  const auto bytes_of = [&](const Selection& selection) {
    Basis basis = bare_;
    pack_into(basis, model_, selection);
    return bytes_per_vertex(basis);
  };
  const Bracket price = turn_of([&](const Selection& selection) { return bytes_of(selection) <= budget; });
  Selection best = allocation_.at(price.above);
  if (!is_empty(best)) return best;
  // The best is empty where nothing learned is worth its bytes at any price. It may be empty though the least that is
  // fits: the price lay between two steps of the search.
  Selection least = allocation_.at(turn_of(is_empty).below);
  if (bytes_of(least) > budget) refuse_budget(budget, bytes_of(least), "the least that holds anything learned");
  return least;
}

// Halves the bracket, to a hundredth of a factor of two.
TradeOff::Bracket TradeOff::turn_of(const std::function<bool(const Selection&)>& holds) const {
  Bracket price{kLowestPrice, highest_};
  if (holds(allocation_.at(price.below))) return {price.below, price.below};
  while (price.above > 1.007 * price.below) {
    const double middle = std::sqrt(price.below * price.above);
    (holds(allocation_.at(middle)) ? price.above : price.below) = middle;
  }
  return price;
}

std::vector<TradeOffPoint> TradeOff::curve() const {
  std::vector<TradeOffPoint> points;
  Progress progress("train: trade-off", kCurvePoints);
  for (int k = 0; k < kCurvePoints; ++k) {
    const double share = static_cast<double>(k) / (kCurvePoints - 1);
    const Selection selection = allocation_.at(highest_ * std::pow(kLowestPrice / highest_, share));
    Basis basis = bare_;
    pack_into(basis, model_, selection);
    points.push_back({bytes_per_vertex(basis), 1e3 * expected_error(model_, selection), estimated_microseconds(basis),
                      basis.residual.coefficient_count()});
    progress.advance();
  }
  return points;
}

std::string curve_text(const std::vector<TradeOffPoint>& curve) {
  Json list = Json::array();
  for (const TradeOffPoint& point : curve) list.push_back(Json(to_json(point)));
  return list.dump();
}

std::vector<TradeOffPoint> read_curve(const Basis& basis) {
  const auto text = basis.metadata.find("curve");
  if (text == basis.metadata.end()) return {};
  const std::string where = "the basis' metadata 'curve'";
  const auto list = parse_strict_json(text->second, where);
  std::vector<TradeOffPoint> curve;
  try {
    for (const auto& point : list) {
      curve.push_back({point.at("bytes_per_vertex").get<double>(), point.at("expected_rms_mm").get<double>(),
                       point.at("microseconds").get<double>(), point.at("coefficients").get<std::uint32_t>()});
    }
  } catch (const Json::exception& error) {
    throw Error(ErrorKind::file, where + " is damaged: " + error.what());
  }
  return curve;
}

PackedResidual pack_into(Basis& basis, const ResidualModel& model, const Selection& selection) {
  PackedResidual packed = pack_residual(model, selection);
  basis.residual = packed.table;
  drop_unused_fibres(basis.strain, basis.residual, joint_feature_count(basis.skeleton));
  return packed;
}

double bytes_per_vertex(const Basis& basis) {
  return static_cast<double>(total_bytes(basis)) / basis.mesh.vertex_count();
}

void refuse_budget(double budget, double least, const std::string& what) {
  std::array<char, 256> text;
  std::snprintf(
      text.data(), text.size(),
      "--budget asks for %.6g bytes per vertex at most, and %s takes %.1f: a smaller --smoothing-radius makes "
      "Direct Delta Mush smaller",
      budget, what.c_str(), least);
  throw Error(ErrorKind::usage, text.data());
}

}  // namespace bodyopt::trainer
