#include "tests/assets/random_gltf.h"

#include <gtest/gtest.h>

#include "tests/support/temporary_folder.h"
#include "trainer/attach/loose_meshes.h"

namespace bodyopt {
namespace {

using namespace trainer;

// As PlainGltf shows them, to a ten thousandth of their size; every mesh is on the character's skin or rides on it.
TEST(RandomGltf, CharactersAreAsTheirScenesShowThem) {
  const TemporaryFolder folder;
  std::size_t refused = 0;
  for (std::uint64_t seed = 0; seed < 400; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const RandomGltf made(seed);
    put_bytes(folder / "c.glb", made.blob.glb());
    try {
      const Character character = read_character(folder / "c.glb");
      EXPECT_EQ(made.what_is_wrong(character), "");
      const ClipOptions options{.fps = 1, .unit = character.unit};
      EXPECT_EQ(made.what_is_wrong(character, read_clip((folder / "c.glb").string(), character.skeleton, options)), "");
      std::vector<std::string> notes;
      const double unit = character.unit > 0 ? character.unit : 1;
      const auto loose =
          read_loose_meshes(GltfFile(folder / "c.glb"), character.skeleton, character.output_count(), unit, notes);
      EXPECT_EQ(loose.size(), made.loose_pieces.size()) << (notes.empty() ? "" : notes.back());
    } catch (const Error& error) {
      EXPECT_TRUE(made.may_be_refused()) << error.what();
      ++refused;
    }
  }
  EXPECT_LT(refused, 60u);
}

}  // namespace
}  // namespace bodyopt
