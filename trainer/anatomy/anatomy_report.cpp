#include "trainer/anatomy/anatomy_report.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "assets/clips/joint_roles.h"
#include "base/parallel.h"
#include "base/wording.h"
#include "geometry/mesh.h"
#include "geometry/self_intersections.h"
#include "runtime/core/text.h"
#include "trainer/anatomy/muscle_paths.h"

namespace bodyopt::trainer {
namespace {

constexpr auto kRegions = std::size_t{kBodyRegions};
constexpr std::size_t kKinds = static_cast<std::size_t>(TissueKind::other_lean) + 1;
constexpr double kSmallestTrusted = 0.6, kLargestTrusted = 1.5;  // of a limb
constexpr double kOffBone = 2e-3;                                // metres
constexpr double kLeastShare = 0.2;                              // of a muscle's target
constexpr double kLeastLean = 0.4;                               // of a limb's part: half and more is usual
constexpr double kLeastTissue = 0.01;                            // of a part: less differs by how samples fall
constexpr double kOffMirrorImage = 0.01;                         // of the body's extent

// Cubic metres on one side of a body.
struct SideVolumes {
  std::array<std::array<double, kKinds>, kRegions> parts{};
  std::vector<double> muscles;
};

using Sides = std::array<SideVolumes, 2>;

double total(const std::array<double, kKinds>& tissues) { return std::accumulate(tissues.begin(), tissues.end(), 0.0); }

// Adds the field's tissues at the samples of a half, or at their mirror images.
void add_half(const AnatomyField& field, const AnatomyField::Half& half, bool mirrored, SideVolumes& side) {
  const Eigen::Vector3d turn(mirrored ? -1 : 1, 1, 1);
  const Eigen::Affine3d to_rest = half.body.from_rest.inverse() * Eigen::Scaling(turn);
  std::vector<TissueAt> found(static_cast<std::size_t>(half.grid.size()));
  parallel_for(found.size(), [&](std::size_t s) {
    found[s] = field.tissue_at(to_rest * half.grid.points.row(static_cast<Eigen::Index>(s)).transpose());
  });
  for (std::size_t s = 0; s < found.size(); ++s) {
    const auto kind = static_cast<std::size_t>(found[s].kind);
    side.parts[static_cast<std::size_t>(half.tissue.region[s])][kind] += half.grid.volume();
    if (found[s].kind == TissueKind::muscle) {
      side.muscles[static_cast<std::size_t>(found[s].muscle)] += half.grid.volume();
    }
  }
  std::array<double, kKinds>& head = side.parts[static_cast<std::size_t>(BodyRegion::head)];
  const double brain = std::min(half.tissue.brain, head[static_cast<std::size_t>(TissueKind::bone)]);
  head[static_cast<std::size_t>(TissueKind::bone)] -= brain;
  head[static_cast<std::size_t>(TissueKind::other_lean)] += brain;
}

Sides volumes_of_sides(const AnatomyField& field, std::size_t muscles) {
  Sides sides;
  for (SideVolumes& side : sides) side.muscles.resize(muscles);
  for (std::size_t h = 0; h < field.halves().size(); ++h) add_half(field, field.halves()[h], false, sides[h]);
  if (field.is_own_mirror()) add_half(field, field.halves().front(), true, sides[1]);
  return sides;
}

double largest_difference(const Sides& sides, const std::vector<Muscle>& muscles) {
  double largest = 0;
  const auto compare = [&](double a, double b) {
    if (a + b > 0) largest = std::max(largest, 2 * std::abs(a - b) / (a + b));
  };
  for (std::size_t r = 0; r < kRegions; ++r) {
    const auto &left = sides[0].parts[r], &right = sides[1].parts[r];
    const double both = total(left) + total(right);
    compare(total(left), total(right));
    for (const TissueKind kind : {TissueKind::bone, TissueKind::fat, TissueKind::muscle}) {
      const auto k = static_cast<std::size_t>(kind);
      if (left[k] + right[k] > kLeastTissue * both) compare(left[k], right[k]);
    }
  }
  const std::vector<int> others = mirrored_places(names_of(muscles));
  for (std::size_t m = 0; m < others.size(); ++m) {
    if (others[m] < 0) continue;
    const auto o = static_cast<std::size_t>(others[m]);
    compare(sides[0].muscles[m] + sides[1].muscles[m], sides[0].muscles[o] + sides[1].muscles[o]);
  }
  return largest;
}

AnatomyReport::OfPart part_of(const char* name, const std::array<double, kKinds>& tissues) {
  const double volume = total(tissues);
  const auto share = [&](TissueKind kind) { return tissues[static_cast<std::size_t>(kind)] / volume; };
  AnatomyReport::OfPart part{name,
                             volume,
                             share(TissueKind::bone),
                             share(TissueKind::fat),
                             share(TissueKind::cavity),
                             share(TissueKind::muscle),
                             0};
  // Rounding leaves some samples at the skin itself outside: they count here, too.
  part.other_lean = share(TissueKind::other_lean) + share(TissueKind::tendon) + share(TissueKind::outside);
  return part;
}

std::vector<AnatomyReport::OfPart> parts_of(const Sides& sides) {
  std::vector<AnatomyReport::OfPart> parts;
  std::array<double, kKinds> body{};
  for (std::size_t r = 0; r < kRegions; ++r) {
    std::array<double, kKinds> both{};
    for (std::size_t k = 0; k < kKinds; ++k) {
      both[k] = sides[0].parts[r][k] + sides[1].parts[r][k];
      body[k] += both[k];
    }
    if (total(both) > 0) parts.push_back(part_of(name_of(static_cast<BodyRegion>(r)), both));
  }
  parts.push_back(part_of("body", body));
  return parts;
}

// Copies what the division found for a region to one of the muscles that share it. `other`: set for the mirror image of
// a half that stands for both; it maps joints to those of the other side.
void tell_muscle(const Division::OfMuscle& region, const Character& character, const AnatomyField::Half* other,
                 AnatomyReport::OfMuscle& muscle) {
  muscle.target = region.target / static_cast<double>(std::max<std::size_t>(1, region.slips.size()));
  muscle.pieces = region.pieces;
  for (std::size_t end = 0; end < 2; ++end) {
    muscle.ends_off_bone[end] = region.ends_off_bone[end];
    int joint = region.end_joint[end];
    if (joint >= 0 && other) joint = other->joint[static_cast<std::size_t>(joint)];
    muscle.bones[end] = joint < 0 ? "" : character.skeleton.joints[static_cast<std::size_t>(joint)].name;
  }
}

// Muscles that share a region have equal parts of it.
std::vector<AnatomyReport::OfMuscle> muscles_of(const Character& character, const std::vector<Muscle>& muscles,
                                                const AnatomyField& field, const Sides& sides) {
  std::vector<AnatomyReport::OfMuscle> told(muscles.size());
  for (std::size_t m = 0; m < muscles.size(); ++m) told[m].name = muscles[m].name;
  const auto tell = [&](const Division::OfMuscle& region, const AnatomyField::Half* other) {
    const auto number = [&](int muscle) {
      return static_cast<std::size_t>(other ? other->muscle[static_cast<std::size_t>(muscle)] : muscle);
    };
    const std::vector<int> slips = region.slips.empty() ? std::vector<int>{region.muscle} : region.slips;
    const std::size_t m = number(region.muscle);
    const double volume = (sides[0].muscles[m] + sides[1].muscles[m]) / static_cast<double>(slips.size());
    for (const int slip : slips) {
      told[number(slip)].volume = volume;
      tell_muscle(region, character, other, told[number(slip)]);
    }
  };
  for (const AnatomyField::Half& half : field.halves()) {
    for (const Division::OfMuscle& region : half.division.muscles) {
      tell(region, nullptr);
      if (field.is_own_mirror()) tell(region, &half);
    }
  }
  return told;
}

// Two halves of their own have factors of their own: "left arm".
std::map<std::string, double> limb_factors_of(const AnatomyField& field) {
  if (field.halves().size() == 1) return field.halves().front().division.limb_factors;
  std::map<std::string, double> factors;
  for (std::size_t h = 0; h < field.halves().size(); ++h) {
    for (const auto& [limb, factor] : field.halves()[h].division.limb_factors) {
      factors[(h == 0 ? "left " : "right ") + limb] = factor;
    }
  }
  return factors;
}

// "recfem_l (origin, 4.1 mm)"
std::vector<std::string> ends_off_bone(const AnatomyReport& report) {
  std::vector<std::string> ends;
  for (const AnatomyReport::OfMuscle& muscle : report.muscles) {
    for (std::size_t end = 0; end < 2; ++end) {
      if (muscle.ends_off_bone[end] <= kOffBone) continue;
      ends.push_back(muscle.name + (end == 0 ? " (origin, " : " (insertion, ") +
                     formatted("%.1f mm)", 1e3 * muscle.ends_off_bone[end]));
    }
  }
  return ends;
}

// A skin that is its own mirror image gets the mean of left and right, which hides that they lie elsewhere.
std::string averaged_apart(const std::vector<Muscle>& muscles, const AnatomyField& field) {
  if (!field.is_own_mirror()) return "";
  const HalfBody& body = field.halves().front().body;
  const std::vector<double> off = off_mirror_images(body, muscles);
  const double most = kOffMirrorImage * longest_extent(body.vertices);
  std::vector<std::string> apart;
  for (std::size_t m = 0; m < muscles.size(); ++m) {
    if (off[m] > most) apart.push_back(muscles[m].name + formatted(" (%.0f mm)", 1e3 * off[m]));
  }
  if (apart.empty()) return "";
  return count_of(apart.size(), "muscle does", "muscles do") +
         " not lie where the mirror image of the other side's would; the mean of both is taken: " + list_names(apart);
}

std::string parts_without_lean(const AnatomyReport& report) {
  std::vector<std::string> parts;
  for (const BodyRegion region : {BodyRegion::thigh, BodyRegion::calf, BodyRegion::upper_arm, BodyRegion::forearm}) {
    for (const AnatomyReport::OfPart& part : report.parts) {
      const double lean = part.muscle + part.other_lean;
      if (part.name == name_of(region) && lean < kLeastLean)
        parts.push_back(part.name + formatted(" (%.0f %%)", 100 * lean));
    }
  }
  if (parts.empty()) return "";
  return "bone and fat leave little room for muscles, half of a limb or more as a rule: " + list_names(parts) +
         ": the body fat asked for may not suit this skin";
}

std::vector<std::string> warnings_of(const AnatomyReport& report, const std::vector<Muscle>& muscles,
                                     const AnatomyField& field) {
  std::vector<std::string> warnings;
  for (const std::string& warning : {averaged_apart(muscles, field), parts_without_lean(report)}) {
    if (!warning.empty()) warnings.push_back(warning);
  }
  for (const AnatomyField::Half& half : field.halves()) {
    for (const std::vector<std::string>* notes : {&half.grid.notes, &half.tissue.notes}) {
      for (const std::string& note : *notes) {
        if (std::ranges::find(warnings, note) == warnings.end()) warnings.push_back(note);
      }
    }
  }
  for (const auto& [limb, factor] : report.limb_factors) {
    if (factor >= kSmallestTrusted && factor <= kLargestTrusted) continue;
    warnings.push_back(limb + ": its muscles fill its lean tissue at " + formatted("%.2f", factor) +
                       " times the volumes that anatomists measured (0.6 to 1.5 is usual): the body fat asked for, or "
                       "muscles that are missing, may not suit this skin");
  }
  if (const std::vector<std::string> ends = ends_off_bone(report); !ends.empty()) {
    warnings.push_back(count_of(ends.size(), "end of a muscle is", "ends of muscles are") +
                       " more than 2 mm off the bone: " + list_names(ends, ends.size()));
  }
  std::vector<std::string> small;
  for (const AnatomyReport::OfMuscle& muscle : report.muscles) {
    if (muscle.target > 0 && muscle.volume < kLeastShare * muscle.target) {
      small.push_back(muscle.name + formatted(" (%.0f %%)", 100 * muscle.volume / muscle.target));
    }
  }
  if (!small.empty()) {
    warnings.push_back(
        count_of(small.size(), "muscle has", "muscles have") +
        " less than 20 % of the volume wanted: paths may lie outside the skin: " + list_names(small, small.size()));
  }
  return warnings;
}

constexpr Rgb kOtherLeanColour{222, 150, 138}, kShortenedColour{250, 148, 40}, kStretchedColour{98, 88, 196};
// They are in the order of TissueKind; muscles have colours of their own.
constexpr Rgb kColours[] = {kOtherLeanColour, {236, 228, 204}, {232, 196, 92},  {112, 128, 148},
                            kOtherLeanColour, {250, 250, 246}, kOtherLeanColour};

bool same_tissue(const TissueAt& a, const TissueAt& b) { return a.kind == b.kind && a.muscle == b.muscle; }

// Spread evenly in two directions at once, whatever their number (Roberts 2018, the sequence R2).
Rgb muscle_colour(std::size_t number) {
  const auto share = [&](double step) { return std::fmod(0.5 + step * static_cast<double>(number), 1.0); };
  const double warmth = share(0.7548776662), light = share(0.5698402910);
  const double value = 105 + 95 * light;
  return {static_cast<std::uint8_t>(value), static_cast<std::uint8_t>(value * (0.18 + 0.34 * warmth)),
          static_cast<std::uint8_t>(value * (0.22 + 0.10 * (1 - warmth)))};
}

Rgb tinted(const Rgb& colour, double stretch) {
  constexpr double kFullStretch = 1.0 / 3;
  const double share = std::clamp((stretch - 1) / kFullStretch, -1.0, 1.0);
  const Rgb& end = share < 0 ? kShortenedColour : kStretchedColour;
  Rgb result;
  for (std::size_t i = 0; i < 3; ++i) {
    result[i] = static_cast<std::uint8_t>(
        std::lerp(static_cast<double>(colour[i]), static_cast<double>(end[i]), std::abs(share)));
  }
  return result;
}

}  // namespace

AnatomyReport report_anatomy(const Character& character, const std::vector<Muscle>& muscles,
                             const AnatomyField& field) {
  const Sides sides = volumes_of_sides(field, muscles.size());
  AnatomyReport report;
  report.parts = parts_of(sides);
  report.muscles = muscles_of(character, muscles, field, sides);
  report.limb_factors = limb_factors_of(field);
  if (field.halves().front().body.has_plane) report.mirror_difference = largest_difference(sides, muscles);
  report.warnings = warnings_of(report, muscles, field);
  return report;
}

std::string skin_crossing(const Character& character) {
  const std::vector<TrianglePair> pairs = self_intersections(character.vertices, character.triangles);
  if (pairs.empty()) return "";
  std::map<std::uint32_t, std::vector<std::uint32_t>> by_joint;
  for (const std::uint32_t vertex : corners_of(pairs, character.triangles)) {
    by_joint[character.weights[vertex].front().joint].push_back(vertex);
  }
  const auto& [joint, vertices] = *std::ranges::max_element(
      by_joint, [](const auto& a, const auto& b) { return a.second.size() < b.second.size(); });
  std::string place;
  for (const double x : character.vertices.row(vertices.front())) place += formatted(" %.3g", x);
  return "the skin passes through itself at " + count_of(pairs.size(), "pair", "pairs") + " of triangles, most at '" +
         character.skeleton.joints[joint].name + "', first at" + place +
         " m: what is in both parts there counts as one's";
}

TissueColours::TissueColours(const std::vector<Muscle>& muscles) {
  const std::vector<std::string> names = names_of(muscles);
  std::vector<std::string> distinct;
  for (const std::string& name : names) {
    const std::string other = mirrored_name(name, names);
    const auto known = std::ranges::find_if(
        distinct, [&](const std::string& d) { return d == name || (!other.empty() && d == other); });
    muscles_.push_back(muscle_colour(static_cast<std::size_t>(known - distinct.begin())));
    if (known == distinct.end()) distinct.push_back(name);
  }
}

Rgb TissueColours::of(const TissueAt& tissue) const {
  return tissue.kind == TissueKind::muscle ? muscles_[static_cast<std::size_t>(tissue.muscle)]
                                           : kColours[static_cast<std::size_t>(tissue.kind)];
}

std::vector<std::uint8_t> TissueColours::picture(const TissueSection& section, std::span<const double> stretch) const {
  constexpr double kBorder = 0.45;  // of the light that is left there
  std::vector<std::uint8_t> rgba(4 * section.tissue.size());
  const auto width = static_cast<std::size_t>(section.width);
  for (std::size_t pixel = 0; pixel < section.tissue.size(); ++pixel) {
    const TissueAt& tissue = section.tissue[pixel];
    if (tissue.kind == TissueKind::outside) continue;
    const bool last = pixel % width + 1 == width, lowest = pixel + width >= section.tissue.size();
    const bool border = (!last && !same_tissue(tissue, section.tissue[pixel + 1])) ||
                        (!lowest && !same_tissue(tissue, section.tissue[pixel + width]));
    const bool strained = !stretch.empty() && tissue.kind == TissueKind::muscle;
    const Rgb colour = strained ? tinted(of(tissue), stretch[pixel]) : of(tissue);
    for (std::size_t i = 0; i < 3; ++i) {
      rgba[4 * pixel + i] = static_cast<std::uint8_t>(border ? kBorder * colour[i] : colour[i]);
    }
    rgba[4 * pixel + 3] = 255;
  }
  return rgba;
}

}  // namespace bodyopt::trainer
