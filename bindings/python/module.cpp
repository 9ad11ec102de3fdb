// bodyopt.h as a Python module: numpy arrays are read and written where they are, and other Python threads run
// meanwhile.
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <array>
#include <exception>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include "include/bodyopt/bodyopt.hpp"

namespace {

namespace py = pybind11;
namespace api = bodyopt::api;

using Shape = std::vector<py::ssize_t>;

PyObject* error_type = nullptr;  // bodyopt.Error; has the result as its `code`

void translate(std::exception_ptr thrown) {
  try {
    std::rethrow_exception(thrown);
  } catch (const api::Error& error) {
    py::object value = py::reinterpret_borrow<py::object>(error_type)(error.what());
    value.attr("code") = static_cast<int>(error.result());
    PyErr_SetObject(error_type, value.ptr());
  }
}

std::string text_of(const Shape& shape) {
  std::string text;
  for (const py::ssize_t size : shape) text += (text.empty() ? "" : " x ") + (size < 0 ? "any" : std::to_string(size));
  return text;
}

Shape shape_of(const py::array& array) { return {array.shape(), array.shape() + array.ndim()}; }

// Bytes from one element of a dimension to the next; packed where there is no next one.
std::size_t stride_of(const py::array& array, int dimension) {
  if (array.shape(dimension) > 1) return static_cast<std::size_t>(array.strides(dimension));
  return 0;
}

// Throws TypeError unless each element of a dimension ends before the next begins, and the last dimension has no gaps.
void require_layout(const py::array& array, const std::string& name) {
  if (array.size() == 0) return;
  py::ssize_t extent = array.itemsize();
  for (py::ssize_t d = array.ndim() - 1; d >= 0; --d) {
    if (array.shape(d) <= 1) continue;
    const py::ssize_t stride = array.strides(d);
    const bool has_gaps = d + 1 == array.ndim() && stride != extent;
    if (stride < extent || has_gaps || stride % array.itemsize() != 0) {
      throw py::type_error(name + ": its numbers overlap, run backwards or do not stand one after the other; give " +
                           "numpy.ascontiguousarray(" + name + ")");
    }
    extent += (array.shape(d) - 1) * stride;
  }
}

// The array where it is, never a copy. Throws TypeError for another type or layout, ValueError for another shape.
template <typename T>
py::array_t<T> as_given(const py::handle& given, const Shape& shape, const std::string& name) {
  if (!py::isinstance<py::array_t<T>>(given)) {
    const py::object found = py::isinstance<py::array>(given) ? py::object(given.attr("dtype")) : py::type::of(given);
    throw py::type_error(name + ": expected a numpy array of " +
                         py::str(py::dtype::of<T>()).template cast<std::string>() + ", found " +
                         py::str(found).cast<std::string>());
  }
  const auto array = py::reinterpret_borrow<py::array_t<T>>(given);
  const Shape found = shape_of(array);
  bool fits = found.size() == shape.size();
  for (std::size_t d = 0; fits && d < shape.size(); ++d) fits = shape[d] < 0 || shape[d] == found[d];
  if (!fits) throw py::value_error(name + ": expected the shape " + text_of(shape) + ", found " + text_of(found));
  require_layout(array, name);
  return array;
}

// Where an output of this shape goes: the caller's array, or a new one.
py::array_t<float> output(const py::object& given, const Shape& shape, const std::string& name) {
  if (given.is_none()) return py::array_t<float>(shape);
  auto array = as_given<float>(given, shape, name);
  if (!array.writeable()) throw py::value_error(name + ": the array is read-only");
  return array;
}

// What is written of an output that a caller may do without: nothing for False, a new array for True and None.
std::optional<py::array_t<float>> output_if_wanted(const py::object& given, const Shape& shape,
                                                   const std::string& name) {
  if (given.ptr() == Py_False) return std::nullopt;
  return output(given.ptr() == Py_True ? py::none() : given, shape, name);
}

// Bytes from an array's first number to the end of its last.
std::size_t extent_of(const py::array& array) {
  if (array.size() == 0) return 0;
  py::ssize_t size = array.itemsize();
  for (py::ssize_t d = 0; d < array.ndim(); ++d) size += (array.shape(d) - 1) * array.strides(d);
  return static_cast<std::size_t>(size);
}

// Frames x elements x 3 (4 of tangents), frames x elements, or frames.
bodyopt_floats floats_of(py::array_t<float>& array) {
  bodyopt_floats floats{};
  if (array.size() == 0) return floats;
  floats.data = array.mutable_data();
  floats.frame_stride = stride_of(array, 0);
  floats.element_stride = array.ndim() > 1 ? stride_of(array, 1) : 0;
  floats.size = extent_of(array);
  return floats;
}

struct Skin {
  py::array_t<float> positions, strains, outside, fades, outside_features, excess;
  std::optional<py::array_t<float>> expected_errors;  // of a model that knows its error
  std::optional<py::array_t<float>> normals;          // where they are wanted
  std::optional<py::array_t<float>> tangents;         // where they are wanted, of a model with texture coordinates
  std::optional<py::array_t<float>> vertex_errors;    // where they are wanted, of a model that knows its error
  std::optional<std::vector<py::array_t<float>>> attached;  // where they are wanted, of each attached mesh
  std::optional<py::array_t<float>> full_positions;         // where they are wanted
};

// A file's name. Throws TypeError for what is neither text nor os.PathLike, ValueError for a NUL in it.
std::string path_of(const py::object& given) {
  PyObject* bytes = nullptr;
  if (PyUnicode_FSConverter(given.ptr(), &bytes) == 0) throw py::error_already_set();
  return py::reinterpret_steal<py::bytes>(bytes);
}

std::optional<std::string> path_if_given(const py::object& given) {
  if (given.is_none()) return std::nullopt;
  return path_of(given);
}

// Poses as they were given, and a skin to write: the arrays live as long as this, which stays where it is.
struct Frames {
  // `frame_numbers`: none for the quasi-static skin.
  Frames(const bodyopt_description& description, const py::object& given_joints, const py::object& given_controls,
         std::optional<std::vector<std::int32_t>> given_numbers, const py::object& positions, const py::object& normals,
         const py::object& tangents)
      : frame_numbers(std::move(given_numbers)) {
    take_joints(given_joints);
    const py::ssize_t count = poses.frame_count, vertices = description.vertex_count;
    if (!given_controls.is_none()) {
      controls = as_given<float>(given_controls, {count, -1}, "controls");
      poses.control_count = static_cast<std::uint32_t>(controls.shape(1));
      poses.controls = controls.data();
      poses.control_frame_stride = stride_of(controls, 0);
    }
    if (frame_numbers) {
      if (static_cast<py::ssize_t>(frame_numbers->size()) != count) {
        throw py::value_error("frame_numbers: expected " + std::to_string(count) + " numbers, found " +
                              std::to_string(frame_numbers->size()));
      }
      poses.frame_numbers = frame_numbers->data();
    }
    skin = {output(positions, {count, vertices, 3}, "positions"),
            py::array_t<float>(Shape{count, static_cast<py::ssize_t>(description.strain_count)}),
            py::array_t<float>(Shape{count}),
            py::array_t<float>(Shape{count}),
            py::array_t<float>(Shape{count}),
            py::array_t<float>(Shape{count, static_cast<py::ssize_t>(description.feature_count)}),
            {},
            output_if_wanted(normals, {count, vertices, 3}, "normals"),
            {},
            {},
            {},
            {}};
    wanted.positions = floats_of(skin.positions);
    if (skin.normals) wanted.normals = floats_of(*skin.normals);
    wanted.strains = floats_of(skin.strains);
    wanted.outside = floats_of(skin.outside);
    wanted.fades = floats_of(skin.fades);
    wanted.outside_features = floats_of(skin.outside_features);
    wanted.excess = floats_of(skin.excess);
    if (description.knows_error != 0) wanted.expected_errors = floats_of(skin.expected_errors.emplace(Shape{count}));
    if (description.has_tangents != 0) {
      skin.tangents = output_if_wanted(tangents, {count, vertices, 4}, "tangents");
      if (skin.tangents) wanted.tangents = floats_of(*skin.tangents);
    } else if (!tangents.is_none() && !py::isinstance<py::bool_>(tangents)) {
      throw py::value_error("tangents: the model was loaded without texture coordinates");
    }
  }
  // The character's modifiers, where there is a rate. Throws Error(mismatch), later, for another number of channels.
  void show_modifiers(std::optional<double> frames_per_second, const py::object& given_channels, bool goes_on) {
    if (!frames_per_second) return;
    poses.shows_modifiers = 1;
    poses.goes_on = goes_on;
    poses.frames_per_second = *frames_per_second;
    if (given_channels.is_none()) return;
    channels = as_given<float>(given_channels, {poses.frame_count, -1}, "channels");
    poses.channel_count = static_cast<std::uint32_t>(channels.shape(1));
    poses.channels = channels.data();
    poses.channel_frame_stride = stride_of(channels, 0);
  }

