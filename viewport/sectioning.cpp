#include "viewport/sectioning.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include "assets/characters/muscles.h"
#include "dataset/dataset.h"
#include "draw/camera.h"
#include "draw/cut_surface.h"
#include "geometry/mesh.h"
#include "report/pictures.h"
#include "runtime/core/error.h"
#include "runtime/host/rig.h"
#include "trainer/anatomy/anatomy_report.h"
#include "trainer/anatomy/section.h"
#include "trainer/builtin/arm.h"
#include "trainer/curate/named_shapes.h"
#include "trainer/simulate/simulate.h"
#include "viewport/picking.h"

namespace bodyopt::viewport {

struct Anatomy {
  Character character;
  std::vector<Muscle> muscles;
  trainer::AnatomyField field;
  trainer::TissueColours colours;

  Anatomy(Character whose, std::vector<Muscle> its, const trainer::AnatomyOptions& options)
      : character(std::move(whose)), muscles(std::move(its)), field(character, muscles, options), colours(muscles) {}
};

namespace {

constexpr int kFine = 700, kCoarse = 220;  // pixels to the longer side of the skin

Eigen::Vector3d eigen(const Vec3& v) { return {v[0], v[1], v[2]}; }

CutOpenSkin::Part upload_soup(const vulkan::Device& device, const draw::Soup& soup) {
  if (soup.triangles.empty()) return {};
  return {vulkan::upload(device, soup.positions, "a cut skin"), vulkan::upload(device, soup.normals, "a cut skin"),
          vulkan::upload(device, soup.colours, "a cut skin"), vulkan::upload(device, soup.triangles, "a cut skin"),
          static_cast<std::uint32_t>(soup.triangles.size() / 3)};
}

std::vector<Muscle> muscles_of(const shots::ActorFiles& files, const Skeleton& skeleton) {
  if (!files.muscles.empty()) return read_muscles(files.muscles, skeleton);
  return files.basis.empty() ? trainer::build_arm().muscles : std::vector<Muscle>();
}

// "other lean"
std::string spoken(trainer::TissueKind kind) {
  std::string name = trainer::name_of(kind);
  std::ranges::replace(name, '_', ' ');
  return name;
}

// Options are those by which the dataset's shapes were simulated, where one is looked at.
trainer::AnatomyOptions options_of(const shots::ActorFiles& files, const Skeleton& skeleton) {
  const bool is_of_dataset = files.clip == files.truth && trainer::is_dataset(files.truth);
  return is_of_dataset ? trainer::anatomy_options(read_dataset(files.truth), skeleton) : trainer::AnatomyOptions();
}

std::string files_key(const shots::ActorFiles& files) {
  return files.basis + "\n" + files.character + "\n" + files.muscles + "\n" + files.truth;
}

bool is_ready(const std::shared_future<std::shared_ptr<const Anatomy>>& found) {
  return found.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
}

// Makes a plane across an axis of the world, seen from the camera's side, as large as the skin.
trainer::SectionPlane plane_across(const Positions& skin, int axis, double at, bool from_above, int pixels) {
  const Eigen::Vector3d low = skin.colwise().minCoeff(), high = skin.colwise().maxCoeff();
  Vec3 normal{};
  normal[static_cast<std::size_t>(axis)] = from_above ? 1 : -1;
  const draw::ViewAxes axes = draw::view_axes(normal);
  Eigen::Vector3d middle = 0.5 * (low + high);
  middle[axis] = std::lerp(low[axis], high[axis], at);
  const auto side = [&](const Vec3& along) { return eigen(along).cwiseAbs().dot(high - low); };
  const std::array<double, 2> sides{side(axes.right), side(axes.up)};
  return trainer::plane_around(middle, eigen(axes.right), -eigen(axes.up), sides,
                               std::max({sides[0], sides[1], 1e-6}) / pixels);
}

}  // namespace

bool Sectioning::Shown::operator==(const Shown& other) const {
  return anatomy == other.anatomy && same(pose, other.pose) && correction == other.correction && axis == other.axis &&
         at == other.at && from_above == other.from_above && coarse == other.coarse;
}

Sectioning::Found& Sectioning::find() {
  const Actor& lead = scene_.lead();
  const shots::ActorFiles& files = lead.files();
  const std::string key = files_key(files);
  if (const auto known = fields_.find(key); known != fields_.end()) return known->second;
  if (!lead.character()) {
    throw Error(ErrorKind::usage, lead.name() + ": what lies inside is found from its skin weights, which a basis " +
                                      "does not hold: open it with --character FILE");
  }
  const auto work = [character = *lead.character(), muscles = muscles_of(files, lead.character()->skeleton),
                     options = options_of(files, lead.character()->skeleton)] {
    return std::make_shared<const Anatomy>(character, muscles, options);
  };
  return fields_[key] = std::async(std::launch::async, work).share();
}

std::shared_ptr<const Anatomy> Sectioning::found() {
  const Found& found = find();
  if (controls_.headless) found.wait();
  waits_ = !is_ready(found);
  return waits_ ? nullptr : found.get();
}

void Sectioning::look(bool coarse) {
  if (!controls_.settings.look.anatomy || scene_.empty()) {
    if (shown_) scene_.show_cut_open(std::nullopt);
    shown_.reset();
    waits_ = false;
    return;
  }
  try {
    const std::shared_ptr<const Anatomy> anatomy = found();
    if (anatomy) {
      Shown now = wanted(anatomy, coarse);
      if (shown_ == now) return;
      shown_ = std::move(now);
      cut();
      return;
    }
  } catch (...) {
    controls_.settings.look.anatomy = false;
    forget();
    throw;
  }
  scene_.show_cut_open(std::nullopt);
  shown_.reset();
}

Sectioning::Shown Sectioning::wanted(std::shared_ptr<const Anatomy> anatomy, bool coarse) const {
  const shots::ViewSettings::Look& look = controls_.settings.look;
  const draw::Camera camera = controls_.camera.camera();
  const auto axis = static_cast<std::size_t>(look.anatomy_axis);
  return {std::move(anatomy),
          {scene_.lead_pose(controls_)},
          controls_.settings.pose.correction,
          look.anatomy_axis,
          look.anatomy_at,
          camera.eye[axis] >= camera.target[axis],
          coarse};
}

void Sectioning::cut() {
  const Anatomy& anatomy = *shown_->anatomy;
  const Positions skin = welded_from_output(anatomy.character, scene_.lead_skin(controls_).data());
  const std::vector<Affine> skinning = skinning_matrices(anatomy.character.skeleton, shown_->pose.front().joints);
  plane_ = plane_across(skin, static_cast<int>(shown_->axis), shown_->at, shown_->from_above,
                        shown_->coarse ? kCoarse : kFine);
  const trainer::RestPoints rest = trainer::rest_points(plane_, trainer::PosedBody{anatomy.character, skin, skinning});
  section_ =
      trainer::section_of(plane_, rest, [&](const Eigen::Vector3d& point) { return anatomy.field.tissue_at(point); });

  const std::vector<float> points = floats_of(skin);
  const Triangles& own = anatomy.character.triangles;
  const std::span<const std::uint32_t> triangles(own.data(), static_cast<std::size_t>(own.size()));
  const Eigen::Vector3d out = plane_.down.cross(plane_.right), at = plane_.corner;
  const draw::Soup behind =
      draw::cut_surface(points, report::smooth_normals(triangles, points), triangles, draw::kClayColour,
                        {{at.x(), at.y(), at.z()}, {out.x(), out.y(), out.z()}});
  const draw::Soup face = report::standing_section(plane_, anatomy.colours.picture(section_));
  scene_.show_cut_open(CutOpenSkin{upload_soup(*device_, behind), upload_soup(*device_, face)});
}

bool Sectioning::has_news() const {
  if (!waits_ || scene_.empty()) return false;
  const auto found = fields_.find(files_key(scene_.lead().files()));
  return found != fields_.end() && is_ready(found->second);
}

void Sectioning::forget() {
  fields_.clear();
  shown_.reset();
  waits_ = false;
  scene_.show_cut_open(std::nullopt);
}

std::string Sectioning::name_of(const trainer::TissueAt& tissue) const {
  const Anatomy& anatomy = *shown_->anatomy;
  const auto muscle = [&] { return anatomy.muscles[static_cast<std::size_t>(tissue.muscle)].name; };
  switch (tissue.kind) {
    case trainer::TissueKind::outside:
      return "";
    case trainer::TissueKind::bone:
      return tissue.joint < 0
                 ? "bone"
                 : "bone of " + anatomy.character.skeleton.joints[static_cast<std::size_t>(tissue.joint)].name;
    case trainer::TissueKind::muscle:
      return muscle();
    case trainer::TissueKind::tendon:
      return "tendon of " + muscle();
    default:
      return spoken(tissue.kind);
  }
}

std::string Sectioning::tissue_under(const draw::Rectangle& area, const std::array<double, 2>& mouse) const {
  const Ray ray = ray_through(scene_, controls_, area, mouse);
  const Eigen::Vector3d out = plane_.down.cross(plane_.right);
  const double along = out.dot(eigen(ray.along)), t = out.dot(plane_.corner - eigen(ray.from)) / along;
  if (!(t > ray.least)) return "";
  const Eigen::Vector3d from_corner = (eigen(ray.from) + t * eigen(ray.along) - plane_.corner) / plane_.pixel;
  const double x = from_corner.dot(plane_.right), y = from_corner.dot(plane_.down);
  if (!(x >= 0 && y >= 0 && x < plane_.width && y < plane_.height)) return "";
  return name_of(section_.tissue[static_cast<std::size_t>(static_cast<int>(y) * plane_.width + static_cast<int>(x))]);
}

void Sectioning::describe(const draw::Rectangle& area, const std::optional<std::array<double, 2>>& mouse,
                          Snapshot& snapshot) const {
  snapshot.has_character = !scene_.empty() && scene_.lead().character();
  snapshot.section.reset();
  if (!controls_.settings.look.anatomy || !(shown_ || waits_)) return;
  SectionRow& row = snapshot.section.emplace();
  row.is_ready = shown_.has_value();
  if (!shown_) return;
  for (const trainer::TissueKind kind :
       {trainer::TissueKind::bone, trainer::TissueKind::fat, trainer::TissueKind::cavity, trainer::TissueKind::tendon,
        trainer::TissueKind::other_lean}) {
    row.tissues.push_back({spoken(kind), shown_->anatomy->colours.of({kind})});
  }
  if (mouse) row.under_mouse = tissue_under(area, *mouse);
}

}  // namespace bodyopt::viewport
