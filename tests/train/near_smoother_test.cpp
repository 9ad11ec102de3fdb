// Smoothing near where something is, against implicit steps over the whole skin.
#include "trainer/train/skinning/near_smoother.h"

#include <gtest/gtest.h>

#include <map>
#include <random>

#include "assets/characters/character.h"
#include "base/linear_algebra.h"
#include "geometry/surface_distance.h"
#include "tests/support/instruction_sets.h"
#include "tests/support/shared_data.h"
#include "trainer/train/skinning/ddm.h"

namespace bodyopt::trainer {
namespace {

struct Skin {
  Positions rest;
  Triangles triangles;
  double radius;  // of the smoothing
};

// A strip of so many edges, one metre long, whose vertices lie `disorder` of an edge beside their places.
Skin strip(int along, int across, double disorder, double radius) {
  const int columns = across + 1;
  Skin skin{Positions((along + 1) * columns, 3), Triangles(2 * along * across, 3), radius};
  std::mt19937 random(3);
  std::uniform_real_distribution<double> shift(-disorder, disorder);
  const double edge = 1.0 / along;
  for (int i = 0; i <= along; ++i) {
    for (int k = 0; k < columns; ++k) {
      skin.rest.row(columns * i + k) << edge * (i + shift(random)), edge * (k + shift(random)), edge * shift(random);
    }
  }
  int t = 0;
  for (int i = 0; i < along; ++i) {
    for (int k = 0; k < across; ++k) {
      const auto at = [&](int u, int v) { return static_cast<std::uint32_t>(columns * (i + u) + k + v); };
      skin.triangles.row(t++) << at(0, 0), at(1, 0), at(1, 1);
      skin.triangles.row(t++) << at(0, 0), at(1, 1), at(0, 1);
    }
  }
  return skin;
}

// Of one beginning.
struct Smoothed {
  double worst = 0, share = 0;  // largest difference from the whole skin's; part of the skin that was reached
};

class BothSmoothings {
 public:
  BothSmoothings(const Skin& skin, int steps)
      : areas_(lumped_areas(skin.rest, skin.triangles)),
        steps_(steps),
        near_(areas_, laplacian(skin), steps),
        whole_(matrix(skin)) {}

  const NearSmoother& near() const { return near_; }

  Smoothed compare(const TenColumns& from) const {
    const TenColumns found = near_(from);
    EXPECT_TRUE(found.values.allFinite());
    Eigen::MatrixXd expected = Eigen::MatrixXd::Zero(areas_.size(), 10);
    for (std::size_t k = 0; k < from.vertices.size(); ++k) {
      expected.row(from.vertices[k]) = from.values.row(static_cast<Eigen::Index>(k));
    }
    for (int step = 0; step < steps_; ++step) {
      const Eigen::MatrixXd right = areas_.asDiagonal() * expected;
      expected = whole_.solve(right);
    }
    for (std::size_t k = 0; k < found.vertices.size(); ++k) {
      expected.row(found.vertices[k]) -= found.values.row(static_cast<Eigen::Index>(k));
    }
    return {expected.cwiseAbs().maxCoeff(),
            static_cast<double>(found.vertices.size()) / static_cast<double>(areas_.size())};
  }

 private:
  Eigen::SparseMatrix<double> laplacian(const Skin& skin) const {
    return skin.radius * skin.radius / (2.0 * steps_) * cotangent_laplacian(skin.rest, skin.triangles);
  }
  Eigen::SparseMatrix<double> matrix(const Skin& skin) const {
    Eigen::SparseMatrix<double> sum = laplacian(skin);
    sum.diagonal() += areas_;
    return sum;
  }