  // Throws Error(mismatch), later, where the model does not know its error.
  void want_vertex_errors(bool are_wanted) {
    if (!are_wanted) return;
    wanted.vertex_errors =
        floats_of(skin.vertex_errors.emplace(Shape{skin.positions.shape(0), skin.positions.shape(1)}));
  }

  // `vertices`: of each attached mesh of the model.
  void want_attached(const std::vector<std::uint32_t>& vertices) {
    std::vector<py::array_t<float>>& meshes = skin.attached.emplace();
    for (const std::uint32_t count : vertices) {
      meshes.emplace_back(Shape{poses.frame_count, static_cast<py::ssize_t>(count), 3});
      attached.push_back(floats_of(meshes.back()));
    }
    wanted.attached = attached.data();
    wanted.attached_count = static_cast<std::uint32_t>(attached.size());
  }

  // Throws Error(usage), later, of a model that carries no full skin.
  void want_full_positions(std::uint32_t vertices) {
    const Shape shape{poses.frame_count, std::max<py::ssize_t>(1, vertices), 3};
    wanted.full_positions = floats_of(skin.full_positions.emplace(shape));
  }

  Frames(const Frames&) = delete;
  Frames& operator=(const Frames&) = delete;

  py::array joints;  // or skinning matrices
  py::array_t<float> controls, channels;
  std::vector<bodyopt_floats> attached;
  std::optional<std::vector<std::int32_t>> frame_numbers;
  bodyopt_poses poses = api::make<bodyopt_poses>();
  Skin skin;
  bodyopt_skin wanted = api::make<bodyopt_skin>();

