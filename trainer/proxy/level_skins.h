// The skins of all levels, before any is trained, and how far they are from the full one that they carry.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "assets/characters/character.h"
#include "dataset/compare.h"
#include "runtime/basis/levels.h"
#include "trainer/train/data/samples.h"

namespace bodyopt::trainer {

// A skin of fewer vertices that moves as the full one does.

struct SimplifiedSkin {
  std::vector<std::uint32_t> vertices;  // welded vertices that stay, ascending
  Triangles triangles;                  // T x 3, numbers into `vertices`
};

// Collapses edges onto one of their ends, least harm first, so that a subset of the vertices stays. The harm is the
// quadric error (Garland and Heckbert 1997) summed over several shapes (Mohr and Gleicher 2003, Deformation Sensitive
// Decimation). So vertices stay where the skin bends and folds, not only where it is curved at rest.
//
// `shapes`: V x 3 each, posed, metres, the first at rest. `error`: the most, metres, that a vertex may lie from the
// planes of the triangles it stands for: root mean square over area and shapes.
//
// A closed skin stays closed and manifold, of the same genus; vertices at open or irregular edges stay, those of no
// triangle go. Every joint keeps three of the vertices that follow it most, or all it has. A function of its arguments
// alone.
SimplifiedSkin simplify_skin(const Character& character, const std::vector<Positions>& shapes, double error);

// Maps from the full skin to a proxy's.

// Puts every vertex of the full skin on the nearest triangle of the proxy's rest skin, and keeps its offset from there.
// Triangles that face as the full skin does come first, so that fingers stay apart. Steps of an offset are 1/32767 of
// the largest. -> one for every output vertex of `full`. `mesh`: of the proxy's basis.
CarriedSkin map_skin(const Character& full, const MeshTable& mesh);

// A skin as an Evaluation has it: O x 3 in output order. `vertices`: V x 3 in runtime order of the mesh.
struct ShownSkin {
  std::vector<float> positions, normals;
};
ShownSkin show_skin(const MeshTable& mesh, std::span<const float> vertices);

// Distances of the full rest skin's vertices from the proxy's, mm.
struct SkinDistance {
  double rms = 0, max = 0;
};
SkinDistance skin_distance(const Character& full, const Character& proxy);

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
// vertices, or no fewer than the level before; of default errors, only where none makes a level.
std::vector<LevelSkin> level_skins(const Character& character, const std::vector<Positions>& shapes,
                                   const std::vector<double>& asked, std::vector<std::string>& notes);

// The error that remains where every vertex of the proxy is exactly where the full shape has it. `proxy` has the same
// frames as `samples`, which are of `full`. `level` needs the mesh and where it carries the full skin.
double carried_rms_mm(const Level& level, const Character& full, const std::vector<Sample>& samples,
                      const std::vector<Sample>& proxy);

// Errors of the level's result, computed on the CPU, over all samples of the full skin.
ErrorStatistics level_errors(const Level& level, const Character& full, const std::vector<Sample>& samples);

// Spreads at most `most` of the samples evenly.
std::vector<Sample> some_samples(const std::vector<Sample>& samples, std::size_t most);

}  // namespace bodyopt::trainer
