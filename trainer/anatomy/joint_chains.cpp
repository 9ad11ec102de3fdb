#include "trainer/anatomy/joint_chains.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <map>

#include "geometry/mesh.h"

namespace bodyopt::trainer {
namespace {

using Eigen::Index;
using Eigen::Vector3d;
using Use = JointLimb::Use;

constexpr double kOffMiddle = 0.015;        // of the extent: skin further from the median plane is of a side
constexpr double kLeastLimb = 0.004;        // of the skin's area
constexpr double kGround = 0.08;            // of the height: what comes so near to the lowest point stands on it
constexpr double kFlat = 0.2, kLong = 0.3;  // thickness to width; share of the extent

std::size_t at(int joint) { return static_cast<std::size_t>(joint); }

Eigen::VectorXd vertex_areas(const HalfBody& body) {
  Eigen::VectorXd areas = Eigen::VectorXd::Zero(body.vertices.rows());
  for (Index t = 0; t < body.triangles.rows(); ++t) {
    const double area = triangle_area(body.vertices, body.triangles, t) / 3;
    for (int k = 0; k < 3; ++k) areas[body.triangles(t, k)] += area;
  }
  return areas;
}

class ChainFinder {
 public:
  explicit ChainFinder(const HalfBody& body)
      : body_(body), areas_(vertex_areas(body)), extent_(longest_extent(body.vertices)) {
    for (const NamedJoint& joint : body.joints) result_.parent.push_back(joint.parent);
  }

  JointChains find() && {
    measure_skin();
    read_names();
    find_limbs();
    attach_detached_limbs();
    for (JointLimb& limb : result_.limbs) limb.use = use_of(limb);
    find_axis();
    return std::move(result_);
  }

 private:
  int count() const { return static_cast<int>(result_.parent.size()); }
  int parent(int joint) const { return result_.parent[at(joint)]; }

  void measure_skin() {
    result_.skin.assign(body_.joints.size(), 0);
    result_.centre.assign(body_.joints.size(), Vector3d::Zero());
    for (std::size_t v = 0; v < body_.weights.size(); ++v) {
      const auto row = static_cast<Index>(v);
      for (const JointWeight& weight : body_.weights[v]) {
        result_.skin[weight.joint] += weight.weight * areas_[row];
        result_.centre[weight.joint] += weight.weight * areas_[row] * body_.vertices.row(row).transpose();
      }
    }
    const double all = std::max(areas_.sum(), 1e-300);
    for (int j = 0; j < count(); ++j) {
      double& skin = result_.skin[at(j)];
      result_.centre[at(j)] = skin > 0 ? Vector3d(result_.centre[at(j)] / skin) : body_.places[at(j)];
      skin /= all;
    }
  }

  void read_names() {
    for (int j = 0; j < count(); ++j) {
      const std::string& name = body_.joints[at(j)].name;
      result_.is_head.push_back(is_named(name, {"head", "skull"}) ||
                                (parent(j) >= 0 && result_.is_head[at(parent(j))]));
      result_.is_excess.push_back(is_named(
          name, {"ear",  "ears",   "eye",   "eyes",  "hair", "jaw",     "mouth",  "tongue", "nose",    "lip",
                 "brow", "lid",    "cloth", "skirt", "cape", "hat",     "socket", "weapon", "sword",   "shield",
                 "prop", "breast", "ik",    "pole",  "ctrl", "control", "target", "mane",   "feather", "helper"}));
    }
  }

  // -1, 1: the side that the skin of a joint lies on; 0: the middle; 2: it has no skin.
  int side_of_skin(int joint) const {
    if (!result_.has_skin(joint)) return 2;
    const double x = result_.centre[at(joint)].x();
    return std::abs(x) < kOffMiddle * extent_ ? 0 : (x > 0 ? 1 : -1);
  }

  // The side that all of the skin at and below a joint lies on, J; 0: several, or the middle; 2: there is none.
  std::vector<int> sides() const {
    std::vector<int> side;
    for (int j = 0; j < count(); ++j) side.push_back(side_of_skin(j));
    for (int j = count() - 1; j >= 0; --j) {
      if (parent(j) < 0 || side[at(j)] == 2) continue;
      int& above = side[at(parent(j))];
      above = above == 2 || above == side[at(j)] ? side[at(j)] : 0;
    }
    return side;
  }

