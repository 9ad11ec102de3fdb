// libFuzzer on every reader of bytes from outside:
//   bodyopt_fuzz --list                        names of the readers
//   bodyopt_fuzz --write-seeds=DIR             sound bytes for each, in DIR/READER, and their words in DIR/READER.dict
//   bodyopt_fuzz --reader=READER [libFuzzer's options] [CORPUS]
#include <tbb/global_control.h>
#include <unistd.h>

#include <cstdint>
#include <cstring>
#include <fstream>
#include <iterator>
#include <random>
#include <regex>
#include <set>

#include "runtime/core/error.h"
#include "tests/fuzz/fuzz_target.h"
#include "tests/fuzz/memory_watch.h"
#include "tests/support/temporary_folder.h"

namespace bodyopt::fuzz {
namespace {

namespace fs = std::filesystem;

const FuzzTarget* chosen = nullptr;

// Words of the seeds, which libFuzzer puts elsewhere: keys of JSON, elements of XML.
void write_dictionary(const std::vector<std::string>& seeds, const fs::path& path) {
  constexpr std::size_t kMostWords = 300;
  static const std::regex word("[A-Za-z_][A-Za-z0-9_.-]{2,40}");
  std::set<std::string> words;
  for (const std::string& seed : seeds) {
    for (std::sregex_iterator found(seed.begin(), seed.end(), word), end; found != end; ++found) {
      if (words.size() < kMostWords) words.insert(found->str());
    }
  }
  std::ofstream file(path);
  for (const std::string& each : words) file << '"' << each << "\"\n";
}

void write_seeds(const fs::path& folder) {
  for (const FuzzTarget& target : targets()) {
    const std::vector<std::string> seeds = target.seeds();
    fs::create_directories(folder / target.name);
    for (std::size_t k = 0; k < seeds.size(); ++k) {
      target.read(seeds[k]);  // sound, or they teach nothing
      std::ofstream(folder / target.name / std::to_string(k), std::ios::binary) << seeds[k];
    }
    write_dictionary(seeds, folder / (target.name + ".dict"));
  }
}

void choose(const std::string& name) {
  for (const FuzzTarget& target : targets()) {
    if (target.name == name) chosen = &target;
  }
}

bool starts(const std::string& argument, const std::string& option, std::string& value) {
  if (!argument.starts_with(option)) return false;
  value = argument.substr(option.size());
  return true;
}

// Where the numbers of a safetensors file begin; 0 of any other.
std::size_t numbers_begin(const std::uint8_t* bytes, std::size_t size) {
  std::uint64_t header = 0;
  if (size < 16) return 0;
  std::memcpy(&header, bytes, sizeof(header));
  return header < size - 8 ? static_cast<std::size_t>(8 + header) : 0;
}

// A word of the numbers by one of the worst there are: infinite, none, largest, just large, -1, -0.
void forge_number(std::uint8_t* bytes, std::size_t begin, std::size_t size, std::minstd_rand& random) {
  const std::uint32_t worst[] = {0x7f800000u, 0xffc00000u, 0x7f7fffffu, 0x60ad78ecu, 0x4e6e6b28u,
                                 0xffffffffu, 0x80000000u, 0x7fe00000u, 0u,          1u};
  const std::uint32_t word = worst[random() % std::size(worst)];
  std::memcpy(bytes + begin + 4 * (random() % ((size - begin) / 4)), &word, sizeof(word));
}

int initialize(const std::vector<std::string>& arguments) {
  for (const std::string& argument : arguments) {
    std::string value;
    if (argument == "--list") {
      for (const FuzzTarget& target : targets()) std::cout << target.name << '\n';
      std::exit(0);
    } else if (starts(argument, "--write-seeds=", value)) {
      write_seeds(value);
      std::exit(0);
    } else if (starts(argument, "--reader=", value)) {
      choose(value);
    }
  }
  if (chosen) return 0;
  std::cerr << "usage: bodyopt_fuzz --list | --write-seeds=DIR | --reader=READER [libFuzzer's options]\n";
  std::exit(64);
}

}  // namespace

std::vector<FuzzTarget>& targets() {
  static std::vector<FuzzTarget> all;
  return all;
}

fs::path as_file(const std::string& name, const std::string& bytes) {
  static const TemporaryFolder folder;
  const fs::path path = folder / name;
  fs::remove(path);
  std::ofstream(path, std::ios::binary).write(bytes.data(), std::ssize(bytes));
  return path;
}

std::string with_checksum(const std::string& bytes) {
  const std::string key = "\"checksum\":\"", other_key = "\"checkszz\":\"";
  const std::size_t at = bytes.find(key);
  if (at == std::string::npos || bytes.size() < at + key.size() + 17) return bytes;
  // Under a key of the same length it is not looked at.
  std::string other = bytes;
  other.replace(at, key.size(), other_key);
  try {
    Safetensors file = read_safetensors(as_file("unsigned", other));
    file.metadata.erase("checkszz");
    std::string with = bytes;
    return with.replace(at + key.size(), 16, content_checksum(file));
  } catch (const Error&) {
    return bytes;
  }
}

}  // namespace bodyopt::fuzz

extern "C" int LLVMFuzzerInitialize(int* argc, char*** argv) {
  static const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
  bodyopt::fuzz::watch_memory();
  return bodyopt::fuzz::initialize({*argv + 1, *argv + *argc});
}

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t max_size);

// Every other change to a file of tensors is to its numbers: the header would nearly always be broken else.
extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t max_size,
                                               unsigned seed) {
  std::minstd_rand random(seed + 1);
  const std::size_t begin = bodyopt::fuzz::numbers_begin(data, size);
  if (begin == 0 || size - begin < 4 || random() % 2 == 0) return LLVMFuzzerMutate(data, size, max_size);
  for (auto n = 1 + random() % 3; n > 0; --n) bodyopt::fuzz::forge_number(data, begin, size, random);
  return size;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using bodyopt::ErrorKind;
  bodyopt::fuzz::begin_read(static_cast<std::size_t>(bodyopt::fuzz::chosen->most_mib) * (1 + size / 1024));
  try {
    bodyopt::fuzz::chosen->read({reinterpret_cast<const char*>(data), size});
  } catch (const bodyopt::Error& error) {
    const bool refuses =
        error.kind() == ErrorKind::file || error.kind() == ErrorKind::mismatch || error.kind() == ErrorKind::usage;
    if (!refuses) throw;
  }
  bodyopt::fuzz::end_read();
  return 0;
}
