// What verbs that look inside a body are told of it.
#pragma once

#include "cli/arguments/common.h"
#include "dataset/dataset.h"
#include "trainer/anatomy/field.h"

namespace bodyopt::cli {

// [--body-fat X] [--kind K] [--corrections FILE]
struct FieldArguments {
  double body_fat = 0;  // 0: not given
  std::string kind, corrections;
  void add(CLI::App& verb);
  // Throws as read_corrections().
  AnatomyOptions options(const Skeleton& skeleton) const;
  // As the dataset keeps them.
  void put_into(Dataset& dataset) const;
};

}  // namespace bodyopt::cli