  // Limbs begin at the first joint below which all skin is of one side. What has no median plane is all one limb.
  void find_limbs() {
    const std::vector<int> side = sides();
    result_.limb.assign(body_.joints.size(), -1);
    for (int j = 0; j < count(); ++j) {
      const int above = parent(j) < 0 ? -1 : result_.limb[at(parent(j))];
      const bool begins = body_.has_plane ? side[at(j)] == 1 || side[at(j)] == -1 : result_.limbs.empty();
      if (above >= 0 || (!body_.has_plane && !begins)) {
        result_.limb[at(j)] = std::max(above, 0);
      } else if (begins) {
        result_.limb[at(j)] = static_cast<int>(result_.limbs.size());
        result_.limbs.emplace_back().is_left = side[at(j)] != -1;
      }
      if (const int limb = result_.limb[at(j)]; limb >= 0) {
        result_.limbs[at(limb)].joints.push_back(j);
        result_.limbs[at(limb)].skin += result_.skin[at(j)];
      }
    }
  }

  // How many edges of triangles join the skins of two joints, each vertex counting for the joint it follows most.
  std::map<std::pair<int, int>, int> joined_skins() const {
    std::map<std::pair<int, int>, int> joined;
    for_each_edge(body_.triangles, [&](std::uint32_t a, std::uint32_t b) {
      const auto &one = body_.weights[a], &other = body_.weights[b];
      if (one.empty() || other.empty() || one.front().joint == other.front().joint) return;
      ++joined[{static_cast<int>(one.front().joint), static_cast<int>(other.front().joint)}];
      ++joined[{static_cast<int>(other.front().joint), static_cast<int>(one.front().joint)}];
    });
    return joined;
  }

  // Feet for inverse kinematics hang at the root: a limb whose skin goes on from that of one other limb alone is its
  // end.
  void attach_detached_limbs() {
    const auto joined = joined_skins();
    std::vector<int> onto(result_.limbs.size(), -1);
    for (int limb = 0; limb < static_cast<int>(result_.limbs.size()); ++limb) {
      int other = -1, most = 0, joint = -1;
      bool is_end = parent(result_.limbs[at(limb)].joints.front()) >= 0;
      for (const auto& [pair, triangles] : joined) {
        if (result_.limb[at(pair.first)] != limb || result_.limb[at(pair.second)] == limb) continue;
        const int touched = result_.limb[at(pair.second)];
        is_end = is_end && touched >= 0 && (other < 0 || other == touched) && !hangs_at(limb, touched);
        other = touched;
        if (triangles > most) joint = pair.second;
        most = std::max(most, triangles);
      }
      if (is_end && joint >= 0 && onto[at(other)] < 0) onto[at(limb)] = joint;
    }
    for (int limb = 0; limb < static_cast<int>(onto.size()); ++limb) {
      if (onto[at(limb)] >= 0) hang(limb, onto[at(limb)]);
    }
    std::erase_if(result_.limbs, [](const JointLimb& limb) { return limb.joints.empty(); });
    for (int limb = 0; limb < static_cast<int>(result_.limbs.size()); ++limb) {
      for (const int j : result_.limbs[at(limb)].joints) result_.limb[at(j)] = limb;
    }
  }

  // If two limbs touch, the one with less skin is the end.
  bool hangs_at(int limb, int other) const { return result_.limbs[at(limb)].skin > result_.limbs[at(other)].skin; }

  void hang(int limb, int joint) {
    JointLimb& end = result_.limbs[at(limb)];
    JointLimb& whole = result_.limbs[at(result_.limb[at(joint)])];
    result_.parent[at(end.joints.front())] = joint;
    whole.joints.insert(whole.joints.end(), end.joints.begin(), end.joints.end());
    whole.skin += end.skin;
    end.joints.clear();
  }

