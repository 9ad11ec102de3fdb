// The fields of bone and fat in a body: of bones as shapes, and of fat as it is spread over the skin.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "trainer/anatomy/body_survey.h"

namespace bodyopt::trainer {

struct Bone {
  int joint = -1;
  double cover = 0;                             // metres of other tissue between it and the skin, at least
  std::function<double(const Spot&)> distance;  // to its surface, metres; negative inside
};

// Farther from bones than this, fields say just so: metres, of a body of 1.75 m.
constexpr double kFarFromBone = 0.08;

// Leaves out bones of joints that carry none by a correction, and thickens others as one says.
std::vector<Bone> corrected_bones(const std::vector<Bone>& bones, const HalfBody& body,
                                  const AnatomyCorrections& corrections);

// Sets tissue.bone and tissue.bone_joint: the nearest bone of each sample, -1 where there is none.
void find_bone(const BodySurvey& survey, const std::vector<Bone>& bones, InnerTissue& tissue);

// Gives a survey its fat and tissue its field: a pattern (V), times the corrections of regions and joints, by how much
// skin follows them. It is so thick that the fat under the skin is four fifths of a body's; the rest lies inside.
// Nowhere does it take more than 0.45 of the way to the middle of a limb. A note says where the body has no room for
// what is asked. skin: metres.
void lay_fat(BodySurvey& survey, const Eigen::VectorXd& pattern, double skin, const InnerTissueOptions& options,
             InnerTissue& tissue);

// Signed distances to the simple shapes that bones are put together of: negative inside, metres.

double sphere_distance(const Eigen::Vector3d& point, const Eigen::Vector3d& centre, double radius);
// The shape between two balls, with a linear radius (not the exact distance to a cone).
double cone_distance(const Eigen::Vector3d& point, const Eigen::Vector3d& a, const Eigen::Vector3d& b, double radius_a,
                     double radius_b);
struct ChainLink {
  Eigen::Vector3d place;
  double radius;
};
double chain_distance(const Eigen::Vector3d& point, const std::vector<ChainLink>& links);
// axes: unit, by rows. Exact on the surface only.
double ellipsoid_distance(const Eigen::Vector3d& point, const Eigen::Vector3d& centre, const Eigen::Matrix3d& axes,
                          const Eigen::Vector3d& radii);
// A triangle, thickened on either side by `half`.
double plate_distance(const Eigen::Vector3d& point, const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                      const Eigen::Vector3d& c, double half);

}  // namespace bodyopt::trainer
