// The skins of all levels, before any is trained, and how far they are from the full one that they carry.
#pragma once

#include <string>
#include <vector>

#include "dataset/compare.h"
#include "runtime/basis/levels.h"
#include "trainer/proxy/simplify_skin.h"
#include "trainer/train/data/samples.h"

namespace bodyopt {

struct LevelSkin {
  double error;  // metres
  SimplifiedSkin skin;
};

// 1/500 of the character's longest extent, and twice and four times that: 3.5, 7 and 14 mm for 1.75 m.
std::vector<double> default_errors(const Character& character);

// The rest skin, then 16 shapes at most, spread over the training frames: V x 3 each, posed, metres.
std::vector<Positions> shapes_of_skin(const SampleSet& set);

// The character simplified for each error asked for, or for the default ones as far as they make levels. `shapes`: as
// simplify_skin(). `notes`: gets why there are fewer levels. Throws Error(usage) where an error leaves too few
// vertices, or no fewer than the level before it: of errors that nobody gave only where none of them
// makes a level.
std::vector<LevelSkin> level_skins(const Character& character, const std::vector<Positions>& shapes,
                                   const std::vector<double>& asked, std::vector<std::string>& notes);

// What the level's skin itself leaves: with every vertex of the proxy exactly where it is in the full shape. Of the
// samples of `full`, those of `proxy` being the same frames. `level` needs the mesh and where it carries the full skin.
double carried_rms_mm(const Level& level, const Character& full, const std::vector<Sample>& samples,
                      const std::vector<Sample>& proxy);

// What the level's result is off, on the CPU, over all samples of the full skin.
ErrorStatistics level_errors(const Level& level, const Character& full, const std::vector<Sample>& samples);

// At most `most` of the samples, spread evenly.
std::vector<Sample> some_samples(const std::vector<Sample>& samples, std::size_t most);

}  // namespace bodyopt
