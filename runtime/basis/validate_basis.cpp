#include <algorithm>
#include <bit>
#include <cmath>
#include <set>

#include "runtime/basis/basis.h"
#include "runtime/basis/skin_modifiers.h"
#include "runtime/basis/table_checks.h"

namespace bodyopt {
namespace {

constexpr double kLargestFeature = 1e6;  // standardised: standard deviations of training
constexpr float kShortestFibre = 1e-6f;  // metres
constexpr double kUnitTolerance = 1e-3;  // of a quaternion's length
constexpr std::size_t kMostCoefficients = 65536;

class Validator : TableChecks {
 public:
  Validator(const Basis& basis, const std::string& origin) : TableChecks(origin), basis_(basis) {}

  void run() const {
    check_skeleton();
    check_joint_features();
    check_mesh();
    check_ddm();
    check_strain();
    check_residual();
    check_regions();
    expect_entries("residual.blend", basis_.residual.blend, basis_.residual.coefficient_region.size());
    check_fade();
    check_coverage();
    check_modifiers();
  }

 private:
  // Words of a row of halves.
  static std::size_t row_words(std::uint32_t halves) { return (std::size_t{halves} + 1) / 2; }

  static bool finite_halves(std::uint32_t word) {
    return (word & 0x7c00u) != 0x7c00u && ((word >> 16) & 0x7c00u) != 0x7c00u;
  }

  static bool is_turn(const Quat& q) {
    double norm2 = 0;
    for (const double x : q) norm2 += x * x;
    return std::abs(std::sqrt(norm2) - 1) <= kUnitTolerance;
  }

  // Is every number finite and of sane size, and the rotation of unit length?
  static bool usable(const JointTransform& t) {
    bool good = true;
    for (std::size_t i = 0; i < 3; ++i)
      good = good && std::abs(t.translation[i]) <= kLargest && std::abs(t.scale[i]) <= kLargest;
    return good && is_turn(t.rotation);
  }

  void check_skeleton() const {
    const auto& joints = basis_.skeleton.joints;
    if (joints.empty()) refuse("the skeleton has 0 joints, expected 1 or more");
    for (std::size_t j = 0; j < joints.size(); ++j) {
      const Joint& joint = joints[j];
      const std::string name = "joint " + std::to_string(j) + " ('" + joint.name + "')";
      if (joint.parent < -1 || joint.parent >= static_cast<int>(j)) {
        refuse(name, " has parent ", joint.parent, ", expected a joint before it, or -1");
      }
      if (!usable(joint.bind) || !usable(joint.default_local)) {
        refuse(name, " has a transform that is not of finite numbers with a rotation of unit length");
      }
      for (const auto& row : joint.inverse_bind.m) {
        for (const double x : row) {
          if (!(std::abs(x) <= kLargest)) {
            refuse(name, " has ", x, " in its inverse bind matrix, expected a number of at most 1e9");
          }
        }
      }
    }
  }

  void check_joint_features() const {
    const std::vector<JointFeatures>& features = basis_.skeleton.features;
    for (std::size_t k = 0; k < features.size(); ++k) {
      const JointFeatures& of = features[k];
      const std::string name = element("skeleton.features", k);
      const std::size_t joints = basis_.skeleton.size();
      if (of.joint >= joints || of.above >= joints || common_joint(basis_.skeleton, of.joint, of.above) < 0) {
        refuse(name, " is of joint ", of.joint, " seen from ", of.above, ", expected two joints of one tree");
      }
      if (!(of.per_metre >= 0 && of.per_metre <= kLargest)) {
        refuse(name, " has ", of.per_metre, " a metre, expected 0 to 1e9");
      }
      if (!is_turn(of.above_turn) || !is_turn(of.own_turn)) refuse(name, " turns by no rotation of unit length");
    }
  }

