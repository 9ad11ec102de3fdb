#include <gtest/gtest.h>

#include <complex>

#include "runtime/cpu/dynamics_kernels.h"
#include "runtime/host/jiggle.h"
#include "tests/support/random_jiggle.h"

namespace bodyopt::testing {
namespace {

// Nodes that do not touch one another: m u'' + c u' + k u = m g in each axis, c = alpha m + beta k.
struct Oscillator {
  double mass = 1, stiffness = 1, mass_damping = 0;

  double damping(const JiggleStep& step) const {
    return mass_damping * mass + static_cast<double>(step.stiffness_damping) * stiffness;
  }
};

struct Oscillators {
  Oscillators(const JiggleStep& step_, std::vector<Oscillator> each)
      : step(step_), springs(std::move(each)), displacement(3 * springs.size()), velocity(3 * springs.size()) {
    const double d = step.stage();
    for (const Oscillator& o : springs) {
      JiggleNode node{};
      node.mass = static_cast<float>(o.mass);
      node.inertia = static_cast<float>(o.mass / (d * d) + o.mass_damping * o.mass / d);
      node.control = kNoControl;
      jiggle.nodes.push_back(node);
      for (int i = 0; i < 9; ++i) rotations.push_back(i % 4 == 0 ? 1.0f : 0.0f);
    }
    jiggle.step = step;
  }

  // A step as the backends take it, with A a diagonal matrix.
  void advance(const Eigen::Vector3d& gravity = Eigen::Vector3d::Zero()) {
    JiggleStepPush frame{};
    frame.node_count = static_cast<std::uint32_t>(springs.size());
    frame.gravity_x = static_cast<float>(gravity[0]);
    frame.gravity_y = static_cast<float>(gravity[1]);
    frame.gravity_z = static_cast<float>(gravity[2]);
    const JiggleStages stages = jiggle_stages(step, frame);
    std::vector<float> u(displacement.size()), v(u.size()), right_side(u.size());
    cpu::jiggle_begin(jiggle, stages.begin, rotations, {}, {}, displacement, velocity, u, v, right_side);
    std::vector<float> z = solve(right_side);
    if (stages.advance) {
      std::vector<float> next_u(u.size()), next_v(u.size());
      cpu::jiggle_advance(jiggle, *stages.advance, rotations, z, u, v, next_u, next_v, right_side);
      z = solve(right_side);
      u = next_u;
    }
    cpu::jiggle_end(stages.end, rotations, z, u, displacement, velocity);
  }

  std::vector<float> solve(const std::vector<float>& right_side) const {
    const double d = step.stage(), b = 1 + step.stiffness_damping / d;
    std::vector<float> z;
    for (std::size_t k = 0; k < right_side.size(); ++k) {
      const Oscillator& o = springs[k / 3];
      z.push_back(static_cast<float>(right_side[k] / (jiggle.nodes[k / 3].inertia + b * o.stiffness)));
    }
    return z;
  }

  double energy() const {
    double sum = 0;
    for (std::size_t k = 0; k < displacement.size(); ++k) {
      const double u = displacement[k], v = velocity[k];
      sum += (springs[k / 3].mass * v * v + springs[k / 3].stiffness * u * u) / 2;
    }
    return sum;
  }

