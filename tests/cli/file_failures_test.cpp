// Files, limits and options that fail: exit codes, and that nothing is written over, left behind or lost.
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <fstream>
#include <map>
#include <nlohmann/json.hpp>

#include "dataset/dataset.h"
#include "runtime/core/atomic_file.h"
#include "tests/cli/limb_files.h"
#include "tests/support/background_program.h"
#include "tests/support/hostile_bytes.h"
#include "tests/support/read_bytes.h"
#include "tests/support/run_program.h"
#include "tests/support/run_verb.h"

namespace bodyopt {
namespace {

namespace fs = std::filesystem;
using namespace testing;

class FileFailures : public ::testing::Test {
 protected:
  FileFailures() : files_(folder_, 1) {}
  std::string at(const std::string& name) const { return (folder_ / name).string(); }
  std::size_t entries() const {
    return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder_.path()), {}));
  }
  std::string simulate(const std::string& out) const {
    return "simulate " + files_.character + " --clip " + files_.motion + " --draft --out " + out;
  }
  std::string clip_of_24_frames() const {
    return " --clip " + files_.motion + " --fps 120 --frames 1-24 --draft --out ";
  }
  static void expect(const ProgramResult& result, int exit_code, const std::string& named) {
    EXPECT_EQ(result.exit_code, exit_code) << result.output;
    EXPECT_NE(result.output.find(named), std::string::npos) << named << " is not in:\n" << result.output;
  }

  TemporaryFolder folder_;
  LimbFiles files_;
};

// A file whose bytes cannot be read, as on a disk that fails: no defect of the program.
TEST_F(FileFailures, AFailureOfReadingIsAnErrorOfTheFile) {
  for (const char* name : {"a.glb", "a.gltf", "a.bvh", "a.safetensors", "a.pc2", "dataset.json"}) {
    fs::create_symlink("/proc/self/mem", folder_ / name);
    expect(run_verb("info " + at(name)), 4, at(name));
  }
  fs::create_symlink("/proc/self/mem", folder_ / "a.xml");
  expect(run_verb("muscles import " + files_.character + " --from " + at("a.xml") + " " + at("dataset.json") +
                  " --out " + at("muscles.json")),
         4, "cannot be read to its end");
}

// What a slip of the hand names as an output keeps its bytes: an input, another output, a file of another kind.
TEST_F(FileFailures, ResultsTakeThePlaceOfNothingElse) {
  const std::string basis = at("limb.safetensors"), cache = at("shot.pc2"), report = at("report.json"),
                    limits = at("limits.json"), muscles = at("muscles.json");
  std::ofstream(muscles) << R"({"schema": "bodyopt-muscles-1", "muscles": []})";
  std::ofstream(limits) << R"({"schema": "bodyopt-joint-limits-1", "dofs": [{"name": "bend", "rest": 0, "min": 0,
 "max": 90, "turns": [{"joint": "lower", "axis": [1, 0, 0]}]}]})";
  ASSERT_EQ(run_verb("train --ddm-only " + files_.character + " --out " + basis).exit_code, 0);
  ASSERT_EQ(run_verb("rom " + files_.character + " --limits " + limits + " --out " + at("rom.glb")).exit_code, 0);
  const std::string eval = "eval " + basis + " --clip " + files_.motion + " --device cpu --out ";
  ASSERT_EQ(run_verb(eval + cache + " --json " + report).exit_code, 0);
  std::ofstream(at("foreign.glb")) << "glTF, of another program";
  const std::pair<std::string, std::string> slips[] = {
      {"check " + files_.character + " --json ", files_.character},
      {"info " + basis + " --json ", basis},
      {"devices --json ", muscles},
      {"devices --json ", cache},
      {"compare " + cache + " " + cache + " --json ", cache},
      {eval + cache + " --json ", files_.motion},
      {eval + at("./shot.pc2") + " --json ", cache},
      {"check " + files_.character + " --limits " + limits + " --clip " + files_.motion + " --json ", limits},
      {"rom " + files_.character + " --limits " + limits + " --out ", at("foreign.glb")},
      {"train --ddm-only " + files_.character + " --out ", at("muscles.safetensors")},
  };
  fs::copy_file(muscles, at("muscles.safetensors"));
  for (const auto& [command, file] : slips) {
    const std::string bytes = read_bytes(file);
    expect(run_verb(command + file), 64, fs::path(file).filename());
    EXPECT_EQ(read_bytes(file), bytes) << command << file;
  }
  // Of two that are not there yet, too.
  expect(run_verb(eval + at("new.pc2") + " --json " + at("new.pc2")), 64, "another output");
  EXPECT_FALSE(fs::exists(at("new.pc2")));
  // A report takes the place of a report, and of what is damaged.
  EXPECT_EQ(run_verb(eval + cache + " --json " + report).exit_code, 0);
  std::ofstream(report) << "{\"cut o";
  EXPECT_EQ(run_verb("anatomy " + files_.character + " --json " + report).exit_code, 0);
  EXPECT_EQ(run_verb("anatomy " + files_.character + " --json " + report).exit_code, 0);
}

