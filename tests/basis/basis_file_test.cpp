#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "runtime/basis/basis.h"
#include "runtime/basis/safetensors.h"
#include "runtime/core/json.h"
#include "runtime/deformer/deformer.h"
#include "runtime/host/device_choice.h"
#include "tests/support/error_kind.h"
#include "tests/support/forged_word.h"
#include "tests/support/hostile_bytes.h"
#include "tests/support/paths.h"
#include "tests/support/same_basis.h"
#include "tests/support/small_basis.h"
#include "tests/support/temporary_folder.h"

namespace bodyopt {
namespace {

using namespace testing;
void read(const std::filesystem::path& path) { load_basis(path); }

// A basis without strain and residual, as `train --ddm-only` makes it.
Basis ddm_only() {
  Basis basis = small_basis();
  basis.strain = {};
  basis.residual = {};
  basis.residual.blend_begin.assign(basis.mesh.block_count() + 1, 0);
  return basis;
}

// One joint, one triangle that it carries rigidly: every prefix of its file can be tried.
Basis one_triangle() {
  Basis basis;
  basis.skeleton.joints.resize(1);
  basis.skeleton.joints[0].name = "root";
  basis.mesh.rest = {0, 0, 0, 1, 0, 0, 0, 1, 0};
  basis.mesh.triangles = basis.mesh.output_triangles = basis.mesh.output_vertex = {0, 1, 2};
  basis.mesh.vertex_triangle_begin = {0, 1, 2, 3};
  basis.mesh.vertex_triangles = {0, 0, 0};
  basis.ddm.block_begin = {0, 1};
  basis.ddm.block_joints = {0};
  basis.ddm.moments.resize(kMomentWords * kBlockSize);
  basis.ddm.vertices.resize(kBlockSize);
  basis.residual.blend_begin = {0, 0};
  return basis;
}

// Poses that bend, twist and move the small basis.
std::vector<Pose> test_poses(const Skeleton& skeleton) {
  std::vector<Pose> poses = {bind_pose(skeleton)};
  for (const double angle : {0.5, 2.0}) {
    Pose pose = bind_pose(skeleton);
    pose.joints[0].translation = {0.3, -2, 10};
    pose.joints.back().rotation = axis_angle({1, 0.2, 0}, angle) * pose.joints.back().rotation;
    poses.push_back(pose);
  }
  return poses;
}

TEST(SmallBasis, IsValidAndRestsAtRest) {
  const Basis basis = small_basis();
  EXPECT_NO_THROW(validate(basis, "small"));
  Deformer deformer(basis, {.name = "cpu"});
  const Pose rest = bind_pose(basis.skeleton);
  const Evaluation evaluation = deformer.evaluate({&rest, 1});
  ASSERT_EQ(evaluation.positions.size(), 3 * std::size_t{basis.mesh.output_count()});
  for (std::size_t o = 0; o < basis.mesh.output_count(); ++o) {
    for (std::size_t i = 0; i < 3; ++i) {
      EXPECT_NEAR(evaluation.positions[3 * o + i], basis.mesh.rest[3 * basis.mesh.output_vertex[o] + i], 1e-6f);
    }
  }
  for (const float strain : evaluation.strains) EXPECT_NEAR(strain, 0, 1e-5f);
}

TEST(BasisFile, RoundTripIsBitExact) {
  const TemporaryFolder folder;
  for (const Basis& basis : {small_basis(), knowing_basis(), ddm_only(), one_triangle()}) {
    save_basis(basis, folder / "a.safetensors");
    const Basis loaded = load_basis(folder / "a.safetensors");
    EXPECT_EQ(difference(basis, loaded), "");
    save_basis(loaded, folder / "b.safetensors");
    EXPECT_EQ(read_bytes(folder / "a.safetensors"), read_bytes(folder / "b.safetensors"));
  }
}

std::string earlier_file(const std::string& ending) { return kSourceFolder + "/tests/data/basis_schema_2" + ending; }

// The small basis as the program wrote it before residuals had coordinates, and the positions it gave then.
// Features that a carried basis reads as those of another skeleton.
TEST(BasisFile, RoundTripOfCarriedFeatures) {
  const TemporaryFolder folder;
  Basis basis = small_basis();
  for (const double per_metre : {0.0, 12.5}) {
    basis.skeleton.features = {{1, 0, axis_angle({1, 2, 0}, 0.3), axis_angle({0, 1, 3}, 0.7), per_metre}};
    save_basis(basis, folder / "a.safetensors");
    const Basis read = load_basis(folder / "a.safetensors");
    EXPECT_EQ(read.skeleton.features, basis.skeleton.features);
    EXPECT_EQ(difference(read, basis), "");
    // Versions that know of rotations alone refuse what they would take for one.
    EXPECT_EQ(read_safetensors(folder / "a.safetensors").tensors.contains("skeleton.feature_scales"), per_metre > 0);
  }
}

TEST(BasisFile, TheEarlierSchemaGivesTheSame) {
  const TemporaryFolder folder;
  const Basis basis = load_basis(earlier_file(".safetensors"));
  std::vector<Pose> poses;
  for (int k = 0; k < 3; ++k) {
    Pose& pose = poses.emplace_back(bind_pose(basis.skeleton));
    pose.joints[0].rotation = axis_angle({0, 0, 1}, 0.2 * k) * pose.joints[0].rotation;
    pose.joints[0].translation = {0.1 * k, -0.2 * k, 0.3};
    pose.joints[1].rotation = pose.joints[1].rotation * axis_angle({1, 0, 0}, 0.7 * k);
    pose.controls = {0.3f * static_cast<float>(k)};
  }
  const std::string bytes = read_bytes(earlier_file(".positions"));
  std::vector<float> before(bytes.size() / sizeof(float));
  std::memcpy(before.data(), bytes.data(), bytes.size());
  const std::vector<float> now = Deformer(basis, {.name = "cpu"}).evaluate(poses).positions;
  ASSERT_EQ(now.size(), before.size());
  // The kernels sum in another order since they run in lanes.
  for (std::size_t i = 0; i < now.size(); ++i) ASSERT_NEAR(now[i], before[i], 2e-7) << i;
  save_basis(basis, folder / "a.safetensors");  // in the schema of today
  EXPECT_EQ(read_safetensors(folder / "a.safetensors").metadata.at("schema"), "bodyopt-basis-3");
  EXPECT_EQ(difference(basis, load_basis(folder / "a.safetensors")), "");
}

// Coverage as earlier files have it, among the metadata, in millimetres.
TEST(BasisFile, EarlierCoverageIsRead) {
  const TemporaryFolder folder;
  const Basis expected = knowing_basis();
  const auto millimetres = [](const std::vector<float>& metres, std::size_t begin, std::size_t end) {
    Json list = Json::array();
    for (std::size_t k = begin; k < end; ++k) list.push_back(1e3 * double{metres[k]});
    return list;
  };
  const CoverageTable& coverage = expected.coverage;
  Json list = Json::array();
  for (std::size_t r = 0; r < 2; ++r) {
    const std::size_t begin = r, end = r == 0 ? 1 : coverage.local.size();
    list.push_back({{"name", coverage.names[r]},
                    {"joints", r == 0 ? Json({"lower", "upper"}) : Json({"upper"})},
                    {"size", coverage.sizes[r]},
                    {"distance_m2", coverage.growth[r]},
                    {"usual", coverage.usual[r]},
                    {"local_mm", millimetres(coverage.local, begin, end)},
                    {"motion_mm", millimetres(coverage.motion, begin, end)}});
  }
  const auto load = [&](const Json& told) {
    Basis basis = small_basis();
    basis.metadata["coverage"] = told.is_string() ? told.get<std::string>() : told.dump();
    save_basis(basis, folder / "a.safetensors");
    return load_basis(folder / "a.safetensors");
  };
  EXPECT_EQ(difference(load(list), expected), "");
  Json nameless = list;
  for (Json& region : nameless) region.erase("name");
  EXPECT_EQ(load(nameless).coverage.names, (std::vector<std::string>{"lower", "upper"}));
  Json unknown = list, short_of = list, none = list;
  unknown[1]["joints"] = Json({"knee"});
  short_of[1]["local_mm"].erase(0);
  none[0]["joints"] = Json::array();
  for (const Json& damaged : {Json(""), Json("[]"), Json("{}"), Json("[1]"), Json(R"([{"joints": 3, "size": 1}])"),
                              unknown, short_of, none}) {
    EXPECT_EQ(kind_of([&] { load(damaged); }), ErrorKind::file) << damaged;
  }
}

// The format read by its public description alone: another program finds every tensor where the header says.
TEST(BasisFile, AnotherReaderOpensIt) {
  const TemporaryFolder folder;
  const Basis basis = small_basis();
  save_basis(basis, folder / "a.safetensors");
  const std::string bytes = read_bytes(folder / "a.safetensors");
  std::uint64_t length = 0;
  for (int i = 7; i >= 0; --i) length = length << 8 | static_cast<unsigned char>(bytes[static_cast<std::size_t>(i)]);
  EXPECT_EQ(length % 8, 0u);
  ASSERT_EQ(bytes[8], '{');
  const Json header = Json::parse(bytes.substr(8, length));

  std::vector<std::pair<std::size_t, std::size_t>> ranges;
  for (const auto& [name, entry] : header.items()) {
    if (name == "__metadata__") continue;
    const std::size_t begin = entry["data_offsets"][0], end = entry["data_offsets"][1];
    std::size_t size = entry["dtype"] == "F64" ? 8 : 4;
    EXPECT_EQ(begin % size, 0u) << name << " is not aligned";
    for (const std::size_t n : entry["shape"]) size *= n;
    EXPECT_EQ(end - begin, size) << name;
    ranges.emplace_back(begin, end);
  }
  std::sort(ranges.begin(), ranges.end());
  std::size_t expected = 0;
  for (const auto& [begin, end] : ranges) {
    EXPECT_EQ(begin, expected);
    expected = end;
  }
  EXPECT_EQ(8 + length + expected, bytes.size());

  const Json& rest = header["mesh.rest"];
  EXPECT_EQ(rest["dtype"], "F32");
  EXPECT_EQ(rest["shape"], Json({basis.mesh.vertex_count(), 3}));
  std::vector<float> values(basis.mesh.rest.size());
  std::memcpy(values.data(), bytes.data() + 8 + length + rest["data_offsets"][0].get<std::size_t>(),
              values.size() * sizeof(float));
  EXPECT_EQ(values, basis.mesh.rest);

  const Json& metadata = header["__metadata__"];
  EXPECT_EQ(Json::parse(metadata["joint_names"].get<std::string>()), Json({"lower", "upper"}));
  EXPECT_EQ(metadata["note"], "\"é\"\n");
  EXPECT_EQ(metadata["schema"], "bodyopt-basis-3");
  EXPECT_EQ(metadata["checksum"].get<std::string>().size(), 16u);
}

TEST(BasisFile, EveryTruncationIsRefused) {
  const TemporaryFolder folder;
  save_basis(one_triangle(), folder / "a.safetensors");
  expect_every_truncation_refused(read, folder / "b.safetensors", read_bytes(folder / "a.safetensors"));
}

TEST(BasisFile, DamagedBytesAreRefusedOrChangeNothing) {
  const TemporaryFolder folder;
  const Basis basis = small_basis();
  save_basis(basis, folder / "a.safetensors");
  const Reader read_and_compare = [&](const auto& path) { EXPECT_EQ(difference(basis, load_basis(path)), ""); };
  EXPECT_GT(damage_bytes(read_and_compare, folder / "b.safetensors", read_bytes(folder / "a.safetensors"), 1000), 950u);
}

// Of 300 copies of a file, each with a word of its tables forged under a checksum that fits, how many were accepted;
// the others were refused, and none gave anything but numbers.
int forged_and_accepted(const Safetensors& file) {
  const TemporaryFolder folder;
  const std::vector<Pose> poses = test_poses(small_basis().skeleton);
  std::mt19937 random(11);
  int accepted = 0;
  for (int k = 0; k < 300; ++k) {
    Safetensors forged = file;
    const std::string word = forge_word(forged, random);
    forged.metadata["checksum"] = content_checksum(forged);
    write_safetensors(forged, folder / "b.safetensors");
    const auto evaluate = [&](const auto& path) {
      Basis loaded = load_basis(path);
      Deformer deformer(std::move(loaded), {.name = "cpu"});
      const Evaluation evaluation = deformer.evaluate(poses);
      for (const auto* values :
           {&evaluation.positions, &evaluation.normals, &evaluation.strains, &evaluation.outside, &evaluation.fades}) {
        for (const float value : *values) ASSERT_TRUE(std::isfinite(value)) << word;
      }
    };
    accepted += refuses(evaluate, folder / "b.safetensors", word) ? 0 : 1;
  }
  return accepted;
}

TEST(BasisFile, ForgedTablesAreRefusedOrEvaluateToNumbers) {
  const TemporaryFolder folder;
  save_basis(small_basis(), folder / "a.safetensors");
  EXPECT_GT(forged_and_accepted(read_safetensors(folder / "a.safetensors")), 50);  // or the kernels were hardly tried
  EXPECT_GT(forged_and_accepted(read_safetensors(earlier_file(".safetensors"))), 50);
  Basis carried = small_basis();
  carried.skeleton.features = {{1, 0, axis_angle({1, 2, 0}, 0.3), axis_angle({0, 1, 3}, 0.7)}};
  save_basis(carried, folder / "carried.safetensors");
  EXPECT_GT(forged_and_accepted(read_safetensors(folder / "carried.safetensors")), 50);
}

// Its regions become rows of coordinates, as many as they claim to have features.
TEST(BasisFile, AnEarlierRegionOfFarTooManyFeaturesIsRefused) {
  const TemporaryFolder folder;
  Safetensors forged = read_safetensors(earlier_file(".safetensors"));
  const std::uint32_t many = 4097;
  std::memcpy(forged.tensors.at("residual.regions").bytes.data() + 4, &many, 4);
  forged.metadata["checksum"] = content_checksum(forged);
  write_safetensors(forged, folder / "a.safetensors");
  expect_refused(read, folder / "a.safetensors", read_bytes(folder / "a.safetensors"),
                 "a region listens to 4097 features");
}

// Changes to the container's parts under a checksum that fits.
TEST(BasisFile, ForgedPartsAreRefusedByName) {
  const TemporaryFolder folder;
  save_basis(small_basis(), folder / "a.safetensors");
  const Safetensors file = read_safetensors(folder / "a.safetensors");
  const auto expect = [&](const std::string& named, const std::function<void(Safetensors&)>& change) {
    Safetensors forged = file;
    change(forged);
    if (forged.metadata.contains("checksum")) forged.metadata["checksum"] = content_checksum(forged);
    std::filesystem::remove(folder / "b.safetensors");  // one of another kind would keep its place
    write_safetensors(forged, folder / "b.safetensors");
    expect_refused(read, folder / "b.safetensors", read_bytes(folder / "b.safetensors"), named);
  };
  for (const std::string schema : {"bodyopt-basis-1", "bodyopt-basis-4"}) {
    expect("schema is '" + schema + "', expected 'bodyopt-basis-3'",
           [&](Safetensors& f) { f.metadata["schema"] = schema; });
  }
  expect("lacks 'schema'", [](Safetensors& f) { f.metadata.erase("schema"); });
  expect("lacks 'checksum'", [](Safetensors& f) { f.metadata.erase("checksum"); });
  expect("'joint_names'", [](Safetensors& f) { f.metadata["joint_names"] = "[\"a\","; });
  expect("'joint_names'", [](Safetensors& f) { f.metadata["joint_names"] = "[1, 2]"; });
  expect("'joint_names'", [](Safetensors& f) { f.metadata["joint_names"] = std::string(100000, '['); });
  expect("names 1 joints", [](Safetensors& f) { f.metadata["joint_names"] = "[\"a\"]"; });
  expect("fibres' names", [](Safetensors& f) { f.metadata["fibre_names"] = "[]"; });
  expect("residual.features", [](Safetensors& f) { f.metadata["controls"] = "[]"; });
  expect("'mesh.rest' is missing", [](Safetensors& f) { f.tensors.erase("mesh.rest"); });
  expect("'jiggle.mass'", [](Safetensors& f) { f.tensors["jiggle.mass"] = f.tensors["mesh.rest"]; });
  expect("'mesh.rest' has type U32", [](Safetensors& f) { f.tensors["mesh.rest"].dtype = "U32"; });
  expect("'mesh.rest' has a shape", [](Safetensors& f) { f.tensors["mesh.rest"].shape = {606}; });
  expect("'residual.blend' has a shape", [](Safetensors& f) {
    Tensor& blend = f.tensors["residual.blend"];
    blend.bytes.resize(blend.bytes.size() - 4);
    blend.shape = {blend.bytes.size() / 4};
  });
  expect("'residual.centres' has type F32", [](Safetensors& f) { f.tensors["residual.centres"].dtype = "F32"; });
  expect("residual.centres has 9 entries, expected 10", [](Safetensors& f) {
    Tensor& centres = f.tensors["residual.centres"];
    centres.bytes.resize(centres.bytes.size() - 4);
    --centres.shape[0];
  });
  expect("residual.blend_begin ends", [](Safetensors& f) {
    Tensor& blend = f.tensors["residual.blend"];
    blend.bytes.resize(blend.bytes.size() - sizeof(BlendEntry));
    --blend.shape[0];
  });
  expect("skeleton.parents[1] is 4294967295",
         [](Safetensors& f) { std::memset(f.tensors["skeleton.parents"].bytes.data() + 4, 0xff, 4); });
}

TEST(BasisFile, FailedWritesLeaveNothing) {
  const TemporaryFolder folder;
  Basis basis = small_basis();
  EXPECT_TRUE(refuses([&](const auto& path) { save_basis(basis, path); }, folder / "nowhere/a.safetensors", "folder"));
  EXPECT_TRUE(refuses([&](const auto& path) { save_basis(basis, path); }, folder.path(), "is a folder"));
  basis.residual.weights[3] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_TRUE(refuses([&](const auto& path) { save_basis(basis, path); }, folder / "a.safetensors", "NaN"));
  basis = small_basis();
  basis.skeleton.joints[1].name = "not \xff UTF-8";
  EXPECT_TRUE(refuses([&](const auto& path) { save_basis(basis, path); }, folder / "a.safetensors", "UTF-8"));
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST(BasisFile, MissingFilesFoldersAndDevicesAreRefused) {
  const TemporaryFolder folder;
  EXPECT_TRUE(refuses(read, folder / "nowhere.safetensors", "missing"));
  EXPECT_TRUE(refuses(read, folder.path(), "folder"));
  EXPECT_TRUE(refuses(read, "/dev/zero", "device"));
}

TEST(TableBytes, CountsWhatTheStagesRead) {
  const Basis basis = small_basis();
  const std::map<std::string, std::size_t> bytes = table_bytes(basis);
  ASSERT_EQ(bytes.size(), 3u);
  const DdmTable& ddm = basis.ddm;
  EXPECT_EQ(bytes.at("ddm"),
            4 * (ddm.block_begin.size() + ddm.block_joints.size() + ddm.moments.size()) + 32 * ddm.vertices.size());
  EXPECT_EQ(bytes.at("strain"), 54 * 4 + 18 * 24 + 3 * 4 + 2 * 4u);
  EXPECT_GT(bytes.at("residual"), 52 * basis.residual.blend.size());
  EXPECT_EQ(table_bytes(ddm_only()).at("strain"), 0u);
}

TEST(TopologyHash, SeesTrianglesAndOutputMapButNotPositions) {
  const MeshTable mesh = small_basis().mesh;
  MeshTable other = mesh;
  other.rest[5] += 1;
  EXPECT_EQ(topology_hash(mesh), topology_hash(other));
  std::swap(other.triangles[0], other.triangles[1]);
  EXPECT_NE(topology_hash(mesh), topology_hash(other));
  other = mesh;
  std::swap(other.output_vertex[0], other.output_vertex[1]);
  EXPECT_NE(topology_hash(mesh), topology_hash(other));
  other = mesh;  // the same numbers, split differently between the arrays
  other.output_triangles.insert(other.output_triangles.begin(), other.output_vertex.back());
  other.output_vertex.pop_back();
  EXPECT_NE(topology_hash(mesh), topology_hash(other));
}

}  // namespace
}  // namespace bodyopt
