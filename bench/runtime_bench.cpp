// Direct Delta Mush on one thread: the product with each set of instructions, beside what others do with the same
// table and pose. The built-in arm; with BODYOPT_BENCH_CHARACTER, a character, and the same with every edge halved as
// often as it takes to have 100,000 vertices.
#include <benchmark/benchmark.h>
#include <hwy/targets.h>

#include <Eigen/SVD>
#include <Eigen/Sparse>
#include <cstdlib>
#include <map>
#include <random>
#include <string>

#include "bench/subdivide.h"
#include "runtime/core/executor.h"
#include "runtime/core/half.h"
#include "runtime/cpu/kernels.h"
#include "runtime/deformer/deformer.h"
#include "runtime/deformer/evaluate_together.h"
#include "runtime/host/device_choice.h"
#include "runtime/host/rig.h"
#include "trainer/builtin/arm.h"
#include "trainer/train/skinning/ddm.h"

namespace bodyopt::bench {
namespace {

constexpr std::size_t kLargeVertices = 100000;

// A pose in which every joint is turned by up to 0.3 radians.
Pose random_pose(const Skeleton& skeleton) {
  std::mt19937 random(1);
  Pose pose = bind_pose(skeleton);
  for (JointTransform& joint : pose.joints) {
    const auto number = [&] { return random() / 4294967296.0 - 0.5; };
    Vec3 axis{number(), number(), number()};
    axis = (1 / length(axis)) * axis;
    joint.rotation = normalized(joint.rotation * axis_angle(axis, 0.6 * number()));
  }
  return pose;
}

// 4 x 4 moments about the origin of one vertex and joint: ten numbers, as libigl's table has them.
struct Moments {
  std::uint32_t joint;
  Eigen::Matrix4d psi;
};

Eigen::Matrix4d moments_about_origin(const DdmTable& ddm, std::uint32_t entry, std::uint32_t vertex) {
  const DdmVertex& v = ddm.vertices[vertex];
  const auto word = [&](std::uint32_t w) {
    return ddm.moments[(std::size_t{entry} * kMomentWords + w) * kBlockSize + vertex % kBlockSize];
  };
  const double omega = std::bit_cast<float>(word(6)), r2 = v.radius2;
  const Eigen::Vector3d centre(v.centre_x, v.centre_y, v.centre_z);
  const Eigen::Vector3d first =
      r2 * Eigen::Vector3d(std::bit_cast<float>(word(3)), std::bit_cast<float>(word(4)), std::bit_cast<float>(word(5)));
  const double xx = half_low(word(0)), xy = half_high(word(0)), xz = half_low(word(1)), yy = half_high(word(1)),
               yz = half_low(word(2)), zz = half_high(word(2));
  Eigen::Matrix3d second;
  second << xx, xy, xz, xy, yy, yz, xz, yz, zz;
  Eigen::Matrix4d psi;
  psi.topLeftCorner<3, 3>() =
      r2 * second + centre * first.transpose() + first * centre.transpose() + omega * centre * centre.transpose();
  psi.topRightCorner<3, 1>() = first + omega * centre;
  psi.bottomLeftCorner<1, 3>() = (first + omega * centre).transpose();
  psi(3, 3) = omega;
  return psi;
}

struct Body {
  explicit Body(Character of) : character(std::move(of)), basis(trainer::build_ddm_basis(character, {})) {
    const RigFrame rig = pose_rig(basis.skeleton, random_pose(basis.skeleton));
    skinning = rig.skinning;
    origin.assign(rig.origin, rig.origin + 3);
    origin.push_back(0);
    displacements.assign(std::size_t{3} * basis.mesh.vertex_count(), 0.0f);
    const DdmTable& ddm = basis.ddm;
    for (std::uint32_t v = 0; v < basis.mesh.vertex_count(); ++v) {
      for (std::uint32_t e = ddm.block_begin[v / kBlockSize]; e < ddm.block_begin[v / kBlockSize + 1]; ++e) {
        const Eigen::Matrix4d psi = moments_about_origin(ddm, e, v);
        if (psi(3, 3) != 0) moments.push_back({ddm.block_joints[e], psi});
      }
      moments_end.push_back(moments.size());
    }
    for (std::size_t j = 0; j < basis.skeleton.size(); ++j) {
      Eigen::Matrix4d m = Eigen::Matrix4d::Identity();
      m.topRows<3>() = Eigen::Map<const Eigen::Matrix<float, 3, 4, Eigen::RowMajor>>(&skinning[12 * j]).cast<double>();
      matrices.push_back(m);
    }
  }