  JiggleStep step;
  std::vector<Oscillator> springs;
  JiggleTable jiggle;
  std::vector<float> rotations, displacement, velocity;
};

using State = Eigen::Vector2d;  // u, v

// y' = F y + f of an oscillator.
Eigen::Matrix2d rates(const Oscillator& o, const JiggleStep& step) {
  Eigen::Matrix2d f;
  f << 0, 1, -o.stiffness / o.mass, -o.damping(step) / o.mass;
  return f;
}

// The textbook's TR-BDF2 (Bank et al. 1985; Hosea and Shampine 1996): the trapezoidal rule over gamma h, then the
// second-order backward differentiation formula over all three points.
State tr_bdf2(const Eigen::Matrix2d& f, const State& force, const State& y, double h) {
  const Eigen::Matrix2d one = Eigen::Matrix2d::Identity();
  const double gamma = 2 - std::sqrt(2.0), half = gamma * h / 2;
  const State middle = (one - half * f).inverse() * (y + half * (f * y + 2 * force));
  const State past = (middle - (1 - gamma) * (1 - gamma) * y) / (gamma * (2 - gamma));
  const double weight = (1 - gamma) / (2 - gamma) * h;
  return (one - weight * f).inverse() * (past + weight * force);
}

State implicit_euler(const Eigen::Matrix2d& f, const State& force, const State& y, double h) {
  return (Eigen::Matrix2d::Identity() - h * f).inverse() * (y + h * force);
}

// Free motion of an underdamped oscillator from (u, v), after a time.
State exact(const Oscillator& o, const JiggleStep& step, const State& start, double time) {
  const double decay = o.damping(step) / (2 * o.mass);
  const std::complex<double> s(-decay, std::sqrt(o.stiffness / o.mass - decay * decay));
  // u = Re(a e^(s t)) with Re(a) = u(0), Re(s a) = v(0).
  const std::complex<double> a(start[0], (s.real() * start[0] - start[1]) / s.imag());
  const std::complex<double> z = a * std::exp(s * time);
  return {z.real(), (s * z).real()};
}

constexpr double kPi = 3.14159265358979323846;

// A mode of this frequency, Hz, and damping ratio, the damping half by mass and half by stiffness.
Oscillator mode(double frequency, double ratio, JiggleStep& step) {
  const double omega = 2 * kPi * frequency;
  step.stiffness_damping = static_cast<float>(ratio / omega);
  return {0.3, 0.3 * omega * omega, ratio * omega};
}

TEST(JiggleStages, StepEqualsTheTextbook) {
  Random random(1);
  for (const bool euler : {false, true}) {
    for (int k = 0; k < 200; ++k) {
      JiggleStep step;
      step.implicit_euler = euler;
      step.substeps = 1 + random.below(3);
      const Oscillator o = mode(random.uniform(0.5, 60), random.uniform(0, 0.5), step);
      Oscillators body(step, {o});
      body.rotations = random_rotations(random, 1, 3);
      body.displacement = random.floats(3, -1, 1);
      body.velocity = random.floats(3, -20, 20);
      const Eigen::Vector3d gravity(random.uniform(-10, 10), random.uniform(-10, 10), random.uniform(-10, 10));
      const Eigen::Vector3d u = point_of(body.displacement, 0), v = point_of(body.velocity, 0);
      body.advance(gravity);
      const double h = 1 / (24.0 * step.substeps);
      const Eigen::Matrix2d f = rates(o, step);
      for (int i = 0; i < 3; ++i) {
        const State y(u[i], v[i]), force(0, gravity[i]);
        const State expected = euler ? implicit_euler(f, force, y, h) : tr_bdf2(f, force, y, h);
        ASSERT_NEAR(point_of(body.displacement, 0)[i], expected[0], 3e-6) << "case " << k;
        ASSERT_NEAR(point_of(body.velocity, 0)[i], expected[1], 3e-6 * 400) << "case " << k;
      }
    }
  }
}

// Error at the end of a second of a damped mode, against the exact solution; h = 1 / (24 substeps).
double error_of(JiggleStep step, std::uint32_t substeps) {
  const Oscillator o = mode(2, 0.1, step);
  step.substeps = substeps;
  Oscillators body(step, {o});
  body.displacement[0] = 1;
  for (std::uint32_t n = 0; n < 24 * substeps; ++n) body.advance();
  const State expected = exact(o, step, {1, 0}, 1);
  const double omega = std::sqrt(o.stiffness / o.mass);
  return std::hypot(body.displacement[0] - expected[0], (body.velocity[0] - expected[1]) / omega);
}

TEST(JiggleStages, SecondOrderInTime) {
  const double order = std::log2(error_of({}, 2) / error_of({}, 4));
  EXPECT_NEAR(order, 2, 0.15);
  EXPECT_LT(error_of({}, 1), 0.05);
  JiggleStep euler;
  euler.implicit_euler = true;
  EXPECT_NEAR(std::log2(error_of(euler, 16) / error_of(euler, 32)), 1, 0.15);
}

// What is seen of a mode of 3 Hz with a damping ratio of 5 % at one step a frame: from the eigenvalue of a step.
TEST(JiggleStages, FreeDecayAtOneStepAFrame) {
  JiggleStep step;
  const Oscillator o = mode(3, 0.05, step);
  Eigen::Matrix2d transition;
  for (int column = 0; column < 2; ++column) {
    Oscillators body(step, {o});
    (column == 0 ? body.displacement : body.velocity)[0] = 1;
    body.advance();
    transition.col(column) << body.displacement[0], body.velocity[0];
  }
  const double half_trace = transition.trace() / 2;
  const std::complex<double> root = std::sqrt(std::complex<double>(half_trace * half_trace - transition.determinant()));
  const std::complex<double> rate = std::log(half_trace + root) * 24.0;
  const double frequency = std::abs(rate) / (2 * kPi), ratio = -rate.real() / std::abs(rate);
  EXPECT_NEAR(frequency, 3, 0.05 * 3);
  EXPECT_NEAR(ratio, 0.05, 0.02);
  RecordProperty("frequency", std::to_string(frequency));
  RecordProperty("damping_ratio", std::to_string(ratio));
}

// Modes without damping whose stiffness spans six decades, from far below to far above the step's rate. What is allowed
// is the roundings of the softest: a velocity is a difference of displacements over d.
TEST(JiggleStages, EnergyNeverGrows) {
  double worst = 0;
  for (const bool euler : {false, true}) {
    Random random(7);
    JiggleStep step;
    step.implicit_euler = euler;
    for (int decade = -3; decade < 3; ++decade) {
      std::vector<Oscillator> springs;
      for (int k = 0; k < 4; ++k) springs.push_back({1, 24 * 24 * std::pow(10, decade + random.uniform(0, 1)), 0});
      Oscillators body(step, springs);
      body.rotations = random_rotations(random, 4, 3);
      body.displacement = random.floats(12, -1, 1);
      body.velocity = random.floats(12, -24, 24);
      const double first = body.energy();
      for (int n = 0; n < 10000; ++n) {
        body.advance();
        worst = std::max(worst, body.energy() / first - 1);
        ASSERT_LE(body.energy(), first * (1 + 2e-4)) << "decade " << decade << ", step " << n;
      }
      EXPECT_LT(body.energy(), first) << "decade " << decade;
    }
  }
  RecordProperty("worst_growth", std::to_string(1e6 * worst) + " millionths");
}

}  // namespace
}  // namespace bodyopt::testing