  Eigen::VectorXd areas_;
  int steps_;
  NearSmoother near_;
  SparseSolver whole_;
};

// The first `count` vertices, each column with other numbers up to one.
TenColumns first_vertices(int count) {
  TenColumns from{{}, Eigen::Matrix<double, Eigen::Dynamic, 10, Eigen::RowMajor>(count, 10)};
  for (int v = 0; v < count; ++v) {
    from.vertices.push_back(v);
    for (int k = 0; k < 10; ++k) from.values(v, k) = 1.0 / (1 + k) / (k % 2 ? 1 : 1 + v);
  }
  return from;
}

TEST(NearSmoother, GivesWhatTheWholeSkinDoes) {
  // From edges far below the radius to some above it, where a step hardly leaves the vertex.
  for (const double radius : {0.1, 0.025, 0.005, 0.002}) {
    for (const double disorder : {0.0, 0.3}) {
      const Skin skin = strip(200, 6, disorder, radius);
      for (const int steps : {1, 4, 20, 60}) {
        const Smoothed smoothed = BothSmoothings(skin, steps).compare(first_vertices(14));
        const std::string what =
            std::to_string(radius) + ", " + std::to_string(disorder) + ", " + std::to_string(steps);
        EXPECT_LT(smoothed.worst, 1e-8) << what;
        EXPECT_LT(smoothed.share, radius < 0.1 ? 0.6 : 1.01) << what;
      }
    }
  }
}

TEST(NearSmoother, ReachesAPieceAndNoOther) {
  // Two strips without an edge between them: all of a short one, nothing of the other.
  Skin skin = strip(10, 3, 0.2, 0.5);
  const Eigen::Index count = skin.rest.rows();
  skin.rest.conservativeResize(2 * count, 3);
  skin.rest.bottomRows(count) = skin.rest.topRows(count);
  const Triangles own = skin.triangles;
  skin.triangles.conservativeResize(2 * own.rows(), 3);
  skin.triangles.bottomRows(own.rows()) = own.array() + static_cast<std::uint32_t>(count);
  const Smoothed smoothed = BothSmoothings(skin, 20).compare(first_vertices(3));
  EXPECT_LT(smoothed.worst, 1e-13);
  EXPECT_EQ(smoothed.share, 0.5);
}

TEST(NearSmoother, EveryInstructionSetGivesTheSameBits) {
  const BothSmoothings smoothings(strip(60, 5, 0.3, 0.03), 20);
  const TenColumns first = smoothings.near()(first_vertices(9));
  const int sets = testing::with_each_instruction_set([&](const std::string& name) {
    const TenColumns found = smoothings.near()(first_vertices(9));
    EXPECT_EQ(found.vertices, first.vertices) << name;
    EXPECT_EQ(found.values, first.values) << name;
  });
  EXPECT_GT(sets, 2);
}

// Every joint's weights; of large skins every fifth's.
TEST(NearSmoother, OfRealBodiesGivesWhatTheWholeSkinDoes) {
  for (const char* name : {"human_average", "human_163_joints", "cesium_man", "fox", "greenman", "quaternius_man",
                           "quaternius_trex", "quaternius_horse"}) {
    const auto path = shared_data(std::string("characters/") + name + ".glb");
    if (!path) GTEST_SKIP() << kNeedsRealBodies;
    const Character body = read_character(*path);
    const BothSmoothings smoothings({body.vertices, body.triangles, default_smoothing_radius(body.vertices)}, 20);
    std::map<std::uint32_t, std::map<int, double>> joints;
    for (std::size_t v = 0; v < body.weights.size(); ++v) {
      for (const JointWeight& w : body.weights[v]) joints[w.joint][static_cast<int>(v)] += w.weight;
    }
    for (const auto& [joint, weights] : joints) {
      if (body.weights.size() > 5000 && joint % 5 != 0) continue;
      TenColumns from = first_vertices(static_cast<int>(weights.size()));
      from.vertices.clear();
      for (const auto& [v, weight] : weights) {
        const auto row = static_cast<Eigen::Index>(from.vertices.size());
        from.vertices.push_back(v);
        from.values.row(row).setConstant(weight);
      }
      EXPECT_LT(smoothings.compare(from).worst, 1e-8) << name << ", joint " << joint;
    }
  }
}

}  // namespace
}  // namespace bodyopt::trainer
