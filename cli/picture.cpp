// bodyopt picture: a frame of a dataset as the simulation left it, whole or cut open.
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "assets/caches/nodes_cache.h"
#include "assets/caches/shape_reader.h"
#include "base/wording.h"
#include "cli/arguments/common.h"
#include "dataset/modifier.h"
#include "draw/cut_surface.h"
#include "geometry/mesh.h"
#include "report/pictures.h"
#include "runtime/core/error.h"
#include "runtime/core/text.h"
#include "runtime/host/rig.h"
#include "trainer/anatomy/section.h"
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

// A frame's skin by the dataset's modifiers; nothing where it has none, or the frame did not converge.
std::optional<Positions> curated_skin(const PicturedFrame& pictured, int number) {
  if (pictured.dataset.modifiers.empty()) return std::nullopt;
  const trainer::ShapeStack stack(trainer::read_pose_database(pictured.dataset));
  say(stack.notes());
  const trainer::PoseDatabase& database = stack.database();
  for (std::size_t n = 0; n < database.frames.size(); ++n) {
    if (database.take_of(n) == pictured.take.name && database.frames[n].frame == number) return stack.shape(n);
  }
  return std::nullopt;
}

PicturedFrame read_pictured_frame(const PictureArguments& arguments) {
  const std::filesystem::path path = dataset_file(arguments.dataset);
  PicturedFrame pictured;
  pictured.dataset = read_dataset(path);
  const auto take = std::ranges::find_if(
      pictured.dataset.takes, [&](const DatasetTake& t) { return arguments.take.empty() || t.name == arguments.take; });
  if (take == pictured.dataset.takes.end()) {
    throw Error(ErrorKind::usage, path.string() + " has no take '" + arguments.take + "'");
  }
  pictured.take = *take;
  const auto at = std::ranges::find(take->frames, arguments.frame);
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
  pictured.skin = floats_of(curated_skin(pictured, arguments.frame)
                                .value_or(welded_from_output(pictured.character, shapes.sample(sample).data())));
  return pictured;
}

// A view around a joint, or of all of the skin.
struct View {
  draw::Camera camera;
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
  const Positions skin = rows_of(pictured.skin);
  std::array<float, 3> low, high;
  for (std::size_t i = 0; i < 3; ++i) {
    low[i] = static_cast<float>(skin.col(static_cast<Eigen::Index>(i)).minCoeff());
    high[i] = static_cast<float>(skin.col(static_cast<Eigen::Index>(i)).maxCoeff());
  }
  if (!arguments.around.empty()) {
    const int joint = pictured.character.skeleton.find(arguments.around);
    if (joint < 0) {
      throw Error(ErrorKind::usage, "--around: the character has no joint '", arguments.around, "'; it has ",
                  list_names(names_of(pictured.character.skeleton.joints)));
    }
    const Affine world = posed_joints(pictured.character.skeleton, pose.joints)[static_cast<std::size_t>(joint)];
    for (std::size_t i = 0; i < 3; ++i) {
      low[i] = static_cast<float>(world.m[i][3] - arguments.radius);
      high[i] = static_cast<float>(world.m[i][3] + arguments.radius);
    }
  }
  View view{draw::frame_box(low, high, direction, aspect), {}, towards_camera};
  for (std::size_t i = 0; i < 3; ++i) view.centre[i] = 0.5 * (double{low[i]} + double{high[i]});
  return view;
}

constexpr std::array<float, 3> kSkinColour{0.52f, 0.42f, 0.36f};

// The hash in the side-car of all that the frame was solved from.
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

void require_same_inputs(const PicturedFrame& pictured, std::uint64_t now, std::uint64_t inputs, int frame) {
  if (now == inputs) return;
  throw Error(ErrorKind::mismatch,
              format("--cut-open solves frame {} of take '{}' again, but {} says that its skin was solved of other "
                     "inputs ({}, expected {}): it was simulated with --tet-size or by another version, or the "
                     "character, muscles, materials, clip or controls were changed since; simulate it again",
                     frame, pictured.take.name, pictured.take.shapes_status, hexadecimal(inputs), hexadecimal(now)));
}