  Use use_of(JointLimb& limb) const {
    const int first = limb.joints.front();
    const std::string& name = body_.joints[at(first)].name;
    if (result_.is_excess[at(first)] || result_.is_head[at(first)] || limb.skin < kLeastLimb) return Use::none;
    const Positions points = skin_of(limb);
    if (points.rows() < 3) return Use::none;
    limb.flatness = flatness(points);
    if (!body_.has_plane) return named_in(limb, {"elbow", "wrist", "forearm", "hand"}) ? Use::arm : Use::leg;
    if (named_in(limb, {"wing", "wings"})) return Use::wing;
    if (is_named(name, {"fin", "flipper", "pectoral"})) return Use::fin;
    const double lowest = body_.vertices.col(1).minCoeff(), height = body_.vertices.col(1).maxCoeff() - lowest;
    const bool stands = points.col(1).minCoeff() < lowest + kGround * height, is_flat = limb.flatness < kFlat;
    const bool is_long = longest_extent(points) > kLong * extent_;
    // A thin leg that is bent looks flat, too.
    if (stands && (is_long || !is_flat)) return Use::leg;
    if (!is_flat) return Use::arm;
    return is_long ? Use::wing : Use::fin;
  }

  bool named_in(const JointLimb& limb, std::initializer_list<std::string_view> words) const {
    return std::ranges::any_of(limb.joints, [&](int j) { return is_named(body_.joints[at(j)].name, words); });
  }

  // The vertices that mostly follow a limb.
  Positions skin_of(const JointLimb& limb) const {
    std::vector<Index> rows;
    for (std::size_t v = 0; v < body_.weights.size(); ++v) {
      double share = 0;
      for (const JointWeight& weight : body_.weights[v]) {
        share +=
            std::ranges::find(limb.joints, static_cast<int>(weight.joint)) != limb.joints.end() ? weight.weight : 0;
      }
      if (share > 0.5) rows.push_back(static_cast<Index>(v));
    }
    return body_.vertices(rows, Eigen::all);
  }

  static double flatness(const Positions& points) {
    const Positions centred = points.rowwise() - points.colwise().mean();
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(centred.transpose() * centred);
    return std::sqrt(std::max(axes.eigenvalues()[0], 0.0) / std::max(axes.eigenvalues()[1], 1e-300));
  }

  // The joints from one up to its root.
  std::vector<int> upwards(int joint) const {
    std::vector<int> chain;
    for (; joint >= 0; joint = parent(joint)) chain.push_back(joint);
    return chain;
  }

  // The joints from one to another, through the last that both hang under.
  std::vector<int> path(int from, int to) const {
    std::vector<int> up = upwards(from), down = upwards(to);
    int shared = -1;
    while (!up.empty() && !down.empty() && up.back() == down.back()) {
      shared = up.back();
      up.pop_back();
      down.pop_back();
    }
    if (shared >= 0) up.push_back(shared);
    up.insert(up.end(), down.rbegin(), down.rend());
    return up;
  }

  double length(const std::vector<int>& chain) const {
    double sum = 0;
    for (std::size_t k = 1; k < chain.size(); ++k)
      sum += (result_.centre[at(chain[k])] - result_.centre[at(chain[k - 1])]).norm();
    return sum;
  }

  bool is_axial(int joint) const {
    return result_.limb[at(joint)] < 0 && result_.has_skin(joint) && !result_.is_excess[at(joint)];
  }

  int farthest_from(int joint) const {
    int farthest = joint;
    double most = 0;
    for (int j = 0; j < count(); ++j) {
      if (!is_axial(j)) continue;
      const double far = length(path(joint, j));
      if (far > most) farthest = j;
      most = std::max(most, far);
    }
    return farthest;
  }

