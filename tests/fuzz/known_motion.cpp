// Not damaged bytes, but sound files that hold a motion that is known, each as another program might write it.
#include "tests/support/known_motion.h"

#include <xxhash.h>

#include "tests/fuzz/clip.h"

namespace bodyopt::fuzz {
namespace {

std::vector<std::string> seeds() { return {"1", "2", "3", "4"}; }

void read(const std::string& bytes) {
  const testing::KnownMotion known =
      testing::known_motion(static_cast<std::uint32_t>(XXH3_64bits(bytes.data(), bytes.size())));
  const Clip clip = read_clip(as_file("known.bvh", known.bvh).string(), known.skeleton, {.fps = known.fps});
  const std::string wrong = testing::wrong_in(known, clip);
  if (wrong.empty() || testing::asks_for_up(clip)) return;
  std::cerr << "wrong motion: " << wrong << "; " << known.what << '\n';
  std::abort();
}

const bool added = add_target({"known_motion", seeds, read});

}  // namespace
}  // namespace bodyopt::fuzz
