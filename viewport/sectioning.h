// The lead cut open by a plane that shows what lies inside: the field of its tissues, found once in the background.
#pragma once

#include <array>
#include <future>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "trainer/anatomy/section.h"
#include "viewport/commands/controls.h"
#include "viewport/panels/snapshot.h"
#include "viewport/scene/scene.h"

namespace bodyopt::viewport {

struct Anatomy;  // a character, its muscles and its field

class Sectioning {
 public:
  // All must outlive it; its end waits for what is being worked out.
  Sectioning(std::shared_ptr<const vulkan::Device> device, Scene& scene, Controls& controls)
      : device_(std::move(device)), scene_(scene), controls_(controls) {}

  // Finds what lies inside the lead, where the settings ask for it: that takes seconds, once for each character. Then
  // gives the scene the cut skin and its section, again only where pose, correction, plane or `coarse` are others.
  // Headless it waits. `coarse`: in fewer pixels, while something moves. Throws Error(usage) where the lead's weights
  // are not at hand, and as AnatomyField and read_muscles(), and then turns the section off.
  void look(bool coarse);
  // Whether what lies inside became known since the last look.
  bool has_news() const;
  void forget();  // the cast's files have changed

  // mouse: pixels of the picture; none: it is not over it.
  void describe(const draw::Rectangle& area, const std::optional<std::array<double, 2>>& mouse,
                Snapshot& snapshot) const;

 private:
  using Found = std::shared_future<std::shared_ptr<const Anatomy>>;

  // The input of the section that is shown.
  struct Shown {
    std::shared_ptr<const Anatomy> anatomy;
    std::vector<Pose> pose;  // one
    double correction;
    shots::SectionAxis axis;
    double at;
    bool from_above;  // what is before the plane along the axis is taken away
    bool coarse;
    bool operator==(const Shown& other) const;
  };

  Found& find();
  std::shared_ptr<const Anatomy> found();
  Shown wanted(std::shared_ptr<const Anatomy> anatomy, bool coarse) const;
  void cut();
  std::string name_of(const trainer::TissueAt& tissue) const;
  std::string tissue_under(const draw::Rectangle& area, const std::array<double, 2>& mouse) const;

  std::shared_ptr<const vulkan::Device> device_;
  Scene& scene_;
  Controls& controls_;
  std::map<std::string, Found> fields_;  // by the files that they are of
  bool waits_ = false;                   // for that of the lead
  std::optional<Shown> shown_;
  trainer::SectionPlane plane_;
  trainer::TissueSection section_;
};

}  // namespace bodyopt::viewport
