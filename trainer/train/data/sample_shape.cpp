#include "trainer/train/data/sample_shape.h"

#include "assets/character.h"
#include "assets/shape_reader.h"
#include "trainer/curate/shape_stack.h"

namespace bodyopt {

SampleShape SampleShape::at(std::shared_ptr<const VertexRows> rows) const {
  SampleShape result = *this;
  result.rows_ = std::move(rows);
  return result;
}

Positions SampleShape::read() const {
  if (!rows_) return whole();
  const Positions all = whole();
  Positions some(static_cast<Eigen::Index>(rows_->size()), 3);
  for (std::size_t k = 0; k < rows_->size(); ++k) some.row(static_cast<Eigen::Index>(k)) = all.row((*rows_)[k]);
  return some;
}

Positions SampleShape::whole() const {
  if (stack_) return stack_->shape(frame_);
  if (cache_) return welded_from_output(*cache_->character, cache_->reader->sample(sample_).data());
  return positions_ ? *positions_ : Positions();
}

}  // namespace bodyopt
