// The whole path by the program itself, small: `bodyopt demo --quick`, and the other verbs on what it leaves.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "assets/caches/nodes_cache.h"
#include "assets/caches/pc2.h"
#include "assets/caches/shape_reader.h"
#include "dataset/compare.h"
#include "dataset/dataset.h"
#include "runtime/core/json.h"
#include "tests/support/decoded_animation.h"
#include "tests/support/read_bytes.h"
#include "tests/support/run_verb.h"
#include "tests/support/temporary_folder.h"

namespace bodyopt {
namespace {

// A row of the ablation in a report.
const Json& method(const Json& report, const std::string& name) {
  for (const Json& row : report["methods"]) {
    if (row["name"] == name) return row;
  }
  throw std::runtime_error("no method '" + name + "'");
}

// The draft is of the same frames as the full simulation it is held against, and as far from it as the report says.
void expect_draft(const std::filesystem::path& demo, const Json& report) {
  const Dataset draft = read_dataset(demo / "draft" / "dataset.json");
  const Dataset dataset = read_dataset(demo / "dataset" / "dataset.json");
  ASSERT_EQ(draft.takes.size(), 2u);
  const DatasetTake &take = draft.takes.back(), &full = dataset.takes.back();
  EXPECT_EQ(take.name, full.name);
  EXPECT_EQ(take.clip, full.clip);
  EXPECT_EQ(take.frames, full.frames);
  EXPECT_EQ(take.heldout, full.heldout);
  EXPECT_TRUE(unconverged_frames(draft, take).empty());
  const ShapeReader shapes(draft.folder / take.shapes), truth(dataset.folder / full.shapes);
  EXPECT_EQ(shapes.sample_count(), take.frames.size());
  EXPECT_EQ(shapes.start_frame(), static_cast<float>(take.frames.front()));
  EXPECT_EQ(shapes.sample_rate(), truth.sample_rate());
  EXPECT_EQ(shapes.point_count(), truth.point_count());
  EXPECT_LT(NodesReader(draft.folder / take.shapes).node_count(), truth.point_count());
  EXPECT_EQ(run_verb("check " + draft.folder.string()).exit_code, 0);

  const std::set<int> unsolved = unconverged_frames(dataset, full);
  ErrorAccumulator errors(truth.point_count());
  for (std::uint32_t k = 0; k < truth.sample_count(); ++k) {
    if (!unsolved.contains(full.frames[k])) errors.add(full.frames[k], shapes.sample(k), truth.sample(k));
  }
  const ErrorStatistics expected = errors.finish();
  const double rms = report["simulation"]["draft_rms_mm"], max = report["simulation"]["draft_max_mm"];
  EXPECT_NEAR(rms, expected.rms, 1e-3);
  EXPECT_NEAR(max, expected.max, 1e-3);
  EXPECT_GT(rms, 0.1);  // a draft, not the full simulation once more
  EXPECT_LT(rms, method(report, "DDM")["errors_mm"]["rms"]);
  EXPECT_LT(max, 100);  // twice what it is
  EXPECT_GT(report["seconds"]["draft"], 0);
}

// A pose that is held has no displacement at all; after the stop the flesh swings, and comes to rest.
void expect_jiggle(const std::filesystem::path& demo, const Json& report) {
  const Json& jiggle = report["jiggle"];
  const auto largest = jiggle["frame_max_mm"].get<std::vector<double>>();
  const auto moves_after = jiggle["moves_after"].get<std::size_t>(), stops = jiggle["stops"].get<std::size_t>();
  ASSERT_GT(largest.size(), stops + 24);
  for (std::size_t frame = 1; frame < moves_after; ++frame) EXPECT_EQ(largest[frame - 1], 0) << frame;
  // Keys and times are in single precision, in the clip and in the file that it was made from: a trace of the next.
  EXPECT_LT(largest[moves_after - 1], 1e-3);
  EXPECT_GT(largest[moves_after], 0);
  const double peak = *std::max_element(largest.begin(), largest.end());
  EXPECT_GT(peak, 5);  // seen
  EXPECT_LT(peak, 30);
  EXPECT_EQ(std::max(largest[stops - 1], largest[stops]), peak);
  for (std::size_t frame = stops + 24; frame <= largest.size(); ++frame) EXPECT_LT(largest[frame - 1], 0.05 * peak);
  EXPECT_GT(jiggle["tets"], 10000);
  EXPECT_GT(jiggle["worst_quality"], 0);

  const std::string animation = testing::read_bytes(demo / "stop.webp");
  const DecodedAnimation decoded = decode_animation({animation.begin(), animation.end()});
  ASSERT_FALSE(decoded.ends.empty());
  EXPECT_EQ(decoded.ends.back(), std::lround(1000.0 * static_cast<double>(largest.size()) / 24));
  EXPECT_GT(decoded.ends.size(), stops - moves_after);
  const std::string slow = testing::read_bytes(demo / "stop_slow.webp");
  EXPECT_EQ(decode_animation({slow.begin(), slow.end()}).ends.back(),
            std::lround(2000.0 * static_cast<double>(largest.size()) / 24));
}

TEST(Demo, QuickRunLeavesEverythingAndTheVerbsReadIt) {
#ifdef BODYOPT_SANITIZED
  GTEST_SKIP() << "the sanitizers make a simulation of 60 frames take most of an hour; its parts are tested alone";
#endif
  const TemporaryFolder folder;
  const std::string out = folder.path().string();
  const ProgramResult demo = run_verb("demo --quick --all --out " + out);
  ASSERT_EQ(demo.exit_code, 0) << demo.output;
  for (const char* name : {"character.glb",
                           "muscles.json",
                           "rom.glb",
                           "heldout.glb",
                           "dataset/dataset.json",
                           "dataset/rom.pc2",
                           "dataset/rom.status.json",
                           "draft/dataset.json",
                           "draft/heldout.nodes",
                           "draft/heldout.status.json",
                           "first.safetensors",
                           "basis.safetensors",
                           "heldout.pc2",
                           "report.html",
                           "report.json",
                           "stop.glb",
                           "jiggle.json",
                           "basis.dynamics.safetensors",
                           "stop_strip.png",
                           "stop.webp",
                           "stop_slow.webp",
                           "stocky.glb",
                           "stocky.safetensors",
                           "transfer.html"}) {
    EXPECT_TRUE(std::filesystem::exists(folder / name)) << name;
  }

  const Json report = Json::parse(std::ifstream(folder / "report.json"));
  const auto& box = report["character"]["bounding_box_m"];
  const double size = std::hypot(box[0].get<double>(), box[1].get<double>(), box[2].get<double>());
  EXPECT_GE(report["character"]["vertices"], 6000);
  EXPECT_NE(report["device"], "cpu");
  EXPECT_GE(report["character"]["joints"], 8);
  EXPECT_GE(report["character"]["muscles"], 12);
  EXPECT_LE(report["cpu_gpu_max_difference_m"].get<double>(), 1e-5 * size);
  const std::string full = "full: DDM + strains, kernels, dynamic";
  const auto rms = [&](const std::string& name) { return method(report, name)["errors_mm"]["rms"].get<double>(); };
  EXPECT_EQ(report["methods"].size(), 12u);  // all rows of the ablation
  EXPECT_EQ(report["methods"].back()["name"], full);
  // Forty-eight frames are too few for the claim that the whole demo makes (half of DDM's error), but what was learned
  // must already help.
  EXPECT_LT(rms(full), 0.8 * rms("DDM"));
  EXPECT_LT(rms("DDM"), rms("LBS"));
  EXPECT_LT(report["unposing_residual_mm"]["ddm"], report["unposing_residual_mm"]["lbs"]);
  // Linear correctives may have as many bytes as the full model; of so few frames they learn less than that.
  EXPECT_GT(method(report, full)["coefficients"], 0);
  for (const char* linear : {"DDM + joints, linear, dense", "DDM + joints, linear, local"}) {
    EXPECT_GT(method(report, linear)["coefficients"], 0) << linear;
    EXPECT_LE(method(report, linear)["bytes_per_vertex"], method(report, full)["bytes_per_vertex"]) << linear;
    EXPECT_NE(demo.output.find(linear), std::string::npos) << demo.output;
  }
  EXPECT_EQ(report["flexed"]["take"], "flexed");
  EXPECT_EQ(report["flexed"]["controls"].size(), 1u) << report["flexed"];  // the groups flex in turns
  EXPECT_GT(report["flexed"]["max_mm"], 1);
  EXPECT_LT(report["flexed"]["max_mm"], 12);  // twice what all frames teach
  EXPECT_EQ(report["trade_off"][0]["coefficients"], 0);
  EXPECT_GT(report["trade_off"].size(), 10u);

  EXPECT_EQ(run_verb("check " + out + "/dataset").exit_code, 0);
  for (const char* name : {"character.glb", "rom.glb", "dataset/dataset.json", "basis.safetensors", "heldout.pc2"}) {
    EXPECT_EQ(run_verb("info " + out + "/" + name).exit_code, 0) << name;
  }
  expect_draft(folder.path(), report);
  expect_jiggle(folder.path(), report);
  // What `eval` makes of the stored basis on the CPU is what the demo got from its device.
  const ProgramResult eval =
      run_verb("eval " + out + "/basis.safetensors --clip " + out + "/heldout.glb --frames 1-24x3 --device cpu --out " +
               out + "/again.pc2 --json " + out + "/eval.json");
  ASSERT_EQ(eval.exit_code, 0) << eval.output;
  const Pc2Reader again(folder / "again.pc2"), heldout(folder / "heldout.pc2");
  EXPECT_EQ(heldout.start_frame(), again.start_frame());
  EXPECT_EQ(heldout.sample_rate(), again.sample_rate());
  // The truth's errors as `coverage` measures them are those of the report; the strip has a column per frame.
  const ProgramResult coverage = run_verb(
      "coverage " + out + "/basis.safetensors --clip " + out + "/heldout.glb --frames 1-24x3 --worst 3" + " --truth " +
      out + "/dataset/heldout.pc2 --picture " + out + "/strip.svg --json " + out + "/coverage.json");
  ASSERT_EQ(coverage.exit_code, 0) << coverage.output;
  const Json covered = Json::parse(std::ifstream(folder / "coverage.json"));
  ASSERT_EQ(covered["per_frame"].size(), heldout.sample_count());
  const Json evaluated = Json::parse(std::ifstream(folder / "eval.json"));
  ASSERT_EQ(evaluated["per_frame"].size(), heldout.sample_count());
  double sum = 0;
  for (std::size_t k = 0; k < covered["per_frame"].size(); ++k) {
    const Json& frame = covered["per_frame"][k];
    EXPECT_GT(frame["expected_rms_mm"], 0);
    EXPECT_EQ(evaluated["per_frame"][k]["frame"], frame["frame"]);
    EXPECT_EQ(evaluated["per_frame"][k]["expected_rms_mm"], frame["expected_rms_mm"]);
    EXPECT_GE(evaluated["per_frame"][k]["outside"], 0);
    EXPECT_EQ(report["coverage"]["frame_expected_rms_mm"][k], frame["expected_rms_mm"]);
    sum += std::pow(frame["true_rms_mm"].get<double>(), 2);
  }
  EXPECT_NEAR(std::sqrt(sum / static_cast<double>(covered["per_frame"].size())), rms(full), 2e-3);
  EXPECT_LE(std::abs(covered["rank_correlation"].get<double>()), 1);
  EXPECT_TRUE(std::filesystem::exists(folder / "strip.svg"));

  const ProgramResult compare = run_verb("compare " + out + "/again.pc2 " + out + "/heldout.pc2 --fail-above 0.01");
  EXPECT_EQ(compare.exit_code, 0) << compare.output;
}

}  // namespace
}  // namespace bodyopt
