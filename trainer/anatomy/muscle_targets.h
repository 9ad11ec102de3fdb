// The volumes of muscles, as anatomists measured, and where along its path a muscle's belly lies.
#pragma once

#include <string>
#include <vector>

namespace bodyopt::trainer {

// A row of rigs/human/muscle_volumes.json.
struct WholeMuscle {
  std::string name;                // as anatomists call it
  std::vector<std::string> names;  // of it and its parts in models of muscles, by matching_name()
  double volume = 0;               // cubic metres, one side of an adult of 7.1 l of leg muscles
  double belly_from = 0, belly_to = 1;
  std::string limb;                   // of Division::limb_factors
  bool is_sheet = false;              // its parts lie side by side without a gap
  bool slips_share_a_region = false;  // its parts are told apart by their tendons alone
};

const std::vector<WholeMuscle>& whole_muscles();

// The letters and digits of a muscle's name, small, without its side: "TRIlong_l" is "trilong".
std::string matching_name(const std::string& name);

// The length of a table's name (of matching_name()) if it names a muscle, otherwise 0. It must be the muscle's name but
// for a number at the end or, with six letters and more, its beginning.
std::size_t match_length(const std::string& muscle, const std::string& table_name);

// The row whose `names` (of matching_name()) have the longest match; null: none names the muscle.
template <typename Row>
const Row* longest_match(const std::vector<Row>& rows, const std::string& muscle) {
  const Row* found = nullptr;
  std::size_t longest = 0;
  for (const Row& row : rows) {
    for (const std::string& name : row.names) {
      const std::size_t length = match_length(muscle, name);
      if (length <= longest) continue;
      longest = length;
      found = &row;
    }
  }
  return found;
}

const WholeMuscle* find_whole_muscle(const std::string& name);

}  // namespace bodyopt::trainer
