#include "assets/caches/pc2.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>

#include "assets/caches/shape_reader.h"
#include "runtime/core/error.h"
#include "tests/support/damaged_cache.h"
#include "tests/support/hostile_bytes.h"
#include "tests/support/temporary_folder.h"

namespace bodyopt {
namespace pc2_test {

using namespace testing;

const std::vector<float> kFirst = {0, -0.0f, 1e-40f, 1.5f, -2.25f, 3e38f};
const std::vector<float> kSecond = {1, 2, 3, 4, 5, 6};

// Two samples of two points.
void write_small(const std::filesystem::path& path) {
  Pc2Writer writer(path, 2, 2, 1001, 0.5f);
  writer.append(kFirst);
  writer.append(kSecond);
  writer.close();
}

// A point 2 m to the left, 3 m up and 4 m ahead, for a program of centimetres with z up: 4 m against y.
TEST(Pc2, IsWrittenInAnotherUnitAndWithAnotherAxisUp) {
  const TemporaryFolder folder;
  const auto written = [&](const CacheSpace& space) {
    Pc2Writer writer(folder / "other.pc2", 1, 1, 1, 1, space);
    writer.append(std::vector<float>{2, 3, 4});
    writer.close();
    return Pc2Reader(folder / "other.pc2").sample(0);
  };
  EXPECT_EQ(written({}), (std::vector<float>{2, 3, 4}));
  EXPECT_EQ(written({0.01, false}), (std::vector<float>{200, 300, 400}));
  EXPECT_EQ(written({1, true}), (std::vector<float>{2, -4, 3}));
  EXPECT_EQ(written({0.5, true}), (std::vector<float>{4, -8, 6}));
}

// Metres that are finite, and no number of another unit.
TEST(Pc2, WhatIsNotFiniteInItsUnitIsRefused) {
  const TemporaryFolder folder;
  Pc2Writer writer(folder / "other.pc2", 1, 1, 1, 1, {1e-10, false});
  EXPECT_THROW(writer.append(std::vector<float>{1e30f, 0, 0}), Error);
}

// Reads everything, as a program that trusts its cache does.
void read(const std::filesystem::path& path) {
  const Pc2Reader reader(path);
  for (std::uint32_t k = 0; k < reader.sample_count(); ++k) reader.sample(k);
}

// A cache of a header and `bytes` bytes of zeros.
std::string cache(std::int32_t version, std::int32_t points, std::int32_t samples, std::size_t bytes,
                  float start_frame = 1, float sample_rate = 1) {
  std::string file("POINTCACHE2\0", 12);
  const auto add = [&](const auto& value) { file.append(reinterpret_cast<const char*>(&value), 4); };
  add(version);
  add(points);
  add(start_frame);
  add(sample_rate);
  add(samples);
  return file + std::string(bytes, '\0');
}

TEST(Pc2, RoundTripIsBitExact) {
  const TemporaryFolder folder;
  write_small(folder / "a.pc2");
  const Pc2Reader reader(folder / "a.pc2");
  EXPECT_EQ(reader.point_count(), 2u);
  EXPECT_EQ(reader.sample_count(), 2u);
  EXPECT_EQ(reader.start_frame(), 1001.0f);
  EXPECT_EQ(reader.sample_rate(), 0.5f);
  EXPECT_EQ(std::memcmp(reader.sample(0).data(), kFirst.data(), 24), 0);
  EXPECT_EQ(std::memcmp(reader.sample(1).data(), kSecond.data(), 24), 0);
}

TEST(Pc2, AFileThatIsCutOffWhileItIsReadIsRefused) {
  const TemporaryFolder folder;
  write_small(folder / "a.pc2");
  const Pc2Reader reader(folder / "a.pc2");
  std::filesystem::resize_file(folder / "a.pc2", 32 + 24 + 23);
  EXPECT_EQ(reader.sample(0).size(), 6u);
  try {
    reader.sample(1);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::file);
    EXPECT_NE(std::string(error.what()).find("sample 1 cannot be read"), std::string::npos) << error.what();
  }
}

TEST(Pc2, AFileThatIsReplacedOrTakenAwayIsReadAsItWas) {
  const TemporaryFolder folder;
  write_small(folder / "a.pc2");
  const Pc2Reader reader(folder / "a.pc2");
  Pc2Writer writer(folder / "a.pc2", 1, 0);
  writer.close();
  EXPECT_EQ(reader.sample(1), kSecond);
  std::filesystem::remove(folder / "a.pc2");
  EXPECT_EQ(reader.sample(1), kSecond);
}

TEST(Pc2, BytesAreThoseOfTheFormat) {
  const TemporaryFolder folder;
  write_small(folder / "a.pc2");
  std::string expected = cache(1, 2, 2, 0, 1001, 0.5f);
  expected.append(reinterpret_cast<const char*>(kFirst.data()), 24);
  expected.append(reinterpret_cast<const char*>(kSecond.data()), 24);
  EXPECT_EQ(read_bytes(folder / "a.pc2"), expected);
}

TEST(Pc2, ReaderMoves) {
  const TemporaryFolder folder;
  write_small(folder / "a.pc2");
  Pc2Reader a(folder / "a.pc2");
  Pc2Reader b(std::move(a));
  a = std::move(b);
  EXPECT_EQ(a.sample(1)[5], 6.0f);
}

TEST(Pc2, ACacheWithoutSamplesIsOne) {
  const TemporaryFolder folder;
  Pc2Writer(folder / "a.pc2", 3, 0).close();
  EXPECT_EQ(Pc2Reader(folder / "a.pc2").sample_count(), 0u);
}

TEST(Pc2, EveryTruncationIsRefused) {
  const TemporaryFolder folder;
  write_small(folder / "a.pc2");
  expect_every_truncation_refused(read, folder / "b.pc2", read_bytes(folder / "a.pc2"));
}

TEST(Pc2, DamagedBytesGiveRefusalOrNumbers) {
  const TemporaryFolder folder;
  write_small(folder / "a.pc2");
  const std::size_t refused = damage_bytes(read, folder / "b.pc2", read_bytes(folder / "a.pc2"), 5000);
  EXPECT_GT(refused, 1500u);  // 24 of 80 bytes are the magic, the version and the counts
}

TEST(Pc2, HostileHeadersAreRefused) {
  const TemporaryFolder folder;
  const auto expect = [&](const std::string& bytes, const std::string& named) {
    expect_refused(read, folder / "a.pc2", bytes, named);
  };
  const std::int32_t most = std::numeric_limits<std::int32_t>::max();
  const float nan = std::numeric_limits<float>::quiet_NaN(), infinity = std::numeric_limits<float>::infinity();
  expect(cache(1, 2, 2, 49), "49 bytes after the header");
  expect(cache(1, 2, 2, 60), "60 bytes after the header");
  expect(cache(2, 2, 2, 48), "version is 2");
  expect(cache(1, -2, 2, 48), "-2 points");
  expect(cache(1, 2, -2, 48), "-2 samples");
  expect(cache(1, 0, most, 0), "0 points");
  expect(cache(1, most, most, 48), "samples of");
  expect(cache(1, 2, 2, 48, nan), "start frame");
  expect(cache(1, 2, 2, 48, 1, infinity), "sample rate");
  expect(cache(1, 848'032'978, 1'812'699'167, 296), "samples of");  // 12 x their product is 2^64 + 296
  std::string other = cache(1, 2, 2, 48);
  other[5] = 'X';
  expect(other, "POINTCACHE2");
}

// Big-endian, as LightWave and Blender write it.
std::string mdd(std::uint32_t samples, std::uint32_t points, const std::vector<float>& numbers) {
  std::string file;
  const auto add = [&](std::uint32_t word) {
    for (int byte = 3; byte >= 0; --byte) file += static_cast<char>(word >> 8 * byte & 0xff);
  };
  add(samples);
  add(points);
  for (const float number : numbers) add(std::bit_cast<std::uint32_t>(number));
  return file;
}

std::string small_mdd() {
  std::vector<float> numbers = {0, 0.04f};  // seconds
  numbers.insert(numbers.end(), kFirst.begin(), kFirst.end());
  numbers.insert(numbers.end(), kSecond.begin(), kSecond.end());
  return mdd(2, 2, numbers);
}

TEST(Mdd, IsReadWhereAPc2Is) {
  const TemporaryFolder folder;
  for (const char* name : {"a.mdd", "a.MDD"}) {
    write_bytes(folder / name, small_mdd());
    const ShapeReader reader(folder / name);
    EXPECT_EQ(reader.point_count(), 2u);
    EXPECT_EQ(reader.sample_count(), 2u);
    EXPECT_EQ(reader.start_frame(), 1.0f);
    EXPECT_EQ(reader.sample_rate(), 1.0f);
    const std::vector<float> first = reader.sample(0);
    EXPECT_EQ(std::memcmp(first.data(), kFirst.data(), 24), 0);
    EXPECT_EQ(reader.sample(1), kSecond);
  }
}

TEST(Mdd, IsWrittenAsOthersWriteIt) {
  const TemporaryFolder folder;
  Pc2Writer writer(folder / "w.mdd", 2, 2, 1001, 1, {}, 25);
  writer.append(kFirst);
  writer.put_aside(folder / "aside");
  Pc2Writer rest(folder / "w.mdd", 2, 2, 1001, 1, {}, 25);
  rest.take_up(folder / "aside", 1);
  rest.append(kSecond);
  rest.close();
  EXPECT_EQ(read_bytes(folder / "w.mdd"), small_mdd());
  Pc2Writer other(folder / "other.mdd", 1, 1, 1, 1, {0.5, true});
  other.append(std::vector<float>{2, 3, 4});
  other.close();
  EXPECT_EQ(Pc2Reader(folder / "other.mdd").sample(0), (std::vector<float>{4, -8, 6}));
}

TEST(Mdd, DamagedOnesAreRefusedOrGiveNumbers) {
  const TemporaryFolder folder;
  expect_every_truncation_refused(read, folder / "a.mdd", small_mdd());
  EXPECT_GT(damage_bytes(read, folder / "a.mdd", small_mdd(), 2000), 200u);
  const std::uint32_t most = std::numeric_limits<std::int32_t>::max();
  const auto expect = [&](const std::string& bytes, const std::string& named) {
    expect_refused(read, folder / "a.mdd", bytes, named);
  };
  expect(mdd(1, 0, {0}), "0 points");
  expect(mdd(most + 1, 1, {0}), "samples of 1 points");
  expect(mdd(most, most, {0}), "samples of");
  expect(mdd(1, 1, {0, 1, std::nanf(""), 3}), "sample 0, point 0");
  expect(mdd(1, 1, {0, 1, 2, 3, 4}), "16 bytes after the header");
}

TEST(Mdd, CachesByWrongNamesAndAlembicAreNamed) {
  const TemporaryFolder folder;
  write_small(folder / "a.pc2");
  expect_refused(read, folder / "b.mdd", read_bytes(folder / "a.pc2"), "looks like a PC2 point cache");
  expect_refused(read, folder / "b.pc2", small_mdd(), "call it .mdd");
  for (const char* name : {"b.abc", "b.pc2", "b.mdd"}) {
    expect_refused(read, folder / name, "Ogawa" + std::string(100, '\1'), "an Alembic cache (.abc): Blender");
    expect_refused(read, folder / name, "\x89HDF" + std::string(100, '\1'), "an Alembic cache (.abc): Houdini");
  }
}

TEST(Pc2, NanIsNamed) {
  const TemporaryFolder folder;
  write_small(folder / "a.pc2");
  put_nan(folder / "a.pc2", 1, 4);
  const Pc2Reader reader(folder / "a.pc2");
  EXPECT_EQ(reader.sample(0).size(), 6u);
  try {
    reader.sample(1);
    FAIL();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("sample 1, point 1"), std::string::npos) << error.what();
  }
}

TEST(Pc2, NumbersThatAreNotFiniteAreNotWritten) {
  const TemporaryFolder folder;
  for (const float damaged : {std::nanf(""), std::numeric_limits<float>::infinity()}) {
    expect_refused(
        [&](const auto& path) {
          Pc2Writer writer(path, 2, 1);
          writer.append(std::vector<float>{1, 2, 3, damaged, 5, 6});
        },
        folder / "a.pc2", "the old one", "sample 0, point 1");
    EXPECT_EQ(read_bytes(folder / "a.pc2"), "the old one");
  }
}

TEST(Pc2, SamplesOutsideAreRefused) {
  const TemporaryFolder folder;
  write_small(folder / "a.pc2");
  EXPECT_TRUE(refuses([](const auto& path) { Pc2Reader(path).sample(2); }, folder / "a.pc2", "sample 2"));
}

TEST(Pc2, WhatIsNotAFileIsRefused) {
  const TemporaryFolder folder;
  ASSERT_EQ(mkfifo((folder / "pipe").c_str(), 0600), 0);
  for (const std::filesystem::path& path :
       {folder / "nowhere", folder.path(), folder / "pipe", std::filesystem::path("/dev/zero")}) {
    EXPECT_TRUE(refuses(read, path, path.string()));
  }
}

TEST(Pc2, AWriterThatDoesNotEndLeavesNothing) {
  const TemporaryFolder folder;
  const auto write_one_of_two = [](const auto& path) {
    Pc2Writer writer(path, 2, 2);
    writer.append(kFirst);
    writer.close();
  };
  EXPECT_TRUE(refuses(write_one_of_two, folder / "a.pc2", "too few"));
  const auto write_three_of_two = [](const auto& path) {
    Pc2Writer writer(path, 2, 2);
    for (int k = 0; k < 3; ++k) writer.append(kFirst);
  };
  EXPECT_TRUE(refuses(write_three_of_two, folder / "a.pc2", "too many"));
  const auto write_other_points = [](const auto& path) { Pc2Writer(path, 3, 2).append(kFirst); };
  EXPECT_TRUE(refuses(write_other_points, folder / "a.pc2", "other points"));
  const auto write_with = [](std::uint32_t points, std::uint32_t samples) {
    return [=](const auto& path) { Pc2Writer(path, points, samples); };
  };
  EXPECT_TRUE(refuses(write_with(0, 1), folder / "a.pc2", "no points"));
  EXPECT_TRUE(refuses(write_with(1u << 31, 1), folder / "a.pc2", "2^31 points"));
  EXPECT_TRUE(refuses(write_with(1, 1u << 31), folder / "a.pc2", "2^31 samples"));
  EXPECT_TRUE(refuses(write_with(1, 1), folder / "nowhere/a.pc2", "no folder"));
  EXPECT_TRUE(refuses(write_with(1, 1), folder.path(), "a folder"));
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

}  // namespace pc2_test
}  // namespace bodyopt
