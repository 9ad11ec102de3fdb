// Shapes that are right, of bodies of any size, and the same with one thing done to all of them.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>
#include <sstream>

#include "assets/clips/clip.h"
#include "geometry/mesh.h"
#include "tests/support/stand_in_human.h"
#include "trainer/check/shape_doubts.h"
#include "trainer/train/skinning/unpose.h"

namespace bodyopt::trainer {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr int kFrames = 60;

double between(std::mt19937& random, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(random);
}

Vector3d direction(std::mt19937& random) {
  Vector3d way;
  do {
    way = Vector3d(between(random, -1, 1), between(random, -1, 1), between(random, -1, 1));
  } while (way.norm() > 1 || way.norm() < 0.1);
  return way.normalized();
}

Character of_size(Character character, double size) {
  character.vertices *= size;
  for (Joint& joint : character.skeleton.joints) {
    for (double& x : joint.bind.translation) x *= size;
    for (auto& row : joint.inverse_bind.m) row[3] *= size;
  }
  return character;
}

Quat turn_of(double angle, const Vector3d& axis) {
  const double s = std::sin(angle / 2);
  return {s * axis.x(), s * axis.y(), s * axis.z(), std::cos(angle / 2)};
}

// All joints swing, each in its own way, while the root walks a curve.
class Walk {
 public:
  Walk(const Character& character, double size, std::mt19937& random)
      : joints_(character.skeleton.joints), size_(size) {
    for (std::size_t j = 0; j < joints_.size(); ++j) {
      axes_.push_back(direction(random));
      paces_.push_back(between(random, 1, 3));
    }
  }

  Pose at(double frame) const {
    const double t = (frame - 1) / kFrames;
    Pose pose;
    for (std::size_t j = 0; j < joints_.size(); ++j) {
      JointTransform local = joints_[j].bind;
      local.rotation = local.rotation * turn_of(0.25 * std::sin(2 * std::numbers::pi * paces_[j] * t), axes_[j]);
      if (joints_[j].parent < 0) {
        local.translation[0] += size_ * t;
        local.translation[2] += size_ * 0.4 * std::sin(4 * t);
      }
      pose.joints.push_back(local);
    }
    return pose;
  }

 private:
  std::vector<Joint> joints_;
  double size_;
  std::vector<Vector3d> axes_;
  std::vector<double> paces_;
};

struct Take {
  Character character;
  Clip clip;
  std::vector<int> frames;
  std::vector<Positions> shapes;

