#include "trainer/train/pack/trade_off.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "base/progress.h"
#include "runtime/core/error.h"
#include "runtime/core/strict_json.h"
#include "runtime/host/rig.h"
#include "trainer/train/data/samples.h"
#include "trainer/train/pack/selection_error.h"

namespace bodyopt {
namespace {

// Of a byte, in mean squared displacements of a vertex: where no budget is given, and so little that all is worth it.
constexpr double kUsualPrice = 3e-6, kLowestPrice = 1e-7;
// Nanoseconds of one core per byte, measured by `bodyopt bench` on the built-in arm with AVX-512.
constexpr double kDdmNanoseconds = 0.1, kResidualNanoseconds = 0.045;
constexpr int kCurvePoints = 14;

bool is_empty(const Selection& selection) {
  return std::ranges::all_of(selection, [](const SelectedRegion& region) { return region.blocks.empty(); });
}

// Of a frame on one core, which reads the tables of Direct Delta Mush and of the residual once.
double estimated_microseconds(const Basis& basis) {
  const auto bytes = table_bytes(basis);
  return 1e-3 * (kDdmNanoseconds * static_cast<double>(bytes.at("ddm")) +
                 kResidualNanoseconds * static_cast<double>(bytes.at("residual")));
}

}  // namespace

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
  // Empty though nothing learned is worth its bytes at any price, or though the least that is fits: the price lay
  // between two steps of the search.
  Selection least = allocation_.at(turn_of(is_empty).below);
  if (bytes_of(least) > budget) refuse_budget(budget, bytes_of(least), "the least that holds anything learned");
  return least;
}

// By halving, to a hundredth of a factor of two.
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

}  // namespace bodyopt