 private:
  // Frames x joints x 10 of double, or frames x joints x 3 x 4 of float: skinning matrices.
  void take_joints(const py::object& given) {
    if (py::isinstance<py::array_t<float>>(given) && py::reinterpret_borrow<py::array>(given).ndim() == 4) {
      const auto matrices = as_given<float>(given, {-1, -1, 3, 4}, "joints");
      if (matrices.size() > 0 && matrices.strides(2) != 4 * matrices.itemsize()) {
        throw py::type_error("joints: the rows of its matrices do not stand one after the other");
      }
      poses.skinning = matrices.data();
      poses.skinning_frame_stride = stride_of(matrices, 0);
      poses.skinning_stride = stride_of(matrices, 1);
      joints = matrices;
    } else {
      const auto numbers = as_given<double>(given, {-1, -1, 10}, "joints");
      poses.joints = numbers.data();
      poses.joint_frame_stride = stride_of(numbers, 0);
      poses.joint_stride = stride_of(numbers, 1);
      joints = numbers;
    }
    poses.frame_count = static_cast<std::uint32_t>(joints.shape(0));
    poses.joint_count = static_cast<std::uint32_t>(joints.shape(1));
  }
};

// Other Python threads run meanwhile.
template <typename Call>
void check_without_gil(const Call& call) {
  bodyopt_result result;
  {
    const py::gil_scoped_release others_run;
    result = call();
  }
  api::check(result);
}

struct State {
  api::State handle;
};

struct Device {
  Device(const std::optional<std::string>& name, bool validation, const py::object& given_cache) {
    const std::optional<std::string> pipeline_cache = path_if_given(given_cache);
    auto options = api::make<bodyopt_device_options>();
    options.name = name ? name->c_str() : nullptr;
    options.validation = validation;
    options.pipeline_cache = pipeline_cache ? pipeline_cache->c_str() : nullptr;
    bodyopt_device* opened = nullptr;
    check_without_gil([&] { return bodyopt_open_device(&options, &opened); });
    handle.reset(opened);
  }

