#include <Eigen/Core>
#include <Eigen/Geometry>
#include <Eigen/LU>

#include "runtime/cpu/kernels.h"
#include "runtime/vulkan/kernels/kernels.h"
#include "tests/support/kernel_cases.h"
#include "tests/support/random_tables.h"

namespace bodyopt::testing {
namespace strain_measure_test {

constexpr std::uint32_t kPoints = 40;

struct Case {
  Case(std::uint32_t fibres, std::uint32_t frame_count)
      : random(fibres + 31 * frame_count),
        frames(frame_count),
        strain(random_strain(random, fibres, kPoints, 1000)),
        positions(random.floats(std::size_t{3} * kPoints * frames, -1, 1)),
        strains(std::size_t{fibres} * frames) {
    cpu::strain_measure(strain, positions, strains);
  }

  Random random;
  std::uint32_t frames;
  StrainTable strain;
  std::vector<float> positions;
  std::vector<float> strains;  // by the reference
};

const bool added = add_kernel_cases_of_frames("strain_measure", "fibres", [](KernelSet& kernels, const Trial& trial) {
  const Case c(trial.size, trial.variant);
  return run_on<vulkan::StrainMeasure>(kernels, {trial.size, kPoints}, c.frames, {{c.strains}}, c.strain.points,
                                       c.strain.fibre_begin, c.strain.rest_length, c.positions);
});

TEST(StrainMeasureReference, EqualsTheTextbook) {
  const Case c(200, 2);
  const std::size_t fibres = c.strain.fibre_count();
  for (std::size_t k = 0; k < c.strains.size(); ++k) {
    const auto x =
        Eigen::Map<const Eigen::Matrix3Xf>(c.positions.data() + 3 * kPoints * (k / fibres), 3, kPoints).cast<double>();
    const auto at = [&](std::uint32_t p) -> Eigen::Vector3d {
      const FibrePoint& point = c.strain.points[p];
      return point.wa * x.col(point.a) + point.wb * x.col(point.b) + point.wc * x.col(point.c);
    };
    const std::size_t fibre = k % fibres;
    double length = 0;
    for (std::uint32_t p = c.strain.fibre_begin[fibre]; p + 1 < c.strain.fibre_begin[fibre + 1]; ++p) {
      length += (at(p + 1) - at(p)).norm();
    }
    const double rest = c.strain.rest_length[fibre];
    ASSERT_NEAR(c.strains[k], length / rest - 1, 1e-6 * (1 + length / rest)) << "fibre " << fibre;
  }
}

}  // namespace strain_measure_test
}  // namespace bodyopt::testing