  Eigen::Vector3d rest(std::uint32_t v) const {
    const DdmVertex& d = basis.ddm.vertices[v];
    return {double{d.centre_x} + d.offset_x, double{d.centre_y} + d.offset_y, double{d.centre_z} + d.offset_z};
  }

  Character character;
  Basis basis;
  std::vector<float> skinning, origin, displacements;
  std::vector<Moments> moments;          // of all vertices, those that are not zero
  std::vector<std::size_t> moments_end;  // V
  std::vector<Eigen::Matrix4d> matrices;
};

Character human() { return read_character(std::getenv("BODYOPT_BENCH_CHARACTER")); }

Character large_human() {
  Character character = human();
  while (4 * static_cast<std::size_t>(character.vertices.rows()) < kLargeVertices) {
    character = halve_all_edges(character).character;
  }
  return halve_longest_edges(character, kLargeVertices).character;
}

const Body& body(const std::string& name) {
  static std::map<std::string, Body> bodies;
  const auto known = bodies.find(name);
  if (known != bodies.end()) return known->second;
  const auto make = [&] {
    return name == "arm" ? trainer::build_arm().character : name == "human" ? human() : large_human();
  };
  return bodies.emplace(name, Body(make())).first->second;
}

void report(benchmark::State& state, const Body& of) {
  state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations() * of.basis.mesh.vertex_count()));
  state.counters["vertices"] = of.basis.mesh.vertex_count();
  state.counters["joints"] = static_cast<double>(of.basis.skeleton.size());
}

void product(benchmark::State& state, const std::string& name, std::int64_t instructions) {
  const Body& of = body(name);
  std::vector<float> positions(of.displacements.size());
  hwy::SetSupportedTargetsForTest(instructions);
  hwy::GetChosenTarget().Update(hwy::SupportedTargets());
  for (auto _ : state) {
    cpu::pose_skin(of.basis.ddm, static_cast<std::uint32_t>(of.basis.skeleton.size()), of.skinning, of.origin,
                   of.displacements, positions);
    benchmark::DoNotOptimize(positions.data());
  }
  hwy::SetSupportedTargetsForTest(0);
  hwy::GetChosenTarget().Update(hwy::SupportedTargets());
  report(state, of);
  const DdmTable& ddm = of.basis.ddm;
  const std::size_t bytes = 4 * (ddm.moments.size() + ddm.block_joints.size() + 2 * positions.size()) +
                            sizeof(DdmVertex) * ddm.vertices.size();
  state.SetBytesProcessed(static_cast<std::int64_t>(state.iterations() * bytes));
}

// Computes as many vertices with the quickest instructions, over and over the same few blocks, which the second cache
// holds. This is the time without waits for memory.
void product_in_cache(benchmark::State& state, const std::string& name) {
  constexpr std::size_t kNumbers = std::size_t{3} * kBlockSize * 64;
  const Body& of = body(name);
  const std::size_t rounds = of.displacements.size() / kNumbers;
  std::vector<float> positions(kNumbers);
  for (auto _ : state) {
    for (std::size_t round = 0; round < rounds; ++round) {
      cpu::pose_blocks(of.basis.ddm, of.skinning.data(), nullptr, of.origin.data(), 0,
                       std::span(of.displacements).first(kNumbers), positions);
      benchmark::DoNotOptimize(positions.data());
    }
  }
  state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations() * rounds * kNumbers / 3));
}

