#include "assets/caches/join_caches.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "assets/caches/pc2.h"
#include "assets/caches/usda.h"
#include "assets/caches/usda_part.h"
#include "base/progress.h"
#include "runtime/core/atomic_file.h"
#include "runtime/core/error.h"
#include "runtime/core/transformed.h"

namespace bodyopt {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void refuse_part(const fs::path& path, const auto&... what) {
  throw Error(ErrorKind::mismatch, path, ": ", what...);
}

void require_apart(const fs::path& before, int last, const fs::path& after, int first) {
  if (first > last) return;
  refuse_part(after, "begins with frame ", first, ", and ", before, " ends with frame ", last,
              ": parts of one shot have no frames in common");
}

int frame_number(const fs::path& path, double frame) {
  if (std::abs(frame) <= 1e7 && frame == std::floor(frame)) return static_cast<int>(frame);
  refuse_part(path, "its samples are not at whole frames: it is no part that 'bodyopt eval' wrote");
}

std::vector<int> frames_of(const Pc2Reader& part) {
  std::vector<int> frames;
  for (std::uint32_t k = 0; k < part.sample_count(); ++k) {
    frames.push_back(frame_number(part.path(), static_cast<double>(part.start_frame()) +
                                                   static_cast<double>(k) * static_cast<double>(part.sample_rate())));
  }
  return frames;
}

void join_pc2(const std::vector<fs::path>& paths, const fs::path& out) {
  std::vector<Pc2Reader> parts = transformed(paths, [&](const fs::path& path) { return Pc2Reader(path); });
  std::ranges::sort(parts, [](const Pc2Reader& a, const Pc2Reader& b) { return a.start_frame() < b.start_frame(); });
  std::vector<int> frames;
  for (std::size_t k = 0; k < parts.size(); ++k) {
    if (parts[k].point_count() != parts[0].point_count()) {
      refuse_part(parts[k].path(), "has ", parts[k].point_count(), " points, and ", parts[0].path(), " has ",
                  parts[0].point_count(), ": caches of two meshes");
    }
    const std::vector<int> more = frames_of(parts[k]);
    if (k > 0 && !frames.empty() && !more.empty()) {
      require_apart(parts[k - 1].path(), frames.back(), parts[k].path(), more.front());
    }
    frames.insert(frames.end(), more.begin(), more.end());
  }
  Pc2Writer writer(out, parts[0].point_count(), static_cast<std::uint32_t>(frames.size()),
                   frames.empty() ? 1.0f : static_cast<float>(frames.front()), frame_spacing(frames));
  Progress progress("join", frames.size());
  for (const Pc2Reader& part : parts) {
    for (std::uint32_t k = 0; k < part.sample_count(); ++k) {
      writer.append(part.sample(k));
      progress.advance();
    }
  }
  writer.close();
}

void join_usda(const std::vector<fs::path>& paths, const fs::path& out) {
  std::vector<UsdaPart> parts = transformed(paths, [&](const fs::path& path) { return UsdaPart(path); });
  std::ranges::sort(parts, [](const UsdaPart& a, const UsdaPart& b) { return a.frames() < b.frames(); });
  std::size_t frames = 0;
  for (std::size_t k = 0; k < parts.size(); ++k) {
    if (parts[k].head() != parts[0].head() || parts[k].between() != parts[0].between()) {
      refuse_part(parts[k].path(), "is of another mesh or frame rate than ", parts[0].path());
    }
    if (k > 0) {
      require_apart(parts[k - 1].path(), parts[k - 1].frames().back(), parts[k].path(), parts[k].frames().front());
    }
    frames += parts[k].frames().size();
  }
  AtomicFile file(out);
  Progress progress("join", 2 * frames);
  const auto write_samples = [&](const std::string& opening) {
    file.write(opening + '\n');
    for (UsdaPart& part : parts) {
      part.for_samples(opening, [&](const std::string& line) {
        file.write(line + '\n');
        progress.advance();
      });
    }
  };
  file.write(parts.front().opening(parts.back().last_frame()));
  write_samples(kUsdaPointSamples);
  file.write(parts.front().between());
  if (parts.front().has_normals()) {
    write_samples(kUsdaNormalSamples);
    file.write(std::string(kUsdaSamplesEnd) + "\n}\n");
  }
  copy_usd_images(parts.front().head(), parts.front().path().parent_path(), out.parent_path());
  file.commit();
}

}  // namespace

bool can_join(const fs::path& cache) { return cache.extension() != ".glb" && cache.extension() != ".mdd"; }

void join_caches(const std::vector<fs::path>& parts, const fs::path& out) {
  if (parts.empty()) throw Error(ErrorKind::usage, out, ": there are no parts to join");
  for (const fs::path& part : parts) {
    if (part.extension() == out.extension()) continue;
    refuse_part(part, "and ", out, " are of different formats: parts and whole are all .pc2 or all .usda");
  }
  if (out.extension() == ".glb") {
    throw Error(ErrorKind::usage, out,
                ": parts of glTF cannot be joined: evaluate the whole shot to one .glb, or its parts to .pc2 or .usda");
  }
  if (out.extension() == ".mdd") {
    throw Error(ErrorKind::usage, out,
                ": parts of MDD cannot be joined, for they do not tell their frames: evaluate the parts to .pc2");
  }
  if (out.extension() == ".usda") {
    join_usda(parts, out);
  } else {
    join_pc2(parts, out);
  }
}

}  // namespace bodyopt