  void check_mesh() const {
    const MeshTable& mesh = basis_.mesh;
    const std::size_t vertices = mesh.rest.size() / 3;
    if (mesh.rest.empty()) refuse("mesh.rest has 0 entries, expected 1 vertex or more");
    for (const auto& [name, size] :
         {std::pair("mesh.rest", mesh.rest.size()), std::pair("mesh.triangles", mesh.triangles.size()),
          std::pair("mesh.output_triangles", mesh.output_triangles.size())}) {
      if (size % 3 != 0) refuse(name, " has ", size, " entries, expected three to a row");
    }
    expect_numbers("mesh.rest", mesh.rest);
    expect_below("mesh.triangles", mesh.triangles, vertices);
    expect_below("mesh.output_vertex", mesh.output_vertex, vertices);
    expect_below("mesh.output_triangles", mesh.output_triangles, mesh.output_vertex.size());
    expect_offsets("mesh.vertex_triangle_begin", mesh.vertex_triangle_begin, vertices, mesh.vertex_triangles.size());
    expect_size("mesh.vertex_triangles", mesh.vertex_triangles.size(), mesh.triangles.size());
    Indices next = mesh.vertex_triangle_begin;  // where the next triangle of each vertex must stand
    for (std::size_t c = 0; c < mesh.triangles.size(); ++c) {
      const std::uint32_t v = mesh.triangles[c], k = next[v]++;
      if (k < mesh.vertex_triangle_begin[v + 1] && mesh.vertex_triangles[k] == c / 3) continue;
      refuse("mesh.vertex_triangles does not list triangle ", c / 3, " at vertex ", v,
             " in ascending order, expected at ", k);
    }
  }

  void check_ddm() const {
    const DdmTable& ddm = basis_.ddm;
    const std::size_t vertices = basis_.mesh.vertex_count();
    const std::size_t blocks = basis_.mesh.block_count();
    expect_offsets("ddm.block_begin", ddm.block_begin, blocks, ddm.block_joints.size());
    expect_below("ddm.block_joints", ddm.block_joints, basis_.skeleton.size());
    expect_size("ddm.moments", ddm.moments.size(), ddm.block_joints.size() * kMomentWords * kBlockSize);
    expect_size("ddm.vertices", ddm.vertices.size(), blocks * kBlockSize);
    for (std::size_t k = 0; k < ddm.moments.size(); ++k) {
      const std::uint32_t word = ddm.moments[k];
      const bool halves = (k / kBlockSize) % kMomentWords < 3;
      if (!halves) {
        expect_number("ddm.moments", k, static_cast<double>(std::bit_cast<float>(word)));
      } else if (!finite_halves(word)) {
        refuse(element("ddm.moments", k), " holds a half that is infinite or not a number, expected finite ones");
      }
    }
    for (std::size_t v = 0; v < ddm.vertices.size(); ++v) check_ddm_vertex(v, v < vertices);
  }

  void check_ddm_vertex(std::size_t v, bool used) const {
    const DdmTable& ddm = basis_.ddm;
    const DdmVertex& vertex = ddm.vertices[v];
    for (const float x : {vertex.centre_x, vertex.centre_y, vertex.centre_z, vertex.radius2, vertex.offset_x,
                          vertex.offset_y, vertex.offset_z}) {
      expect_number("ddm.vertices", v, static_cast<double>(x));
    }
    if (vertex.radius2 < 0) {
      refuse(element("ddm.vertices", v), " has the squared radius ", vertex.radius2, ", expected 0 or more");
    }
    const std::size_t block = v / kBlockSize;
    const auto first = ddm.block_joints.begin() + ddm.block_begin[block];
    const auto last = ddm.block_joints.begin() + ddm.block_begin[block + 1];
    if (vertex.base_joint >= basis_.skeleton.size() || (used && std::find(first, last, vertex.base_joint) == last)) {
      refuse(element("ddm.vertices", v), " has base joint ", vertex.base_joint, ", expected one of the ", last - first,
             " joints of its block");
    }
  }

  void check_strain() const {
    const StrainTable& strain = basis_.strain;
    const std::size_t fibres = strain.rest_length.size();
    if (fibres > 0 || !strain.fibre_begin.empty()) {
      expect_offsets("strain.fibre_begin", strain.fibre_begin, fibres, strain.points.size());
    }
    expect_size("the fibres' names", strain.names.size(), fibres);
    expect_below("strain.vertices", strain.vertices, basis_.mesh.vertex_count());
    for (std::size_t k = 0; k < strain.points.size(); ++k) {
      const FibrePoint& p = strain.points[k];
      for (const std::uint32_t index : {p.a, p.b, p.c}) {
        if (index < strain.vertices.size()) continue;
        refuse(element("strain.points", k), " names strain vertex ", index, ", expected an index below ",
               strain.vertices.size());
      }
      for (const float w : {p.wa, p.wb, p.wc}) expect_number("strain.points", k, static_cast<double>(w));
      const float sum = p.wa + p.wb + p.wc;
      if (std::abs(sum - 1) > kWeightTolerance) {
        refuse(element("strain.points", k), " has weights that sum to ", sum, ", expected 1");
      }
    }
    expect_numbers("strain.rest_length", strain.rest_length);
    for (std::size_t k = 0; k < fibres; ++k) {
      if (strain.fibre_begin[k + 1] - strain.fibre_begin[k] < 2) {
        refuse("fibre ", k, " ('", strain.names[k], "') has fewer than 2 points");
      }
      if (strain.rest_length[k] < kShortestFibre) {
        refuse(element("strain.rest_length", k), " is ", strain.rest_length[k],
               " m, expected a length above 0 (1e-6 or more)");
      }
    }
  }