// R u + t of the sum of M psi.
Eigen::Vector3d place(const Eigen::Matrix4d& sum, const Eigen::Vector3d& u) {
  const Eigen::Vector3d q = sum.topRightCorner<3, 1>(), p = sum.bottomLeftCorner<1, 3>().transpose();
  const Eigen::Matrix3d a = sum.topLeftCorner<3, 3>() - q * p.transpose();
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(a, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Eigen::Matrix3d r = svd.matrixU() * svd.matrixV().transpose();
  return r * u + q - r * p;
}

// Follows the description of libigl's direct_delta_mush(): a table of every vertex and every joint, in double
// precision, a singular value decomposition per vertex.
void dense_double(benchmark::State& state, const std::string& name) {
  const Body& of = body(name);
  const Eigen::Index vertices = of.basis.mesh.vertex_count(), joints = static_cast<Eigen::Index>(of.matrices.size());
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> table =
      Eigen::MatrixXd::Zero(vertices, 10 * joints);
  for (std::size_t v = 0, e = 0; v < of.moments_end.size(); ++v) {
    for (; e < of.moments_end[v]; ++e) {
      const Eigen::Matrix4d& m = of.moments[e].psi;
      table.row(static_cast<Eigen::Index>(v)).segment<10>(10 * of.moments[e].joint) << m(0, 0), m(0, 1), m(0, 2),
          m(0, 3), m(1, 1), m(1, 2), m(1, 3), m(2, 2), m(2, 3), m(3, 3);
    }
  }
  Positions posed(vertices, 3);
  for (auto _ : state) {
    for (Eigen::Index v = 0; v < vertices; ++v) {
      Eigen::Matrix4d sum = Eigen::Matrix4d::Zero();
      for (Eigen::Index j = 0; j < joints; ++j) {
        const double* m = &table(v, 10 * j);
        Eigen::Matrix4d psi;
        psi << m[0], m[1], m[2], m[3], m[1], m[4], m[5], m[6], m[2], m[5], m[7], m[8], m[3], m[6], m[8], m[9];
        sum.noalias() += of.matrices[static_cast<std::size_t>(j)] * psi;
      }
      posed.row(v) = place(sum, of.rest(static_cast<std::uint32_t>(v)));
    }
    benchmark::DoNotOptimize(posed.data());
  }
  report(state, of);
}

// Computes dense_double() over the moments that are not zero alone.
void sparse_double(benchmark::State& state, const std::string& name) {
  const Body& of = body(name);
  Positions posed(of.basis.mesh.vertex_count(), 3);
  for (auto _ : state) {
    for (std::size_t v = 0, e = 0; v < of.moments_end.size(); ++v) {
      Eigen::Matrix4d sum = Eigen::Matrix4d::Zero();
      for (; e < of.moments_end[v]; ++e) sum.noalias() += of.matrices[of.moments[e].joint] * of.moments[e].psi;
      posed.row(static_cast<Eigen::Index>(v)) = place(sum, of.rest(static_cast<std::uint32_t>(v)));
    }
    benchmark::DoNotOptimize(posed.data());
  }
  report(state, of);
}

// Linear blend skinning, which every engine has, with the weights of the moments.
void linear_blending(benchmark::State& state, const std::string& name) {
  const Body& of = body(name);
  const std::size_t vertices = of.moments_end.size();
  std::vector<float> weights, rest, posed(3 * vertices);
  for (const Moments& m : of.moments) weights.push_back(static_cast<float>(m.psi(3, 3)));
  for (std::uint32_t v = 0; v < vertices; ++v) {
    for (const double x : {of.rest(v)[0], of.rest(v)[1], of.rest(v)[2]}) rest.push_back(static_cast<float>(x));
  }
  for (auto _ : state) {
    for (std::size_t v = 0, e = 0; v < vertices; ++v) {
      float m[12] = {};
      for (; e < of.moments_end[v]; ++e) {
        const float* joint = &of.skinning[std::size_t{12} * of.moments[e].joint];
        for (std::size_t k = 0; k < 12; ++k) m[k] += weights[e] * joint[k];
      }
      const float* u = &rest[3 * v];
      for (std::size_t i = 0; i < 3; ++i) {
        posed[3 * v + i] = m[4 * i] * u[0] + m[4 * i + 1] * u[1] + m[4 * i + 2] * u[2] + m[4 * i + 3];
      }
    }
    benchmark::DoNotOptimize(posed.data());
  }
  report(state, of);
}

Character halved_human(int halvings) {
  Character character = human();
  for (int k = 0; k < halvings; ++k) character = halve_all_edges(character).character;
  return character;
}

// Makes the tables, which who opens an untrained character waits for: the time of all processors.
void made(benchmark::State& state, int halvings) {
  const Character character = halved_human(halvings);
  for (auto _ : state) benchmark::DoNotOptimize(trainer::build_ddm_basis(character, {}));
}

// A frame from pose to normals in output order, of so many in a call.
void frames(benchmark::State& state, int halvings, std::size_t count) {
  const Basis basis = trainer::build_ddm_basis(halved_human(halvings), {});
  Deformer deformer(basis, {.name = "cpu", .executor = std::make_shared<SerialExecutor>()});
  const std::vector<Pose> poses(count, random_pose(basis.skeleton));
  Evaluation evaluation;
  const auto evaluate = [&] {
    DeformerCall call{.deformer = &deformer, .poses = poses, .evaluation = &evaluation};
    evaluate_together({&call, 1});
  };
  evaluate();  // memory is got
  for (auto _ : state) evaluate();
  const std::size_t written = std::size_t{24} * (basis.mesh.vertex_count() + basis.mesh.output_count());
  state.SetBytesProcessed(static_cast<std::int64_t>(state.iterations() * count * (total_bytes(basis) + written)));
  state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations() * count));
}