  api::Device handle;
};

bodyopt_attached describe_attached(const api::Model& model, std::uint32_t mesh) {
  auto attached = api::make<bodyopt_attached>();
  api::check(bodyopt_describe_attached(model.get(), mesh, &attached));
  return attached;
}

class Instance {
 public:
  Instance(const api::Model& model, const Device* device, bool jiggles, std::uint32_t iterations,
           const std::array<double, 3>& gravity_change, bool check)
      : description_(api::describe(model)) {
    for (std::uint32_t m = 0; m < description_.attached_count; ++m) {
      attached_.push_back(describe_attached(model, m).vertex_count);
    }
    auto options = api::make<bodyopt_instance_options>();
    options.device = device != nullptr ? device->handle.get() : nullptr;
    options.jiggles = jiggles;
    options.iterations = iterations;
    options.check = check;
    std::copy(gravity_change.begin(), gravity_change.end(), options.gravity_change);
    bodyopt_instance* created = nullptr;
    call([&] { return bodyopt_create_instance(model.get(), &options, &created); });
    handle_.reset(created);
  }

  Skin evaluate(const py::object& joints, const py::object& controls, const py::object& positions,
                const py::object& normals, const py::object& tangents, std::optional<double> frames_per_second,
                const py::object& channels, bool goes_on, bool vertex_errors, bool attached, bool full_positions) {
    Frames frames(description_, joints, controls, std::nullopt, positions, normals, tangents);
    frames.show_modifiers(frames_per_second, channels, goes_on);
    frames.want_vertex_errors(vertex_errors);
    want_following(frames, attached, full_positions);
    call([&] { return bodyopt_evaluate(handle_.get(), &frames.poses, &frames.wanted); });
    return std::move(frames.skin);
  }

  Skin jiggle(const py::object& joints, std::vector<std::int32_t> frame_numbers, const py::object& controls,
              const py::object& positions, const py::object& normals, const py::object& tangents,
              std::optional<double> frames_per_second, const py::object& channels, bool goes_on, bool attached,
              bool full_positions) {
    Frames frames(description_, joints, controls, std::move(frame_numbers), positions, normals, tangents);
    frames.show_modifiers(frames_per_second, channels, goes_on);
    want_following(frames, attached, full_positions);
    call([&] { return bodyopt_jiggle(handle_.get(), &frames.poses, &frames.wanted); });
    return std::move(frames.skin);
  }

  void skip(const py::object& joints, double frames_per_second, const py::object& channels, bool goes_on) {
    const py::object none = py::bool_(false);
    Frames frames(description_, joints, py::none(), std::nullopt, py::none(), none, none);
    frames.show_modifiers(frames_per_second, channels, goes_on);
    const auto nothing = api::make<bodyopt_skin>();
    call([&] { return bodyopt_evaluate(handle_.get(), &frames.poses, &nothing); });
  }

