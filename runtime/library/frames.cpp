// bodyopt.h: frames.
#include <algorithm>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <utility>

#include "runtime/deformer/evaluate_together.h"
#include "runtime/library/following_outputs.h"
#include "runtime/library/guard.h"
#include "runtime/library/handles.h"
#include "runtime/library/modifier_drive.h"
#include "runtime/library/strides.h"

namespace bodyopt {
namespace {

constexpr std::size_t kBatches = 4;  // of a part: a device runs one while another is taken

// A caller's request of an instance, checked, and done part by part: as much as is held in memory at once.
class AskedFrames {
 public:
  AskedFrames(bodyopt_instance& instance, const bodyopt_poses* poses, const bodyopt_skin* skin, bool jiggles)
      : instance_(instance),
        deformer_(*instance.deformer),
        poses_(instance.poses),
        given_(poses, deformer_.basis(), instance.channels),
        drive_(instance, given_),
        wanted_(skin, deformer_.basis(), given_.count()),
        following_(wanted_.outputs(), *instance.following, given_.count(), instance.following_memory),
        jiggles_(jiggles) {
    if (!wanted_.wants_expected_errors() && !wanted_.wants_vertex_errors()) return;
    if (!instance.expectation) instance.expectation.emplace(deformer_.basis());
    if (wanted_.wants_vertex_errors() && !instance.shares) instance.shares.emplace(deformer_.basis());
    expectation_ = &*instance.expectation;
  }

  // Modifiers go on past all frames where nothing of them is wanted.
  bool is_skipped() const { return !jiggles_ && wanted_.wants_nothing() && !following_.wanted(); }
  void skip() {
    given_.read(0, given_.count(), poses_);
    drive_.apply(0, poses_);
    drive_.keep(instance_);
    has_more_ = false;
  }

  bool has_more() const { return has_more_; }

  // The call of the next part. A jiggle is one part: where it fails, none of it has been stepped.
  DeformerCall next() {
    const std::size_t left = given_.count() - begin_;
    given_.read(begin_, jiggles_ ? left : std::min<std::size_t>(left, kBatches * deformer_.batch_limit()), poses_);
    drive_.apply(begin_, poses_);
    place_ = wanted_.place(begin_);
    if (following_.wanted()) place_ = following_.gather(poses_.size(), place_);
    DeformerCall call{.deformer = &deformer_, .poses = poses_, .evaluation = &instance_.evaluation, .place = &place_};
    if (jiggles_) call.frames = given_.frame_numbers();
    return call;
  }

  // Writes what was not placed of the part.
  void take() {
    const Evaluation& evaluation = instance_.evaluation;
    wanted_.write(evaluation, begin_);
    if (following_.wanted()) following_.write(poses_, begin_, deformer_.threads());
    if (expectation_ != nullptr && !poses_.empty()) write_expected_errors(evaluation);
    begin_ += poses_.size();
    has_more_ = begin_ < given_.count();
    if (!has_more_) drive_.keep(instance_);
  }

 private:
  void write_expected_errors(const Evaluation& evaluation) const {
    ErrorMemory& memory = instance_.error_memory;
    for (std::size_t f = 0; f < poses_.size(); ++f) {
      memory.expected = expectation_->of(evaluation, f, std::move(memory.expected));
      wanted_.write_expected_error(static_cast<float>(1e-3 * memory.expected.rms_mm), begin_ + f);
      if (!wanted_.wants_vertex_errors()) continue;
      memory.vertices = instance_.shares->carry(memory.expected.region_mm, std::move(memory.vertices));
      memory.outputs.clear();
      for (const std::uint32_t v : deformer_.basis().mesh.output_vertex) memory.outputs.push_back(memory.vertices[v]);
      wanted_.write_vertex_errors(memory.outputs, begin_ + f);
    }
  }

  bodyopt_instance& instance_;
  Deformer& deformer_;
  std::vector<Pose>& poses_;  // of the part under way
  GivenPoses given_;
  ModifierDrive drive_;
  WantedSkin wanted_;
  FollowingOutputs following_;
  bool jiggles_;
  const ErrorExpectation* expectation_ = nullptr;  // where errors are wanted
  bool has_more_ = true;                           // nothing of no frames is asked for, too
  std::size_t begin_ = 0;
  SkinPlace place_;
};

// One of many calls, and its outcome.
struct AskedCall {
  std::optional<AskedFrames> frames;  // none: it failed
  std::exception_ptr error;