  std::string cause() const { return find_misplacement(character, clip, frames, shapes).cause; }
};

using FrameOfClip = std::function<double(int frame)>;

FrameOfClip late_by(double frames) {
  return [frames](int frame) { return frame - frames; };
}

// Muscles that bulge with the motion by up to 12 mm of 1.7 m, and a belly that lags behind. The shapes are those of
// other frames of the clip.
Take take_of(double size, const FrameOfClip& of_clip, std::mt19937& random, double liveliness = 1) {
  Take take{of_size(stand_in_human(), size), {}, {}, {}};
  const Walk walk(take.character, size, random);
  for (int frame = 1; frame <= kFrames; ++frame) take.clip.poses.push_back(walk.at(frame));
  for (int frame = 12; frame <= kFrames - 12; frame += 3) {
    const double now = of_clip(frame);
    Positions shape = skin_linear(take.character, walk.at(now));
    const Positions before = skin_linear(take.character, walk.at(now - liveliness));
    const Positions normals = vertex_normals(shape, take.character.triangles);
    for (Eigen::Index v = 0; v < shape.rows(); ++v) {
      const Vector3d rest = take.character.vertices.row(v) / size;
      if (std::abs(rest.y() - 1.05) < 0.1) shape.row(v) = before.row(v);
      shape.row(v) += liveliness * size * 0.012 * std::pow(std::sin(9 * rest.sum() + 0.2 * frame), 2) * normals.row(v);
    }
    take.frames.push_back(frame);
    take.shapes.push_back(shape);
  }
  return take;
}

// The numbers that follow a text.
std::vector<double> numbers_after(const std::string& text, const std::string& words) {
  const std::size_t place = text.find(words);
  if (place == std::string::npos) return {};
  std::istringstream rest(text.substr(place + words.size()));
  std::vector<double> numbers;
  for (double number = 0; rest >> number;) numbers.push_back(number);
  return numbers;
}

class MisplacedShapes : public ::testing::TestWithParam<int> {
 protected:
  std::mt19937 random_{static_cast<std::mt19937::result_type>(GetParam())};
  double size_ = std::pow(10.0, between(random_, -2, 1.5));
};

TEST_P(MisplacedShapes, RightOnesAreNeverDoubted) { EXPECT_EQ(take_of(size_, late_by(0), random_).cause(), ""); }

TEST_P(MisplacedShapes, FramesLateAndEarlyAreNamedWithTheirNumber) {
  const int late = GetParam() % 2 == 0 ? 1 + GetParam() % 9 : -1 - GetParam() % 9;
  EXPECT_EQ(take_of(size_, late_by(late), random_).cause(),
            "the frames are numbered " + std::to_string(std::abs(late)) + (late > 0 ? " too high" : " too low"));
}

TEST_P(MisplacedShapes, FramesBetweenFramesAreNamed) {
  for (const double late : {0.5, -0.5}) {
    EXPECT_EQ(take_of(size_, late_by(late), random_, 0.3).cause(),
              std::string("the frames are numbered 0.5 too ") + (late > 0 ? "high" : "low"));
  }
}

TEST_P(MisplacedShapes, FramesOfAnotherRateAreNamed) {
  for (const double rate : {25, 30, 60}) {
    EXPECT_EQ(take_of(
                  size_, [rate](int frame) { return 1 + (frame - 1) * 24 / rate; }, random_)
                  .cause(),
              "the frames are " + std::to_string(std::lround(rate)) +
                  " a second, and those of the clip are taken as 24 (--fps)");
  }
}

TEST_P(MisplacedShapes, MovedOnesAreNamedWithTheirWay) {
  Take take = take_of(size_, late_by(0), random_);
  const Vector3d way = size_ * between(random_, 0.03, 2) * direction(random_);
  for (Positions& shape : take.shapes) shape.rowwise() += way.transpose();
  const std::vector<double> told = numbers_after(take.cause(), "the shapes are moved by ");
  ASSERT_EQ(told.size(), 3u) << take.cause();
  EXPECT_LT((Vector3d::Map(told.data()) - way).norm(), 0.01 * size_) << take.cause();
}

TEST_P(MisplacedShapes, ThoseOfAnotherSizeAreNamedWithTheirFactor) {
  Take take = take_of(size_, late_by(0), random_);
  const double factor = std::pow(10.0, between(random_, 0.05, 3)), scale = GetParam() % 2 == 0 ? factor : 1 / factor;
  for (Positions& shape : take.shapes) shape *= scale;
  const std::string cause = take.cause();
  const std::vector<double> told = numbers_after(cause, "the shapes are ");
  ASSERT_EQ(told.size(), 1u) << cause;
  EXPECT_NEAR(told[0] / factor, 1, 0.02) << cause;
  EXPECT_NE(cause.find(scale > 1 ? "times too large" : "times too small"), std::string::npos) << cause;
}

TEST_P(MisplacedShapes, TurnedOnesAreNamedWithTheirAngleAndAxis) {
  Take take = take_of(size_, late_by(0), random_);
  const double angle = between(random_, 6, 179);
  const Vector3d axis = direction(random_);
  const Matrix3d turn = Eigen::AngleAxisd(angle * std::numbers::pi / 180, axis).toRotationMatrix();
  for (Positions& shape : take.shapes) shape = Positions(shape * turn.transpose());
  const std::string cause = take.cause();
  const std::vector<double> degrees = numbers_after(cause, "turned by "), about = numbers_after(cause, "about ");
  ASSERT_EQ(degrees.size(), 1u) << cause;
  EXPECT_NEAR(degrees[0], angle, 0.7) << cause;
  ASSERT_EQ(about.size(), 3u) << cause;
  EXPECT_LT((Vector3d::Map(about.data()) - axis).norm(), 0.1) << cause;
}

TEST_P(MisplacedShapes, SeveralThingsAtOnceAreNamed) {
  Take take = take_of(size_, late_by(0), random_);
  for (Positions& shape : take.shapes) {
    const Positions right = 100 * shape;
    shape.col(0) = right.col(0);
    shape.col(1) = -right.col(2);
    shape.col(2) = right.col(1);
  }
  EXPECT_EQ(take.cause(),
            "the shapes are 100 times too large, as in centimetres, turned by 90 degrees about 1 0 0: Z-up, the "
            "character Y-up");
}

TEST_P(MisplacedShapes, MissingAndDoubledTravelIsNamed) {
  for (const double more : {-1.0, 1.0}) {
    Take take = take_of(size_, late_by(0), random_);
    const Vec3 rest = take.character.skeleton.joints[0].bind.translation;
    for (std::size_t k = 0; k < take.frames.size(); ++k) {
      const Vec3 now = take.clip.poses[static_cast<std::size_t>(take.frames[k] - 1)].joints[0].translation;
      for (int i = 0; i < 3; ++i) {
        const auto axis = static_cast<std::size_t>(i);
        take.shapes[k].col(i).array() += more * (now[axis] - rest[axis]);
      }
    }
    const char* expected = more < 0 ? "the root's travel is missing, " : "the root's travel is in the shapes twice, ";
    EXPECT_EQ(take.cause().find(expected), 0u) << take.cause();
  }
}

INSTANTIATE_TEST_SUITE_P(Bodies, MisplacedShapes, ::testing::Range(0, 12));

}  // namespace
}  // namespace bodyopt::trainer