  void set_weights(float correction, float jiggle) {
    call([&] { return bodyopt_set_weights(handle_.get(), correction, jiggle); });
  }

  std::unique_ptr<State> state() {
    bodyopt_state* state = nullptr;
    call([&] { return bodyopt_get_state(handle_.get(), &state); });
    return std::make_unique<State>(State{api::State(state)});
  }
  void set_state(const State* state) {
    call([&] { return bodyopt_set_state(handle_.get(), state != nullptr ? state->handle.get() : nullptr); });
  }
  void save_state(const State& state, const py::object& given_path) {
    const std::string path = path_of(given_path);
    call([&] { return bodyopt_save_state(handle_.get(), state.handle.get(), path.c_str()); });
  }
  std::unique_ptr<State> load_state(const py::object& given_path) {
    const std::string path = path_of(given_path);
    bodyopt_state* state = nullptr;
    call([&] { return bodyopt_load_state(handle_.get(), path.c_str(), &state); });
    return std::make_unique<State>(State{api::State(state)});
  }

 private:
  // Without Python's lock, and one thread at a time. The message of a failure is this thread's.
  template <typename Call>
  void call(const Call& function) {
    check_without_gil([&] {
      const std::lock_guard lock(mutex_);
      return function();
    });
  }

  void want_following(Frames& frames, bool attached, bool full_positions) const {
    if (attached && !attached_.empty()) frames.want_attached(attached_);
    if (full_positions) frames.want_full_positions(description_.full_vertex_count);
  }

  friend class Call;

  bodyopt_description description_;
  std::vector<std::uint32_t> attached_;  // vertices of each attached mesh
  api::Instance handle_;
  std::mutex mutex_;
};

// What one instance does among others.
class Call {
 public:
  Call(Instance& instance, const py::object& joints, const py::object& controls,
       std::optional<std::vector<std::int32_t>> frame_numbers, const py::object& positions, const py::object& normals,
       const py::object& tangents, bool attached, bool full_positions)
      : instance_(instance),
        kept_(py::cast(&instance, py::return_value_policy::reference)),
        frames_(instance.description_, joints, controls, std::move(frame_numbers), positions, normals, tangents) {
    instance.want_following(frames_, attached, full_positions);
  }

  // None before it is evaluated, and where that failed.
  std::optional<Skin> skin() const {
    if (!is_done_) return std::nullopt;
    return frames_.skin;
  }

  static void evaluate_together(const std::vector<std::shared_ptr<Call>>& calls) {
    std::vector<bodyopt_call> all(calls.size(), api::make<bodyopt_call>());
    std::set<std::mutex*> mutexes;  // in the same order in every thread
    for (std::size_t k = 0; k < calls.size(); ++k) {
      if (calls[k] == nullptr) throw py::type_error("calls: expected a bodyopt.Call, found None");
      Call& call = *calls[k];
      all[k].instance = call.instance_.handle_.get();
      all[k].poses = &call.frames_.poses;
      all[k].skin = &call.frames_.wanted;
      all[k].jiggles = call.frames_.frame_numbers.has_value();
      all[k].result = BODYOPT_INTERNAL;  // until told otherwise: the library may fail before it tells
      mutexes.insert(&call.instance_.mutex_);
    }
    bodyopt_result result;
    {
      const py::gil_scoped_release others_run;
      std::vector<std::unique_lock<std::mutex>> locks;
      for (std::mutex* mutex : mutexes) locks.emplace_back(*mutex);
      result = bodyopt_evaluate_together(all.data(), all.size());
    }
    for (std::size_t k = 0; k < calls.size(); ++k) calls[k]->is_done_ = all[k].result == BODYOPT_OK;
    api::check(result);
  }

