// Many instances in one call: the bits of one after the other, and one that fails leaves the others right.
#include "runtime/deformer/evaluate_together.h"
#include "tests/library/c_api.h"
#include "tests/support/gpu_fixture.h"

namespace bodyopt::testing {
namespace together_test {

// An instance, what it is asked for, and what it gave.
struct Asked {
  Asked(const api::Model& model, const api::Device& device, const Basis& basis, std::size_t frames, bool jiggles_)
      : jiggles(jiggles_),
        instance(make_instance(model, jiggles, device)),
        given(turning_poses(basis, frames)),
        found(basis, frames) {}

  bodyopt_call call() {
    auto result = api::make<bodyopt_call>();
    result.instance = instance.get();
    result.poses = &given.all;
    result.skin = &found.all;
    result.jiggles = jiggles;
    result.result = BODYOPT_INTERNAL;
    return result;
  }

  bool jiggles;
  api::Instance instance;
  PoseArrays given;
  Arrays found;
};

void expect_same(const Arrays& found, const Arrays& expected) {
  EXPECT_EQ(found.positions, expected.positions);
  EXPECT_EQ(found.normals, expected.normals);
  EXPECT_EQ(found.strains, expected.strains);
  EXPECT_EQ(found.outside, expected.outside);
  EXPECT_EQ(found.fades, expected.fades);
}

class LibraryTogether : public ::testing::TestWithParam<bool> {
 protected:
  // On lavapipe, or on the CPU: two that pose as many frames as a batch has at most, and more; one without what was
  // learned; one that jiggles.
  LibraryTogether() {
    test_device();
    if (GetParam()) device_ = api::open_device();
    cast_.emplace_back(model_, device_, basis_, 2, false);
    cast_.emplace_back(model_, device_, basis_, 70, false);
    cast_.emplace_back(other_, device_, basis_, 1, false);
    cast_.emplace_back(model_, device_, basis_, 3, true);
    api::check(bodyopt_set_weights(cast_[2].instance.get(), 0, 1));
  }

  std::vector<bodyopt_call> calls() {
    std::vector<bodyopt_call> all;
    for (Asked& asked : cast_) all.push_back(asked.call());
    return all;
  }

  // What an instance like it gives by itself.
  Arrays alone(std::size_t k) const {
    const Asked& of = cast_[k];
    Asked own(k == 2 ? other_ : model_, device_, basis_, of.found.fades.size(), of.jiggles);
    if (k == 2) api::check(bodyopt_set_weights(own.instance.get(), 0, 1));
    api::check((of.jiggles ? bodyopt_jiggle : bodyopt_evaluate)(own.instance.get(), &own.given.all, &own.found.all));
    return std::move(own.found);
  }

  const Basis basis_ = load_basis(hero());
  const api::Model model_ = api::load_model(hero(), hero_dynamics()), other_ = api::load_model(hero());
  api::Device device_;
  std::vector<Asked> cast_;
};

TEST_P(LibraryTogether, HaveTheBitsOfOneAfterTheOther) {
  std::vector<bodyopt_call> all = calls();
  api::evaluate_together(all);
  for (std::size_t k = 0; k < cast_.size(); ++k) {
    SCOPED_TRACE(k);
    EXPECT_EQ(all[k].result, BODYOPT_OK);
    expect_same(cast_[k].found, alone(k));
  }
  EXPECT_NE(cast_[0].found.positions, std::vector<float>(cast_[0].found.positions.size()));
}

// The first fails in its second frame; the one that jiggles in its last, after which it goes on as if nothing was.
TEST_P(LibraryTogether, OneThatFailsIsNamedAndTheOthersAreRight) {
  cast_[0].given.joints[10 * basis_.skeleton.size() + 11] = std::nan("");
  double& last = cast_[3].given.joints[20 * basis_.skeleton.size() + 11];
  const double before = std::exchange(last, std::nan(""));
  std::vector<bodyopt_call> all = calls();
  all[2].poses = nullptr;
  EXPECT_EQ(bodyopt_evaluate_together(all.data(), all.size()), BODYOPT_MISMATCH);
  const std::string said = bodyopt_last_error();
  for (const char* part : {"call 0: ", "finite", "; call 2: ", "'poses' is a null pointer", "; call 3: "}) {
    EXPECT_NE(said.find(part), std::string::npos) << part << " is not in: " << said;
  }
  EXPECT_EQ(said.find("call 1"), std::string::npos);
  EXPECT_EQ(all[0].result, BODYOPT_MISMATCH);
  EXPECT_EQ(all[1].result, BODYOPT_OK);
  EXPECT_EQ(all[2].result, BODYOPT_USAGE);
  EXPECT_EQ(all[3].result, BODYOPT_MISMATCH);
  expect_same(cast_[1].found, alone(1));

  last = before;
  all = calls();
  all.erase(all.begin(), all.begin() + 2);
  api::evaluate_together(all);
  expect_same(cast_[2].found, alone(2));
  expect_same(cast_[3].found, alone(3));
}

INSTANTIATE_TEST_SUITE_P(On, LibraryTogether, ::testing::Bool(),
                         [](const auto& on) { return on.param ? "ADevice" : "TheCpu"; });

TEST(LibraryTogetherCalls, ThatAreWrongAreRefused) {
  const Basis basis = load_basis(hero());
  const api::Model model = api::load_model(hero());
  Asked asked(model, {}, basis, 1, false), second(model, {}, basis, 1, false);
  EXPECT_EQ(bodyopt_evaluate_together(nullptr, 0), BODYOPT_OK);
  EXPECT_EQ(bodyopt_evaluate_together(nullptr, 1), BODYOPT_USAGE);
  EXPECT_NE(std::string(bodyopt_last_error()).find("'calls' is a null pointer"), std::string::npos);
  bodyopt_call all[] = {asked.call(), asked.call(), second.call()};
  all[2].jiggles = 1;
  EXPECT_EQ(bodyopt_evaluate_together(all, 3), BODYOPT_USAGE);
  EXPECT_EQ(all[0].result, BODYOPT_OK);
  EXPECT_EQ(all[1].result, BODYOPT_USAGE);
  EXPECT_EQ(all[2].result, BODYOPT_USAGE);
  const std::string said = bodyopt_last_error();
  for (const char* part : {"call 1: the instance is in an earlier call", "call 2: ", "without dynamics"}) {
    EXPECT_NE(said.find(part), std::string::npos) << part << " is not in: " << said;
  }
  all[0].struct_size = 8;
  EXPECT_EQ(bodyopt_evaluate_together(all, 1), BODYOPT_USAGE);
  EXPECT_NE(std::string(bodyopt_last_error()).find("struct_size of 'calls' is 8"), std::string::npos);
  all[0] = asked.call();
  all[0].instance = nullptr;
  EXPECT_EQ(bodyopt_evaluate_together(all, 1), BODYOPT_USAGE);
  EXPECT_NE(std::string(bodyopt_last_error()).find("'call.instance' is a null pointer"), std::string::npos);
}

}  // namespace together_test
}  // namespace bodyopt::testing
