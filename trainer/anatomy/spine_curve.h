// The spine of a body that has no tables: a curve under the back, from the tip of the tail to the skull.
#pragma once

#include <vector>

#include "trainer/anatomy/body_survey.h"
#include "trainer/anatomy/joint_chains.h"

namespace bodyopt::trainer {

class SpineCurve {
 public:
  struct Row {
    double along = 0;                         // metres from the tail's end
    Eigen::Vector3d middle;                   // of the section
    Eigen::Vector3d place;                    // of the vertebra
    Eigen::Vector3d forward, dorsal;          // unit: to the head, to the back
    double up = 0, down = 0, half_width = 0;  // metres, of the section: from its middle
    int joint = -1;
  };
  // A point beside the curve, as a section sees it.
  struct Spot {
    double row = 0;                // between two rows
    double beyond = 0;             // metres past either end
    double aside = 0, height = 0;  // metres from the section's middle: out of the median plane, to the back

    bool is_beyond() const { return beyond > 0; }
  };

  // The curve of a body without an axis is empty.
  SpineCurve(const BodySurvey& survey, const JointChains& chains, BodyKind kind);

  const std::vector<Row>& rows() const { return rows_; }
  bool empty() const { return rows_.size() < 2; }
  Row at(double row) const;  // interpolated
  // The nearest place on rows `from` to `to`.
  Spot spot(const Eigen::Vector3d& point, double from, double to) const;
  double row_near(const Eigen::Vector3d& point) const;

  // Rows of the roots of hind and fore limbs: between them lies the trunk.
  double hip() const { return hip_; }
  double shoulder() const { return shoulder_; }

 private:
  void lay(const BodySurvey& survey, const JointChains& chains);
  void measure(const BodySurvey& survey);
  void find_trunk(const JointChains& chains, BodyKind kind);
  void lift(BodyKind kind);
  void turn();    // forward and dorsal from the rows' middles
  void spread();  // rows at equal distances along their middles

  // The way from a row to the next, in the median plane (y, z).
  struct Segment {
    Eigen::Vector2d from, along;  // along: unit
    double length;
  };

  std::vector<Row> rows_;
  std::vector<Segment> segments_;
  double hip_ = 0, shoulder_ = 0;
};

// Metres from a place inside along a direction to where the body ends; `most` at most.
double way_out(const BodyGrid& grid, const Eigen::Vector3d& from, const Eigen::Vector3d& along, double most);

}  // namespace bodyopt::trainer