// A limit on the size of files is as a full disk is.
TEST_F(FileFailures, ALimitOnTheSizeOfFilesIsAnErrorOfTheFile) {
  ASSERT_EQ(run_verb("train --ddm-only " + files_.character + " --out " + at("limb.safetensors")).exit_code, 0);
  const std::size_t before = entries();
  for (const std::string& command :
       {"train --ddm-only " + files_.character + " --out " + at("again.safetensors"),
        "eval " + at("limb.safetensors") + " --clip " + files_.motion + " --device cpu --out " + at("out.pc2")}) {
    expect(run_program("ulimit -f 1; exec " + kProgram + " " + command), 4, "File too large");
    EXPECT_EQ(entries(), before) << command;
  }
  expect(run_program("ulimit -f 1; exec " + kProgram + " " + simulate(at("data"))), 4, "File too large");
  EXPECT_FALSE(fs::exists(folder_ / "data/dataset.json"));
  expect(run_verb(simulate(at("data"))), 0, "wrote");  // nothing that was left stands in the way
}

TEST_F(FileFailures, LinksInThePlaceOfAPartialFileOrALockAreNotFollowed) {
  for (const char* name : {"bend.nodes.partial", "bend.lock", ".dataset.json.lock"}) {
    fs::remove_all(folder_ / "data");
    fs::create_directory(folder_ / "data");
    write_bytes(folder_ / "precious", "as it was");
    fs::create_symlink(folder_ / "precious", folder_ / "data" / name);
    expect(run_verb(simulate(at("data"))), 4, name);
    EXPECT_TRUE(read_bytes(folder_ / "precious") == "as it was") << name;
    EXPECT_FALSE(fs::exists(folder_ / "data/bend.nodes"));  // refused before the work
  }
}

TEST_F(FileFailures, ANameThatJsonCannotHoldIsRefusedBeforeTheWork) {
  const std::string name = "no\xfftext";
  fs::create_directory(folder_ / name);
  fs::copy_file(files_.character, folder_ / name / "limb.glb");
  fs::copy_file(files_.motion, folder_ / name / "bend.glb");
  expect(run_verb("simulate " + at(name + "/limb.glb") + " --clip " + files_.motion + " --draft --out " + at("a")), 4,
         "not UTF-8");
  expect(run_verb("simulate " + files_.character + " --clip " + at(name + "/bend.glb") + " --draft --out " + at("b")),
         4, "not UTF-8");
  for (const char* data : {"a", "b"}) {
    for (const fs::directory_entry& entry : fs::directory_iterator(folder_ / data)) {
      EXPECT_EQ(entry.path().filename(), ".dataset.json.lock");
    }
  }
  const std::string inside = at(name + "/data");  // where no name in the file has to tell of it
  expect(
      run_verb("simulate " + at(name + "/limb.glb") + " --clip " + at(name + "/bend.glb") + " --draft --out " + inside),
      0, "wrote");
  expect(run_verb("check " + inside), 0, "");
}

