// Forecasts what the verbs make of a character, and why.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "assets/characters/character.h"
#include "assets/clips/clip.h"
#include "runtime/basis/skeleton.h"
#include "runtime/core/error.h"
#include "trainer/train/data/samples.h"

namespace bodyopt::trainer {

// The shape that simulate and dynamics fill with tetrahedra; works: of train and proxy, which fill nothing.
enum class BodyFill { skin, mended, coarser, lattice, refused, works };

// "skin", "mended skin", "coarser skin", "lattice", "refused", "works".
const char* name_of(BodyFill fill);

struct VerbForecast {
  std::string verb;
  BodyFill fill = BodyFill::refused;
  Eigen::Index nodes = 0;  // of train and proxy: vertices of the skin, of the coarsest level
  bool has_contact = false;
  std::string why;                       // what was mended, or keeps it from a better filling; empty: nothing
  std::string remedy;                    // empty: none is needed, or `why` says it
  std::string glued{};                   // of a cage: glued_parts()
  ErrorCause cause = ErrorCause::other;  // of what keeps it from a better filling
};

// Vertices of one joint where something is amiss.
struct RestPlace {
  std::string joint, other;                            // other: of parts that are near each other
  std::vector<std::uint32_t> vertices;                 // welded
  std::uint32_t vertex = 0;                            // the first of them, in file order
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  // its own, rest space, metres
};

struct CharacterForecast {
  std::vector<VerbForecast> verbs;       // simulate, simulate --draft, dynamics, train, proxy
  std::vector<RestPlace> intersections;  // of the skin with itself at rest, by joint, most first
  std::vector<RestPlace> near_parts;     // of different joints, face to face, less than a mean edge apart
  std::vector<RestPlace> holes;          // skin at edges of a single triangle, by joint
  std::vector<RestPlace> flipped;        // at edges whose triangles wind oppositely, by joint
  std::vector<RestPlace> loose_pieces;   // pieces that follow the others, by joint
  std::vector<RestPlace> glued;          // that the cages of simulate hold together (glued_vertices), by joints
  std::vector<std::string> remarks;      // likely unit, joints that move nothing or are never moved, clips of no use
};

// Fills and simplifies the character as the verbs do: what is foreseen is what they get. `clips`: its own, by
// which its skin is simplified; none: by the rest skin alone. Where all of them scale joints, simulate is refused.
// `unit`: metres per unit of its file that it was read with, 0: metres. Takes seconds.
CharacterForecast foresee(const Character& character, const std::vector<Clip>& clips = {}, double unit = 0);

// Forecasts train and proxy for a dataset.
std::vector<VerbForecast> foresee_training(const SampleSet& set);

}  // namespace bodyopt::trainer
