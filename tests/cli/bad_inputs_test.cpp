// What the program says to bad inputs, word for word, and how it ends: scripts of studios read both. The list is
// tests/cli/bad_inputs.txt: a command line, and below it the exit code and what was printed.
#include <gtest/gtest.h>

#include <fstream>
#include <string>
#include <vector>

#include "assets/caches/pc2.h"
#include "tests/cli/limb_files.h"
#include "tests/support/read_bytes.h"
#include "tests/support/run_verb.h"
#include "tests/support/small_basis.h"

namespace bodyopt {
namespace {

namespace fs = std::filesystem;

void put(const fs::path& path, const std::string& bytes) { std::ofstream(path, std::ios::binary) << bytes; }

// limb.glb and bend.glb are sound, as are hero.safetensors (of another skeleton) and two.pc2 (of two vertices); what is
// called cut ends in the middle, what is called empty has no byte, and text is a text.
void write_inputs(const TemporaryFolder& folder) {
  const LimbFiles limb(folder, 1);
  save_basis(testing::small_basis(), folder / "hero.safetensors");
  Pc2Writer writer(folder / "two.pc2", 2, 3);
  for (int k = 0; k < 3; ++k) writer.append(std::vector<float>(6, 0.1f));
  writer.close();
  for (const char* ending : {".glb", ".pc2", ".safetensors", ".bvh", ".json", ".nodes"}) {
    put(folder / (std::string("empty") + ending), "");
    put(folder / (std::string("text") + ending), "To whom it may concern\n");
  }
  for (const auto& [whole, cut] :
       {std::pair("limb.glb", "cut.glb"), {"two.pc2", "cut.pc2"}, {"hero.safetensors", "cut.safetensors"}}) {
    const std::string bytes = testing::read_bytes(folder / whole);
    put(folder / cut, bytes.substr(0, bytes.size() / 2));
  }
  put(folder / "cut.bvh", "HIERARCHY\nROOT Hips\n{\n  OFFSET 0 0 0\n");
  put(folder / "other.json", R"({"schema": "something-else-1"})");
  put(folder / "twice.json", R"({"schema": "a", "schema": "b"})");
  fs::create_directory(folder / "hollow");
}

struct Answer {
  std::string command, text;  // exit code and output
  bool operator==(const Answer&) const = default;
};

void PrintTo(const Answer& answer, std::ostream* stream) { *stream << "$ " << answer.command << "\n" << answer.text; }

std::vector<Answer> recorded() {
  std::vector<Answer> answers;
  std::ifstream file(kSourceFolder + "/tests/cli/bad_inputs.txt");
  for (std::string line; std::getline(file, line);) {
    if (line.starts_with("$ ")) {
      answers.push_back({line.substr(2), ""});
    } else if (!answers.empty()) {
      answers.back().text += line + "\n";
    }
  }
  return answers;
}

Answer answer_of(const std::string& command) {
  const ProgramResult result = run_verb(command);
  return {command, std::to_string(result.exit_code) + "\n" + result.output};
}

TEST(BadInputs, GetTheRecordedMessageAndExitCode) {
  const TemporaryFolder folder;
  const WorkingFolder here(folder.path());
  write_inputs(folder);
  const std::vector<Answer> expected = recorded();
  EXPECT_GE(expected.size(), 40u);
  std::ofstream now(kBuildFolder + "/bad_inputs.txt");  // to be copied where a message is changed on purpose
  for (const Answer& answer : expected) {
    const Answer found = answer_of(answer.command);
    EXPECT_EQ(found, answer) << "all of today's: " << kBuildFolder << "/bad_inputs.txt";
    now << "$ " << found.command << "\n" << found.text;
  }
  EXPECT_FALSE(fs::exists(folder / "out.pc2"));
  EXPECT_FALSE(fs::exists(folder / "out.safetensors"));
}

}  // namespace
}  // namespace bodyopt
