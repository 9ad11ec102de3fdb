#include "trainer/proxy/level_errors.h"

#include <cmath>
#include <numeric>

#include "base/parallel.h"
#include "geometry/table_rows.h"
#include "runtime/deformer/deformer.h"
#include "runtime/host/carry_skin.h"
#include "runtime/host/device_choice.h"
#include "runtime/threads/tbb_executor.h"
#include "trainer/proxy/skin_map.h"
#include "trainer/train/data/unposed_shapes.h"

namespace bodyopt {
double carried_rms_mm(const Level& level, const Character& full, const std::vector<Sample>& samples,
                      const std::vector<Sample>& proxy) {
  const MeshTable& mesh = level.basis.mesh;
  std::vector<double> sums(samples.size());
  parallel_for(samples.size(), [&](std::size_t n) {
    std::vector<float> vertices(mesh.rest.size());
    const Positions shape = proxy[n].shape.read();
    for (std::size_t o = 0; o < mesh.output_vertex.size(); ++o) {
      for (int i = 0; i < 3; ++i) {
        vertices[3 * std::size_t{mesh.output_vertex[o]} + static_cast<std::size_t>(i)] =
            static_cast<float>(shape(static_cast<Eigen::Index>(o), i));
      }
    }
    const ShownSkin skin = show_skin(mesh, vertices);
    const std::vector<float> carried = carry_skin(mesh, level.carried, skin.positions, skin.normals);
    sums[n] = (welded_from_output(full, carried.data()) - samples[n].shape.read()).squaredNorm();
  });
  const double count = static_cast<double>(samples.size()) * static_cast<double>(full.vertices.rows());
  return 1e3 * std::sqrt(std::accumulate(sums.begin(), sums.end(), 0.0) / count);
}

ErrorStatistics level_errors(const Level& level, const Character& full, const std::vector<Sample>& samples) {
  Deformer deformer(level.basis, {.name = "cpu"});
  const std::unique_ptr<Executor> threads = make_tbb_executor();
  ErrorAccumulator errors(static_cast<std::uint32_t>(full.vertices.rows()));
  for (const Sample& sample : samples) {
    const Evaluation frame = deformer.evaluate({&sample.pose, 1});
    const std::vector<float> carried =
        carry_skin(level.basis.mesh, level.carried, frame.positions, frame.normals, *threads);
    errors.add(sample.frame, floats_of(welded_from_output(full, carried.data())), floats_of(sample.shape.read()));
  }
  return errors.finish();
}

std::vector<Sample> some_samples(const std::vector<Sample>& samples, std::size_t most) {
  std::vector<Sample> some;
  for (const std::size_t k : spread_evenly(samples.size(), most)) some.push_back(samples[k]);
  return some;
}

}  // namespace bodyopt
