// Sections through the body of a dataset, for a report.
#pragma once

#include <optional>

#include "report/report.h"
#include "trainer/anatomy/field.h"
#include "trainer/train/data/samples.h"

namespace bodyopt::cli {

// At rest, and in the frame of which most is flexed by controls or, where nothing is, in which a muscle is shortest
// beside its length at rest. None where there are no muscles or no frames; and, with a line on standard error, where
// nothing can be told of the inside.
std::optional<SectionsReport> section_pictures(const SampleSet& set, const AnatomyOptions& options);

}  // namespace bodyopt::cli
