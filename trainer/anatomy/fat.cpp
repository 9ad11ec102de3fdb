// Subcutaneous fat: how it is spread over a body, and how much there is.
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "geometry/mend_surface.h"
#include "geometry/mesh.h"
#include "trainer/anatomy/bone.h"
#include "trainer/anatomy/human_bones.h"

namespace bodyopt::trainer {
namespace {

using Eigen::Index;
using Eigen::Vector3d;

// Millimetres without skin; the pattern of ultrasound measurements of young men.
struct FatTable {
  double head = 2, neck = 4, chest = 5.5, back = 7, belly = 12, flank = 11, loin = 11, buttock = 16;
  double upper_arm_front = 3, upper_arm_back = 6.5, forearm = 3, hand = 1.5;
  double thigh_front = 7, thigh_back = 8.5, thigh_inside = 9, thigh_outside = 8, calf = 5, shin = 3.5, foot = 2.5;
};
constexpr FatTable kFat;

// A vertex as if it were on the side that is looked at.
struct SkinSpot {
  Vector3d point, normal;
  double forward;  // 1: faces forward, 0: back
};

double square(double x) { return x * x; }
double blend(double from, double to, double share) { return std::lerp(from, to, std::clamp(share, 0.0, 1.0)); }

double trunk_fat(const SkinSpot& spot, double hip_height, double neck_height) {
  const double height = std::clamp((spot.point.y() - hip_height) / (neck_height - hip_height), 0.0, 1.0);
  const double below_ribs = std::clamp((0.62 - height) / 0.2, 0.0, 1.0);
  const double front = blend(kFat.chest, kFat.belly, below_ribs), back = blend(kFat.back, kFat.loin, below_ribs);
  const double flank = blend(kFat.back, kFat.flank, below_ribs);
  const double trunk = blend(blend(back, front, spot.forward), flank, square(spot.normal.x()));
  const double seat = blend(kFat.buttock, 0.8 * kFat.belly, spot.forward);
  return blend(trunk, seat, (0.30 - height) / 0.15);
}

double thigh_fat(const SkinSpot& spot, const Vector3d& hip, const Vector3d& knee) {
  const double inside = square(std::max(-spot.normal.x(), 0.0)), outside = square(std::max(spot.normal.x(), 0.0));
  const double around = inside * kFat.thigh_inside + outside * kFat.thigh_outside +
                        (1 - inside - outside) * blend(kFat.thigh_back, kFat.thigh_front, spot.forward);
  const double down = (spot.point - hip).dot(knee - hip) / (knee - hip).squaredNorm();
  return around * (1.15 - 0.55 * std::clamp(down, 0.2, 1.0));  // thinner towards the knee
}

double upper_arm_fat(const SkinSpot& spot, const HumanFrame& frame) {
  const Vector3d along = (frame.elbow->at - frame.shoulder->at).normalized();
  const Vector3d flexor = across(frame.wrist->at - frame.elbow->at, along, Vector3d::UnitZ());
  return blend(kFat.upper_arm_back, kFat.upper_arm_front, 0.5 + 0.5 * spot.normal.dot(flexor));
}

// Metres of cubic cells, those at the border by their share.
double fat_volume(const BodySurvey& survey, const Eigen::VectorXd& thickness) {
  const BodyGrid& grid = survey.grid();
  double cells = 0;
  for (int s = 0; s < grid.size(); ++s)
    cells += std::clamp((grid.on_skin(thickness, s) - grid.depth[s]) / grid.cell + 0.5, 0.0, 1.0);
  return cells * grid.volume();
}

// A pattern times what corrections say of regions and joints.
Eigen::VectorXd corrected_pattern(const BodySurvey& survey, const Eigen::VectorXd& pattern,
                                  const AnatomyCorrections& corrections) {
  const HalfBody& body = survey.body();
  const auto factor_in = [](const std::map<std::string, double>& factors, const std::string& name) {
    const auto found = factors.find(name);
    return found == factors.end() ? 1.0 : found->second;
  };
  std::vector<double> factors;
  for (std::size_t j = 0; j < body.joints.size(); ++j) {
    factors.push_back(factor_in(corrections.region_fat, name_of(survey.regions()[j])) *
                      factor_in(corrections.joint_fat, body.joints[j].name));
  }
  Eigen::VectorXd result = pattern;
  for (std::size_t v = 0; v < body.weights.size(); ++v) {
    double factor = 0;
    for (const JointWeight& weight : body.weights[v]) factor += weight.weight * factors[weight.joint];
    result[static_cast<Index>(v)] *= factor;
  }
  return result;
}

struct FatFit {
  Eigen::VectorXd thickness;  // V, metres: skin and fat
  double body_fat = 0;        // of the body's mass: what was asked for, or the nearest that the body has room for
};

// Halving finds it, for of thicker patterns there is more fat.
FatFit fit_fat(const BodySurvey& survey, const Eigen::VectorXd& pattern, double skin, double body_fat) {
  constexpr double kUnderSkin = 0.8, kFatDensity = 0.92, kBodyDensity = 1.01;  // kilograms a litre
  constexpr double kMostOfHalf = 0.45, kLeast = 0.05, kMost = 12;
  constexpr int kHalvings = 30;
  const Eigen::ArrayXd room = kMostOfHalf * survey.half_thickness().array().max(2.5 * skin);
  const auto thickness = [&](double scale) -> Eigen::VectorXd { return (skin + scale * pattern.array()).min(room); };
  const double body = survey.grid().size() * survey.grid().volume();
  const double share_of_mass = kFatDensity / (kUnderSkin * kBodyDensity * body);
  double low = kLeast, high = kMost;
  for (int k = 0; k < kHalvings; ++k) {
    const double scale = (low + high) / 2;
    (fat_volume(survey, thickness(scale)) * share_of_mass < body_fat ? low : high) = scale;
  }
  FatFit fit{thickness((low + high) / 2), 0};
  fit.body_fat = fat_volume(survey, fit.thickness) * share_of_mass;
  return fit;
}

}  // namespace

Eigen::VectorXd human_fat_pattern(const BodySurvey& survey, const HumanFrame& frame) {
  const HalfBody& body = survey.body();
  const double inwards = enclosed_volume(body.vertices, body.triangles) < 0 ? -1 : 1;
  const Positions normals = inwards * vertex_normals(body.vertices, body.triangles).rowwise().normalized();
  const Eigen::MatrixXd weights = survey.region_weights();
  const double low = body.vertices.col(1).minCoeff(), high = body.vertices.col(1).maxCoeff();
  const double hip = frame.hip ? frame.hip->at.y() : std::lerp(low, high, 0.5);
  const double neck = frame.neck ? frame.neck->at.y() : std::lerp(low, high, 0.85);
  Eigen::VectorXd pattern(body.vertices.rows());
  for (Index v = 0; v < pattern.size(); ++v) {
    SkinSpot spot{body.vertices.row(v), normals.row(v), 0.5 + 0.5 * normals(v, 2)};
    if (body.has_plane && spot.point.x() < 0) {
      spot.point.x() *= -1;
      spot.normal.x() *= -1;
    }
    const auto weight = [&](BodyRegion region) { return weights(v, static_cast<Index>(region)); };
    const double trunk = weight(BodyRegion::trunk) + weight(BodyRegion::hip);
    double fat = trunk * trunk_fat(spot, hip, std::max(neck, hip + 1e-9));
    fat += weight(BodyRegion::neck) * kFat.neck + weight(BodyRegion::head) * kFat.head;
    fat += weight(BodyRegion::forearm) * kFat.forearm + weight(BodyRegion::hand) * kFat.hand;
    fat += weight(BodyRegion::calf) * blend(kFat.calf, kFat.shin, spot.forward) + weight(BodyRegion::foot) * kFat.foot;
    if (frame.has_leg()) fat += weight(BodyRegion::thigh) * thigh_fat(spot, frame.hip->at, frame.knee->at);
    if (frame.has_arm()) fat += weight(BodyRegion::upper_arm) * upper_arm_fat(spot, frame);
    pattern[v] = frame.mm * fat;
  }
  return pattern;
}

void lay_fat(BodySurvey& survey, const Eigen::VectorXd& pattern, double skin, const InnerTissueOptions& options,
             InnerTissue& tissue) {
  constexpr double kNear = 0.01;
  const FatFit fit = fit_fat(survey, corrected_pattern(survey, pattern, options.corrections), skin, options.body_fat);
  survey.set_fat(fit.thickness);
  tissue.fat.resize(survey.grid().size());
  for (Index s = 0; s < tissue.fat.size(); ++s)
    tissue.fat[s] = survey.spots()[static_cast<std::size_t>(s)].depth - survey.spots()[static_cast<std::size_t>(s)].fat;
  const auto percent = [](double share) { return std::to_string(std::lround(100 * share)) + " %"; };
  if (fit.body_fat < options.body_fat - kNear) {
    tissue.notes.push_back("the body has room for " + percent(fit.body_fat) + " of fat, not for the " +
                           percent(options.body_fat) + " asked for");
  } else if (fit.body_fat > options.body_fat + kNear) {
    tissue.notes.push_back("skin and the least fat below it count as " + percent(fit.body_fat) +
                           " of body fat, more than the " + percent(options.body_fat) + " asked for");
  }
}

}  // namespace bodyopt::trainer