// The body of a take, as it was simulated.
struct CutBody {
  std::vector<Muscle> muscles;
  trainer::AnatomyField field;
  trainer::QuasiStaticBody body;
  Positions nodes;  // of the frame, posed
};

// The nodes of a draft are kept; of other takes the frame is solved again.
CutBody cut_body(const PicturedFrame& pictured, int frame) {
  const std::uint64_t inputs = recorded_inputs(pictured, frame);
  const Dataset& dataset = pictured.dataset;
  std::vector<Muscle> muscles;
  if (!dataset.muscles.empty()) muscles = read_muscles(dataset.folder / dataset.muscles, pictured.character.skeleton);
  trainer::SimulateOptions options;
  options.draft = pictured.take.shapes.ends_with(".nodes");
  if (!dataset.materials.empty()) options.materials = trainer::read_materials(dataset.folder / dataset.materials);
  options.anatomy = trainer::anatomy_options(dataset, pictured.character.skeleton);
  trainer::AnatomyField field(pictured.character, muscles, options.anatomy);
  trainer::QuasiStaticBody body = trainer::make_body(pictured.character, muscles, field, options);
  require_same_inputs(pictured, trainer::frame_key(body, muscles, pictured.clip, frame), inputs, frame);
  const auto sample =
      static_cast<std::uint32_t>(std::ranges::find(pictured.take.frames, frame) - pictured.take.frames.begin());
  Positions nodes = options.draft ? NodesReader(dataset.folder / pictured.take.shapes).nodes(sample)
                                  : trainer::solve_frame(body, muscles, pictured.clip, frame).nodes;
  return {std::move(muscles), std::move(field), std::move(body), std::move(nodes)};
}

// The plane through the middle of the view, with the picture's own pixels.
trainer::SectionPlane plane_of_view(const View& view, const std::vector<std::uint32_t>& size) {
  const draw::ViewAxes axes = draw::view_axes(view.direction);
  const double height = 2 * draw::distance_to_target(view.camera) * std::tan(0.5 * double{view.camera.vertical_angle});
  const double pixel = height / size[1];
  const auto eigen = [](const Vec3& v) { return Eigen::Vector3d(v[0], v[1], v[2]); };
  return trainer::plane_around(eigen(view.centre), eigen(axes.right), -eigen(axes.up), {pixel * size[0], height},
                               pixel);
}

// How long the fibres are at every pixel, times their length at rest.
std::vector<double> fibre_stretch(const CutBody& cut, const trainer::RestPoints& rest) {
  const TetMesh& mesh = cut.body.mesh();
  const TetMesh moved{cut.nodes, mesh.tets, 0};
  std::vector<double> stretch(rest.size(), 1.0);
  for (std::size_t pixel = 0; pixel < rest.size(); ++pixel) {
    if (!rest[pixel]) continue;
    const Eigen::Vector3d fibre = cut.field.fibre_at(rest[pixel]->position);
    if (fibre.isZero()) continue;
    const Eigen::Matrix3d strain = tet_edges(moved, rest[pixel]->tet) * tet_edges(mesh, rest[pixel]->tet).inverse();
    stretch[pixel] = (strain * fibre).norm();
  }
  return stretch;
}

// Tets of a cage reach beyond the skin.
void keep_inside(const trainer::SectionPlane& plane, const PicturedFrame& pictured, trainer::RestPoints& rest) {
  const std::vector<bool> inside = trainer::pixels_inside(plane, rows_of(pictured.skin), pictured.character.triangles);
  for (std::size_t pixel = 0; pixel < rest.size(); ++pixel) {
    if (!inside[pixel]) rest[pixel].reset();
  }
}