  void check_residual() const {
    const ResidualTable& residual = basis_.residual;
    expect_offsets("residual.blend_begin", residual.blend_begin, basis_.mesh.block_count(), residual.blend.size());
    const std::size_t features =
        9 * feature_joint_count() + basis_.strain.rest_length.size() + residual.controls.size();
    if (residual.regions.empty() && residual.features.empty()) {
      if (!residual.controls.empty())
        refuse("residual.features has 0 entries, expected one for every control at least");
    } else {
      expect_size("residual.features", residual.features.size(), features);
    }
    for (std::size_t k = 0; k < residual.features.size(); ++k) check_feature(k);
    expect_below("residual.region_features", residual.region_features, residual.features.size());
    expect_numbers("residual.weights", residual.weights);
    expect_halves("residual.centres", residual.centres);
    expect_halves("residual.projections", residual.projections);
  }

  void expect_halves(const char* name, const Indices& words) const {
    for (std::size_t k = 0; k < words.size(); ++k) {
      if (finite_halves(words[k])) continue;
      refuse(element(name, k), " holds a half that is infinite or not a number, expected finite ones");
    }
  }

  void check_feature(std::size_t k) const {
    const FeatureRange& range = basis_.residual.features[k];
    for (const float x : {range.low, range.high, range.mean, range.inverse_scale}) {
      expect_number("residual.features", k, static_cast<double>(x));
    }
    if (range.low > range.high) {
      refuse(element("residual.features", k), " has a range from ", range.low, " to ", range.high,
             ", expected low <= high");
    }
    const float farthest = std::max(std::abs(range.low - range.mean), std::abs(range.high - range.mean));
    if (range.inverse_scale < 0 || farthest * range.inverse_scale > kLargestFeature) {
      refuse(element("residual.features", k), " has the inverse scale ", range.inverse_scale,
             ", expected 0 or more, and a range of at most 1e6 standard deviations");
    }
  }

  // Regions must tile every array they point into, in order.
  void check_regions() const {
    const ResidualTable& residual = basis_.residual;
    std::size_t features = 0, coordinates = 0, projections = 0;
    std::size_t centres = 0, centre_values = 0, coefficients = 0, weights = 0;
    for (std::size_t r = 0; r < residual.regions.size(); ++r) {
      const Region& region = residual.regions[r];
      if (region.feature_begin != features || region.coordinate_begin != coordinates ||
          region.projection_values != projections || region.centre_begin != centres ||
          region.centre_values != centre_values || region.coefficient_begin != coefficients ||
          region.weight_values != weights) {
        refuse(element("residual.regions", r), " has offsets that do not follow the region before it");
      }
      if (!(region.inverse_width2 >= 0 && region.inverse_width2 <= kLargest)) {
        refuse(element("residual.regions", r), " has the inverse width ", region.inverse_width2,
               ", expected a number from 0 to 1e9");
      }
      features += region.feature_count;
      coordinates += region.coordinate_count;
      projections += region.coordinate_count * row_words(region.feature_count);
      centres += region.centre_count;
      centre_values += region.centre_count * row_words(region.coordinate_count);
      coefficients += region.coefficient_count;
      weights += std::size_t{region.coefficient_count} *
                 (1 + std::size_t{region.coordinate_count} + std::size_t{region.centre_count});
      if (coefficients > kMostCoefficients) {
        refuse("the regions have ", coefficients, " coefficients or more, expected at most 65536");
      }
      expect_region("residual.coordinate_region", residual.coordinate_region, region.coordinate_begin,
                    region.coordinate_count, r);
      expect_region("residual.centre_region", residual.centre_region, region.centre_begin, region.centre_count, r);
      expect_region("residual.coefficient_region", residual.coefficient_region, region.coefficient_begin,
                    region.coefficient_count, r);
    }
    expect_size("residual.region_features", residual.region_features.size(), features);
    expect_size("residual.coordinate_region", residual.coordinate_region.size(), coordinates);
    expect_size("residual.projections", residual.projections.size(), projections);
    expect_size("residual.centre_region", residual.centre_region.size(), centres);
    expect_size("residual.centres", residual.centres.size(), centre_values);
    expect_size("residual.coefficient_region", residual.coefficient_region.size(), coefficients);
    expect_size("residual.weights", residual.weights.size(), weights);
  }

