// The capsule limb as a basis of Direct Delta Mush, and meshes to ride on it.
#pragma once

#include <string>
#include <vector>

#include "tests/support/capsule_limb.h"
#include "trainer/attach/bind_mesh.h"

namespace bodyopt {

const Basis& limb_basis();

trainer::LooseMesh sphere_at(const std::string& name, const Vec3& centre, double radius);

// A tube around the limb across its elbow, `offset` off the skin; open at both ends, normals outwards.
trainer::LooseMesh sleeve(double offset);

// A blade of 0.3 m that stands off the limb near its end, four triangles.
trainer::LooseMesh blade();

Attachments attached_to_limb(const std::vector<trainer::LooseMesh>& meshes, const trainer::AttachOptions& options = {});

// Something of every kind: an eye inside, a button outside, a sleeve, a blade.
Attachments limb_outfit();

}  // namespace bodyopt
