#include "assets/caches/shape_reader.h"

#include "assets/caches/nodes_cache.h"
#include "assets/caches/pc2.h"

namespace bodyopt {
namespace {

std::variant<Pc2Reader, NodesReader> open_cache(const std::filesystem::path& path) {
  if (path.extension() == ".nodes") return NodesReader(path);
  return Pc2Reader(path);
}

}  // namespace

ShapeReader::ShapeReader(const std::filesystem::path& path)
    : reader_(std::make_unique<const std::variant<Pc2Reader, NodesReader>>(open_cache(path))) {}
ShapeReader::ShapeReader(ShapeReader&&) noexcept = default;
ShapeReader::~ShapeReader() = default;

std::uint32_t ShapeReader::point_count() const {
  return std::visit([](const auto& reader) { return reader.point_count(); }, *reader_);
}

std::uint32_t ShapeReader::sample_count() const {
  return std::visit([](const auto& reader) { return reader.sample_count(); }, *reader_);
}

float ShapeReader::start_frame() const {
  return std::visit([](const auto& reader) { return reader.start_frame(); }, *reader_);
}

float ShapeReader::sample_rate() const {
  return std::visit([](const auto& reader) { return reader.sample_rate(); }, *reader_);
}

std::vector<float> ShapeReader::sample(std::uint32_t k) const {
  return std::visit([k](const auto& reader) { return reader.sample(k); }, *reader_);
}

}  // namespace bodyopt