 private:
  Instance& instance_;
  py::object kept_;  // the same
  Frames frames_;
  bool is_done_ = false;
};

class Model {
 public:
  // `load`(options, model): bodyopt_load_model() or its like.
  template <typename Load>
  Model(const Load& load, bodyopt_load_options options, std::uint32_t level, const py::object& texture) {
    options.level = level;
    py::array_t<float> coordinates;
    if (!texture.is_none()) {
      coordinates = as_given<float>(texture, {-1, 2}, "texture");
      options.texture = coordinates.data();
      options.texture_stride = stride_of(coordinates, 0);
      options.texture_size = extent_of(coordinates);
      options.texture_count = static_cast<std::size_t>(coordinates.shape(0));
    }
    bodyopt_model* loaded = nullptr;
    check_without_gil([&] { return load(options, loaded); });
    handle.reset(loaded);
    description = api::describe(handle);
  }

  static std::unique_ptr<Model> of_files(const py::object& given_path, const py::object& given_dynamics,
                                         std::uint32_t level, const py::object& texture,
                                         const py::object& given_attached) {
    const std::string path = path_of(given_path);
    const std::optional<std::string> dynamics = path_if_given(given_dynamics), attached = path_if_given(given_attached);
    auto options = api::make<bodyopt_load_options>();
    options.dynamics = dynamics ? dynamics->c_str() : nullptr;
    options.attached = attached ? attached->c_str() : nullptr;
    const auto load = [&](const bodyopt_load_options& all, bodyopt_model*& model) {
      return bodyopt_load_model(path.c_str(), &all, &model);
    };
    return std::make_unique<Model>(load, options, level, texture);
  }

  static std::unique_ptr<Model> of_bytes(const py::bytes& given, const std::optional<py::bytes>& given_dynamics,
                                         std::uint32_t level, const py::object& texture,
                                         const std::optional<py::bytes>& given_attached) {
    const std::string_view data = given;
    auto options = api::make<bodyopt_load_options>();
    if (given_dynamics) {
      const std::string_view dynamics = *given_dynamics;
      options.dynamics_data = dynamics.data();
      options.dynamics_size = dynamics.size();
    }
    if (given_attached) {
      const std::string_view attached = *given_attached;
      options.attached_data = attached.data();
      options.attached_size = attached.size();
    }
    const auto load = [&](const bodyopt_load_options& all, bodyopt_model*& model) {
      return bodyopt_load_model_from_memory(data.data(), data.size(), &all, &model);
    };
    return std::make_unique<Model>(load, options, level, texture);
  }

  template <typename Name>
  std::vector<std::string> names(const Name& name, std::uint32_t count) const {
    std::vector<std::string> all;
    for (std::uint32_t k = 0; k < count; ++k) all.emplace_back(name(handle.get(), k));
    return all;
  }

  std::vector<std::int32_t> parents() const {
    std::vector<std::int32_t> all;
    for (std::uint32_t j = 0; j < description.joint_count; ++j) all.push_back(bodyopt_joint_parent(handle.get(), j));
    return all;
  }

  // Name, what it is, constant, low, high of each.
  std::vector<std::tuple<std::string, std::string, float, float, float>> channels() const {
    std::vector<std::tuple<std::string, std::string, float, float, float>> all;
    for (std::uint32_t c = 0; c < description.channel_count; ++c) {
      auto channel = api::make<bodyopt_channel>();
      api::check(bodyopt_describe_channel(handle.get(), c, &channel));
      all.emplace_back(channel.name, channel.what, channel.constant, channel.low, channel.high);
    }
    return all;
  }

  std::vector<std::string> feature_names() const {
    std::vector<std::string> all;
    while (const char* name = bodyopt_feature_name(handle.get(), static_cast<std::uint32_t>(all.size()))) {
      all.emplace_back(name);
    }
    return all;
  }

  py::array_t<std::uint32_t> triangles() const {
    py::array_t<std::uint32_t> all(Shape{static_cast<py::ssize_t>(description.triangle_count), 3});
    api::check(bodyopt_get_triangles(handle.get(), all.mutable_data(), static_cast<std::size_t>(all.nbytes())));
    return all;
  }

