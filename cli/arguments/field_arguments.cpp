#include "cli/arguments/field_arguments.h"

#include "cli/arguments/options.h"

namespace bodyopt::cli {
namespace {

std::string refuse_as_kind(const std::string& name) {
  return body_kind_of(name) ? "" : "expected one of " + body_kind_names() + ", found '" + name + "'";
}

}  // namespace

void FieldArguments::add(CLI::App& verb) {
  add_option(verb, "--body-fat", body_fat, "Fat, as a share of the body's mass, 0.02 to 0.6 (default: 0.15)")
      ->check(number_from(0.02, 0.6));
  add_option(verb, "--kind", kind, "KIND", "Kind of body: " + body_kind_names() + " (default: recognised)")
      ->check(refuse_as_kind);
  add_option(verb, "--corrections", corrections, "FILE",
             "What an artist corrects of bones, fat and muscles (anatomy.json); --kind and --body-fat go before it");
}

AnatomyOptions FieldArguments::options(const Skeleton& skeleton) const {
  AnatomyOptions options;
  if (!corrections.empty()) {
    options.corrections = read_corrections(corrections, skeleton);
    options.body_fat = options.corrections.body_fat.value_or(options.body_fat);
    options.kind = options.corrections.kind;
  }
  if (body_fat > 0) options.body_fat = body_fat;
  if (!kind.empty()) options.kind = body_kind_of(kind);
  return options;
}

}  // namespace bodyopt::cli
