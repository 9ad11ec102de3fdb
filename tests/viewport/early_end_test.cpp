// Ended at any moment of its start, the viewport ends as it should.
#include <gtest/gtest.h>

#include "tests/support/random_tables.h"
#include "tests/viewport/window_fixture.h"

namespace bodyopt::testing {
namespace {

class EarlyEndTest : public WindowTest {
 protected:
  // Before the program listens, a signal ends it as it ends any program.
  static void expect_ended_by(int signal, BackgroundProgram& program, double after) {
    const std::optional<int> code = program.wait(kPatience);
    ASSERT_TRUE(code) << "it still runs; signal " << signal << " after " << after << " s\n" << program.output();
    EXPECT_TRUE(*code == 75 || *code == 128 + signal) << *code << " after " << after << " s\n" << program.output();
    EXPECT_EQ(*code == 75, program.output().find("interrupted") != std::string::npos) << program.output();
  }

  Random random_{20260101};
};

TEST_F(EarlyEndTest, BySignals) {
  const std::string last_picture = "early.0012.png";
  for (int k = 0; k < 12; ++k) {
    const int signal = k % 2 == 0 ? SIGTERM : SIGINT;
    const double after = random_.uniform(0, 1.5);
    const bool headless = k % 3 == 2;
    const std::string how = headless ? "--headless -o early.####.png" : "--do play";
    std::filesystem::remove(folder_ / last_picture);  // of an earlier run
    BackgroundProgram program(command(small(small_.truth + " " + how)), folder_ / "early.txt");
    std::this_thread::sleep_for(std::chrono::duration<double>(after));
    program.send(signal);
    if (headless && program.wait(kPatience) == 0) {  // all was drawn before the signal came
      EXPECT_TRUE(std::filesystem::exists(folder_ / last_picture)) << program.output();
      continue;
    }
    expect_ended_by(signal, program, after);
  }
}

TEST_F(EarlyEndTest, BySignalsOnceTheWindowShowsAPictureItSaysSo) {
  for (const int signal : {SIGTERM, SIGINT}) {
    const auto program = open(small(small_.truth));
    program->send(signal);
    EXPECT_EQ(program->wait(kPatience), 75) << program->output();
    EXPECT_NE(program->output().find("interrupted"), std::string::npos) << program->output();
    std::filesystem::remove(folder_ / "ready.png");
  }
}

TEST_F(EarlyEndTest, ByTheWindow) {
  for (int k = 0; k < 6; ++k) {
    BackgroundProgram program(command(small(small_.truth + " --validate")), folder_ / "early.txt");
    ASSERT_TRUE(comes_true([&] { return !(window_ = display_->window("Bodyopt")).empty(); }, kPatience))
        << program.output();
    std::this_thread::sleep_for(std::chrono::duration<double>(random_.uniform(0, 0.5)));
    display_->ask_to_close(window_);
    expect_end(program, 0);
  }
}

}  // namespace
}  // namespace bodyopt::testing
