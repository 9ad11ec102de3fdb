#include "runtime/cpu/cpu_backend.h"

#include <gtest/gtest.h>

#include <atomic>

#include "runtime/cpu/kernels.h"
#include "runtime/threads/tbb_executor.h"
#include "tests/support/cut_executor.h"
#include "tests/support/random_basis.h"

namespace bodyopt::testing {
namespace cpu_backend_test {

void expect_same(const BatchResult& a, const BatchResult& b) {
  EXPECT_EQ(a.positions, b.positions);
  EXPECT_EQ(a.normals, b.normals);
  EXPECT_EQ(a.strains, b.strains);
  EXPECT_EQ(a.excess, b.excess);
  EXPECT_EQ(a.coefficients, b.coefficients);
}

// Of nineteen frames: more than are worked on at a time.
TEST(CpuBackend, SameBitsHoweverItIsCut) {
  for (const std::uint32_t fibres : {0u, 20u}) {
    SCOPED_TRACE(fibres);
    const Basis basis = random_basis(fibres, 70);
    const Batch batch = random_batch(basis, 19);
    const auto cut = std::make_shared<CutExecutor>();
    const BatchResult whole = make_cpu_backend(model_of(basis))->run(batch);
    expect_same(whole, make_cpu_backend(model_of(basis), {}, cut)->run(batch));
    expect_same(whole, make_cpu_backend(model_of(basis), {}, make_tbb_executor())->run(batch));
    EXPECT_GT(cut->calls, 0u);
  }
}

Batch frame_of(const Batch& batch, std::size_t f) {
  const auto part = [&](const std::vector<float>& values) {
    const std::size_t size = values.size() / batch.frame_count;
    const auto begin = values.begin() + static_cast<std::ptrdiff_t>(f * size);
    return std::vector<float>(begin, begin + static_cast<std::ptrdiff_t>(size));
  };
  Batch frame;
  frame.frame_count = 1;
  frame.skinning = part(batch.skinning);
  frame.origins = part(batch.origins);
  frame.joint_features = part(batch.joint_features);
  frame.controls = part(batch.controls);
  frame.fades = part(batch.fades);
  return frame;
}

TEST(CpuBackend, ABatchHasTheBitsOfItsFrames) {
  const Basis basis = random_basis(20, 70);
  const Batch batch = random_batch(basis, 11);
  const auto backend = make_cpu_backend(model_of(basis));
  const BatchResult whole = backend->run(batch);
  const std::size_t numbers = whole.positions.size() / 11;
  for (std::size_t f = 0; f < 11; ++f) {
    const BatchResult frame = backend->run(frame_of(batch, f));
    const auto begin = static_cast<std::ptrdiff_t>(f * numbers), end = static_cast<std::ptrdiff_t>((f + 1) * numbers);
    EXPECT_TRUE(std::equal(frame.positions.begin(), frame.positions.end(), whole.positions.begin() + begin,
                           whole.positions.begin() + end));
    EXPECT_TRUE(std::equal(frame.normals.begin(), frame.normals.end(), whole.normals.begin() + begin,
                           whole.normals.begin() + end));
  }
}

// The backend finds frames of Direct Delta Mush once and poses with them; pose_skin finds its own. It goes over the
// triangles in an order of its own.
TEST(CpuBackend, PosesAsTheKernel) {
  const Basis basis = random_basis(20, 70);
  const Batch batch = random_batch(basis, 3);
  const BatchResult result = make_cpu_backend(model_of(basis))->run(batch);
  std::vector<float> displacements(result.positions.size()), positions(displacements.size());
  cpu::residual_blend(basis.residual, result.coefficients, 3, 1, displacements);
  cpu::pose_skin(basis.ddm, kBasisJoints, batch.skinning, batch.origins, displacements, positions);
  EXPECT_EQ(result.positions, positions);
  std::vector<float> normals(positions.size());
  cpu::output_normals(basis.mesh, positions, normals);
  EXPECT_EQ(result.normals, normals);
}

TEST(TbbExecutor, DoesEveryElementOnceInPartsAsLongAsAsked) {
  const auto threads = make_tbb_executor();
  for (const std::size_t count : {0, 1, 99, 100, 101, 100000}) {
    std::vector<std::atomic<int>> done(count);
    std::atomic<std::size_t> shortest = count;
    parallel_parts(*threads, count, 100, [&](std::size_t begin, std::size_t end) {
      for (std::size_t k = begin; k < end; ++k) ++done[k];
      for (std::size_t least = shortest; end - begin < least && !shortest.compare_exchange_weak(least, end - begin);) {
      }
    });
    for (const std::atomic<int>& times : done) EXPECT_EQ(times, 1);
    EXPECT_GE(shortest, std::min<std::size_t>(count, 100));
  }
}

}  // namespace cpu_backend_test
}  // namespace bodyopt::testing