// The field of tissues where the plane cuts the tets.
draw::Soup cut_face(const CutBody& cut, const PicturedFrame& pictured, const trainer::SectionPlane& plane) {
  const auto tissue_at = [&](const Eigen::Vector3d& point) { return cut.field.tissue_at(point); };
  const auto is_tissue = [&](const Eigen::Vector3d& point) {
    return tissue_at(point).kind != trainer::TissueKind::outside;
  };
  trainer::RestPoints rest = trainer::rest_points(plane, cut.body.mesh(), cut.nodes, is_tissue);
  keep_inside(plane, pictured, rest);
  const trainer::TissueSection section = trainer::section_of(plane, rest, tissue_at);
  return report::standing_section(plane,
                                  trainer::TissueColours(cut.muscles).picture(section, fibre_stretch(cut, rest)));
}

draw::Image draw_cut(const PictureArguments& arguments, const PicturedFrame& pictured, const View& view,
                     draw::Renderer& renderer) {
  const CutBody cut = cut_body(pictured, arguments.frame);
  const draw::CutPlane plane{view.centre, view.direction};
  const std::span<const std::uint32_t> triangles = report::flat(pictured.character.triangles);
  const draw::Soup skin =
      draw::cut_surface(pictured.skin, report::smooth_normals(triangles, pictured.skin), triangles, kSkinColour, plane);
  const draw::Soup face = cut_face(cut, pictured, plane_of_view(view, arguments.size));
  std::vector<draw::DrawMesh> meshes;
  for (const draw::Soup* soup : {&skin, &face}) {
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
  draw::Renderer renderer;
  draw::Image image;
  if (arguments.cut_open) {
    image = draw_cut(arguments, pictured, view, renderer);
  } else {
    image = report::draw_skin(renderer, report::flat(pictured.character.triangles), pictured.skin, {},
                              {view.camera, arguments.size[0], arguments.size[1]});
  }
  draw::write_png(image, arguments.out);
  arguments.json.emit({{"picture", arguments.out},
                       {"take", pictured.take.name},
                       {"frame", arguments.frame},
                       {"cut_open", arguments.cut_open}},
                      format("wrote {}: frame {} of take '{}'{}\n", arguments.out, arguments.frame, pictured.take.name,
                             arguments.cut_open ? ", cut open" : ""));
}

}  // namespace

void add_picture(CLI::App& app) {
  const auto [verb, arguments] =
      add_verb<PictureArguments>(app, "picture", "Draw a frame of a dataset, whole or cut open", run);
  add_required(verb, "dataset", arguments.dataset, "DATASET", "Dataset (folder or dataset.json)");
  add_option(verb, "--take", arguments.take, "Name of the take (default: the first)");
  add_option(verb, "--frame", arguments.frame, "Frame of the take")->required();
  add_option(verb, "--direction", arguments.direction, "From what is looked at towards the camera: x y z")
      ->expected(3)
      ->capture_default_str();
  CLI::Option* around = add_option(verb, "--around", arguments.around, "Joint to look at (default: the whole body)");
  add_option(verb, "--radius", arguments.radius, "Metres around that joint")
      ->needs(around)
      ->check(above_zero)
      ->capture_default_str();
  add_flag(verb, "--cut-open", arguments.cut_open,
           "Take away what is in front of the middle: bone ivory, fat yellow, cavity grey-blue, every muscle a red of "
           "its own, more orange the shorter than at rest, more violet the longer. Of frames that `simulate` solved "
           "without --tet-size");
  add_option(verb, "--size", arguments.size, "Width and height in pixels")
      ->expected(2)
      ->check(CLI::Range(16u, draw::kMaxPictureSize))
      ->capture_default_str();
  add_option(verb, "--out", arguments.out, "FILE.png", "Picture to write")->required();
  arguments.json.add(verb);
}

}  // namespace bodyopt::cli
