// The options of a training.
#pragma once

#include <cstdint>
#include <filesystem>

namespace bodyopt::trainer {

// The full model, and what is left out of it to see what each part is worth.
struct Method {
  enum class Unposing { ddm, lbs };                                    // lbs: only for evaluation by heldout_by_basis
  enum class Support { whole_skin, static_regions, dynamic_regions };  // dynamic: by what muscles do, too
  Unposing unposing = Unposing::ddm;
  Support support = Support::dynamic_regions;
  bool strains = true;
  bool kernels = true;  // without: a linear map
};

struct TrainOptions {
  // DDM sigma, metres. 0: 0.025 x the character's size (0.045 for 1.8 m) or twice that, as leaves less to learn on the
  // training frames. Where linear blending leaves less than either, a half to a sixteenth of it.
  double smoothing_radius = 0;
  int smoothing_steps = 20;  // DDM p
  int components = 32;       // coefficients per region at most
  int centres = 256;         // kernel centres per region at most
  double memory_gib = 4;  // un-posed motion takes about half of it, one region's at least; a pass over all frames for
                          // every part of the skin that fits
  std::uint64_t seed = 1;
  Method method{};
  // How large the basis is to be, one of them at most; without, as large as is worth it.
  double budget = 0;        // bytes of all tables per vertex at most
  double tolerance_mm = 0;  // as small as its expected error allows
  int surface_curves = 0;   // pairs of them, see choose_map.h
  // A folder for what is found, from which the same training goes on where it stopped; empty: nothing is kept.
  std::filesystem::path keep_in{};
  // Bring what an earlier training kept there to these frames, where no more than a tenth of them are others.
  // Otherwise, and where nothing fits, train from the start.
  bool update = false;
};

}  // namespace bodyopt::trainer