// a = b + 3 c over arrays that no cache holds: the bandwidth that bytes_per_second above are to be seen beside.
void triad(benchmark::State& state) {
  const std::size_t count = std::size_t{1} << 25;
  std::vector<float> a(count), b(count, 1.0f), c(count, 2.0f);
  for (auto _ : state) {
    for (std::size_t k = 0; k < count; ++k) a[k] = b[k] + 3 * c[k];
    benchmark::DoNotOptimize(a.data());
    benchmark::ClobberMemory();
  }
  state.SetBytesProcessed(static_cast<std::int64_t>(state.iterations() * 12 * count));
}

// Of function(state, arguments...).
benchmark::internal::Benchmark* add(const std::string& title, auto function, auto... arguments) {
  return benchmark::RegisterBenchmark(title.c_str(), [=](benchmark::State& state) { function(state, arguments...); })
      ->Unit(benchmark::kMillisecond);
}

void add_body(const std::string& name) {
  add(name + "/dense double, SVD", dense_double, name);
  add(name + "/sparse double, SVD", sparse_double, name);
  add(name + "/linear blending", linear_blending, name);
  for (const auto& [target, title] :
       {std::pair{HWY_AVX3, "AVX-512"}, {HWY_AVX2, "AVX2"}, {HWY_SSE4, "SSE4"}, {HWY_SCALAR, "one lane"}}) {
    if (hwy::SupportedTargets() & target) add(name + "/pose_skin, " + title, product, name, std::int64_t{target});
  }
  add(name + "/pose_skin, in cache", product_in_cache, name);
}

}  // namespace
}  // namespace bodyopt::bench

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  bodyopt::bench::add_body("arm");
  if (std::getenv("BODYOPT_BENCH_CHARACTER")) {
    bodyopt::bench::add_body("human");
    bodyopt::bench::add_body("large");
    for (const int halvings : {0, 1, 2}) {
      const std::string title = "human/tables made, edges halved " + std::to_string(halvings) + " times";
      bodyopt::bench::add(title, bodyopt::bench::made, halvings)->Iterations(1)->MeasureProcessCPUTime();
    }
    for (const int halvings : {0, 1, 2, 3}) {
      for (const std::size_t count : {1, 64}) {
        const std::string title = "human/edges halved " + std::to_string(halvings) + " times, " + std::to_string(count);
        bodyopt::bench::add(title + " frames", bodyopt::bench::frames, halvings, count);
      }
    }
  }
  bodyopt::bench::add("triad", bodyopt::bench::triad);
  benchmark::RunSpecifiedBenchmarks();
}
