#include "trainer/simulate/contact.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <map>

#include "tests/simulate/limb.h"
#include "tests/simulate/tet_block.h"
#include "trainer/simulate/lbfgs.h"
#include "trainer/simulate/quasi_static.h"
#include "trainer/tets/tets.h"

namespace bodyopt::trainer {
namespace {

constexpr double kMargin = 0.01;
constexpr double kGap = 0.06;  // more than two edges of the skin: two parts

// Two limbs side by side, the second `gap` above the first (y); below 0 they overlap.
TetMesh two_limbs(double gap) {
  const Character limb = make_limb();
  const TetMesh one = tetrahedralise(limb.vertices, limb.triangles, 0.05);
  const double radius = limb.vertices.col(1).maxCoeff();
  TetMesh two;
  two.nodes.resize(2 * one.nodes.rows(), 3);
  two.nodes << one.nodes, one.nodes.rowwise() + Eigen::RowVector3d(0.013, 2 * radius + gap, 0.004);
  two.tets.resize(2 * one.tets.rows(), 4);
  two.tets << one.tets, one.tets.array() + static_cast<int>(one.nodes.rows());
  return two;
}

// Tets whose surface is the skin.
Cage cage_of(const TetMesh& mesh) {
  Cage cage;
  cage.mesh = mesh;
  cage.is_own_skin = true;
  cage.skin.resize(static_cast<std::size_t>(mesh.nodes.rows()));
  for (int t = 0; t < mesh.tets.rows(); ++t) {
    for (int a = 0; a < 4; ++a) cage.skin[static_cast<std::size_t>(mesh.tets(t, a))] = {t, Eigen::Vector4d::Unit(a)};
  }
  return cage;
}

SkinContact contact_of(const TetMesh& mesh) { return SkinContact(mesh.nodes, surface_of(mesh.tets), cage_of(mesh)); }

Positions moved_apart(const TetMesh& mesh, double distance) {
  Positions nodes = mesh.nodes;
  nodes.bottomRows(nodes.rows() / 2).col(1).array() += distance;
  return nodes;
}

// Of skin nodes in contact of which more than half acts, metres.
double deepest(const SkinContact& contact, const Positions& nodes) {
  double depth = 0;
  for (const ContactPlane& plane : contact.find(nodes, 0)) {
    if (plane.share > 0.5 && plane.weights.minCoeff() >= 0) depth = std::max(depth, plane.offset);
  }
  return depth;
}

TEST(Contact, RestAndRigidMotionTouchNothing) {
  const TetMesh mesh = two_limbs(kGap);
  const SkinContact contact = contact_of(mesh);
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(1.9, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  const Positions near = moved_apart(mesh, -kGap + 0.0001);  // rings do not meet: vertices come no nearer than this
  for (const Positions& nodes : {Positions(mesh.nodes), Positions(mesh.nodes * turn.transpose()), near}) {
    Positions gradient = Positions::Zero(nodes.rows(), 3);
    EXPECT_EQ(contact.add_gradient(contact.find(nodes, kMargin), nodes, gradient), 0);
    EXPECT_EQ(gradient.norm(), 0);
    EXPECT_EQ(deepest(contact, nodes), 0);
  }
}

// How deep two limbs of tets have been pushed into each other is known: no more than they were moved.
TEST(Contact, DepthIsHowFarTheyWerePushed) {
  const TetMesh mesh = two_limbs(kGap);
  const SkinContact contact = contact_of(mesh);
  double last = 0;
  for (const double depth : {0.005, 0.01, 0.02}) {
    const double found = deepest(contact, moved_apart(mesh, -kGap - depth));
    EXPECT_LE(found, depth + 1e-9);
    EXPECT_GT(found, 0.3 * depth);  // coarse rings: vertices do not meet vertices
    EXPECT_GT(found, last);
    last = found;
  }
}

TEST(Contact, GradientIsTheEnergysDerivativeAndMakesNoNetForce) {
  const TetMesh mesh = two_limbs(kGap);
  const SkinContact contact = contact_of(mesh);
  const Positions nodes = moved_apart(mesh, -kGap - 0.006);
  const std::vector<ContactPlane> planes = contact.find(nodes, kMargin);
  Positions gradient = Positions::Zero(nodes.rows(), 3), unused = gradient;
  EXPECT_GT(contact.add_gradient(planes, nodes, gradient), 1e-3);
  Eigen::RowVector3d torque = Eigen::RowVector3d::Zero();
  for (Eigen::Index n = 0; n < nodes.rows(); ++n) torque += nodes.row(n).cross(gradient.row(n));
  EXPECT_LT(gradient.colwise().sum().norm(), 1e-10 * gradient.norm());
  EXPECT_LT(torque.norm(), 1e-10 * gradient.norm());
  // The limbs push each other apart.
  EXPECT_LT(gradient.bottomRows(nodes.rows() / 2).col(1).sum(), -0.1 * gradient.norm());
  std::srand(3);
  for (int k = 0; k < 5; ++k) {
    const Positions direction = Positions::Random(nodes.rows(), 3);
    const double step = 1e-8, up = contact.add_gradient(planes, nodes + step * direction, unused),
                 down = contact.add_gradient(planes, nodes - step * direction, unused);
    EXPECT_NEAR(gradient.cwiseProduct(direction).sum(), (up - down) / (2 * step), 1e-4 * gradient.norm());
  }
}

// Planes found before parts touch stand for the contact that follows.
TEST(Contact, NearbySkinIsFoundBeforeItTouches) {
  const TetMesh mesh = two_limbs(kGap);
  const SkinContact contact = contact_of(mesh);
  const Positions near = moved_apart(mesh, -kGap + 0.001), pushed = moved_apart(mesh, -kGap - 0.004);
  Positions early = Positions::Zero(mesh.nodes.rows(), 3), late = early;
  const double before = contact.add_gradient(contact.find(near, kMargin), pushed, early);
  const double after = contact.add_gradient(contact.find(pushed, kMargin), pushed, late);
  EXPECT_GT(after, 0);
  EXPECT_NEAR(before, after, 0.5 * after);
  EXPECT_GT(early.cwiseProduct(late).sum(), 0.8 * early.norm() * late.norm());
}

// A node's planes, what it believes of its depth by them, and the share of all of them.
struct Held {
  std::size_t planes = 0;
  double depth = 0, share = 0;
};
std::map<int, Held> held_by_node(const SkinContact& contact, const HeldContact& held, const Positions& nodes) {
  std::map<int, Held> of_node;
  for (const ContactPlane& plane : held.planes()) {
    Held& node = of_node[plane.point];
    node.depth += std::max(contact.depth(plane, nodes), 0.0);
    node.share += plane.share;
    ++node.planes;
  }
  for (auto& [number, node] : of_node) node.depth /= static_cast<double>(node.planes);
  return of_node;
}

// Slid along a curved limb, nodes whose planes are wrong get those of the new place beside them; a few times of this,
// and all planes fit.
TEST(Contact, HeldPlanesAreRenewedWhereTheyAreWrong) {
  const TetMesh mesh = two_limbs(kGap);
  const SkinContact contact = contact_of(mesh);
  const Positions start = moved_apart(mesh, -kGap - 0.006);
  Positions slid = start;
  slid.bottomRows(slid.rows() / 2).col(2).array() += 0.03;
  HeldContact held(contact, kMargin, start);
  const std::size_t at_first = held.planes().size();
  EXPECT_EQ(at_first, contact.find(start, kMargin).size());
  EXPECT_TRUE(held.renew(start));
  EXPECT_EQ(held.planes().size(), at_first);

  EXPECT_FALSE(held.renew(slid));
  const std::vector<ContactPlane> found = contact.find(slid, kMargin);
  for (const auto& [number, node] : held_by_node(contact, held, slid)) EXPECT_LE(node.planes, 2u);
  bool is_true = false;
  for (int round = 0; round < 100 && !is_true; ++round) is_true = held.renew(slid);
  EXPECT_TRUE(is_true);
  const std::map<int, Held> now = held_by_node(contact, held, slid);
  ASSERT_EQ(now.size(), found.size());  // those that do not touch any more are let go
  bool several = false;
  for (const ContactPlane& plane : found) {
    EXPECT_NEAR(now.at(plane.point).depth, std::max(plane.offset, 0.0), 6e-4);
    EXPECT_NEAR(now.at(plane.point).share, plane.share, 1e-12);
    several = several || now.at(plane.point).planes > 1;
  }
  EXPECT_TRUE(several);
}

// A push that ends all at once means that planes did not fit, however well those that are left do.
TEST(Contact, LettingGoMeansThatPlanesDidNotFit) {
  const TetMesh mesh = two_limbs(kGap);
  const SkinContact contact = contact_of(mesh);
  const Positions start = moved_apart(mesh, -kGap - 0.006);
  Positions beyond = start;
  beyond.bottomRows(beyond.rows() / 2).col(0).array() += 10;
  HeldContact held(contact, kMargin, start);
  ASSERT_FALSE(held.planes().empty());
  Positions away = moved_apart(mesh, 0.5);
  EXPECT_TRUE(HeldContact(held).renew(away));  // straight apart, as the planes tell
  EXPECT_TRUE(contact.find(beyond, kMargin).empty());
  EXPECT_FALSE(held.renew(beyond));  // along the limb until nothing is there
  EXPECT_TRUE(held.planes().empty());
}

// What is as near at rest is the same part: neighbours in the skin do not push each other.
TEST(Contact, WhatIsOnePartAtRestDoesNotCollide) {
  const TetMesh touching = two_limbs(0.0005), apart = two_limbs(kGap);
  EXPECT_TRUE(contact_of(touching).find(moved_apart(touching, -0.0055), 0).empty());
  EXPECT_FALSE(contact_of(apart).find(moved_apart(apart, -kGap - 0.005), 0).empty());
}

// A block with a V-shaped groove along z, whose bottom passes through the origin, and a tet that points down at it.
// Below the groove the depth in the block is the distance from the bottom.
struct Groove {
  TetMesh mesh;
  Eigen::Index tip = 0;  // node of the tet, the last
  double tip_area = 0;   // a third of the faces around it, square metres
};

Groove make_groove() {
  constexpr int kWide = 6, kHigh = 3;
  constexpr double kCell = 0.02, kAbove = 0.2;
  Groove groove;
  groove.mesh = tet_block(kWide, kHigh, kWide, kCell);
  Positions& nodes = groove.mesh.nodes;
  Tets& tets = groove.mesh.tets;
  nodes.rowwise() -= Eigen::RowVector3d(kWide / 2.0, kHigh, kWide / 2.0) * kCell;
  nodes.col(1) += nodes.col(0).cwiseAbs();
  groove.tip = nodes.rows() + 3;
  nodes.conservativeResize(nodes.rows() + 4, 3);
  nodes.bottomRows(4) << kCell, kCell, 0, -kCell, kCell, kCell, -kCell, kCell, -kCell, 0, 0, 0;
  for (int a = 0; a < 3; ++a) {
    const Eigen::RowVector3d b = nodes.row(groove.tip - 3 + a), c = nodes.row(groove.tip - 3 + (a + 1) % 3);
    groove.tip_area += b.cross(c).norm() / 2 / 3;
  }
  nodes.bottomRows(4).col(1).array() += kAbove;
  const int tip = static_cast<int>(groove.tip);
  tets.conservativeResize(tets.rows() + 1, 4);
  tets.bottomRows(1) << tip - 3, tip - 2, tip - 1, tip;
  orient(groove.mesh);
  return groove;
}

// A node pulled into the groove, beside its bottom. Each slope alone would push it across to the other, so that with
// the newest plane alone it would never rest. Held by both it rests on the bottom, as deep as its pull and the
// contact's pressure balance, and stays there.
TEST(Contact, ANodeBetweenTwoSlopesComesToRest) {
  constexpr double kPull = 3000, kDown = 0.004;   // N/m, metres: towards a point that far below the bottom
  constexpr double kTold = 6e-4, kReach = 0.002;  // metres, as documented
  constexpr int kRounds = 16;
  const Groove groove = make_groove();
  const SkinContact contact = contact_of(groove.mesh);
  const double area = Materials{}.contact * groove.tip_area, square = area / kReach, linear = area + kPull;
  const double balance = (std::sqrt(linear * linear + 4 * square * kPull * kDown) - linear) / (2 * square);
  SparseMatrix stiffness(groove.mesh.nodes.rows(), groove.mesh.nodes.rows());
  stiffness.setIdentity();
  stiffness *= kPull;
  const Metric metric(stiffness);
  const StiffModes plain(metric, groove.mesh.nodes.rows(), {}, {});
  for (const double beside : {-0.001, 0.001}) {
    Positions nodes = groove.mesh.nodes;
    const Eigen::RowVector3d start(beside, -0.002, 0), shift = start - nodes.row(groove.tip);
    nodes.bottomRows(4).rowwise() += shift;
    HeldContact held(contact, kMargin, nodes);
    const Objective pulled = [&](const Positions& x, Positions& gradient) {
      gradient.setZero();
      const double energy = contact.add_gradient(held.planes(), x, gradient);
      const Eigen::RowVector3d pull = kPull * (x.row(groove.tip) - Eigen::RowVector3d(beside, -kDown, 0));
      gradient.row(groove.tip) += pull;
      gradient.topRows(groove.tip).setZero();
      return ObjectiveValue{energy + pull.squaredNorm() / (2 * kPull), pull.squaredNorm()};
    };
    const auto relax = [&] { EXPECT_LT(Lbfgs(plain, 1e-9).minimise(pulled, 1e-7, 200, nodes).residual, 1e-7); };
    bool is_true = false;
    for (int round = 0; round < kRounds && !is_true; ++round) {
      relax();
      is_true = held.renew(nodes);
    }
    EXPECT_TRUE(is_true);
    const Eigen::RowVector3d rest = nodes.row(groove.tip);
    const double depth = deepest(contact, nodes);
    EXPECT_NEAR(depth, std::hypot(rest[0], rest[1]), 1e-9);
    EXPECT_NEAR(held_by_node(contact, held, nodes).at(static_cast<int>(groove.tip)).depth, depth, kTold);
    EXPECT_NEAR(depth, balance, kTold);
    relax();
    EXPECT_TRUE(held.renew(nodes));
    EXPECT_LT((nodes.row(groove.tip) - rest).norm(), 1e-6);
  }
}

// A vertex that hangs below the tip of its tet is held at the tip. Its plane gives the depth of where it hangs, so that
// planes fit at once.
TEST(Contact, APlaneGivesTheDepthOfAVertexOutsideItsTet) {
  constexpr double kBelow = 0.003, kDeep = 0.002;  // metres: of the vertex under the tip, of the tip in the groove
  const Groove groove = make_groove();
  Cage cage = cage_of(groove.mesh);
  const Eigen::RowVector3d below(0, -kBelow, 0);
  Positions skin = groove.mesh.nodes;
  skin.row(groove.tip) += below;
  EmbeddedPoint& hanging = cage.skin[static_cast<std::size_t>(groove.tip)];
  hanging.weights = weights_in(groove.mesh, hanging.tet, skin.row(groove.tip));
  ASSERT_LT(hanging.weights.minCoeff(), -0.01);
  const SkinContact contact(skin, surface_of(groove.mesh.tets), cage);
  Positions nodes = groove.mesh.nodes;
  nodes.bottomRows(4).rowwise() -= nodes.row(groove.tip) + Eigen::RowVector3d(0, kDeep, 0);
  bool is_found = false;
  for (const ContactPlane& plane : contact.find(nodes, kMargin)) {
    if (plane.point != groove.tip) continue;
    is_found = true;
    EXPECT_NEAR(contact.depth(plane, nodes), kBelow + kDeep, 1e-9);
  }
  EXPECT_TRUE(is_found);
  HeldContact held(contact, kMargin, nodes);
  const std::size_t at_first = held.planes().size();
  nodes.bottomRows(4).rowwise() -= Eigen::RowVector3d(0, 0.001, 0);  // so far that planes are looked for anew
  EXPECT_TRUE(held.renew(nodes));
  EXPECT_EQ(held.planes().size(), at_first);
}

// A limb folded on itself: skin lies on skin.
TEST(Contact, AFoldedLimbRestsOnItself) {
  const Character limb = make_limb();
  const QuasiStaticBody body = own_body(limb, {}, 0.05, kLimbAnatomy);
  const SolvedPose solved = body.solve(bent(limb, degrees(140)));
  EXPECT_TRUE(solved.status.converged);
  EXPECT_EQ(solved.status.inverted_tets, 0);
  EXPECT_GT(solved.status.contact_depth, 0);
  EXPECT_LT(solved.status.contact_depth, 2e-3);
}

}  // namespace
}  // namespace bodyopt::trainer
