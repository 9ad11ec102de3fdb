#include "cli/arguments/field_arguments.h"

#include "cli/arguments/dataset_arguments.h"
#include "trainer/simulate/simulate.h"

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
  Dataset given;
  given.body_fat = body_fat;
  given.kind = kind;
  given.corrections = corrections;
  return anatomy_options(given, skeleton);
}

void FieldArguments::put_into(Dataset& dataset) const {
  dataset.body_fat = body_fat;
  dataset.kind = kind;
  dataset.corrections = relative_to(dataset.folder, corrections);
}

}  // namespace bodyopt::cli
