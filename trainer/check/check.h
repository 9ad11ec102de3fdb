// Does a dataset belong together? Counts, units, up axis, frame numbering, controls, and how well shapes fit the
// skinned rest.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <vector>

#include "assets/character.h"
#include "assets/clip.h"
#include "dataset/dataset.h"
#include "geometry/mesh.h"
#include "runtime/basis/skeleton.h"
#include "trainer/train/data/samples.h"

namespace bodyopt {

struct Character;

struct TakeCheck {
  std::string name;
  std::uint32_t points = 0, samples = 0;
  std::uint32_t unconverged = 0;  // frames that training leaves out, or that are not simulated yet
  std::uint32_t compared = 0;     // samples that the distances are of: without those, and without replaced ones
  double fit_mm = 0;       // RMS distance of shapes from linear blend skinning, over some frames spread over the take
  double rest_fit_mm = 0;  // the same for the frame whose pose is nearest to the bind pose
  int rest_frame = 0;
  std::vector<std::string> problems;  // each names what was expected, what was found and the likely cause; where shapes
                                      // lie is none of a take that is `as_given`
};

// One entry per take, of its raw shapes. Throws Error(file) where something cannot be read at all, and Error(mismatch)
// where a modifier does not fit what is sound.
std::vector<TakeCheck> check_dataset(const Dataset& dataset);

// Says what keeps a dataset, read from `path`, from training: its file, the take and the first problem, or that no
// frame is solved. Empty: nothing.
std::string first_problem(const std::vector<TakeCheck>& takes, const std::filesystem::path& path);

// "closed, 1 piece" or what is open, non-manifold, in several pieces: one sentence.
std::string describe_surface(const Character& character);

// Doubts about shapes that do belong to their character: found before they are learned as the truth.

// One sentence for each doubt, take by take. The skin of a part follows its joint by less than 70 %, as if glued to
// what it touches at rest. Only parts count that the joint moves by a hundredth of the body's size or more, in 48
// frames. Vertices fly away from their neighbours in single frames; all frames are searched, but not in sparse sets.
std::vector<std::string> shape_doubts(const SampleSet& set);

// Takes of which hold_out_blocks() can hold out nothing, without frames held out: one sentence each.
std::vector<std::string> short_takes(const Dataset& dataset);

// One sentence for every take whose simulation is further from that in ever finer tets than training comes to it, as
// its side-car estimates. Throws Error(file) as read_frame_status().
std::vector<std::string> coarse_takes(const Dataset& dataset);

// Errors of a take's shapes as a whole, so that they do not lie where its frames are.

struct Character;
struct Clip;

struct Misplacement {
  std::string
      cause;        // "the frames are numbered 1 too high", with its number; empty: none explains most of the distance
  double left = 1;  // share of the distance from the skinned character that is left without it
};

// The simplest explanation of over half of the squared distance between shapes and the skinned character. Frames are
// early or late, or the shapes have another size, are turned, mirrored, moved, or several of these at once. Or each
// frame is moved (and turned) for itself, as without the root's travel. What bulges, folds and swings is none of them.
//
// `shapes`: V x 3 welded, metres, world, of some frames of the clip, `frames`; one or more.
Misplacement find_misplacement(const Character& character, const Clip& clip, const std::vector<int>& frames,
                               const std::vector<Positions>& shapes);

// Shapes that come from elsewhere (Houdini, Ziva, scans, sculpted corrections) into a dataset.

struct AddedShapes {
  DatasetTake take;  // as the dataset has it now
  TakeCheck check;   // of the shapes given, by themselves
  int replaced = 0;  // of the frames given, those that the take had
};

// Copies the shapes of `source` into the dataset of `path` (its dataset.json; `begun` where there is none yet). Sample
// k is frame given.frames[k] of the take given.name, which is made where there is none. The take gets a new cache (PC2,
// by rising frame) beside dataset.json with the new frames, and its side-car, if any, is made anew. After them
// dataset.json is renamed into place, then the files it named before go. Frames that it has keep their shapes. The new
// ones lie in a modifier over them (put_shapes_over()), which can be undone; only damaged shapes are replaced. Killed
// at any moment, the dataset is the old one, the new one, or that without the modifier.
//
// Throws, with nothing changed, Error(mismatch) where the shapes do not belong to the character and the clip's frames
// or the take is of another motion. Throws Error(usage) for frames that it has already unless `replace`, Error(file),
// and Error(interrupted) after SIGINT.
AddedShapes add_shapes(const Dataset& begun, const std::filesystem::path& path, const DatasetTake& given,
                       const std::filesystem::path& source, bool replace);

// Forecasts what the verbs make of a character, and why.

// The shape that simulate and dynamics fill with tetrahedra; works: of train and proxy, which fill nothing.
enum class BodyFill { skin, mended, coarser, lattice, refused, works };

// "skin", "mended skin", "coarser skin", "lattice", "refused", "works".
const char* name_of(BodyFill fill);

struct VerbForecast {
  std::string verb;
  BodyFill fill = BodyFill::refused;
  Eigen::Index nodes = 0;  // of train and proxy: vertices of the skin, of the coarsest level
  bool has_contact = false;
  std::string why;      // what was mended, or keeps it from a better filling; empty: nothing
  std::string remedy;   // empty: none is needed
  std::string glued{};  // of a cage: glued_parts()
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

}  // namespace bodyopt
