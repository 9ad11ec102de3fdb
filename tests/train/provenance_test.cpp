#include "trainer/train/skinning/provenance.h"

#include "runtime/core/error.h"
#include "tests/support/capsule_limb.h"
#include "trainer/train/skinning/ddm.h"

namespace bodyopt::testing {
namespace provenance_test {

using namespace trainer;

TEST(Provenance, IsWhatTheTrainingWrote) {
  TrainOptions options;
  options.smoothing_radius = 0.03;
  options.smoothing_steps = 7;
  options.components = 5;
  options.seed = ~std::uint64_t{0};
  options.tolerance_mm = 0.25;
  options.surface_curves = 3;
  const auto found = read_provenance(build_ddm_basis(limb_character(), options).metadata, "a.safetensors");
  ASSERT_TRUE(found);
  EXPECT_TRUE(found->program.starts_with("bodyopt ")) << found->program;
  EXPECT_FALSE(found->updated);
  EXPECT_EQ(found->options.smoothing_radius, options.smoothing_radius);
  EXPECT_EQ(found->options.smoothing_steps, 7);
  EXPECT_EQ(found->options.components, 5);
  EXPECT_EQ(found->options.centres, options.centres);
  EXPECT_EQ(found->options.seed, options.seed);
  EXPECT_EQ(found->options.tolerance_mm, 0.25);
  EXPECT_EQ(found->options.surface_curves, 3);
}

TEST(Provenance, OfOtherProgramsIsNone) {
  EXPECT_FALSE(read_provenance({}, "a.safetensors"));
  EXPECT_FALSE(read_provenance({{"provenance", "made by hand"}}, "a.safetensors"));
  const auto earlier = read_provenance({{"provenance", R"({"program": "bodyopt 0.0.1"})"}}, "a.safetensors");
  ASSERT_TRUE(earlier);
  EXPECT_EQ(earlier->options.smoothing_steps, TrainOptions().smoothing_steps);
}

TEST(Provenance, OfATransferHasThatOfItsSource) {
  Metadata metadata{{"provenance", R"({"program": "bodyopt 1"})"}};
  const std::string with_source = R"({"program":"bodyopt 1","transferred_from":{"seed":7}})";
  add_source({{"provenance", R"({"seed": 7})"}}, metadata);
  EXPECT_EQ(metadata.at("provenance"), with_source);
  add_source({{"provenance", "made by hand"}}, metadata);
  EXPECT_EQ(metadata.at("provenance"), with_source);
}

TEST(Provenance, DamagedValuesAreNamed) {
  for (const char* damaged : {R"({"seed": -1})", R"({"seed": 1.5})", R"({"components": "many"})", R"({"centres": -2})",
                              R"({"smoothing_radius_m": 1e300})", R"({"updated": 1})"}) {
    try {
      read_provenance({{"provenance", damaged}}, "a.safetensors");
      ADD_FAILURE() << damaged;
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::file);
      EXPECT_NE(std::string(error.what()).find("a.safetensors: the metadata 'provenance'"), std::string::npos)
          << error.what();
    }
  }
}

}  // namespace provenance_test
}  // namespace bodyopt::testing
