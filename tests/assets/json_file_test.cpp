#include "base/json_file.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/support/replaced_file.h"
#include "tests/support/temporary_folder.h"

namespace bodyopt {
namespace {

using namespace testing;

TEST(JsonFile, ThatIsReplacedMeanwhileIsOneOrTheOther) {
  const TemporaryFolder folder;
  const std::string small = R"({"schema": "s", "k": 1})", large = R"({"schema": "s", "k": 1, "more": "of everything"})";
  const ReplacedFile replaced(folder / "a.json", small, large);
  for (int k = 0; k < 20000; ++k) ASSERT_EQ(read_json(folder / "a.json", "s")["k"], 1);
}

}  // namespace
}  // namespace bodyopt
