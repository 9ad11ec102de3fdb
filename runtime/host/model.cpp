#include "runtime/host/model.h"

#include <utility>

namespace bodyopt {

std::shared_ptr<const Model> make_model(Basis basis, std::optional<Dynamics> dynamics) {
  validate(basis, "the basis");
  if (dynamics) validate(*dynamics, basis, "the dynamics");
  return std::make_shared<const Model>(Model{std::move(basis), std::move(dynamics)});
}

}  // namespace bodyopt