  void find_axis() {
    int head = -1, tail = -1, any = -1;
    for (int j = 0; j < count(); ++j) {
      if (!is_axial(j)) continue;
      any = any < 0 ? j : any;
      if (head < 0 && result_.is_head[at(j)]) head = j;
      if (is_named(body_.joints[at(j)].name, {"tail"}) && !result_.is_head[at(j)]) tail = j;
    }
    if (any < 0) return;
    const bool is_told = head >= 0 || tail >= 0;
    if (tail < 0) tail = head >= 0 ? farthest_from(head) : farthest_from(any);
    if (head < 0) head = farthest_from(tail);
    if (!is_told && !is_from_tail(tail, head)) std::swap(tail, head);
    result_.axis = path(tail, head);
    if (can_be_head(head)) result_.is_head[at(head)] = true;
    // A root that stands on the ground, and controls, are no vertebrae.
    std::erase_if(result_.axis,
                  [&](int j) { return !result_.has_skin(j) && (parent(j) < 0 || result_.is_excess[at(j)]); });
  }

  // If none is named, the head ends the axis, is no large part of the body, and no limbs leave it.
  bool can_be_head(int joint) const {
    constexpr double kMost = 0.3;  // of the skin
    const bool carries_limbs = std::ranges::any_of(result_.limbs, [&](const JointLimb& limb) {
      return limb.use != Use::none && parent(limb.joints.front()) == joint;
    });
    return result_.axis.size() > 1 && result_.skin[at(joint)] < kMost && !carries_limbs &&
           std::ranges::none_of(result_.is_head, [](bool is) { return is; });
  }

  // Without telling names, the head is the upper end of a body that stands, the bulkier one of a body that lies.
  bool is_from_tail(int from, int to) const {
    const Vector3d along = result_.centre[at(to)] - result_.centre[at(from)];
    if (std::abs(along.y()) > 0.7 * along.norm()) return along.y() > 0;
    return bulk(to) >= bulk(from);
  }

  // How far the skin of a joint reaches across the body.
  double bulk(int joint) const {
    double sum = 0, weights = 0;
    for (std::size_t v = 0; v < body_.weights.size(); ++v) {
      for (const JointWeight& weight : body_.weights[v]) {
        if (static_cast<int>(weight.joint) != joint) continue;
        const double share = weight.weight * areas_[static_cast<Index>(v)];
        sum += share * (body_.vertices.row(static_cast<Index>(v)).transpose() - result_.centre[at(joint)]).norm();
        weights += share;
      }
    }
    return weights > 0 ? sum / weights : 0;
  }

  const HalfBody& body_;
  Eigen::VectorXd areas_;
  double extent_;
  JointChains result_;
};

}  // namespace

int JointChains::count(JointLimb::Use use) const {
  int left = 0, right = 0;
  for (const JointLimb& each : limbs) (each.is_left ? left : right) += each.use == use ? 1 : 0;
  return std::max(left, right);
}

JointChains find_chains(const HalfBody& body) { return ChainFinder(body).find(); }

std::vector<int> bone_parents(const JointChains& chains) {
  std::vector<int> bones(chains.parent.size(), -1);
  for (std::size_t k = 1; k < chains.axis.size(); ++k) {
    for (const auto& [one, other] : {std::pair(k, k - 1), std::pair(k - 1, k)}) {
      const int joint = chains.axis[one], above = chains.axis[other];
      if (chains.parent[at(joint)] == above) bones[at(joint)] = above;
    }
  }
  std::vector<bool> holds_skin(chains.parent.size());  // at or below it
  for (const JointLimb& limb : chains.limbs) {
    if (limb.use == Use::none) continue;
    for (std::size_t k = limb.joints.size(); k-- > 1;) {
      const int joint = limb.joints[k], above = chains.parent[at(joint)];
      holds_skin[at(joint)] = holds_skin[at(joint)] || chains.has_skin(joint);
      if (!holds_skin[at(joint)] || chains.is_excess[at(joint)]) continue;
      holds_skin[at(above)] = true;
      bones[at(joint)] = above;
    }
  }
  return bones;
}

bool is_named(const std::string& joint, std::initializer_list<std::string_view> words) {
  const std::vector<std::string> own = name_words(joint);
  return std::ranges::any_of(words, [&](std::string_view word) {
    return std::ranges::any_of(own, [&](const std::string& name) {
      return word.size() < 4 ? name == word : name.find(word) != std::string::npos;
    });
  });
}

}  // namespace bodyopt::trainer
