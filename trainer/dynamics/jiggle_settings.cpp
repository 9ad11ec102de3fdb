#include "trainer/dynamics/jiggle_settings.h"

#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>
#include <utility>

#include "base/json_file.h"
#include "runtime/core/error.h"

namespace bodyopt::trainer {
namespace {

constexpr const char* kSchema = "bodyopt-jiggle-1";
constexpr double kSoftest = 1e4, kMostDamping = 10, kMostAmount = 10, kThinnestFlesh = 1e-6, kMostFlesh = 1e3,
                 kMostFleshFactor = 1e3;
constexpr double kLeastPoisson = -0.99, kMostPoisson = 0.495;  // at -1 and 0.5 a material cannot be computed with
constexpr double kFastest = 1e3, kLeastLimit = 1e-3, kMostLimit = 1e3;
constexpr double kLightest = 1, kHeaviest = 1e5, kMostTension = 1e3;

double softness(const JsonObject& object) { return object.number("softness", 1 / kSoftest, kSoftest); }
double damping(const JsonObject& object) { return object.number("damping", 0, kMostDamping); }
double amount(const JsonObject& object) { return object.number("amount", 0, kMostAmount); }
double lowest_frequency(const JsonObject& object) { return object.number("lowest_frequency", 0, kFastest); }
double limit(const JsonObject& object) { return object.number("limit", kLeastLimit, kMostLimit); }
double flesh(const JsonObject& object) { return object.number("flesh", kThinnestFlesh, kMostFlesh); }

JiggleRegion read_region(const JsonObject& object) {
  object.allow({"joint", "muscle", "region", "softness", "damping", "amount", "flesh", "flesh_factor", "comment"});
  constexpr std::array kinds = {std::pair("joint", JiggleRegion::By::joint),
                                std::pair("muscle", JiggleRegion::By::muscle),
                                std::pair("region", JiggleRegion::By::painted)};
  JiggleRegion region;
  int named = 0;
  for (const auto& [key, by] : kinds) {
    if (!object.has(key)) continue;
    region.by = by;
    region.name = object.name(key);
    ++named;
  }
  if (named != 1) object.refuse("has ", named, " of 'joint', 'muscle' and 'region', expected one");
  if (object.has("softness")) region.softness = softness(object);
  if (object.has("damping")) region.damping = damping(object);
  if (object.has("amount")) region.amount = amount(object);
  if (object.has("flesh")) region.flesh = flesh(object);
  if (object.has("flesh_factor")) {
    if (region.flesh) object.refuse("has both 'flesh' (metres) and 'flesh_factor' (of the flesh there), expected one");
    region.flesh_factor = object.number("flesh_factor", 1 / kMostFleshFactor, kMostFleshFactor);
  }
  if (object.has("comment")) region.comment = object.text("comment");
  if (!region.softness && !region.damping && !region.amount && !region.flesh && !region.flesh_factor) {
    object.refuse("says nothing of softness, damping, amount, flesh or flesh_factor");
  }
  return region;
}

Json region_json(const JiggleRegion& region) {
  const char* const kinds[] = {"joint", "muscle", "region"};
  Json json = {{kinds[static_cast<std::size_t>(region.by)], region.name}};
  const auto add = [&](const char* name, const std::optional<double>& value) {
    if (value) json[name] = *value;
  };
  add("softness", region.softness);
  add("damping", region.damping);
  add("amount", region.amount);
  add("flesh", region.flesh);
  add("flesh_factor", region.flesh_factor);
  if (!region.comment.empty()) json["comment"] = region.comment;
  return json;
}

class Limits {
 public:
  explicit Limits(const JiggleSettings& settings) : settings_(settings) {}
  void above(const char* what, double value, double low) const {
    if (!(value > low && std::isfinite(value))) refuse(what, value, "above", low);
  }
  void below(const char* what, double value, double high) const {
    if (!(value < high && std::isfinite(value))) refuse(what, value, "below", high);
  }
  void at_least_0(const char* what, double value) const {
    if (!(value >= 0 && std::isfinite(value))) refuse(what, value, "of at least", 0);
  }

