// What is not the driver's own is no data for it.
#include "runtime/vulkan/pipeline_cache.h"

#include "tests/fuzz/fuzz_target.h"

namespace bodyopt::fuzz {
namespace {

std::vector<std::string> seeds() { return {vulkan::pack_pipelines({}, "of a driver"), vulkan::pack_pipelines({}, "")}; }

void read(const std::string& bytes) { vulkan::unpack_pipelines({}, bytes); }

const bool added = add_target({"pipeline_cache", seeds, read});

}  // namespace
}  // namespace bodyopt::fuzz