  void expect_region(const char* name, const Indices& regions, std::size_t begin, std::size_t count,
                     std::size_t region) const {
    if (begin + count > regions.size()) {
      refuse(name, " has ", regions.size(), " entries, expected ", begin + count, " or more by the regions");
    }
    for (std::size_t k = begin; k < begin + count; ++k) {
      if (regions[k] != region) refuse(element(name, k), " is ", regions[k], ", expected ", region);
    }
  }

  void expect_entries(const char* name, const std::vector<BlendEntry>& blend, std::size_t coefficients) const {
    for (std::size_t k = 0; k < blend.size(); ++k) {
      const std::uint32_t head = blend[k].scale_coefficient;
      if ((head >> 16) >= coefficients) {
        refuse(element(name, k), " names coefficient ", head >> 16, ", expected an index below ", coefficients);
      }
      if (!finite_halves(head & 0xffffu)) {
        refuse(element(name, k), " has a scale that is infinite or not a number, expected a finite half");
      }
    }
  }

  void check_modifiers() const {
    const SkinModifiers& modifiers = basis_.modifiers;
    if (modifiers.empty()) {
      expect_size("modifiers.blend_begin", modifiers.blend_begin.size(), 0);
      expect_size("modifiers.blend", modifiers.blend.size(), 0);
      return;
    }
    std::vector<char> used;  // components
    std::set<std::string> names;
    for (const SkinModifier& modifier : modifiers.stack) {
      if (modifier.name.empty() || !names.insert(modifier.name).second) {
        refuse("the modifier '", modifier.name, "' has no name of its own");
      }
      check_modifier(modifier, used);
    }
    if (std::ranges::find(used, 0) != used.end()) refuse("there are components that no modifier has");
    if (names.size() > kMostModifiers) refuse("there are more than ", kMostModifiers, " modifiers");
    expect_offsets("modifiers.blend_begin", modifiers.blend_begin, basis_.mesh.block_count(), modifiers.blend.size());
    expect_entries("modifiers.blend", modifiers.blend, used.size());
    check_posed_skin(modifiers);
  }

  void check_posed_skin(const SkinModifiers& modifiers) const {
    for (const PosedSkinType* type : kPosedSkinTypes) {
      const auto count = std::ranges::count(modifiers.stack, type->name, &SkinModifier::type);
      if (count == 0) continue;
      const std::string name = std::string("the type '") + type->name + "'";
      if (count > 1) refuse("there are ", count, " modifiers of ", name, ", expected one");
      const SkinModifier& modifier = *modifiers.of_type(type->name);
      const std::size_t joints = modifier.joints.size();
      if (modifier.component_count != type->components + joints * type->joint_components ||
          modifier.numbers.size() != type->numbers + joints * type->joint_numbers) {
        refuse("the modifier '", modifier.name, "' has not the components and numbers of ", name);
      }
    }
  }

  // Between them modifiers have each component once.
  void check_modifier(const SkinModifier& modifier, std::vector<char>& used) const {
    const std::string name = "the modifier '" + modifier.name + "'";
    const std::size_t end = std::size_t{modifier.first_component} + modifier.component_count;
    if (end > kMostModifierComponents) {
      refuse(name, " has components up to ", end, ", expected at most ", kMostModifierComponents);
    }
    if (used.size() < end) used.resize(end, 0);
    for (std::size_t k = modifier.first_component; k < end; ++k) {
      if (used[k]++ > 0) refuse(name, " has components of another");
    }
    expect_below("the joints of a modifier", modifier.joints, basis_.skeleton.size());
    expect_numbers("the numbers of a modifier", modifier.numbers);
    for (const auto& [control, value] : modifier.constants) expect_number(control.c_str(), 0, double{value});
    for (std::size_t k = 0; k < modifier.turns.size(); ++k) {
      const ModifierTurn& turn = modifier.turns[k];
      if (turn.joint >= basis_.skeleton.size() || turn.component >= modifier.component_count) {
        refuse(name, " turns joint ", turn.joint, " by component ", turn.component, ", which it does not have");
      }
      for (const float x : {turn.x, turn.y, turn.z}) expect_number("the turns of a modifier", k, double{x});
    }
  }

