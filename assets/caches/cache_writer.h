// Shapes of a clip, frame by frame, to a file of the format that its name asks for.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "assets/caches/pc2.h"
#include "assets/gltf/skin_surface.h"

namespace bodyopt {

struct BoundSkin;

// The properties that all frames of a cache have in common.
struct CacheLayout {
  std::string name;                        // of the prim in a .usda, the mesh in a .glb; any text
  std::uint32_t points = 0;                // 1 or more
  std::span<const std::uint32_t> corners;  // T x 3, of the triangles: a .pc2 does not hold them
  std::vector<int> frames;                 // the number of every frame that will be appended, rising
  double fps = 24;
  CacheSpace space{};     // PC2's and MDD's; the others are in metres, Y up
  SkinSurface surface{};  // that a .glb shows; of it a .usda has the texture coordinates
  // A .glb or .usda is then its joints, the skin that follows them, and a blend shape for every frame; or null. It must
  // outlive the writer.
  const BoundSkin* bound = nullptr;
};

// Writes under a temporary name. Numbers that are not finite are refused: Error(file).
class CacheWriter {
 public:
  virtual ~CacheWriter() = default;
  // Appends the next frame. `positions`: points x 3, metres, world. `normals`: points x 3, or empty where the cache has
  // none (then in every frame); only USD text holds them.
  virtual void append(std::span<const float> positions, std::span<const float> normals) = 0;
  // Renames into place. Throws Error(file) where frames are missing.
  virtual void close() = 0;

  // Puts the frames so far aside as files whose names begin with `stem`, instead of close(), and returns these.
  virtual std::vector<std::filesystem::path> put_aside(const std::filesystem::path& stem) = 0;
  // Begins a new writer of the same layout with the `frames` frames that put_aside() left.
  virtual void take_up(const std::filesystem::path& stem, std::size_t frames) = 0;
};

// Check of a writer with `done` frames that the next fits, and that none are missing. Throw Error(mismatch), and
// Error(file) for numbers that are not finite, and where frames are missing.
void require_sample(const std::filesystem::path& path, const CacheLayout& layout, std::size_t done,
                    std::span<const float> values);
void require_all_samples(const std::filesystem::path& path, const CacheLayout& layout, std::size_t done);

// The file of the points that put_aside() leaves.
std::filesystem::path points_aside(const std::filesystem::path& stem);

// The endings of caches, as missing_ending() takes them.
inline constexpr char kCacheEndings[] = ".pc2|.mdd|.usda|.glb";

// `.usda`: USD text, see usda.h; `.glb`: glTF with morph targets, see gltf_shapes.h; `.mdd` and anything else: MDD and
// PC2, see pc2.h. Throws Error(file), Error(usage).
std::unique_ptr<CacheWriter> write_cache(const std::filesystem::path& path, CacheLayout layout);

// Throws Error(usage) where a file of that name is there that write_cache() does not replace.
void require_replaceable_cache(const std::filesystem::path& path);

// Whether caches of that name hold the triangles of the skin, in metres, Y up; and the normals that they are given.
bool holds_triangles(const std::filesystem::path& path);
bool holds_normals(const std::filesystem::path& path);

}  // namespace bodyopt
