// The job of OpenCue: what is generated keeps the rules, the rules refuse what breaks them, and its command is safe in
// a shell.
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <fstream>
#include <pugixml.hpp>
#include <set>
#include <sstream>

#include "farm/queues.h"
#include "runtime/core/error.h"
#include "tests/support/temporary_folder.h"

namespace bodyopt::farm {
namespace {

// What of the rules below a job breaks, a sentence each; of OpenCue's these are the ones that a generated job could
// break. Elements in the order of the DTD; names of 3 or more letters, digits, '.' and '_', in layers each once; a user
// that is not root; 1 to 1,000 layers and at most 100,000 frames; ranges as "1-5,7"; cores with a decimal point
// (without, they are hundredths); a command that holds #IFRAME# once and no other '#', and no control characters;
// dependencies between two layers of the job.
class OpencueChecker {
 public:
  std::vector<std::string> check(const std::string& xml) {
    pugi::xml_document document;
    const pugi::xml_parse_result result = document.load_string(xml.c_str());
    require(static_cast<bool>(result), std::string("it is no XML: ") + result.description());
    const pugi::xml_node spec = document.child("spec"), job = spec.child("job");
    in_order(spec, {"show", "shot", "user", "job", "depends"});
    for (const char* child : {"show", "shot", "user"}) name(spec.child(child).text().get(), child);
    require(spec.child("user").text().get() != std::string("root"), "no job may be root's");
    in_order(job, {"paused", "layers"});
    name(job.attribute("name").value(), "job");
    for (const pugi::xml_node layer : job.child("layers").children()) check_layer(layer);
    require(!layers_.empty() && layers_.size() <= 1000, "there are no layers, or more than 1,000");
    require(frames_ <= 100'000, "there are more than 100,000 frames");
    for (const pugi::xml_node depend : spec.child("depends").children()) check_dependency(depend);
    return problems_;
  }

 private:
  void require(bool holds, const std::string& problem) {
    if (!holds) problems_.push_back(problem);
  }

  void name(const std::string& text, const std::string& whose) {
    const bool is_name = text.size() >= 3 && std::ranges::all_of(text, [](unsigned char c) {
                           return c < 128 && (std::isalnum(c) != 0 || c == '_' || c == '.');
                         });
    require(is_name, "'" + text + "' is no name of a " + whose + ": 3 or more letters, digits, '.' and '_'");
  }

  void in_order(const pugi::xml_node& node, const std::vector<std::string>& names) {
    std::size_t at = 0;
    for (const pugi::xml_node child : node.children()) {
      const auto found = std::find(names.begin() + static_cast<std::ptrdiff_t>(at), names.end(), child.name());
      require(found != names.end(), std::string(node.name()) + " has an unknown or misplaced " + child.name());
      if (found != names.end()) at = static_cast<std::size_t>(found - names.begin());
    }
  }

  void check_layer(const pugi::xml_node& layer) {
    const std::string own = layer.attribute("name").value(), cores = layer.child("cores").text().get();
    name(own, "layer");
    require(layers_.insert(own).second, "two layers are called " + own);
    in_order(layer, {"cmd", "range", "chunk", "cores", "threadable", "gpus", "env"});
    require(cores.find('.') != std::string::npos, own + " has cores without a decimal point: those are hundredths");
    check_command(own, layer.child("cmd").text().get());
    count_frames(own, layer.child("range").text().get());
  }

  void check_command(const std::string& own, const std::string& command) {
    const std::size_t at = command.find("#IFRAME#");
    require(at != std::string::npos && std::ranges::count(command, '#') == 2,
            own + "'s command does not hold #IFRAME# once and no other '#', which OpenCue would replace");
    require(std::ranges::none_of(command, [](unsigned char c) { return c < ' ' || c == 127; }),
            own + "'s command holds a control character");
  }

  void count_frames(const std::string& own, const std::string& range) {
    std::istringstream parts(range);
    std::size_t frames = 0;
    for (std::string part; std::getline(parts, part, ',');) {
      unsigned first = 0, last = 0;
      char end = 0;
      const int found = std::sscanf(part.c_str(), "%u-%u%c", &first, &last, &end);
      const bool is_one = found == 1 && part.find_first_not_of("0123456789") == std::string::npos;
      const bool is_range = found == 2 && last > first;
      require(is_one || is_range, own + " has the range '" + range + "', expected such as 1-5,7");
      frames += is_range ? last - first + 1 : 1;
    }
    require(frames > 0, own + " has no frames");
    frames_ += frames;
  }

  void check_dependency(const pugi::xml_node& depend) {
    in_order(depend, {"depjob", "deplayer", "onjob", "onlayer"});
    const std::string one = depend.child("deplayer").text().get(), other = depend.child("onlayer").text().get();
    const std::string type = depend.attribute("type").value();
    require(type == "LAYER_ON_LAYER" || type == "FRAME_BY_FRAME", "a dependency is of the type '" + type + "'");
    require(one != other && layers_.contains(one) && layers_.contains(other),
            "'" + one + "' depends on '" + other + "': not two layers of the job");
  }

  std::set<std::string> layers_;
  std::size_t frames_ = 0;
  std::vector<std::string> problems_;
};

std::vector<std::string> check_opencue(const std::string& xml) { return OpencueChecker().check(xml); }

std::string cue_job(const std::string& show, const std::string& folder = "/plan", const TaskNeeds& needs = {}) {
  FarmPlan plan{show, {}, true};
  for (const int lane : {0, 1, 2, 5}) plan.tasks.push_back({0, lane, {}});
  plan.tasks.push_back({1, 5, {}});
  plan.tasks.push_back({2, 0, {}});
  return opencue_job(plan, folder, "/bin/echo", "artist", needs);
}

TEST(Opencue, WhatIsGeneratedKeepsTheRules) {
  for (const std::string& show :
       {std::string("show"), std::string(300, 'x'), std::string("a\n<b>&\xff"), std::string()}) {
    EXPECT_EQ(check_opencue(cue_job(show)), std::vector<std::string>{}) << show;
  }
  const std::string job = cue_job("show", "/plan", {.cpus = 4, .tasks_per_gpu = 1});
  EXPECT_EQ(check_opencue(job), std::vector<std::string>{});
  for (const char* part : {"<range>0-2,5</range>", "<cores>4.0</cores>", "<gpus>1</gpus>",
                           "<depend type=\"FRAME_BY_FRAME\">", "<depend type=\"LAYER_ON_LAYER\">"}) {
    EXPECT_NE(job.find(part), std::string::npos) << part << " in " << job;
  }
  EXPECT_EQ(cue_job("show").find("<gpus>"), std::string::npos);
  EXPECT_THROW(cue_job("show", "/plan", {.cpus = 1, .tasks_per_gpu = 2}), Error);
}

// The command is what a shell sees, once the frame's number is in it.
TEST(Opencue, NamesInTheCommandAreNotRun) {
  const TemporaryFolder folder;
  const std::string evil = (folder / "plan $(touch hit) `touch hit` ' \" <&>;touch hit;").string();
  const std::string job = cue_job("show", evil);
  ASSERT_EQ(check_opencue(job), std::vector<std::string>{});
  pugi::xml_document document;
  ASSERT_TRUE(document.load_string(job.c_str()));
  std::string command = document.child("spec").child("job").child("layers").child("layer").child("cmd").text().get();
  command.replace(command.find("#IFRAME#"), 8, "7");
  const CommandResult result = run_command({"env", "-C", folder.path().string(), "sh", "-c", command}, 20);
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_EQ(result.output, "farm run " + evil + " 0.7\n");
  EXPECT_FALSE(std::filesystem::exists(folder / "hit"));
}

// What comes from outside is refused by the product itself.
TEST(Opencue, NamesAndSizesThatBreakARuleAreKnown) {
  FarmPlan plan{"show", {{0, 0, {}}}, false};
  EXPECT_EQ(opencue_problem(plan, "/plan", "/bin/echo", "artist"), "");
  EXPECT_EQ(opencue_problem(plan, "/plan", "/bin/echo", "root"), "no job may be root's");
  EXPECT_NE(opencue_problem(plan, "/plan", "/bin/echo", "me").find("no name of a user"), std::string::npos);
  EXPECT_NE(opencue_problem(plan, "/pl#an", "/bin/echo", "artist").find("no other '#'"), std::string::npos);
  EXPECT_NE(opencue_problem(plan, "/plan", "/bin/ec\nho", "artist").find("a control character"), std::string::npos);
  EXPECT_NE(opencue_problem({}, "/plan", "/bin/echo", "artist").find("no layers"), std::string::npos);
  for (int lane = 1; lane <= 100'000; ++lane) plan.tasks.push_back({0, lane, {}});
  EXPECT_NE(opencue_problem(plan, "/plan", "/bin/echo", "artist").find("100,000 frames"), std::string::npos);
  plan.tasks.clear();
  for (int wave = 0; wave <= 1000; ++wave) plan.tasks.push_back({wave, 0, {}});
  EXPECT_NE(opencue_problem(plan, "/plan", "/bin/echo", "artist").find("more than 1,000"), std::string::npos);
}

TEST(Opencue, TheRulesRefuseWhatBreaksThem) {
  const auto expect_refused = [](const std::string& text, const std::string& instead) {
    std::string job = cue_job("show");
    const std::size_t at = job.find(text);
    ASSERT_NE(at, std::string::npos) << text;
    job.replace(at, text.size(), instead);
    EXPECT_EQ(check_opencue(job).size(), 1u) << text << " -> " << instead;
  };
  expect_refused("<user>artist<", "<user>root<");
  expect_refused("<shot>farm<", "<shot>a b c<");
  expect_refused("<cores>1.0<", "<cores>1<");
  expect_refused("0-2,5", "5-2,7");
  expect_refused("0-2,5", "0-100000");
  expect_refused("#IFRAME#", "7");
  expect_refused("'/plan'", "'/pl#an'");
  expect_refused("'/plan'", "'/pl&#10;an'");
  expect_refused("<deplayer>wave1<", "<deplayer>wave7<");
  expect_refused("FRAME_BY_FRAME", "JOB_ON_JOB");
  expect_refused("<chunk>1</chunk>", "<chunks>1</chunks>");
}

TEST(OpencueJob, TakesThePlaceOfNoOtherFile) {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder / "job.xml";
  require_replaceable_opencue(file);
  std::ofstream(file) << "<?xml version=\"1.0\"?><spec><job name=\"edited\"/></spec>";
  require_replaceable_opencue(file);
  for (const char* other : {"<mujoco model=\"arm\"/>", "no XML", ""}) {
    std::ofstream(file) << other;
    EXPECT_THROW(require_replaceable_opencue(file), Error) << other;
  }
}

}  // namespace
}  // namespace bodyopt::farm
