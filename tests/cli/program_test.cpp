// The program as a user meets it: exit codes and messages.
#include <gtest/gtest.h>

#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>

#include "assets/caches/pc2.h"
#include "dataset/dataset.h"
#include "runtime/basis/basis.h"
#include "runtime/core/json.h"
#include "tests/support/no_vulkan_loader.h"
#include "tests/support/run_program.h"
#include "tests/support/run_verb.h"
#include "tests/support/temporary_folder.h"
#include "trainer/builtin/arm.h"
#include "trainer/train/skinning/ddm.h"
#include "trainer/train/skinning/unpose.h"

namespace bodyopt {
namespace {

using namespace trainer;

TEST(Program, HelpOfEveryVerbExitsWithZero) {
  EXPECT_EQ(run_verb("--help").exit_code, 0);
  for (const char* verb :
       {"demo", "muscles import", "rom", "simulate", "dataset add", "export", "check", "train", "test", "improve",
        "attach", "eval", "compare", "coverage", "picture", "regions", "info", "bench", "devices"}) {
    const ProgramResult result = run_verb(std::string(verb) + " --help");
    EXPECT_EQ(result.exit_code, 0) << verb;
    EXPECT_NE(result.output.find("--json"), std::string::npos) << verb;
  }
}

TEST(Program, WrongArgumentsExitWith64) {
  EXPECT_EQ(run_bodyopt("").exit_code, 64);
  EXPECT_EQ(run_bodyopt("frobnicate").exit_code, 64);
  EXPECT_EQ(run_bodyopt("eval").exit_code, 64);
  EXPECT_EQ(run_bodyopt("compare a.pc2 b.pc2 --fail-above minus").exit_code, 64);
  EXPECT_EQ(run_bodyopt("train --out x.safetensors").exit_code, 64);
}

TEST(Program, AloneItShowsItsVerbsAndAMisspeltOneGetsTheNearest) {
  const ProgramResult alone = run_bodyopt("");
  const std::size_t learning = alone.output.find("Learning:"), train = alone.output.find("  train "),
                    use = alone.output.find("Using it:");
  EXPECT_LT(learning, train);
  EXPECT_LT(train, use);
  EXPECT_NE(alone.output.find("bodyopt demo --quick"), std::string::npos) << alone.output;
  const ProgramResult misspelt = run_bodyopt("trian data --out x.safetensors");
  EXPECT_EQ(misspelt.exit_code, 64);
  EXPECT_NE(misspelt.output.find("the nearest is 'train'"), std::string::npos) << misspelt.output;
}

TEST(Program, AMisspeltOptionIsNamedWithTheNearest) {
  for (const auto& [command, told] :
       {std::pair{"eval x.safetensors --clp y.glb --out z.pc2", "'eval' has no option --clp; the nearest is --clip"},
        {"eval x.safetensors --clip y.glb --out z.pc2 --frame=1-2",
         "'eval' has no option --frame; the nearest is --frames"},
        {"curate add data drop --tke rom", "'add' has no option --tke; the nearest is --take"},
        {"--versoin", "'bodyopt' has no option --versoin; the nearest is --version"}}) {
    const ProgramResult misspelt = run_verb(command);
    EXPECT_EQ(misspelt.exit_code, 64) << command;
    EXPECT_NE(misspelt.output.find(told), std::string::npos) << misspelt.output;
  }
}

TEST(Program, HelpIsAVerbToo) {
  EXPECT_EQ(run_verb("help").output, run_verb("--help").output);
  const ProgramResult of_a_verb = run_verb("help curate");
  EXPECT_EQ(of_a_verb.exit_code, 0);
  EXPECT_EQ(of_a_verb.output, run_verb("curate --help").output);
  EXPECT_EQ(run_verb("help frobnicate").exit_code, 64);
  const ProgramResult misspelt = run_verb("hlep");
  EXPECT_NE(misspelt.output.find("the nearest is 'help'"), std::string::npos) << misspelt.output;
  EXPECT_NE(run_verb("--help").output.find("help VERB is VERB --help"), std::string::npos);
}

TEST(Program, MissingFilesExitWith4AndAreNamed) {
  for (const char* command :
       {"info nowhere.glb", "info nowhere.pc2", "check nowhere/dataset.json", "export nowhere.nodes --out b.pc2",
        "eval nowhere.safetensors --clip a.glb --out b.pc2 --device cpu", "train nowhere --out b.safetensors",
        "compare nowhere.pc2 nowhere.pc2", "regions nowhere --picture p.png", "picture nowhere --frame 1 --out p.png",
        "muscles import nowhere.glb --from a.osim b.json --out m.json",
        "dataset add nowhere --clip a.glb --shapes a.pc2"}) {
    const ProgramResult result = run_verb(command);
    EXPECT_EQ(result.exit_code, 4) << command << "\n" << result.output;
    EXPECT_NE(result.output.find("nowhere"), std::string::npos) << command;
  }
}

TEST(Program, CompareMeasuresAndFailsAboveTheLimit) {
  const TemporaryFolder folder;
  const std::vector<float> rest = {0, 0, 0, 1, 0, 0}, moved = {0, 0, 0, 1.003f, 0, 0};
  for (const auto& [name, sample] : {std::pair("a.pc2", rest), std::pair("b.pc2", moved)}) {
    Pc2Writer writer(folder / name, 2, 1);
    writer.append(sample);
    writer.close();
  }
  const std::string caches = (folder / "a.pc2").string() + " " + (folder / "b.pc2").string();
  EXPECT_EQ(run_bodyopt("compare " + caches + " --fail-above 3.1").exit_code, 0);
  const ProgramResult failed = run_bodyopt("compare " + caches + " --fail-above 2.9 --json -");
  EXPECT_EQ(failed.exit_code, 2);
  EXPECT_NE(failed.output.find("\"worst_vertex\": 1"), std::string::npos) << failed.output;
}

TEST(Program, RunsOnTheCpuWithoutVulkansLoader) {
  const NoVulkanLoader without;
  const TemporaryFolder folder;
  const std::string files = kSourceFolder + "/tests/old_files/", basis = files + "hero.safetensors";
  const std::string eval = " eval " + basis + " --clip " + files + "bend.glb --frames 1-4 --out ";
  const auto run = [&](const std::string& arguments) {
    return run_program(without.environment() + kProgram + arguments);
  };
  ProgramResult result = run(eval + (folder / "auto.pc2").string());
  EXPECT_EQ(result.exit_code, 0) << result.output;
  result = run_verb(eval + (folder / "cpu.pc2").string() + " --device cpu");
  ASSERT_EQ(result.exit_code, 0) << result.output;
  const Pc2Reader a(folder / "auto.pc2"), b(folder / "cpu.pc2");
  for (std::uint32_t k = 0; k < 4; ++k) EXPECT_EQ(a.sample(k), b.sample(k));
  for (const std::string& arguments : {std::string(" devices"), " bench " + basis + " --seconds 0.01"}) {
    result = run(arguments);
    EXPECT_EQ(result.exit_code, 0) << result.output;
    EXPECT_NE(result.output.find("cpu"), std::string::npos) << result.output;
  }

  for (const std::string& arguments : {eval + (folder / "none.pc2").string() + " --device 0",
                                       " view " + basis + " --headless -o " + (folder / "none.png").string()}) {
    result = run(arguments);
    EXPECT_EQ(result.exit_code, 5) << result.output;
    EXPECT_NE(result.output.find("Debian package: libvulkan1"), std::string::npos) << result.output;
  }
  EXPECT_FALSE(std::filesystem::exists(folder / "none.pc2"));
}

TEST(Program, UntrainedBasisOfTheBuiltinArmEvaluatesOnTheCpu) {
  const TemporaryFolder folder;
  const BuiltinArm arm = build_arm();
  const std::string character = (folder / "arm.glb").string(), clip = (folder / "clip.glb").string();
  const std::string basis = (folder / "arm.safetensors").string(), cache = (folder / "out.pc2").string();
  write_character(arm.character, character);
  write_clip(arm_heldout(arm.character.skeleton, 10), arm.character.skeleton, clip);

  ProgramResult result = run_verb("train --ddm-only " + character + " --out " + basis);
  ASSERT_EQ(result.exit_code, 0) << result.output;
  EXPECT_EQ(run_verb("info " + basis).exit_code, 0);
  result = run_verb("eval " + basis + " --clip " + clip + " --frames 1-9x2 --device cpu --out " + cache);
  ASSERT_EQ(result.exit_code, 0) << result.output;
  const Pc2Reader reader(cache);
  EXPECT_EQ(reader.sample_count(), 5u);
  EXPECT_EQ(reader.point_count(), arm.character.output_count());
  EXPECT_EQ(reader.start_frame(), 1);
  EXPECT_EQ(reader.sample_rate(), 2);  // every second frame
  EXPECT_EQ(result.output.find("expected error"), std::string::npos) << result.output;
  // Nothing was learned that could cover anything.
  EXPECT_EQ(run_verb("coverage " + basis + " --clip " + clip).exit_code, 3);
  // A slip that would write over the character.
  EXPECT_EQ(run_verb("eval " + basis + " --clip " + clip + " --device cpu --out " + character).exit_code, 64);
  EXPECT_EQ(run_verb("info " + character).exit_code, 0);

  EXPECT_EQ(run_verb("eval " + basis + " --clip " + clip + " --frames 5-99 --device cpu --out " + cache).exit_code, 64);
  EXPECT_EQ(run_verb("eval " + basis + " --clip " + clip + " --device nosuch --out " + cache).exit_code, 5);
  EXPECT_EQ(run_verb("eval " + basis + " --clip " + clip + " --device cpu --out /nonexistent/x.pc2").exit_code, 4);

  // Half a basis is refused, and the cache of the earlier run is left as it was.
  std::filesystem::resize_file(basis, std::filesystem::file_size(basis) / 2);
  EXPECT_EQ(run_verb("eval " + basis + " --clip " + clip + " --device cpu --out " + cache).exit_code, 4);
  EXPECT_EQ(Pc2Reader(cache).sample_count(), 5u);
}

// A dataset of the built-in arm, skinned linearly.
Dataset write_small_dataset(const TemporaryFolder& folder) {
  const BuiltinArm arm = build_arm();
  const Clip clip = arm_heldout(arm.character.skeleton, 14);
  write_character(arm.character, folder / "arm.glb");
  write_clip(clip, arm.character.skeleton, folder / "clip.glb");
  Pc2Writer writer(folder / "shapes.pc2", arm.character.output_count(), 14);
  for (const Pose& pose : clip.poses)
    writer.append(output_from_welded(arm.character, skin_linear(arm.character, pose)));
  writer.close();
  Dataset dataset;
  dataset.character = "arm.glb";
  DatasetTake& take = dataset.takes.emplace_back();
  take.name = "bend";
  take.clip = "clip.glb";
  take.shapes = "shapes.pc2";
  for (int frame = 1; frame <= 14; ++frame) take.frames.push_back(frame);
  write_dataset(dataset, folder / "dataset.json");
  return dataset;
}

TEST(Program, NamesMayBeAnyBytesAndNoneIsADefect) {
  const TemporaryFolder folder;
  const BuiltinArm arm = build_arm();
  const std::string clip = (folder / "clip.glb").string(), name = (folder / "caf\xe9 1").string();  // not UTF-8
  const std::string basis = "'" + name + ".safetensors'", cache = "'" + name + ".pc2'";
  write_character(arm.character, name + ".glb");
  write_clip(arm_heldout(arm.character.skeleton, 2), arm.character.skeleton, clip);
  const ProgramResult trained = run_verb("train --ddm-only '" + name + ".glb' --out " + basis);
  EXPECT_EQ(trained.exit_code, 0) << trained.output;
  const std::string frames = " --clip " + clip + " --device cpu --json - --out " + cache;
  const ProgramResult evaluated = run_verb("eval " + basis + frames);
  EXPECT_EQ(evaluated.exit_code, 0) << evaluated.output;
  EXPECT_NE(evaluated.output.find("caf\xef\xbf\xbd 1.pc2"), std::string::npos) << evaluated.output;
  // So long that no file can lie beside it.
  const std::filesystem::path longest = folder / (std::string(242, 'n') + ".safetensors");
  std::filesystem::copy_file(name + ".safetensors", longest);
  const ProgramResult refused = run_verb("eval " + longest.string() + frames);
  EXPECT_EQ(refused.exit_code, 4) << refused.output;
  EXPECT_NE(refused.output.find("too long"), std::string::npos) << refused.output;
}

TEST(Program, RegionsAreWrittenReadBackAndRefused) {
  const TemporaryFolder folder;
  Dataset dataset = write_small_dataset(folder);
  const std::string verb = "regions " + folder.path().string(), regions = (folder / "regions.json").string();
  const auto list = [&](const std::string& more) {
    const std::string json = (folder / "list.json").string();
    const ProgramResult result = run_verb(verb + more + " --json " + json);
    EXPECT_EQ(result.exit_code, 0) << result.output;
    std::ifstream file(json);
    return Json::parse(file)["regions"];
  };
  Json first = list(" --out " + regions);
  EXPECT_EQ(first[0]["from"], "training");
  dataset.regions = "regions.json";
  write_dataset(dataset, folder / "dataset.json");
  for (Json& region : first) region["from"] = "file";
  EXPECT_EQ(list(""), first);
  EXPECT_EQ(run_verb(verb + " --out " + regions).exit_code, 64);  // the file that the dataset names

  std::ifstream file(regions);
  const Json good = Json::parse(file);
  const auto exit_code = [&](const Json& bad) {
    std::ofstream(regions) << bad;
    const int code = run_verb(verb).exit_code;
    EXPECT_EQ(run_verb("check " + folder.path().string()).exit_code, code);
    return code;
  };
  Json bad = good;
  bad["vertex_count"] = 7;
  EXPECT_EQ(exit_code(bad), 3);
  bad = good;
  bad["regions"] = Json::array({good["regions"][0]});
  EXPECT_EQ(exit_code(bad), 3);  // uncovered
  bad["complete"] = false;
  EXPECT_EQ(exit_code(bad), 0);
  bad["regions"][0]["weights"][0] = -1;
  EXPECT_EQ(exit_code(bad), 4);
}

TEST(Program, BenchTellsOfEveryBatchSize) {
  const TemporaryFolder folder;
  const std::string basis = (folder / "arm.safetensors").string(), json = (folder / "bench.json").string();
  save_basis(build_ddm_basis(build_arm().character, {}), basis);
  const std::string verb = "bench " + basis + " --device cpu --one-thread --seconds 0.01 --json ";
  const ProgramResult result = run_verb(verb + json);
  ASSERT_EQ(result.exit_code, 0) << result.output;
  std::ifstream file(json);
  const Json found = Json::parse(file);
  std::vector<int> batches, bodies;
  double last_bytes = std::numeric_limits<double>::infinity();
  for (const Json& row : found["measured"]) {
    EXPECT_EQ(row["device"], "cpu");
    EXPECT_GT(row["frame_ms"].get<double>(), row["stage_ms"]["pose"].get<double>());
    EXPECT_LT(row["stage_ms"]["strain"].get<double>(), row["stage_ms"]["pose"].get<double>());  // there is none
    double host = row["stage_ms"]["rig"].get<double>();
    for (const char* part : {"upload", "wait", "download", "order"}) host += row["host_ms"][part].get<double>();
    EXPECT_LE(host, row["frame_ms"].get<double>());
    EXPECT_GT(host, 0.5 * row["frame_ms"].get<double>());
    EXPECT_EQ(row["host_ms"]["upload"], 0);
    // The table is read once a batch: a frame of more has to read less, and does so within the memory's speed.
    const double bytes = row["stage_bytes"]["pose"];
    EXPECT_LT(bytes, last_bytes);
    last_bytes = bytes;
    EXPECT_NEAR(row["stage_of_limit"]["pose"].get<double>(),
                bytes / row["memory_bytes_per_second"].get<double>() / (1e-3 * row["stage_ms"]["pose"].get<double>()),
                1e-6);
    batches.push_back(row["batch"]);
  }
  EXPECT_EQ(batches, (std::vector<int>{1, 4, 16, 64}));
  for (const Json& row : found["instances"]) bodies.push_back(row["instances"]);
  EXPECT_EQ(bodies, (std::vector<int>{4, 16}));
  EXPECT_EQ(found["jiggle"], Json::array());
  EXPECT_EQ(run_verb("bench " + (folder / "none.safetensors").string()).exit_code, 4);
  EXPECT_EQ(run_verb("bench " + basis + " --device nowhere").exit_code, 5);
}

// By the XDG Base Directory Specification, which has relative paths ignored.
TEST(Program, PipelinesAreKeptInTheUsersCache) {
  const TemporaryFolder folder;
  const std::string home = folder.path();
  const std::string verb =
      kProgram + " bench " + kSourceFolder + "/tests/old_files/hero.safetensors --device 0 --seconds 0.01";
  const auto is_kept = [&](const std::string& environment, const std::filesystem::path& kept) {
    // From there: Mesa takes relative paths, too, and would leave a folder wherever the tests run.
    const ProgramResult result = run_program("cd " + home + " && " + environment + " " + verb);
    EXPECT_EQ(result.exit_code, 0) << result.output;
    return std::filesystem::is_directory(kept) && !std::filesystem::is_empty(kept);
  };
  EXPECT_TRUE(is_kept("XDG_CACHE_HOME=" + home + "/caches HOME=" + home, folder / "caches/bodyopt"));
  EXPECT_FALSE(std::filesystem::exists(folder / ".cache/bodyopt"));
  EXPECT_TRUE(is_kept("XDG_CACHE_HOME=relative HOME=" + home, folder / ".cache/bodyopt"));
  EXPECT_FALSE(is_kept("env -u HOME -u XDG_CACHE_HOME", folder / "none"));
}

}  // namespace
}  // namespace bodyopt
