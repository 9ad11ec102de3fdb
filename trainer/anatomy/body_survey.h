// The skin tells of the places under it: their depth, region and joint.
#pragma once

#include <optional>
#include <vector>

#include "trainer/anatomy/body_grid.h"
#include "trainer/anatomy/inner_tissue.h"

namespace bodyopt::trainer {

// A place, and the skin nearest to it.
struct Spot {
  Eigen::Vector3d point;
  double depth = 0;           // metres below the skin
  double half_thickness = 0;  // metres, of the body behind the skin
  double fat = 0;             // metres: skin and fat below it
  int joint = -1;             // that holds the skin
  BodyRegion region = BodyRegion::trunk;
};

class BodySurvey {
 public:
  // body and grid must outlive it. regions: J.
  BodySurvey(const HalfBody& body, const BodyGrid& grid, const std::vector<BodyRegion>& regions);

  const HalfBody& body() const { return body_; }
  const BodyGrid& grid() const { return grid_; }
  const std::vector<BodyRegion>& regions() const { return regions_; }
  const Eigen::VectorXd& half_thickness() const { return half_thickness_; }  // V
  void set_fat(const Eigen::VectorXd& thickness);                            // V, metres, skin included

  const std::vector<Spot>& spots() const { return spots_; }  // S
  Spot spot(const Eigen::Vector3d& point) const;             // of any point inside
  // V x regions: how much of a vertex follows the joints of a region.
  Eigen::MatrixXd region_weights() const;

  // Farthest back and forward that head, neck and trunk reach at a height and distance from the median plane.
  struct Depths {
    double back, front;
  };
  std::optional<Depths> depths(double height, double aside = 0) const;
  // The section of a region by a plane across `axis` (unit): its middle, and half of its width along `across`.
  struct Section {
    Eigen::Vector3d middle;
    double half_width;
  };
  std::optional<Section> section(const Eigen::Vector3d& at, const Eigen::Vector3d& axis, BodyRegion region,
                                 const Eigen::Vector3d& across) const;

 private:
  Spot spot_under(const Eigen::Vector3d& point, const SkinPoint& skin) const;

  const HalfBody& body_;
  const BodyGrid& grid_;
  std::vector<BodyRegion> regions_;
  NearestSkin skin_;
  Eigen::VectorXd half_thickness_, fat_;
  std::vector<Spot> spots_;
};

bool is_trunk(BodyRegion region);  // or hip

// A value of rows, by a quarter of what those beside them have, so many times; the first and the last stay.
template <typename Row, typename Value>
void smooth(std::vector<Row>& rows, Value Row::*value, int rounds) {
  for (int round = 0; round < rounds; ++round) {
    const std::vector<Row> old = rows;
    for (std::size_t k = 1; k + 1 < rows.size(); ++k)
      rows[k].*value = 0.25 * (old[k - 1].*value) + 0.5 * (old[k].*value) + 0.25 * (old[k + 1].*value);
  }
}

}  // namespace bodyopt::trainer