  template <typename Step>
  void attempt(const Step& step) {
    try {
      step();
    } catch (...) {
      frames.reset();
      error = std::current_exception();
    }
  }
};

void run_parts(std::span<AskedCall> calls) {
  std::vector<AskedCall*> running;
  std::vector<DeformerCall> parts;
  for (AskedCall& call : calls) {
    if (!call.frames || !call.frames->has_more()) continue;
    if (call.frames->is_skipped()) {
      call.attempt([&] { call.frames->skip(); });
      continue;
    }
    call.attempt([&] {
      parts.push_back(call.frames->next());
      running.push_back(&call);
    });
  }
  evaluate_together(parts);
  for (std::size_t k = 0; k < running.size(); ++k) {
    running[k]->attempt([&] {
      if (parts[k].error) std::rethrow_exception(parts[k].error);
      running[k]->frames->take();
    });
  }
}

void run_all(std::span<AskedCall> calls) {
  while (std::ranges::any_of(calls, [](const AskedCall& c) { return c.frames && c.frames->has_more(); })) {
    run_parts(calls);
  }
}

bodyopt_result run_alone(bodyopt_instance* instance, const bodyopt_poses* poses, const bodyopt_skin* skin,
                         bool jiggles) {
  return guarded([&] {
    AskedFrames frames(required(instance, "instance"), poses, skin, jiggles);
    while (frames.has_more()) {
      if (frames.is_skipped()) return frames.skip();
      DeformerCall part = frames.next();
      evaluate_together({&part, 1});
      if (part.error) std::rethrow_exception(part.error);
      frames.take();
    }
  });
}

using CallArray = StructArray<bodyopt_call>;

void begin(const bodyopt_call& given, AskedCall& call, std::set<const bodyopt_instance*>& known) {
  const auto asked = read_struct(&given, BODYOPT_CALL_FIRST_SIZE, "call");
  bodyopt_instance& instance = required(asked.instance, "call.instance");
  if (!known.insert(&instance).second) throw Error(ErrorKind::usage, "the instance is in an earlier call, too");
  call.frames.emplace(instance, asked.poses, asked.skin, asked.jiggles != 0);
}

// Says what became of every call. Gives the result of the first that failed, and keeps what all that did have to say.
bodyopt_result tell(const CallArray& given, std::span<const AskedCall> calls) {
  bodyopt_result first = BODYOPT_OK;
  std::string text;
  for (std::size_t k = 0; k < calls.size(); ++k) {
    given[k].result = calls[k].error ? keep_error(calls[k].error) : BODYOPT_OK;
    if (given[k].result == BODYOPT_OK) continue;
    if (first == BODYOPT_OK) first = given[k].result;
    text += (text.empty() ? "call " : "; call ") + std::to_string(k) + ": " + bodyopt_last_error();
  }
  if (first == BODYOPT_OK) return BODYOPT_OK;
  keep_failure(first, text.c_str());
  write_log(BODYOPT_LOG_ERROR, bodyopt_last_error());
  return first;
}

}  // namespace
}  // namespace bodyopt

using namespace bodyopt;

bodyopt_result bodyopt_evaluate(bodyopt_instance* instance, const bodyopt_poses* poses, const bodyopt_skin* skin) {
  return run_alone(instance, poses, skin, false);
}

bodyopt_result bodyopt_jiggle(bodyopt_instance* instance, const bodyopt_poses* poses, const bodyopt_skin* skin) {
  return run_alone(instance, poses, skin, true);
}

bodyopt_result bodyopt_evaluate_together(bodyopt_call* given, size_t count) {
  bodyopt_result of_calls = BODYOPT_OK;
  const bodyopt_result result = guarded([&] {
    const CallArray array(given, count, BODYOPT_CALL_FIRST_SIZE, "calls");
    std::vector<AskedCall> calls(count);
    std::set<const bodyopt_instance*> known;
    for (std::size_t k = 0; k < count; ++k) {
      calls[k].attempt([&] { begin(array[k], calls[k], known); });
    }
    run_all(calls);
    of_calls = tell(array, calls);
  });
  return result != BODYOPT_OK ? result : of_calls;
}