TEST_F(FileFailures, ANumberSignInTheNameOfAClipsFileIsPartOfIt) {
  fs::create_directory(folder_ / "shots#2");
  fs::rename(files_.motion, folder_ / "shots#2/bend#4.glb");
  const std::string clip = at("shots#2/bend#4.glb"), data = at("data");
  const std::string command = "simulate " + files_.character + " --fps 120 --draft --out " + data + " --clip ";
  expect(run_verb(command + clip + " --frames 1-24"), 0, "wrote");
  expect(run_verb(command + clip + "#bend --name named --frames 1-2"), 0, "wrote");
  const Dataset dataset = read_dataset(data + "/dataset.json");
  ASSERT_EQ(dataset.takes.size(), 2u);
  EXPECT_EQ(dataset.takes[0].clip, "../shots#2/bend#4.glb");
  EXPECT_EQ(dataset.takes[0].name, "bend_4");
  EXPECT_EQ(dataset.takes[1].clip, "../shots#2/bend#4.glb#bend");
  expect(run_verb("train " + data + " --out " + at("limb.safetensors") + " --report " + at("report")), 0, "wrote");
  EXPECT_TRUE(fs::exists(folder_ / "report/report.html"));
}

TEST_F(FileFailures, ANumberSignInAFoldersNameIsNoFirstFrame) {
  ASSERT_EQ(run_verb("train --ddm-only " + files_.character + " --out " + at("limb.safetensors")).exit_code, 0);
  fs::create_directory(folder_ / "d#1");
  const std::string eval = "eval " + at("limb.safetensors") + " --clip " + files_.motion + " --device cpu --out ";
  expect(run_verb(eval + at("d#1/all.pc2")), 0, "wrote");
  expect(run_verb(eval + at("d#1/s.##.pc2") + " --frames 2-3"), 0, "wrote");
  EXPECT_TRUE(fs::exists(folder_ / "d#1/all.pc2"));
  EXPECT_TRUE(fs::exists(folder_ / "d#1/s.02.pc2"));
}

TEST_F(FileFailures, ALinkToAFileThatIsNotThereYetIsWrittenThrough) {
  fs::create_directory(folder_ / "scratch");
  fs::create_symlink("scratch/limb.safetensors", folder_ / "limb.safetensors");
  expect(run_verb("train --ddm-only " + files_.character + " --out " + at("limb.safetensors")), 0, "wrote");
  EXPECT_TRUE(fs::is_symlink(folder_ / "limb.safetensors"));
  EXPECT_TRUE(fs::is_regular_file(folder_ / "scratch/limb.safetensors"));
}

TEST_F(FileFailures, LinksThatLeadBackToThemselvesAndLongNamesAreToldInWords) {
  fs::create_symlink("loop.glb", folder_ / "loop.glb");
  const std::string loop = at("loop.glb"), dataset = at(std::string(300, 'n') + ".json");
  for (const std::string& command :
       {"info " + loop, "check " + loop, "info " + files_.character + " --json " + loop,
        "train " + loop + " --out " + at("a.safetensors"), "info " + dataset, "check " + dataset}) {
    const ProgramResult result = run_verb(command);
    const bool is_loop = command.find(loop) != std::string::npos;
    expect(result, 4, is_loop ? "lead back to itself?" : "names have 255 bytes at most");
    EXPECT_EQ(result.count("filesystem error"), 0u) << result.output;
  }
  EXPECT_TRUE(fs::is_symlink(folder_ / "loop.glb"));
}

TEST_F(FileFailures, WhatIsThereAndNoFileIsTold) {
  ASSERT_EQ(mkfifo(at("pipe.glb").c_str(), 0600), 0);
  ASSERT_EQ(mkfifo(at("pipe").c_str(), 0600), 0);
  expect(run_verb("info " + at("pipe.glb")), 4, "pipe.glb: is a pipe");
  expect(run_verb("info " + at("pipe")), 4, "pipe: is a pipe");
  expect(run_verb("info /dev/zero"), 4, "/dev/zero: is a device");
}

TEST_F(FileFailures, AFolderThatCannotBeMadeTellsWhy) {
  const std::string rig = "rig " + files_.character + " --out ";
  expect(run_verb(rig + files_.motion), 4, "is a file in the place of a folder?");
  expect(run_verb(rig + at(std::string(300, 'n'))), 4, "names have 255 bytes at most");
}

// Long texts are written before the last flush, short ones by it; those of help are CLI11's own.
TEST_F(FileFailures, AStandardOutputThatIsFullOrClosedIsAnError) {
  for (const std::string& arguments : {std::string("--version"), std::string("eval --help"), std::string("help eval"),
                                       "info " + files_.character, "info " + files_.character + " --json -"}) {
    const std::string program = "{ " + kProgram + " " + arguments + " 2>&1";
    expect(run_program(program + " >/dev/full; }"), 4, "standard output cannot be written: No space left on device");
    expect(run_program(program + " >&-; }"), 4, "standard output cannot be written: Bad file descriptor");
  }
}

