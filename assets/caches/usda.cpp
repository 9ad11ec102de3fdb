#include "assets/caches/usda.h"

#include <algorithm>
#include <charconv>
#include <utility>

#include "base/parallel.h"
#include "runtime/core/error.h"
#include "runtime/core/text.h"

namespace bodyopt {
namespace {

namespace fs = std::filesystem;

std::string list_of(std::span<const std::uint32_t> numbers) {
  return usda_list(numbers, [](std::uint32_t number) { return std::to_string(number); });
}

std::string topology(std::span<const std::uint32_t> corners) {
  const std::vector<std::uint32_t> counts(corners.size() / 3, 3);
  return "    int[] faceVertexCounts = " + list_of(counts) + "\n    int[] faceVertexIndices = " + list_of(corners) +
         "\n";
}

// Texture coordinates, whose second one USD counts from below.
std::string coordinates(const std::vector<double>& texture, const std::vector<std::uint32_t>& of_corners) {
  std::string text;
  for (std::size_t k = 0; k < texture.size(); ++k) {
    text += k % 2 != 0 ? ", " : k == 0 ? "    texCoord2f[] primvars:st = [(" : "), (";
    text += shortest(static_cast<float>(k % 2 == 0 ? texture[k] : 1 - texture[k]));
  }
  if (text.empty()) return text;
  const char* const each = of_corners.empty() ? "vertex" : "faceVarying";
  text += std::string(")] (\n        interpolation = \"") + each + "\"\n    )\n";
  if (!of_corners.empty()) text += "    int[] primvars:st:indices = " + list_of(of_corners) + "\n";
  return text;
}

// Finite numbers, three a point; `first`: nothing stands before them.
std::string points_text(std::span<const float> values, bool first) {
  constexpr std::size_t kLongest = 20;  // -1.17549435e-38 with what stands before and behind it
  std::string text(kLongest * values.size(), ' ');
  char* to = text.data();
  for (std::size_t k = 0; k < values.size(); ++k) {
    if (k > 0 || !first) *to++ = ',', *to++ = ' ';
    if (k % 3 == 0) *to++ = '(';
    to = std::to_chars(to, text.data() + text.size(), values[k]).ptr;
    if (k % 3 == 2) *to++ = ')';
  }
  text.resize(static_cast<std::size_t>(to - text.data()));
  return text;
}

std::string vertex_colours(const std::vector<double>& colours) {
  if (colours.empty()) return "";
  const std::vector<float> shares(colours.begin(), colours.end());
  return "    color3f[] primvars:displayColor = [" + points_text(shares, true) +
         "] (\n        interpolation = \"vertex\"\n    )\n";
}

std::string head(const CacheLayout& layout) {
  const int first = layout.frames.empty() ? 0 : layout.frames.front();
  const int last = layout.frames.empty() ? 0 : layout.frames.back();
  const std::string prim = prim_name(layout.name);
  return usda_head(prim, first, last, shortest(layout.fps)) + "def Mesh \"" + prim + "\"\n{\n" +
         usda_mesh(layout, "/" + prim) + kUsdaPointSamples + '\n';
}

std::string head_of_normals() {
  return std::string(kUsdaSamplesEnd) + "\n    uniform token normals:interpolation = \"vertex\"\n" +
         kUsdaNormalSamples + '\n';
}

constexpr char kTail[] = "    }\n}\n";

fs::path normals_aside(const fs::path& stem) { return fs::path(stem) += ".normals"; }

}  // namespace

std::string usda_mesh(const CacheLayout& layout, const std::string& prim) {
  return "    uniform token orientation = \"rightHanded\"\n    uniform token subdivisionScheme = \"none\"\n" +
         topology(layout.corners) +
         coordinates(image_coordinates(layout.surface, layout.corners), layout.surface.texture_of) +
         vertex_colours(layout.surface.colours) + usd_materials(layout.surface, layout.name, prim);
}

std::string usda_points(std::span<const float> values) {
  constexpr std::size_t kNumbers = 3 * 1024;  // that one thread prints at a time
  std::vector<std::string> parts((values.size() + kNumbers - 1) / kNumbers);
  parallel_for(parts.size(), [&](std::size_t k) {
    parts[k] = points_text(values.subspan(kNumbers * k, std::min(kNumbers, values.size() - kNumbers * k)), k == 0);
  });
  std::string text = "[";
  for (const std::string& part : parts) text += part;
  return text + "]";
}

std::string usda_head(const std::string& prim, int first_frame, int last_frame, const std::string& fps) {
  return concat("#usda 1.0\n(\n    defaultPrim = \"", prim, "\"\n    startTimeCode = ", first_frame, "\n",
                kUsdaLastFrame, last_frame, "\n    framesPerSecond = ", fps, "\n    timeCodesPerSecond = ", fps,
                "\n    metersPerUnit = 1\n    upAxis = \"Y\"\n)\n\n");
}

UsdaWriter::UsdaWriter(const fs::path& path, CacheLayout layout)
    : path_(path), layout_(std::move(layout)), points_(path), normals_(path) {
  points_.write(head(layout_));
}

void UsdaWriter::write_sample(AtomicFile& file, std::span<const float> values) const {
  require_sample(path_, layout_, written_, values);
  file.write("        " + std::to_string(layout_.frames[written_]) + ": " + usda_points(values) + ",\n");
}

void UsdaWriter::append(std::span<const float> positions, std::span<const float> normals) {
  write_sample(points_, positions);
  has_normals_ = !normals.empty();
  if (has_normals_) write_sample(normals_, normals);
  ++written_;
}

void UsdaWriter::close() {
  require_all_samples(path_, layout_, written_);
  if (has_normals_) {
    points_.write(head_of_normals());
    points_.write_unfinished(normals_);
  }
  points_.write(kTail);
  write_usd_images(layout_.surface, layout_.name, path_.parent_path());
  points_.commit();
}

std::vector<fs::path> UsdaWriter::put_aside(const fs::path& stem) {
  points_.put_aside(points_aside(stem));
  normals_.put_aside(normals_aside(stem));
  return {points_aside(stem), normals_aside(stem)};
}

void UsdaWriter::take_up(const fs::path& stem, std::size_t frames) {
  points_.restart();
  points_.write_file(points_aside(stem));
  normals_.write_file(normals_aside(stem));
  has_normals_ = frames > 0 && fs::file_size(normals_aside(stem)) > 0;
  written_ = frames;
}

}  // namespace bodyopt
