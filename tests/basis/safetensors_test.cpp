#include "runtime/basis/safetensors.h"

#include <gtest/gtest.h>

#include <cstring>
#include <limits>

#include "tests/support/hostile_bytes.h"
#include "tests/support/replaced_file.h"
#include "tests/support/temporary_folder.h"

namespace bodyopt {
namespace safetensors_test {

using namespace testing;

// A safetensors file of a header text and data bytes.
std::string container(const std::string& header, const std::string& data, std::uint64_t length) {
  std::string bytes(8, '\0');
  std::memcpy(bytes.data(), &length, 8);
  return bytes + header + data;
}
std::string container(const std::string& header, const std::string& data) {
  return container(header, data, header.size());
}

void read(const std::filesystem::path& path) { read_safetensors(path); }

TEST(Safetensors, ReadsAnotherWritersFile) {
  const TemporaryFolder folder;
  // As the reference implementation writes it: no checksum, padding, data not in the order of the names, an empty
  // tensor that shares its offset with the one after it, a scalar.
  const std::string header =
      R"({"__metadata__":{"format":"pt"},"b":{"dtype":"F32","shape":[2],"data_offsets":[0,8]},)"
      R"("z":{"dtype":"U32","shape":[0,3],"data_offsets":[8,8]},"a":{"dtype":"U32","shape":[],"data_offsets":[8,12]}}   )";
  write_bytes(folder / "a", container(header, std::string("\0\0\x80\x3f\0\0\0\x40\x07\0\0\0", 12)));
  const Safetensors file = read_safetensors(folder / "a");
  EXPECT_EQ(file.metadata.at("format"), "pt");
  float b[2];
  ASSERT_EQ(file.tensors.at("b").bytes.size(), 8u);
  std::memcpy(b, file.tensors.at("b").bytes.data(), 8);
  EXPECT_EQ(b[0], 1.0f);
  EXPECT_EQ(b[1], 2.0f);
  EXPECT_EQ(file.tensors.at("a").bytes[0], std::byte{7});
  EXPECT_EQ(file.tensors.at("z").shape, (std::vector<std::uint64_t>{0, 3}));
}

TEST(Safetensors, RefusesEveryImpossibleHeader) {
  const TemporaryFolder folder;
  const auto expect = [&](const std::string& bytes, const std::string& named) {
    expect_refused(read, folder / "a", bytes, named);
  };
  const auto tensor = [](const std::string& shape, const std::string& offsets, const std::string& dtype = "F32") {
    return container("{\"a\":{\"dtype\":\"" + dtype + "\",\"shape\":" + shape + ",\"data_offsets\":" + offsets + "}}",
                     std::string(8, 'x'));
  };
  expect("", "shorter than a header");
  expect("1234567", "shorter than a header");
  for (const std::uint64_t length : {std::uint64_t{3}, std::uint64_t{1} << 24, std::uint64_t{1} << 32,
                                     std::uint64_t{1} << 63, std::numeric_limits<std::uint64_t>::max()}) {
    expect(container("{}", "", length), "claims " + std::to_string(length));
  }
  expect(container("{\"a\"", ""), "JSON");
  expect(container("[]", ""), "not a JSON object");
  expect(container("{\"a\":1}", ""), "'a' is not an object");
  expect(container(std::string(1 << 20, '['), ""), "nested deeper");
  expect(container("{\"a\":{},\"a\":{}}", ""), "twice");
  expect(container("{\"\xff\":{}}", ""), "JSON");
  expect(container("{\"__metadata__\":{\"a\":1}}", ""), "metadata 'a'");
  expect(container("{\"a\":{\"dtype\":\"F32\",\"shape\":[2]}}", std::string(8, 'x')), "not described");
  expect(tensor("[2]", "[0,8],\"more\":1"), "not described");
  expect(tensor("2", "[0,8]"), "not described");
  expect(tensor("[2]", "[0,8,9]"), "not described");
  expect(tensor("[2]", "[-8,0]"), "not described");
  expect(tensor("[2]", "[0,8.5]"), "not described");
  expect(tensor("[-2]", "[0,8]"), "not of counts");
  expect(tensor("[1.5]", "[0,8]"), "not of counts");
  expect(tensor("[18446744073709551616]", "[0,8]"), "not of counts");
  expect(tensor("[2]", "[0,8]", "F16"), "type F16");
  expect(tensor("[2]", "[8,0]"), "lies at bytes");
  expect(tensor("[2]", "[0,18446744073709551615]"), "lies at bytes");
  expect(tensor("[1]", "[0,8]"), "expected 4 by its shape");
  expect(tensor("[4294967296,4294967296]", "[0,8]"), "larger than the file");  // the product is 0 in 64 bits
  expect(tensor("[4611686018427387905]", "[0,8]"), "larger than the file");    // 4 bytes each: 4 in 64 bits
  expect(tensor("[1]", "[4,8]"), "gap");
  expect(tensor("[1]", "[0,4]"), "4 bytes follow");
  expect(container("{\"a\":{\"dtype\":\"F32\",\"shape\":[2],\"data_offsets\":[0,8]},"
                   "\"b\":{\"dtype\":\"F32\",\"shape\":[1],\"data_offsets\":[4,8]}}",
                   std::string(8, 'x')),
         "overlaps");
}

TEST(Safetensors, ChecksumSeesStringsNamesTypesShapesAndBytes) {
  const Safetensors file{
      {{"a", {"F32", {2}, std::vector<std::byte>(8)}}, {"b", {"U32", {}, std::vector<std::byte>(4)}}},
      {{"key", "value"}, {"checksum", "x"}}};
  const auto changed = [&](const std::function<void(Safetensors&)>& change) {
    Safetensors other = file;
    change(other);
    return content_checksum(other) != content_checksum(file);
  };
  EXPECT_TRUE(changed([](Safetensors& f) { f.metadata["key"] = "other"; }));
  EXPECT_TRUE(changed([](Safetensors& f) { f.metadata["more"] = ""; }));
  EXPECT_TRUE(changed([](Safetensors& f) { f.tensors["a"].bytes[7] = std::byte{1}; }));
  EXPECT_TRUE(changed([](Safetensors& f) { f.tensors["a"].shape = {1, 2}; }));
  EXPECT_TRUE(changed([](Safetensors& f) { f.tensors["a"].dtype = "U32"; }));
  EXPECT_TRUE(changed([](Safetensors& f) { std::swap(f.tensors["a"], f.tensors["b"]); }));
  EXPECT_FALSE(changed([](Safetensors& f) { f.metadata["checksum"] = "y"; }));
}

TEST(Safetensors, WrongChecksumIsRefused) {
  const TemporaryFolder folder;
  Safetensors file{{{"a", {"F32", {2}, std::vector<std::byte>(8)}}}, {}};
  file.metadata["checksum"] = content_checksum(file);
  write_safetensors(file, folder / "a");
  EXPECT_NO_THROW(read(folder / "a"));
  std::string bytes = read_bytes(folder / "a");
  bytes.back() ^= 1;
  expect_refused(read, folder / "a", bytes, "checksum");
}

TEST(Safetensors, ThatIsReplacedMeanwhileIsOneOrTheOther) {
  const TemporaryFolder folder;
  const auto of = [](const std::string& shape, std::size_t bytes) {
    return container(
        R"({"a":{"dtype":"U32","shape":[)" + shape + R"(],"data_offsets":[0,)" + std::to_string(bytes) + "]}}",
        std::string(bytes, '\0'));
  };
  const ReplacedFile replaced(folder / "a", of("1", 4), of("3", 12));
  for (int k = 0; k < 20000; ++k) ASSERT_EQ(read_safetensors(folder / "a").tensors.size(), 1u);
}

}  // namespace safetensors_test
}  // namespace bodyopt
