// The inside of a body as a field: what tissue lies at any point, whatever tets it is later simulated in.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "trainer/anatomy/body_kind.h"
#include "trainer/anatomy/division.h"

namespace bodyopt::trainer {

struct AnatomyOptions {
  double body_fat = 0.15;            // of the body's mass, 0.02 to 0.6
  std::optional<BodyKind> kind{};    // none: recognised
  double cell = 0;                   // metres; 0: default_cell()
  AnatomyCorrections corrections{};  // of bones, fat and muscles; its kind and body fat are the caller's to take
};

struct TissueAt {
  TissueKind kind = TissueKind::outside;
  int joint = -1;   // of a bone
  int muscle = -1;  // of muscle and tendon
};

class AnatomyField {
 public:
  AnatomyField() = default;  // of nothing: all is outside
  // Throws Error(usage) for options out of range, Error(mismatch) where the skin encloses nothing (flat) or the muscles
  // do not fit the skeleton.
  AnatomyField(const Character& character, const std::vector<Muscle>& muscles, const AnatomyOptions& options = {});

  // Any point of rest space. Of a skin that is its own mirror image, left and right are the same to the last bit.
  TissueAt tissue_at(const Eigen::Vector3d& point) const;
  // Unit, rest space, from origin to insertion, of the muscle at a point; zero where there is none.
  Eigen::Vector3d fibre_at(const Eigen::Vector3d& point) const;

  // All muscles of the list that share the region that tissue_at() reports as this one's, itself among them.
  std::vector<int> slips_of(int muscle) const;

  // Metres along its path at rest, by the list of muscles; 0 for muscles without a region.
  const std::vector<double>& belly_lengths() const { return belly_lengths_; }

  BodyKind kind() const { return kind_; }
  const std::string& why_kind() const { return why_kind_; }
  bool is_own_mirror() const { return halves_.size() == 1 && halves_.front().body.has_plane; }
  std::uint64_t hash() const;  // of all that tissue_at() and belly_lengths() return

  struct Half {
    HalfBody body;
    BodyGrid grid;
    InnerTissue tissue;
    Division division;
    std::vector<int> joint, muscle;  // in the character and in its list, for the other half of a body that is its own
                                     // mirror image: what the numbers of this half are there
  };
  const std::vector<Half>& halves() const { return halves_; }

 private:
  struct Place {
    const Half* half;
    Eigen::Vector3d point;  // in the half's space
    bool is_other_side;     // of a body that is its own mirror image
  };
  Place place_of(const Eigen::Vector3d& point) const;

  std::vector<Half> halves_;
  std::vector<double> belly_lengths_;
  BodyKind kind_ = BodyKind::biped;
  std::string why_kind_;
};

}  // namespace bodyopt::trainer