// Netgen is loaded late, and the loader tells in words alone that memory ran out.
TEST_F(FileFailures, ALibraryThatDoesNotFitIntoMemoryIsNotCalledMissing) {
  for (const char* kilobytes : {"250000", "300000", "350000", "400000"}) {
    const ProgramResult result =
        run_program(std::string("ulimit -v ") + kilobytes + "; exec " + kProgram + " " + simulate(at(kilobytes)));
    EXPECT_EQ(result.count("is the package"), 0u) << kilobytes << "\n" << result.output;
    EXPECT_NE(result.exit_code, 4) << kilobytes << "\n" << result.output;
  }
}

TEST_F(FileFailures, NumbersThatAreNoneAreRefusedAsOptions) {
  const std::string limb = files_.character, clip = " --clip " + files_.motion, out = " --out " + at("out");
  const std::string basis = at("limb.safetensors");
  const std::vector<std::pair<std::string, std::string>> options{
      {"simulate " + limb + clip + out, "--unit"},
      {"simulate " + limb + clip + out, "--tet-size"},
      {"simulate " + limb + clip + out, "--fps"},
      {"train --ddm-only " + limb + out + ".safetensors", "--smoothing-radius"},
      {"train " + at("data") + out + ".safetensors", "--budget"},
      {"train " + at("data") + out + ".safetensors", "--tolerance"},
      {"train " + at("data") + out + ".safetensors", "--memory"},
      {"rom " + limb + " --limits " + at("limits.json") + out + ".glb", "--step"},
      {"eval " + basis + clip + out + ".pc2", "--unit"},
      {"coverage " + basis + clip, "--unit"},
      {"attach " + limb + " " + basis, "--unit"},
      {"compare a.pc2 b.pc2", "--fail-above"},
      {"picture " + at("data") + " --frame 1 --around joint0" + out + ".png", "--radius"},
      {"proxy " + basis + out + ".safetensors", "--error"},
      {"dynamics " + limb + " --basis " + basis + out + ".safetensors", "--fps"},
      {"view --headless", "--seconds"},
      {"view --headless", "--fps"},
      {"view --headless", "--unit"},
      {"check " + limb, "--unit"},
      {"info " + limb, "--unit"},
      {"improve " + at("data") + " --basis " + basis + clip, "--fps"}};
  for (const auto& [command, option] : options) {
    const ProgramResult result = run_verb(command + " " + option + " nan");
    EXPECT_EQ(result.exit_code, 64) << command << " " << option << "\n" << result.output;
    EXPECT_NE(result.output.find(option), std::string::npos) << result.output;
  }
}

// Two runs that train one basis would delete what the other keeps.
TEST_F(FileFailures, OneRunTrainsABasis) {
  ASSERT_EQ(run_verb("simulate " + files_.character + clip_of_24_frames() + at("data")).exit_code, 0);
  const std::string train = "train " + at("data") + " --out " + at("limb.safetensors");
  {
    const RunLock other(folder_ / "limb.training.lock", "training");
    expect(run_verb(train), 4, "another run is training this basis");
  }
  expect(run_verb(train), 0, "wrote");
  EXPECT_FALSE(fs::exists(folder_ / "limb.training.lock"));
}

// More takes than files that may be open by default.
TEST_F(FileFailures, ManyTakesAreTrainedOn) {
  ASSERT_EQ(run_verb("simulate " + files_.character + clip_of_24_frames() + at("data")).exit_code, 0);
  ASSERT_EQ(run_verb("export " + at("data/bend.nodes") + " --out " + at("data/bend.pc2")).exit_code, 0);
  Dataset dataset = read_dataset(folder_ / "data/dataset.json");
  dataset.takes[0].shapes = "bend.pc2";
  dataset.takes.resize(60, dataset.takes[0]);
  for (std::size_t k = 0; k < dataset.takes.size(); ++k) dataset.takes[k].name = "take" + std::to_string(k);
  write_dataset(dataset, folder_ / "data/dataset.json");
  const ProgramResult result = run_program("ulimit -Sn 40; exec " + kProgram + " regions " + at("data"));
  EXPECT_EQ(result.exit_code, 0) << result.output;
}

}  // namespace
}  // namespace bodyopt