  // Name and triangles of each attached mesh.
  std::vector<std::pair<std::string, py::array_t<std::uint32_t>>> attached() const {
    std::vector<std::pair<std::string, py::array_t<std::uint32_t>>> all;
    for (std::uint32_t m = 0; m < description.attached_count; ++m) {
      const bodyopt_attached mesh = describe_attached(handle, m);
      py::array_t<std::uint32_t> triangles(Shape{static_cast<py::ssize_t>(mesh.triangle_count), 3});
      api::check(bodyopt_get_attached_triangles(handle.get(), m, triangles.mutable_data(),
                                                static_cast<std::size_t>(triangles.nbytes())));
      all.emplace_back(mesh.name, triangles);
    }
    return all;
  }

  py::array_t<double> bind_pose() const {
    py::array_t<double> all(Shape{static_cast<py::ssize_t>(description.joint_count), 10});
    api::check(bodyopt_get_bind_pose(handle.get(), all.mutable_data(), static_cast<std::size_t>(all.nbytes())));
    return all;
  }

  api::Model handle;
  bodyopt_description description;
};

// Of all devices, in the order of their indices.
std::vector<std::string> device_names() {
  std::size_t count = 0;
  check_without_gil([&] { return bodyopt_list_devices(nullptr, 0, &count); });
  std::vector<bodyopt_device_description> devices(count, api::make<bodyopt_device_description>());
  check_without_gil([&] { return bodyopt_list_devices(devices.data(), devices.size(), &count); });
  std::vector<std::string> names;
  for (const bodyopt_device_description& device : devices) names.emplace_back(device.name);
  return names;
}

}  // namespace

