// A dataset of the synthetic limb on disk.
#pragma once

#include <string>

#include "assets/caches/pc2.h"
#include "assets/clips/clip.h"
#include "dataset/dataset.h"
#include "dataset/regions_file.h"
#include "tests/support/capsule_limb.h"
#include "trainer/train/skinning/ddm.h"

namespace bodyopt::testing {

// A take into the folder of limb.glb: clip, shapes, and every third frame held out where `heldout`.
inline DatasetTake write_limb_take(const std::filesystem::path& folder, const std::string& name, int frames,
                                   bool heldout) {
  const trainer::SampleSet set = limb_samples(frames, 0);
  Clip clip;
  clip.name = name;
  DatasetTake take{name, name + ".glb", "", 24, 1, {}, name + ".pc2", "", {}};
  Pc2Writer writer(folder / take.shapes, set.character.output_count(), static_cast<std::uint32_t>(frames));
  for (const trainer::Sample& sample : set.train) {
    clip.poses.push_back(sample.pose);
    writer.append(output_from_welded(set.character, sample.shape.read()));
    take.frames.push_back(sample.frame);
    if (heldout && sample.frame % 3 == 0) take.heldout.push_back(sample.frame);
  }
  writer.close();
  write_clip(clip, set.character.skeleton, folder / take.clip);
  return take;
}

// limb.glb and dataset.json with one take, muscles and two painted regions.
inline void write_limb_dataset(const std::filesystem::path& folder, int frames, const std::string& take = "bend") {
  std::filesystem::create_directories(folder);
  const Character limb = limb_character();
  write_character(limb, folder / "limb.glb");
  write_muscles(limb_muscles(), limb.skeleton, folder / "muscles.json");
  std::vector<RegionWeights> regions = {{"upper", {}, {}}, {"lower", {}, {}}};
  for (std::uint32_t v = 0; v < limb.output_count(); ++v) {
    RegionWeights& region = regions[limb.vertices(v, 2) < 0.3 ? 0 : 1];
    region.vertices.push_back(v);
    region.weights.push_back(1);
  }
  write_regions(regions, limb, folder / "regions.json");
  Dataset dataset;
  dataset.folder = folder;
  dataset.character = "limb.glb";
  dataset.muscles = "muscles.json";
  dataset.regions = "regions.json";
  dataset.takes.push_back(write_limb_take(folder, take, frames, true));
  write_dataset(dataset, folder / "dataset.json");
}

}  // namespace bodyopt::testing
