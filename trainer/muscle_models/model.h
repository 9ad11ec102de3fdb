// A musculoskeletal model, whatever file it comes from: rigid segments, joints with coordinates, muscles as paths.
#pragma once

#include <Eigen/Geometry>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace bodyopt::trainer::muscle_models {

// Functions of one variable in muscle models: couplings of joints, moving path points.
class Curve {
 public:
  // sum of coefficients[k] x^k; none: zero.
  static Curve polynomial(std::vector<double> coefficients);
  // The cubic spline through (x, y), x ascending, 2 points or more, straight beyond its ends. At each end its third
  // derivative is that of the cubic through the four outermost points (Forsythe, Malcolm, Moler 1977, chapter 4).
  // OpenSim's SimmSpline is the same function.
  static Curve spline(const std::vector<double>& x, const std::vector<double>& y);

  // Straight from point to point, and on beyond the ends; points as above.
  static Curve polyline(const std::vector<double>& x, const std::vector<double>& y);

  double operator()(double x) const;
  Curve scaled(double factor) const;

 private:
  struct Piece {
    double x = 0;                // where it begins
    double a[4] = {0, 0, 0, 0};  // sum of a[k] (t - x)^k
  };
  // Cubics from point to point, by a sixth of the second derivative at each.
  static Curve pieces(const std::vector<double>& x, const std::vector<double>& y, const std::vector<double>& sixth);
  std::vector<double> polynomial_;
  std::vector<Piece> pieces_;
};

// An angle (radians) or a displacement (metres) of a joint.
struct Coordinate {
  std::string name;
  double default_value = 0;
};

// A turn about an axis through a point, or a shift along it, by curve(coordinate).
struct Motion {
  enum class Kind { turn, shift } kind = Kind::turn;
  Eigen::Vector3d axis = Eigen::Vector3d::UnitX();  // unit
  Eigen::Vector3d point = Eigen::Vector3d::Zero();
  int coordinate = -1;  // -1: the curve at zero
  Curve curve;
};

// Segment to parent: before * motions[0] * motions[1] ... * after.
struct Segment {
  std::string name;
  int parent = -1;  // an earlier segment; -1 for the ground
  Eigen::Isometry3d before = Eigen::Isometry3d::Identity();
  std::vector<Motion> motions;
  Eigen::Isometry3d after = Eigen::Isometry3d::Identity();
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  // of the joint to the parent, in the segment
};

struct PathPoint {
  int segment = 0;
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  // in the segment, metres

  // Conditional: on the path only while a coordinate is within [low, high].
  struct Condition {
    int coordinate;
    double low, high;
  };
  std::optional<Condition> condition;

  // Moving: position[i] = curve(coordinate).
  struct Follow {
    int coordinate;
    Curve curve;
  };
  std::vector<Follow> moving;  // three, or none
};

// A surface a path bends around between two of its points.
struct Wrap {
  std::string name;
  enum class Shape { sphere, cylinder, other } shape = Shape::other;  // a cylinder runs along its z axis, without ends
  double radius = 0;
  int segment = 0;
  Eigen::Isometry3d frame = Eigen::Isometry3d::Identity();  // to the segment
  std::optional<PathPoint> side;                            // the path passes on the side of this point
  int after = 0;                                            // between this path point and the next
};

struct ModelMuscle {
  std::string name;
  double max_force = 0;  // isometric, newtons; 0 where the file does not say
  std::vector<PathPoint> path;
  std::vector<Wrap> wraps;
};

struct Model {
  std::string file;
  std::vector<Segment> segments;  // parents first; [0] is the ground
  std::vector<Coordinate> coordinates;
  std::vector<ModelMuscle> muscles;
  std::vector<std::string> notes;  // what was left out, one sentence each

  int find_segment(const std::string& name) const;  // index, or -1
  int find_coordinate(const std::string& name) const;
};

// A pose of a model: its coordinates and what follows from them.
struct ModelPose {
  std::vector<double> values;               // per coordinate
  std::vector<Eigen::Isometry3d> segments;  // segment to world
};

std::vector<double> default_values(const Model& model);
ModelPose pose_model(const Model& model, const std::vector<double>& values);

// A path in a pose: where it touches which segment, world. Conditional points that are off are left out.
struct PathStop {
  int segment;
  Eigen::Vector3d position;
  double arc = 0;  // length of the arc to the next stop where the path follows a surface; 0 where it is straight
};
std::vector<PathStop> trace_path(const ModelMuscle& muscle, const ModelPose& pose);

// Length of a traced path, metres.
double path_length(const std::vector<PathStop>& stops);

// Is the path traced around the surface? It is around spheres and cylinders.
bool honoured(const Wrap& wrap);

// Reads .osim or MuJoCo .xml by the file's ending. Throws Error(file).
Model read_model(const std::string& path);

// OpenSim, versions 2 to 4. Joints: CustomJoint, WeldJoint, PinJoint, SliderJoint, UniversalJoint, BallJoint,
// GimbalJoint, PlanarJoint, FreeJoint. Functions: Constant, LinearFunction, PiecewiseLinearFunction,
// PolynomialFunction, SimmSpline, MultiplierFunction. Path points: fixed, conditional, moving. Wraps are named, not
// honoured. Throws Error(file).
Model read_opensim(const std::filesystem::path& path);

// MuJoCo: bodies, joints, sites, spatial tendons and the muscles that pull them. Includes are read from the folder of
// `path`, as MuJoCo does; one that is missing is left out with a note. Honoured: hinge and slide joints, default
// classes, the compiler's angle and eulerseq, joint couplings (in the default pose), sphere and cylinder wraps. Ball
// and free joints stay as they are. A tendon without a muscle is left out with a note. Throws Error(file).
Model read_mujoco(const std::filesystem::path& path);

// The shortest way around a sphere or a cylinder.

struct Arc {
  Eigen::Vector3d from, to;  // where the path meets the surface and leaves it
  double length;             // on the surface
};

// The bend of a straight path around the surface; nothing where it stays straight. It then misses the surface, on the
// right side of it, or one of its ends lies inside. All in the surface's frame (a sphere about the origin, a cylinder
// without ends about the z axis), metres. A path with a side passes on that side; a side less than the radius from the
// origin makes it pass through the inside. The rule is MuJoCo's from 3.2.3 on (documentation,
// "tendon/spatial/geom/sidesite"); earlier, what counted was the side's distance in the plane of the bend.
std::optional<Arc> wrap_around(Wrap::Shape shape, double radius, const std::optional<Eigen::Vector3d>& side,
                               const Eigen::Vector3d& start, const Eigen::Vector3d& end);

}  // namespace bodyopt::trainer::muscle_models