PYBIND11_MODULE(_runtime, module) {
  error_type = PyErr_NewException("bodyopt.Error", PyExc_RuntimeError, nullptr);
  module.attr("Error") = py::reinterpret_borrow<py::object>(error_type);
  module.attr("Error").attr("result") = py::none();  // where run() does not set it
  py::register_exception_translator(translate);
  module.attr("__version__") = bodyopt_version();

  py::class_<Skin>(module, "Skin")
      .def_readonly("positions", &Skin::positions)
      .def_readonly("normals", &Skin::normals)
      .def_readonly("strains", &Skin::strains)
      .def_readonly("outside", &Skin::outside)
      .def_readonly("fades", &Skin::fades)
      .def_readonly("expected_errors", &Skin::expected_errors)
      .def_readonly("tangents", &Skin::tangents)
      .def_readonly("vertex_errors", &Skin::vertex_errors)
      .def_readonly("attached", &Skin::attached)
      .def_readonly("full_positions", &Skin::full_positions)
      .def_readonly("outside_features", &Skin::outside_features)
      .def_readonly("excess", &Skin::excess);
  py::class_<State>(module, "State");
  py::class_<Device>(module, "Device").def_property_readonly("name", [](const Device& device) {
    return bodyopt_device_name(device.handle.get());
  });
  const auto none = py::none();
  py::class_<Instance>(module, "Instance")
      .def("evaluate", &Instance::evaluate, py::arg("joints"), py::arg("controls") = none, py::kw_only(),
           py::arg("positions") = none, py::arg("normals") = true, py::arg("tangents") = true,
           py::arg("frames_per_second") = none, py::arg("channels") = none, py::arg("goes_on") = false,
           py::arg("vertex_errors") = false, py::arg("attached") = true, py::arg("full_positions") = false)
      .def("jiggle", &Instance::jiggle, py::arg("joints"), py::arg("frame_numbers"), py::arg("controls") = none,
           py::kw_only(), py::arg("positions") = none, py::arg("normals") = true, py::arg("tangents") = true,
           py::arg("frames_per_second") = none, py::arg("channels") = none, py::arg("goes_on") = false,
           py::arg("attached") = true, py::arg("full_positions") = false)
      .def("skip", &Instance::skip, py::arg("joints"), py::arg("frames_per_second"), py::arg("channels") = none,
           py::kw_only(), py::arg("goes_on") = false)
      .def("set_weights", &Instance::set_weights, py::arg("correction") = 1, py::arg("jiggle") = 1)
      .def("state", &Instance::state)
      .def("set_state", &Instance::set_state, py::arg("state"))
      .def("save_state", &Instance::save_state, py::arg("state"), py::arg("path"))
      .def("load_state", &Instance::load_state, py::arg("path"));
  py::class_<Call, std::shared_ptr<Call>>(module, "Call")
      .def(py::init<Instance&, const py::object&, const py::object&, std::optional<std::vector<std::int32_t>>,
                    const py::object&, const py::object&, const py::object&, bool, bool>(),
           py::arg("instance"), py::arg("joints"), py::arg("controls") = none, py::arg("frame_numbers") = none,
           py::kw_only(), py::arg("positions") = none, py::arg("normals") = true, py::arg("tangents") = true,
           py::arg("attached") = true, py::arg("full_positions") = false)
      .def_property_readonly("skin", &Call::skin);
  module.def("evaluate_together", &Call::evaluate_together, py::arg("calls"));
  py::class_<Model>(module, "Model")
      .def_property_readonly("vertex_count", [](const Model& m) { return m.description.vertex_count; })
      .def_property_readonly("knows_error", [](const Model& m) { return m.description.knows_error != 0; })
      .def_property_readonly("has_tangents", [](const Model& m) { return m.description.has_tangents != 0; })
      .def_property_readonly("has_dynamics", [](const Model& m) { return m.description.has_dynamics != 0; })
      .def_property_readonly("frames_per_second", [](const Model& m) { return m.description.frames_per_second; })
      .def_property_readonly("joint_names",
                             [](const Model& m) { return m.names(bodyopt_joint_name, m.description.joint_count); })
      .def_property_readonly("control_names",
                             [](const Model& m) { return m.names(bodyopt_control_name, m.description.control_count); })
      .def_property_readonly("strain_names",
                             [](const Model& m) { return m.names(bodyopt_strain_name, m.description.strain_count); })
      .def_property_readonly("joint_parents", &Model::parents)
      .def_property_readonly("channels", &Model::channels)
      .def_property_readonly("attached", &Model::attached)
      .def_property_readonly("full_vertex_count", [](const Model& m) { return m.description.full_vertex_count; })
      .def_property_readonly("feature_names", &Model::feature_names)
      .def_property_readonly("triangles", &Model::triangles)
      .def_property_readonly("bind_pose", &Model::bind_pose)
      .def(
          "instance",
          [](const Model& model, const Device* device, bool jiggles, std::uint32_t iterations,
             const std::array<double, 3>& gravity_change, bool check) {
            return std::make_unique<Instance>(model.handle, device, jiggles, iterations, gravity_change, check);
          },
          py::arg("device") = none, py::kw_only(), py::arg("jiggles") = false, py::arg("iterations") = 0,
          py::arg("gravity_change") = std::array<double, 3>{}, py::arg("check") = false);
  module.def("load", &Model::of_files, py::arg("path"), py::arg("dynamics") = none, py::arg("level") = 0,
             py::arg("texture") = none, py::arg("attached") = none);
  module.def("load_from_memory", &Model::of_bytes, py::arg("data"), py::arg("dynamics") = none, py::arg("level") = 0,
             py::arg("texture") = none, py::arg("attached") = none);
  module.def("device_names", &device_names);
  module.def(
      "open_device",
      [](const std::optional<std::string>& name, bool validation, const py::object& pipeline_cache) {
        return std::make_unique<Device>(name, validation, pipeline_cache);
      },
      py::arg("name") = none, py::arg("validation") = false, py::arg("pipeline_cache") = none);
}
