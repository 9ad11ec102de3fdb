#include "trainer/curate/keep_samples.h"

#include <filesystem>

#include "assets/pc2.h"
#include "base/content_hash.h"
#include "runtime/core/hexadecimal.h"

namespace bodyopt {

std::string keep_samples(const Dataset& dataset, const std::string& of, std::size_t count,
                         const std::function<std::vector<float>(std::size_t k)>& sample) {
  ContentHash hash;
  std::size_t size = 0;
  for (std::size_t k = 0; k < count; ++k) {
    const std::vector<float> own = sample(k);
    ContentHash of_sample;
    of_sample.append(own.data(), own.size() * sizeof(float));
    hash.add(of_sample.value());
    size = own.size();
  }
  const std::string name = "modifiers/" + of + "-" + hexadecimal(hash.value()) + ".pc2";
  std::error_code ignored;  // without the folder the writer refuses, naming the file
  std::filesystem::create_directories(dataset.folder / "modifiers", ignored);
  Pc2Writer writer(dataset.folder / name, static_cast<std::uint32_t>(size / 3), static_cast<std::uint32_t>(count));
  for (std::size_t k = 0; k < count; ++k) writer.append(sample(k));
  writer.close();
  return name;
}

}  // namespace bodyopt
