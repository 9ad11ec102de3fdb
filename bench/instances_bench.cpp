// Times a frame of each of many instances of one character on a Vulkan device. They run one after the other, in one
// call, and, where only poses differ, as frames of one instance. Time is on the clock, and of the processors.
// BODYOPT_BENCH_BASIS is the trained character; BODYOPT_BENCH_DEVICE names another device than the best one.
#include <benchmark/benchmark.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <vector>

#include "include/bodyopt/bodyopt.hpp"

namespace bodyopt::bench {
namespace {

// A pose of each instance, and memory for its skin.
struct Cast {
  Cast(const api::Model& model, std::uint32_t count)
      : description(api::describe(model)), numbers(10 * description.joint_count), joints(count * numbers) {
    std::vector<double> bind(numbers);
    api::check(bodyopt_get_bind_pose(model.get(), bind.data(), numbers * sizeof(double)));
    positions.resize(std::size_t{3} * description.vertex_count * count);
    normals.resize(positions.size());
    for (std::uint32_t k = 0; k < count; ++k) {
      double* pose = &joints[k * numbers];
      std::ranges::copy(bind, pose);
      const double half = 0.05 * (1 + k % 5);  // the last joint turns about its x
      pose[numbers - 7] = std::sin(half);
      pose[numbers - 6] = pose[numbers - 5] = 0;
      pose[numbers - 4] = std::cos(half);
    }
  }

  // Returns the poses of `count` instances from number `first` on.
  bodyopt_poses poses_of(std::uint32_t first, std::uint32_t count) const {
    auto poses = api::make<bodyopt_poses>();
    poses.frame_count = count;
    poses.joint_count = description.joint_count;
    poses.joints = &joints[first * numbers];
    return poses;
  }
  bodyopt_skin skin_of(std::uint32_t first, std::uint32_t count) {
    const std::size_t size = std::size_t{3} * description.vertex_count;
    auto skin = api::make<bodyopt_skin>();
    skin.positions = {&positions[first * size], count * size * sizeof(float), 0, 0};
    skin.normals = {&normals[first * size], count * size * sizeof(float), 0, 0};
    return skin;
  }

  bodyopt_description description;
  std::size_t numbers;  // of a pose
  std::vector<double> joints;
  std::vector<float> positions, normals;
};

struct Stage {
  explicit Stage(const char* basis) : model(api::load_model(basis)) {
    const char* name = std::getenv("BODYOPT_BENCH_DEVICE");
    device = api::open_device(name != nullptr ? name : "");
  }
  api::Instance instance() const {
    auto options = api::make<bodyopt_instance_options>();
    options.device = device.get();
    return api::create_instance(model, options);
  }

  api::Model model;
  api::Device device;
};

void one_by_one(benchmark::State& state, const Stage& stage, std::uint32_t count) {
  Cast cast(stage.model, count);
  std::vector<api::Instance> instances;
  for (std::uint32_t k = 0; k < count; ++k) instances.push_back(stage.instance());
  for (auto _ : state) {
    for (std::uint32_t k = 0; k < count; ++k) {
      const bodyopt_poses poses = cast.poses_of(k, 1);
      const bodyopt_skin skin = cast.skin_of(k, 1);
      api::check(bodyopt_evaluate(instances[k].get(), &poses, &skin));
    }
  }
}

void together(benchmark::State& state, const Stage& stage, std::uint32_t count) {
  Cast cast(stage.model, count);
  std::vector<api::Instance> instances;
  std::vector<bodyopt_poses> poses;
  std::vector<bodyopt_skin> skins;
  for (std::uint32_t k = 0; k < count; ++k) {
    instances.push_back(stage.instance());
    poses.push_back(cast.poses_of(k, 1));
    skins.push_back(cast.skin_of(k, 1));
  }
  std::vector<bodyopt_call> calls(count, api::make<bodyopt_call>());
  for (std::uint32_t k = 0; k < count; ++k) {
    calls[k].instance = instances[k].get();
    calls[k].poses = &poses[k];
    calls[k].skin = &skins[k];
  }
  for (auto _ : state) api::evaluate_together(calls);
}

void frames_of_one(benchmark::State& state, const Stage& stage, std::uint32_t count) {
  Cast cast(stage.model, count);
  const api::Instance instance = stage.instance();
  const bodyopt_poses poses = cast.poses_of(0, count);
  const bodyopt_skin skin = cast.skin_of(0, count);
  for (auto _ : state) api::check(bodyopt_evaluate(instance.get(), &poses, &skin));
}

}  // namespace
}  // namespace bodyopt::bench

int main(int argc, char** argv) {
  using namespace bodyopt::bench;
  benchmark::Initialize(&argc, argv);
  const char* basis = std::getenv("BODYOPT_BENCH_BASIS");
  if (basis == nullptr) {
    std::fputs("instances_bench: BODYOPT_BENCH_BASIS names no trained character, nothing is measured\n", stderr);
    return 0;
  }
  const Stage stage(basis);
  for (const std::uint32_t count : {1, 4, 16}) {
    const auto add = [&](const char* name, auto function) {
      benchmark::RegisterBenchmark(
          (std::to_string(count) + "/" + name).c_str(),
          [&stage, function, count](benchmark::State& state) { function(state, stage, count); })
          ->Unit(benchmark::kMillisecond)
          ->UseRealTime()
          ->MeasureProcessCPUTime();
    };
    add("one by one", one_by_one);
    add("together", together);
    add("frames of one", frames_of_one);
  }
  benchmark::RunSpecifiedBenchmarks();
}
