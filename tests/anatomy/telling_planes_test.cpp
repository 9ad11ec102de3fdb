// Which sections tell most of a body.
#include <gtest/gtest.h>

#include "tests/anatomy/egg_human.h"
#include "trainer/anatomy/section.h"

namespace bodyopt::trainer {
namespace {

AnatomyField field_of(const Character& character) {
  AnatomyOptions options;
  options.kind = BodyKind::biped;
  options.cell = 0.02;
  return AnatomyField(character, {}, options);
}

TEST(TellingPlanes, OfAHumanAreItsPartsAndOfOthersAllAlong) {
  Character body = egg_human();
  EXPECT_EQ(telling_planes(field_of(body), 100).front().name, "thigh");
  for (std::size_t j = 1; j < body.skeleton.size(); ++j) body.skeleton.joints[j].name = "node" + std::to_string(j);
  const std::vector<NamedPlane> planes = telling_planes(field_of(body), 100);
  ASSERT_EQ(planes.size(), 6u);
  EXPECT_EQ(planes.back().name, "along the middle");
}

}  // namespace
}  // namespace bodyopt::trainer
