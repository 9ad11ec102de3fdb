// A list made of another, element by element.
#pragma once

#include <functional>
#include <ranges>
#include <type_traits>
#include <vector>

namespace bodyopt {

// Applies `function`, which may be a member of the elements, to every element of `range`.
template <std::ranges::input_range Range, typename Function>
auto transformed(Range&& range, Function function) {
  std::vector<std::decay_t<std::invoke_result_t<Function&, std::ranges::range_reference_t<Range>>>> result;
  if constexpr (std::ranges::sized_range<Range>) result.reserve(std::ranges::size(range));
  for (auto&& element : range) result.push_back(std::invoke(function, element));
  return result;
}

}  // namespace bodyopt
