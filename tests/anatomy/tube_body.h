// Bodies put together of tubes about chains of joints, whose kinds have no character of their own among the shared
// data.
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "assets/characters/character.h"

namespace bodyopt {

class TubeBody {
 public:
  struct Ring {
    Eigen::Vector3d place;
    double wide, high;  // metres, half: along x where the tube does not run along it, otherwise along z; across that
    int joint;
  };

  int joint(const std::string& name, int parent, const Eigen::Vector3d& place) {
    const Eigen::Vector3d above = parent < 0 ? Eigen::Vector3d::Zero() : places_[static_cast<std::size_t>(parent)];
    Joint joint;
    joint.name = name;
    joint.parent = parent;
    for (std::size_t k = 0; k < 3; ++k) {
      joint.bind.translation[k] = place[static_cast<Eigen::Index>(k)] - above[static_cast<Eigen::Index>(k)];
      joint.inverse_bind.m[k][3] = -place[static_cast<Eigen::Index>(k)];
    }
    joint.default_local = joint.bind;
    body_.skeleton.joints.push_back(joint);
    places_.push_back(place);
    return static_cast<int>(places_.size()) - 1;
  }

  // Closed, with a point at either end, finer along than its rings.
  void tube(const std::vector<Ring>& rings) {
    const auto first = static_cast<std::uint32_t>(vertices_.size());
    std::uint32_t count = 0;
    for (std::size_t k = 0; k + 1 < rings.size(); ++k) {
      for (int part = 0; part < kParts + (k + 2 == rings.size() ? 1 : 0); ++part, ++count) {
        const double u = static_cast<double>(part) / kParts;
        const Ring &a = rings[k], &b = rings[k + 1];
        add_ring({a.place + u * (b.place - a.place), std::lerp(a.wide, b.wide, u), std::lerp(a.high, b.high, u),
                  u < 0.5 ? a.joint : b.joint},
                 (b.place - a.place).normalized());
      }
    }
    for (std::uint32_t k = 0; k + 1 < count; ++k) {
      for (std::uint32_t side = 0; side < kSides; ++side) {
        const std::uint32_t next = (side + 1) % kSides, a = first + k * kSides, b = a + kSides;
        triangles_.push_back({a + side, a + next, b + next});
        triangles_.push_back({a + side, b + next, b + side});
      }
    }
    close(first, rings.front(), true);
    close(first + (count - 1) * kSides, rings.back(), false);
  }

  // The same rings, and their mirror image on joints that follow one after another: of each ring the joint, and that
  // plus `apart`.
  void pair(std::vector<Ring> rings, int apart) {
    tube(rings);
    for (Ring& ring : rings) {
      ring.place.x() *= -1;
      ring.joint += apart;
    }
    tube(rings);
  }

  Character character() const {
    Character result = body_;
    result.vertices.resize(static_cast<Eigen::Index>(vertices_.size()), 3);
    result.triangles.resize(static_cast<Eigen::Index>(triangles_.size()), 3);
    for (std::size_t v = 0; v < vertices_.size(); ++v)
      result.vertices.row(static_cast<Eigen::Index>(v)) = vertices_[v].transpose();
    for (std::size_t t = 0; t < triangles_.size(); ++t) {
      for (int k = 0; k < 3; ++k)
        result.triangles(static_cast<Eigen::Index>(t), k) = triangles_[t][static_cast<std::size_t>(k)];
    }
    for (std::uint32_t v = 0; v < vertices_.size(); ++v) result.output_vertex.push_back(v);
    result.output_triangles = result.triangles;
    return result;
  }

 private:
  static constexpr std::uint32_t kSides = 12;
  static constexpr int kParts = 4;

  void add_ring(const Ring& ring, const Eigen::Vector3d& along) {
    const Eigen::Vector3d side = std::abs(along.x()) > 0.7 ? Eigen::Vector3d::UnitZ() : Eigen::Vector3d::UnitX();
    const Eigen::Vector3d up = along.cross(side).normalized(), wide = up.cross(along);
    for (std::uint32_t k = 0; k < kSides; ++k) {
      const double angle = 2 * std::numbers::pi * k / kSides;
      add_vertex(ring.place + ring.wide * std::cos(angle) * wide + ring.high * std::sin(angle) * up, ring.joint);
    }
  }

  void add_vertex(const Eigen::Vector3d& place, int joint) {
    vertices_.push_back(place);
    body_.weights.push_back({{static_cast<std::uint32_t>(joint), 1.0}});
  }

  void close(std::uint32_t ring, const Ring& end, bool is_first) {
    add_vertex(end.place, end.joint);
    const auto tip = static_cast<std::uint32_t>(vertices_.size() - 1);
    for (std::uint32_t side = 0; side < kSides; ++side) {
      const std::uint32_t a = ring + side, b = ring + (side + 1) % kSides;
      triangles_.push_back(is_first ? std::array{tip, b, a} : std::array{tip, a, b});
    }
  }

