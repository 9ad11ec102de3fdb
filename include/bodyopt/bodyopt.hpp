// bodyopt.h for C++: owners release what they own, and calls that fail throw. Nothing but that: bodyopt.h explains what
// the functions do.
#ifndef BODYOPT_BODYOPT_HPP
#define BODYOPT_BODYOPT_HPP

#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "bodyopt.h"

namespace bodyopt::api {

class Error : public std::runtime_error {
 public:
  explicit Error(bodyopt_result result) : std::runtime_error(bodyopt_last_error()), result_(result) {}
  bodyopt_result result() const { return result_; }

 private:
  bodyopt_result result_;
};

// Throws Error unless the call went well.
inline void check(bodyopt_result result) {
  if (result != BODYOPT_OK) throw Error(result);
}

template <auto Release>
struct Releaser {
  template <typename Handle>
  void operator()(Handle* handle) const {
    Release(handle);
  }
};
using Model = std::unique_ptr<bodyopt_model, Releaser<bodyopt_release_model>>;
using Device = std::unique_ptr<bodyopt_device, Releaser<bodyopt_release_device>>;
using Instance = std::unique_ptr<bodyopt_instance, Releaser<bodyopt_release_instance>>;
using State = std::unique_ptr<bodyopt_state, Releaser<bodyopt_release_state>>;

// A structure of bodyopt.h with its struct_size, the rest of it zero.
template <typename Structure>
Structure make() {
  Structure result{};
  result.struct_size = sizeof(Structure);
  return result;
}

inline Model load_model(const std::string& path, const std::string& dynamics = {}, const std::string& attached = {}) {
  auto options = make<bodyopt_load_options>();
  if (!dynamics.empty()) options.dynamics = dynamics.c_str();
  if (!attached.empty()) options.attached = attached.c_str();
  bodyopt_model* model = nullptr;
  check(bodyopt_load_model(path.c_str(), &options, &model));
  return Model(model);
}

inline Device open_device(const std::string& name = {}, const std::string& pipeline_cache = {}) {
  auto options = make<bodyopt_device_options>();
  if (!name.empty()) options.name = name.c_str();
  if (!pipeline_cache.empty()) options.pipeline_cache = pipeline_cache.c_str();
  bodyopt_device* device = nullptr;
  check(bodyopt_open_device(&options, &device));
  return Device(device);
}

inline Instance create_instance(const Model& model, const bodyopt_instance_options& options) {
  bodyopt_instance* instance = nullptr;
  check(bodyopt_create_instance(model.get(), &options, &instance));
  return Instance(instance);
}

// Throws Error where a call fails; the others are done, and `result` of each says which.
inline void evaluate_together(std::vector<bodyopt_call>& calls) {
  check(bodyopt_evaluate_together(calls.data(), calls.size()));
}

inline bodyopt_description describe(const Model& model) {
  auto description = make<bodyopt_description>();
  check(bodyopt_describe(model.get(), &description));
  return description;
}

}  // namespace bodyopt::api

#endif
