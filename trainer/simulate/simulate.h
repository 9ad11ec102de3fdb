// Quasi-static FEM: the shape of the skin for every pose. Design, "simulate".
#pragma once

#include <filesystem>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "assets/characters/character.h"
#include "assets/characters/muscles.h"
#include "assets/clips/clip.h"
#include "dataset/dataset.h"
#include "trainer/simulate/quasi_static.h"

namespace bodyopt::trainer {

// After so many iterations verbs that choose frames themselves give a draft up. One in ten, of limbs that are put into
// each other, would take three quarters of the time, and its shape would teach little.
inline constexpr int kMostIterationsOfDraft = 1500;

struct SimulateOptions {
  double tet_size = 0;                                  // of the skin's own tets inside, metres; 0: a coarser skin
  int threads = 0;                                      // 0: all
  bool draft = false;                                   // in a coarser cage; the cache then holds nodes (nodes_cache.h)
  int give_up_after = std::numeric_limits<int>::max();  // iterations of a frame
  Materials materials{};
  AnatomyOptions anatomy{};
  // Receives warnings before the work begins; of stretched loose pieces, at the end.
  std::function<void(const std::string&)> warn = [](const std::string&) {};
  // Receives what frames are solved in: a coarser skin, the skin, the mended skin or a lattice, and its nodes.
  std::function<void(const std::string&)> inform = [](const std::string&) {};
};

// A dataset's options of its character's inside: its own body fat and kind precede those of its corrections. Throws
// Error(file) for a kind of body that is not known, and as read_corrections().
AnatomyOptions anatomy_options(const Dataset& dataset, const Skeleton& skeleton);

// The inside; nothing, with a warning, where the skin encloses nothing. Throws as AnatomyField otherwise.
AnatomyField look_inside(const Character& character, const std::vector<Muscle>& muscles,
                         const SimulateOptions& options);

// The cage that frames are solved in: without a tet_size that of make_cage(), a coarser skin filled with tets as a
// rule. With one it is the skin's own tets, or a lattice where these fail. Throws as lattice_cage.
Cage choose_cage(const Character& character, const SimulateOptions& options);

// The parts that a cage holds together though their joints would part them: "'Jaw' and 'Head' (12 vertices)", most
// first; empty where there are none.
std::string glued_parts(const Cage& cage, const Character& character);

// The body that frames are solved with, in choose_cage(). Its tets are of second order where they fill the skin and are
// not too many, otherwise linear. Warns of a lattice, and says why.
QuasiStaticBody make_body(const Character& character, const std::vector<Muscle>& muscles,
                          const SimulateOptions& options);
// Makes the same of what look_inside() found.
QuasiStaticBody make_body(const Character& character, const std::vector<Muscle>& muscles, const AnatomyField& anatomy,
                          const SimulateOptions& options);

// The body of make_body() and, without a tet_size, one in a coarser skin of a third of its nodes where there is one.
// With it simulate() estimates the discretisation error.
QuasiStaticBody make_compared_body(const Character& character, const std::vector<Muscle>& muscles,
                                   const SimulateOptions& options);

// One frame of a clip, its controls flexing muscles. Throws Error(usage) for a frame the clip lacks, Error(mismatch)
// for controls that flex no muscle or are not within 0..1.
SolvedPose solve_frame(const QuasiStaticBody& body, const std::vector<Muscle>& muscles, const Clip& clip, int frame);

// Hash of everything the shape of that frame depends on: `inputs` of the side-car that `simulate` writes. Throws as
// solve_frame.
std::uint64_t frame_key(const QuasiStaticBody& body, const std::vector<Muscle>& muscles, const Clip& clip, int frame);

// Throws Error(mismatch), naming clip, joint and frame, where a frame of the clip scales a joint: tissue has the size
// it has. Throws Error(usage) for a frame the clip lacks.
void require_unscaled(const Skeleton& skeleton, const Clip& clip, int frame);

// Simulates the given frames of a clip and writes the cache of `take` (PC2, output vertex order; a draft's nodes) and
// `status` (side-car). A frame that an earlier run, interrupted or finished, solved with the same inputs is taken over
// from these two files or the unfinished one. An unconverged frame is stored and flagged. Throws Error(interrupted)
// after SIGINT; what was finished by then is not lost. body: that make_compared_body() makes with these options.
std::vector<FrameStatus> simulate(const QuasiStaticBody& body, const Character& character,
                                  const std::vector<Muscle>& muscles, const Clip& clip, const std::vector<int>& frames,
                                  const TakeLock& take, const std::filesystem::path& status,
                                  const SimulateOptions& options);

}  // namespace bodyopt::trainer