  Character body_;
  std::vector<Eigen::Vector3d> places_, vertices_;
  std::vector<std::array<std::uint32_t, 3>> triangles_;
};

// Twelve joints along a straight body of 2.4 m.
inline Character snake_body() {
  TubeBody body;
  std::vector<TubeBody::Ring> rings;
  int above = -1;
  for (int k = 0; k < 12; ++k) {
    const Eigen::Vector3d place(0, 0.06, 1.1 - 0.2 * k);
    above = body.joint("b" + std::to_string(k), above, place);
    const double radius = 0.06 - 0.0035 * k;
    rings.push_back({place, radius, radius, above});
  }
  rings.push_back({{0, 0.06, -1.2}, 0.01, 0.01, above});
  body.tube(rings);
  return body.character();
}

// Higher than wide, with a pair of fins and no word about them.
inline Character fish_body() {
  TubeBody body;
  std::vector<TubeBody::Ring> rings;
  const double high[] = {0.05, 0.10, 0.12, 0.08, 0.03, 0.09}, wide[] = {0.03, 0.055, 0.06, 0.035, 0.012, 0.006};
  int above = -1, chest = -1;
  for (int k = 0; k < 6; ++k) {
    const Eigen::Vector3d place(0, 0.3, 0.4 - 0.16 * k);
    above = body.joint("b" + std::to_string(k), above, place);
    if (k == 1) chest = above;
    rings.push_back({place, wide[k], high[k], above});
  }
  body.tube(rings);
  const int fin = body.joint("c0", chest, {0.05, 0.28, 0.22});
  body.joint("c1", chest, {-0.05, 0.28, 0.22});
  body.pair({{{0.05, 0.28, 0.22}, 0.03, 0.004, fin}, {{0.13, 0.25, 0.16}, 0.02, 0.003, fin}}, 1);
  return body.character();
}

// A round body and eight legs that rise and fall.
inline Character spider_body() {
  TubeBody body;
  const int trunk = body.joint("b0", -1, {0, 0.3, 0.1}), belly = body.joint("b1", trunk, {0, 0.3, -0.2});
  body.tube({{{0, 0.3, 0.25}, 0.05, 0.05, trunk},
             {{0, 0.3, 0.1}, 0.14, 0.1, trunk},
             {{0, 0.3, -0.2}, 0.16, 0.14, belly},
             {{0, 0.3, -0.45}, 0.04, 0.04, belly}});
  for (int k = 0; k < 4; ++k) {
    const double at = 0.2 - 0.13 * k, out = 0.35 - 0.2 * k;
    int joint[6];
    for (const int side : {0, 1}) {
      const double x = side == 0 ? 1 : -1;
      const std::string name = "l" + std::to_string(k) + std::to_string(side);
      joint[3 * side] = body.joint(name + "0", trunk, {0.1 * x, 0.3, at});
      joint[3 * side + 1] = body.joint(name + "1", joint[3 * side], {0.35 * x, 0.45, at + 0.3 * out});
      joint[3 * side + 2] = body.joint(name + "2", joint[3 * side + 1], {0.55 * x, 0.2, at + 0.6 * out});
    }
    body.pair({{{0.1, 0.3, at}, 0.03, 0.03, joint[0]},
               {{0.35, 0.45, at + 0.3 * out}, 0.025, 0.025, joint[1]},
               {{0.55, 0.2, at + 0.6 * out}, 0.02, 0.02, joint[2]},
               {{0.6, 0, at + 0.7 * out}, 0.012, 0.012, joint[2]}},
              3);
  }
  return body.character();
}

// Two legs, a tail, and wings spread; or four legs and no wings.
inline Character winged_or_four_legged(bool has_wings) {
  TubeBody body;
  const int trunk = body.joint("b0", -1, {0, 0.5, 0}), chest = body.joint("b1", trunk, {0, 0.52, 0.2});
  const int neck = body.joint("b2", chest, {0, 0.62, 0.34}), head = body.joint("b3", neck, {0, 0.72, 0.42});
  const int tail = body.joint("b4", trunk, {0, 0.5, -0.22});
  body.tube({{{0, 0.5, -0.45}, 0.02, 0.02, tail},
             {{0, 0.5, -0.22}, 0.06, 0.06, tail},
             {{0, 0.5, 0}, 0.12, 0.13, trunk},
             {{0, 0.52, 0.2}, 0.12, 0.13, chest},
             {{0, 0.62, 0.34}, 0.05, 0.05, neck},
             {{0, 0.72, 0.42}, 0.06, 0.06, head},
             {{0, 0.72, 0.56}, 0.02, 0.02, head}});
  const auto leg = [&](int above, double z, const std::string& name) {
    int joint[4];
    for (const int side : {0, 1}) {
      const double x = side == 0 ? 0.08 : -0.08;
      joint[2 * side] = body.joint(name + std::to_string(2 * side), above, {x, 0.45, z});
      joint[2 * side + 1] = body.joint(name + std::to_string(2 * side + 1), joint[2 * side], {x, 0.22, z + 0.02});
    }
    body.pair({{{0.08, 0.45, z}, 0.05, 0.06, joint[0]},
               {{0.08, 0.22, z + 0.02}, 0.03, 0.035, joint[1]},
               {{0.08, 0, z}, 0.025, 0.03, joint[1]}},
              2);
  };
  leg(trunk, -0.1, "h");
  if (!has_wings) leg(chest, 0.2, "f");
  if (!has_wings) return body.character();
  const int wing = body.joint("w0", chest, {0.1, 0.58, 0.18}), tip = body.joint("w1", wing, {0.4, 0.6, 0.16});
  const int other = body.joint("w2", chest, {-0.1, 0.58, 0.18});
  body.joint("w3", other, {-0.4, 0.6, 0.16});
  body.pair({{{0.1, 0.58, 0.16}, 0.1, 0.016, wing},
             {{0.4, 0.6, 0.14}, 0.11, 0.01, tip},
             {{0.75, 0.6, 0.08}, 0.06, 0.006, tip}},
            2);
  return body.character();
}

}  // namespace bodyopt
