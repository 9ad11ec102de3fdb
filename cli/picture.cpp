// bodyopt picture: a frame of a dataset as the simulation left it, whole or cut open.
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "assets/shape_reader.h"
#include "assets/wording.h"
#include "cli/arguments/common.h"
#include "dataset/modifier.h"
#include "geometry/embedding.h"
#include "report/pictures.h"
#include "report/section.h"
#include "runtime/core/error.h"
#include "runtime/core/hexadecimal.h"
#include "runtime/host/rig.h"
#include "trainer/curate/shape_stack.h"
#include "trainer/simulate/simulate.h"

namespace bodyopt::cli {
namespace {

struct PictureArguments {
  std::string dataset, take, around, out;
  int frame = 1;
  double radius = 0.25;
  std::vector<float> direction{0, 0, 1};
  bool cut_open = false;
  std::vector<std::uint32_t> size{900, 900};
  JsonOption json;
};

// One frame of one take, with all that goes with it.
struct PicturedFrame {
  Dataset dataset;
  DatasetTake take;
  Character character;
  Clip clip;
  std::vector<float> skin;  // V x 3
};

// What the dataset's modifiers make of a frame; nothing where it has none, or the frame did not converge.
std::optional<Positions> curated_skin(const PicturedFrame& pictured, int number) {
  if (pictured.dataset.modifiers.empty()) return std::nullopt;
  const ShapeStack stack(read_pose_database(pictured.dataset));
  say(stack.notes());
  const PoseDatabase& database = stack.database();
  for (std::size_t n = 0; n < database.frames.size(); ++n) {
    const DatabaseFrame& frame = database.frames[n];
    const bool same_take = database.takes[static_cast<std::size_t>(frame.take)] == pictured.take.name;
    if (same_take && frame.frame == number) return stack.shape(n);
  }
  return std::nullopt;
}

PicturedFrame read_pictured_frame(const PictureArguments& arguments) {
  const std::filesystem::path path = dataset_file(arguments.dataset);
  PicturedFrame pictured;
  pictured.dataset = read_dataset(path);
  const auto take =
      std::find_if(pictured.dataset.takes.begin(), pictured.dataset.takes.end(),
                   [&](const DatasetTake& t) { return arguments.take.empty() || t.name == arguments.take; });
  if (take == pictured.dataset.takes.end()) {
    throw Error(ErrorKind::usage, path.string() + " has no take '" + arguments.take + "'");
  }
  pictured.take = *take;
  const auto at = std::find(take->frames.begin(), take->frames.end(), arguments.frame);
  if (at == take->frames.end()) {
    throw Error(ErrorKind::usage, format("frame {} is not among the shapes of take '{}'", arguments.frame, take->name));
  }
  pictured.character = read_character(pictured.dataset.folder / pictured.dataset.character, pictured.dataset.unit);
  say(pictured.character.notes);
  pictured.clip = read_clip(pictured.dataset, pictured.take, pictured.character.skeleton);
  say(pictured.clip.notes);
  if (arguments.frame < pictured.clip.first_frame || arguments.frame > pictured.clip.last_frame()) {
    throw Error(
        ErrorKind::mismatch,
        format("take '{}': frame {} is not in the clip {}, which has frames {} to {}: first_frame or fps may be "
               "wrong, or the clip was replaced",
               take->name, arguments.frame, take->clip, pictured.clip.first_frame, pictured.clip.last_frame()));
  }
  const ShapeReader shapes(pictured.dataset.folder / take->shapes);
  const auto sample = static_cast<std::uint32_t>(at - take->frames.begin());
  if (shapes.point_count() != pictured.character.output_count() || sample >= shapes.sample_count()) {
    throw Error(ErrorKind::mismatch, take->shapes + " does not fit the dataset: try `bodyopt check`");
  }
  const Positions skin = curated_skin(pictured, arguments.frame)
                             .value_or(welded_from_output(pictured.character, shapes.sample(sample).data()));
  pictured.skin.assign(skin.data(), skin.data() + skin.size());
  return pictured;
}

// Where the camera looks: around a joint, or at all of the skin.
struct View {
  Camera camera;
  Vec3 centre, direction;  // direction: towards the camera, unit
};

Vec3 unit_direction(const std::vector<float>& direction) {
  const Vec3 given{direction[0], direction[1], direction[2]};
  const double size = length(given);
  if (!(size > 0 && std::isfinite(size))) {
    throw Error(ErrorKind::usage,
                format("--direction {:g} {:g} {:g} points nowhere: expected finite numbers, not all 0", given[0],
                       given[1], given[2]));
  }
  return (1 / size) * given;
}

View choose_view(const PictureArguments& arguments, const PicturedFrame& pictured, const Vec3& towards_camera) {
  const Pose& pose = pictured.clip.poses[static_cast<std::size_t>(arguments.frame - pictured.clip.first_frame)];
  std::array<float, 3> direction;
  for (std::size_t i = 0; i < 3; ++i) direction[i] = static_cast<float>(towards_camera[i]);
  const float aspect = static_cast<float>(arguments.size[0]) / static_cast<float>(arguments.size[1]);
  std::array<float, 3> low, high;
  for (std::size_t i = 0; i < 3; ++i) {
    low[i] = high[i] = pictured.skin[i];
    for (std::size_t v = i; v < pictured.skin.size(); v += 3) {
      low[i] = std::min(low[i], pictured.skin[v]);
      high[i] = std::max(high[i], pictured.skin[v]);
    }
  }
  if (!arguments.around.empty()) {
    const int joint = pictured.character.skeleton.find(arguments.around);
    if (joint < 0) {
      std::vector<std::string> names;
      for (const Joint& known : pictured.character.skeleton.joints) names.push_back(known.name);
      throw Error(ErrorKind::usage,
                  "--around: the character has no joint '" + arguments.around + "'; it has " + list_names(names));
    }
    const Affine world = posed_joints(pictured.character.skeleton, pose.joints)[static_cast<std::size_t>(joint)];
    for (std::size_t i = 0; i < 3; ++i) {
      low[i] = static_cast<float>(world.m[i][3] - arguments.radius);
      high[i] = static_cast<float>(world.m[i][3] + arguments.radius);
    }
  }
  View view{frame_box(low, high, direction, aspect), {}, towards_camera};
  for (std::size_t i = 0; i < 3; ++i) view.centre[i] = 0.5 * (double{low[i]} + double{high[i]});
  return view;
}

constexpr std::array<float, 3> kSkinColour{0.52f, 0.42f, 0.36f}, kFatColour{0.72f, 0.58f, 0.34f},
    kBoneColour{0.80f, 0.78f, 0.70f};

// Relaxed at rest length: dark red. Shortened by up to a third: brighter; stretched by as much: bluer.
std::array<float, 3> muscle_colour(double stretch) {
  constexpr double kFullStretch = 0.33;
  const auto t = static_cast<float>(std::clamp((stretch - 1) / kFullStretch, -1.0, 1.0));
  constexpr std::array<float, 3> rest{0.36f, 0.06f, 0.05f}, shorter{0.95f, 0.30f, 0.04f}, longer{0.12f, 0.10f, 0.55f};
  const std::array<float, 3>& end = t < 0 ? shorter : longer;
  std::array<float, 3> colour;
  for (std::size_t i = 0; i < 3; ++i) colour[i] = std::lerp(rest[i], end[i], std::abs(t));
  return colour;
}

std::vector<std::array<float, 3>> tet_colours(const QuasiStaticBody& body, const Positions& nodes) {
  const TetMesh& mesh = body.mesh();
  std::vector<std::array<float, 3>> colours(static_cast<std::size_t>(mesh.tets.rows()), kFatColour);
  for (const FibreTet& fibre : body.fibres()) {
    const Eigen::Matrix3d strain = tet_edges({nodes, mesh.tets, 0}, fibre.tet) * tet_edges(mesh, fibre.tet).inverse();
    colours[static_cast<std::size_t>(fibre.tet)] = muscle_colour((strain * fibre.direction).norm());
  }
  std::vector<double> bone(colours.size(), 0);  // cubic metres
  for (const BonePoint& point : body.bones()) bone[static_cast<std::size_t>(point.tet)] += point.volume;
  for (std::size_t t = 0; t < bone.size(); ++t) {
    const double volume = tet_edges(mesh, static_cast<Eigen::Index>(t)).determinant() / 6;
    if (bone[t] > 0.5 * volume) colours[t] = kBoneColour;
  }
  return colours;
}

// What the side-car says the frame was solved of.
std::uint64_t recorded_inputs(const PicturedFrame& pictured, int frame) {
  const DatasetTake& take = pictured.take;
  const std::string needs = format(
      "--cut-open solves frame {} of take '{}' again and must know what its skin was solved of; ", frame, take.name);
  if (take.shapes_status.empty()) {
    throw Error(ErrorKind::mismatch, needs + "the take has no side-car: do its shapes come from elsewhere?");
  }
  for (const FrameStatus& status : read_frame_status(pictured.dataset.folder / take.shapes_status)) {
    if (status.frame == frame && status.inputs != 0) return status.inputs;
  }
  throw Error(ErrorKind::mismatch,
              needs + take.shapes_status + " does not say: written by hand, or by another program?");
}

// The nodes (N x 3, posed, metres) under the skin of a frame: they are not kept, it is solved again.
Positions solve_again(const PicturedFrame& pictured, const QuasiStaticBody& body, const std::vector<Muscle>& muscles,
                      int frame, std::uint64_t inputs) {
  const std::uint64_t now = frame_key(body, muscles, pictured.clip, frame);
  if (now != inputs) {
    throw Error(ErrorKind::mismatch,
                format("--cut-open solves frame {} of take '{}' again, but {} says that its skin was solved of other "
                       "inputs ({}, expected {}): it was simulated with --tet-size or by another version, or the "
                       "character, muscles, materials, clip or controls were changed since; simulate it again",
                       frame, pictured.take.name, pictured.take.shapes_status, hexadecimal(inputs), hexadecimal(now)));
  }
  return solve_frame(body, muscles, pictured.clip, frame).nodes;
}

Image draw_cut(const PictureArguments& arguments, const PicturedFrame& pictured, const View& view, Renderer& renderer) {
  if (pictured.take.shapes.ends_with(".nodes")) {
    throw Error(ErrorKind::usage, "--cut-open shows what 'simulate' fills a skin with, its tissues apart; take '" +
                                      pictured.take.name + "' is a draft (" + pictured.take.shapes +
                                      "), of one tissue and few tets: simulate the frame without --draft");
  }
  const std::uint64_t inputs = recorded_inputs(pictured, arguments.frame);
  std::vector<Muscle> muscles;
  const Dataset& dataset = pictured.dataset;
  if (!dataset.muscles.empty()) muscles = read_muscles(dataset.folder / dataset.muscles, pictured.character.skeleton);
  SimulateOptions options;
  if (!dataset.materials.empty()) options.materials = read_materials(dataset.folder / dataset.materials);
  std::string cage;  // why there is one, where there is one
  options.warn = [&](const std::string& warning) { cage = warning; };
  const QuasiStaticBody body = make_body(pictured.character, muscles, options);
  if (body.is_cage()) {
    throw Error(ErrorKind::mismatch, "--cut-open shows the tets that fill a skin, and none fill this one: " + cage);
  }
  const Positions nodes = solve_again(pictured, body, muscles, arguments.frame, inputs);

  const CutPlane plane{view.centre, view.direction};
  const std::span<const std::uint32_t> triangles(pictured.character.triangles.data(),
                                                 static_cast<std::size_t>(pictured.character.triangles.size()));
  const Soup skin = cut_surface(pictured.skin, smooth_normals(triangles, pictured.skin), triangles, kSkinColour, plane);
  const Soup face = cut_face({nodes.data(), static_cast<std::size_t>(nodes.size())},
                             {body.mesh().tets.data(), static_cast<std::size_t>(body.mesh().tets.size())},
                             tet_colours(body, nodes), plane);
  std::vector<DrawMesh> meshes;
  for (const Soup* soup : {&skin, &face}) {
    if (!soup->triangles.empty()) meshes.push_back({soup->positions, soup->normals, soup->triangles, soup->colours});
  }
  return renderer.draw(meshes, view.camera, arguments.size[0], arguments.size[1]);
}

void run(const PictureArguments& arguments) {
  const Vec3 direction = unit_direction(arguments.direction);
  require_writable(arguments.out);
  arguments.json.require_writable();
  const PicturedFrame pictured = read_pictured_frame(arguments);
  const View view = choose_view(arguments, pictured, direction);
  Renderer renderer;
  Image image;
  if (arguments.cut_open) {
    image = draw_cut(arguments, pictured, view, renderer);
  } else {
    const std::span<const std::uint32_t> triangles(pictured.character.triangles.data(),
                                                   static_cast<std::size_t>(pictured.character.triangles.size()));
    const std::vector<float> normals = smooth_normals(triangles, pictured.skin);
    const DrawMesh mesh{pictured.skin, normals, triangles, {}};
    image = renderer.draw(std::span(&mesh, 1), view.camera, arguments.size[0], arguments.size[1]);
  }
  write_png(image, arguments.out);
  arguments.json.emit({{"picture", arguments.out},
                       {"take", pictured.take.name},
                       {"frame", arguments.frame},
                       {"cut_open", arguments.cut_open}},
                      format("wrote {}: frame {} of take '{}'{}\n", arguments.out, arguments.frame, pictured.take.name,
                             arguments.cut_open ? ", cut open" : ""));
}

}  // namespace

void add_picture(CLI::App& app) {
  auto arguments = std::make_shared<PictureArguments>();
  CLI::App& verb = add_verb(app, "picture", "A picture of a frame of a dataset, whole or cut open");
  add_option(verb, "dataset", arguments->dataset, "Dataset (folder or dataset.json)")->required()->type_name("DATASET");
  add_option(verb, "--take", arguments->take, "Name of the take (default: the first)");
  add_option(verb, "--frame", arguments->frame, "Frame of the take")->required();
  add_option(verb, "--direction", arguments->direction, "From what is looked at towards the camera: x y z")
      ->expected(3)
      ->capture_default_str();
  CLI::Option* around = add_option(verb, "--around", arguments->around, "Joint to look at (default: the whole body)");
  add_option(verb, "--radius", arguments->radius, "Metres around that joint")
      ->needs(around)
      ->check(above_zero)
      ->capture_default_str();
  add_flag(verb, "--cut-open", arguments->cut_open,
           "Take away what is in front of the middle: fat yellow, bone white, muscles red, orange where they are "
           "shorter than at rest, violet where longer. Of frames that `simulate` solved without --tet-size");
  add_option(verb, "--size", arguments->size, "Width and height in pixels")
      ->expected(2)
      ->check(CLI::Range(16u, kMaxPictureSize))
      ->capture_default_str();
  add_option(verb, "--out", arguments->out, "FILE.png", "Picture to write")->required();
  arguments->json.add(verb);
  verb.callback([arguments] { run(*arguments); });
}

}  // namespace bodyopt::cli
