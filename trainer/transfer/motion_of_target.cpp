#include "trainer/transfer/motion_of_target.h"

#include "assets/frame_range.h"
#include "geometry/closed_skin.h"
#include "geometry/table_rows.h"
#include "runtime/basis/output_order.h"
#include "trainer/train/coverage/coverage.h"

namespace bodyopt {
namespace {

constexpr std::size_t kFramesToSimulate = 20;

}  // namespace

double relative_volume(const MeshTable& mesh, std::span<const float> output) {
  const Triangles triangles = rows_of(mesh.triangles);
  return enclosed_volume(rows_of(vertices_of(mesh, output)), triangles) /
         enclosed_volume(rows_of(mesh.rest), triangles);
}

std::string frames_to_simulate(std::span<const int> frames, const std::vector<double>& expected_mm) {
  std::vector<int> chosen;
  for (const std::size_t k :
       worth_simulating(expected_mm, kFramesToSimulate, spreading_gap(frames.size(), kFramesToSimulate))) {
    if (expected_mm[k] > 0) chosen = unite_frames(chosen, {frames[k]});
  }
  return format_frame_range(chosen);
}

std::string frames_to_simulate(const Basis& basis, const Clip& clip) {
  if (basis.coverage.empty()) return "";
  std::vector<int> frames;
  std::vector<double> expected;
  for (const ExpectedError& error : expected_errors(basis, clip.poses)) {
    frames.push_back(clip.first_frame + static_cast<int>(frames.size()));
    expected.push_back(error.rms_mm);
  }
  return frames_to_simulate(frames, expected);
}

}  // namespace bodyopt