  void check_fade() const {
    const FadeTable& fade = basis_.residual.fade;
    if (fade.empty()) {
      const std::size_t others = fade.joints.size() + fade.direction_begin.size() + fade.directions.size() +
                                 fade.tolerance.size() + fade.region_begin.size() + fade.region_joints.size() +
                                 fade.region_weights.size();
      if (others > 0) refuse("residual.fade.joint_begin has 0 entries, though other arrays of the fade have some");
      return;
    }
    const std::size_t joints = basis_.residual.features.empty() ? 0 : feature_joint_count();
    expect_offsets("residual.fade.joint_begin", fade.joint_begin, joints, fade.joints.size());
    expect_below("residual.fade.joints", fade.joints, joints);
    expect_size("residual.fade.tolerance", fade.tolerance.size(), joints);
    expect_not_below_zero("residual.fade.tolerance", fade.tolerance);
    expect_size("residual.fade.direction_begin", fade.direction_begin.size(), joints + 1);
    expect_offsets("residual.fade.direction_begin", fade.direction_begin, joints, fade.direction_begin.back());
    std::size_t numbers = 0;
    for (std::size_t j = 0; j < joints; ++j) {
      const std::size_t rows = fade.direction_begin[j + 1] - fade.direction_begin[j];
      numbers += 9 * rows * (fade.joint_begin[j + 1] - fade.joint_begin[j]);
    }
    expect_size("residual.fade.directions", fade.directions.size(), numbers);
    expect_numbers("residual.fade.directions", fade.directions);
    expect_offsets("residual.fade.region_begin", fade.region_begin, basis_.residual.regions.size(),
                   fade.region_joints.size());
    expect_below("residual.fade.region_joints", fade.region_joints, joints);
    expect_size("residual.fade.region_weights", fade.region_weights.size(), fade.region_joints.size());
    expect_not_below_zero("residual.fade.region_weights", fade.region_weights);
  }

  void check_coverage() const {
    const CoverageTable& coverage = basis_.coverage;
    if (coverage.empty()) {
      const std::size_t others = coverage.names.size() + coverage.joints.size() + coverage.sizes.size() +
                                 coverage.growth.size() + coverage.usual.size() + coverage.local.size() +
                                 coverage.motion.size() + coverage.metric.size();
      if (others > 0) refuse("coverage.joint_begin has 0 entries, though other arrays of the coverage have some");
      return;
    }
    const std::size_t regions = basis_.residual.regions.size();
    expect_size("coverage_names", coverage.names.size(), regions);
    expect_offsets("coverage.joint_begin", coverage.joint_begin, regions, coverage.joints.size());
    expect_below("coverage.joints", coverage.joints, basis_.skeleton.size());
    std::size_t centres = 0;
    for (std::size_t r = 0; r < regions; ++r) {
      if (coverage.joint_begin[r] == coverage.joint_begin[r + 1]) {
        refuse("coverage, region ", r, ": no joint moves it, expected at least one");
      }
      centres += std::max(1u, basis_.residual.regions[r].centre_count);
    }
    expect_size("coverage.sizes", coverage.sizes.size(), regions);
    expect_size("coverage.growth", coverage.growth.size(), regions);
    expect_size("coverage.usual", coverage.usual.size(), regions);
    expect_size("coverage.local", coverage.local.size(), centres);
    if (!coverage.motion.empty()) expect_size("coverage.motion", coverage.motion.size(), centres);
    if (!coverage.metric.empty()) {
      expect_size("coverage.metric", coverage.metric.size(), basis_.residual.coordinate_count());
    }
    expect_not_below_zero("coverage.sizes", coverage.sizes);
    for (std::size_t r = 0; r < regions; ++r) {
      if (!(coverage.sizes[r] > 0)) refuse(element("coverage.sizes", r), " is 0, expected more");
    }
    expect_not_below_zero("coverage.growth", coverage.growth);
    expect_numbers("coverage.usual", coverage.usual);
    expect_not_below_zero("coverage.local", coverage.local);
    expect_not_below_zero("coverage.motion", coverage.motion);
    expect_not_below_zero("coverage.metric", coverage.metric);
  }

  void expect_not_below_zero(const char* name, const std::vector<float>& values) const {
    expect_numbers(name, values);
    for (std::size_t k = 0; k < values.size(); ++k) {
      if (values[k] < 0) refuse(element(name, k), " is ", values[k], ", expected 0 or more");
    }
  }

  std::size_t feature_joint_count() const {
    if (!basis_.skeleton.features.empty()) return basis_.skeleton.features.size();
    return static_cast<std::size_t>(
        std::ranges::count_if(basis_.skeleton.joints, [](const Joint& joint) { return joint.parent >= 0; }));
  }

  const Basis& basis_;
};

}  // namespace

void validate(const Basis& basis, const std::string& origin) { Validator(basis, origin).run(); }

}  // namespace bodyopt