 private:
  [[noreturn]] void refuse(const char* what, double value, const char* relation, double limit) const {
    std::ostringstream message;
    message << settings_.origin << ": " << what << " is " << value << ", expected a number " << relation << " "
            << limit;
    throw Error(ErrorKind::usage, message.str());
  }
  const JiggleSettings& settings_;
};

}  // namespace

void require_possible(const JiggleSettings& settings) {
  const Limits limits(settings);
  limits.above("Poisson's ratio", settings.poisson, -1);
  limits.below("Poisson's ratio", settings.poisson, 0.5);
  limits.above("the density", settings.density, 0);
  limits.at_least_0("the tension", settings.tension);
  limits.above("the softness", settings.softness, 0);
  limits.at_least_0("the damping", settings.damping);
  limits.at_least_0("the amount", settings.amount);
  limits.at_least_0("the flesh", settings.flesh);
  limits.at_least_0("the lowest frequency", settings.lowest_frequency);
  limits.above("the limit", settings.limit, 0);
  for (const JiggleRegion& region : settings.regions) {
    limits.above("a region's softness", region.softness.value_or(1), 0);
    limits.at_least_0("a region's damping", region.damping.value_or(0));
    limits.at_least_0("a region's amount", region.amount.value_or(0));
    limits.above("a region's flesh", region.flesh.value_or(1), 0);
    limits.above("a region's factor of flesh", region.flesh_factor.value_or(1), 0);
  }
}

Json jiggle_json(const JiggleSettings& settings) {
  Json json = {{"schema", kSchema},           {"softness", settings.softness},
               {"damping", settings.damping}, {"amount", settings.amount},
               {"poisson", settings.poisson}, {"density", settings.density},
               {"tension", settings.tension}, {"lowest_frequency", settings.lowest_frequency},
               {"limit", settings.limit}};
  if (settings.flesh > 0) json["flesh"] = settings.flesh;
  if (!settings.comment.empty()) json["comment"] = settings.comment;
  json["regions"] = Json::array();
  for (const JiggleRegion& region : settings.regions) json["regions"].push_back(region_json(region));
  return json;
}

JiggleSettings read_jiggle(const std::filesystem::path& path) {
  return jiggle_settings(read_json(path, kSchema), path);
}

void require_replaceable_jiggle(const std::filesystem::path& path) {
  require_replaceable_json(path, "schema", kSchema, "settings of the jiggle");
}

JiggleSettings jiggle_settings(const Json& json, const std::filesystem::path& origin) {
  const JsonObject top(json, origin, "the top level");
  top.allow({"schema", "softness", "damping", "amount", "poisson", "density", "tension", "flesh", "lowest_frequency",
             "limit", "regions", "comment"});
  JiggleSettings settings;
  settings.origin = origin.string();
  if (top.has("softness")) settings.softness = softness(top);
  if (top.has("damping")) settings.damping = damping(top);
  if (top.has("amount")) settings.amount = amount(top);
  if (top.has("poisson")) settings.poisson = top.number("poisson", kLeastPoisson, kMostPoisson);
  if (top.has("density")) settings.density = top.number("density", kLightest, kHeaviest);
  if (top.has("tension")) settings.tension = top.number("tension", 0, kMostTension);
  if (top.has("flesh")) settings.flesh = flesh(top);
  if (top.has("comment")) settings.comment = top.text("comment");
  if (top.has("lowest_frequency")) settings.lowest_frequency = lowest_frequency(top);
  if (top.has("limit")) settings.limit = limit(top);
  if (!top.has("regions")) return settings;
  for (const JsonObject& region : top.objects("regions")) settings.regions.push_back(read_region(region));
  return settings;
}

}  // namespace bodyopt::trainer
