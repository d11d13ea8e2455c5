#include "coppice/extract/stem/loose_components.h"

#include <algorithm>
#include <cstdint>

#include "coppice/base/error.h"
#include "coppice/extract/stem/stem_form.h"
#include "coppice/spatial/kd_tree.h"

namespace coppice {

namespace {

constexpr double kLong = 0.25;   // minimum length of a tree, relative to the longest component
constexpr double kSlope = 0.25;  // maximum slope of the ground between two trees

/// Extent of a component.
struct Part {
    NodeId root;
    double length = 0;
    Vec3 foot;  // lowest node
    float top = 0;
};

std::vector<Part> find_parts(const Skeleton& s) {
    std::vector<Part> parts;
    std::vector<std::uint32_t> part_of(s.size());
    for (const NodeId n : nodes(s)) {
        const Vec3 p = s.position(n);
        if (s.is_root(n)) {
            part_of[n.index()] = static_cast<std::uint32_t>(parts.size());
            parts.push_back({n, 0, p, p.z});
            continue;
        }
        part_of[n.index()] = part_of[s.parent(n).index()];
        Part& part = parts[part_of[n.index()]];
        part.length += distance(Vec3d(p), Vec3d(s.position(s.parent(n))));
        if (p.z < part.foot.z) part.foot = p;
        part.top = std::max(part.top, p.z);
    }
    return parts;
}

/// Estimates the height of the ground from the bases of trees.
class Ground {
  public:
    explicit Ground(const std::vector<Vec3>& feet) : feet_(feet), plan_(make_plan(feet)), tree_(plan_) {}

    bool bears(const Part& part) const {
        if (!(double{part.top} - double{part.foot.z} > kBreastHeight)) return false;
        const KdTree::Nearest near = tree_.nearest({part.foot.x, part.foot.y, 0});
        const double above = double{part.foot.z} - double{feet_[near.index].z};
        return above <= kBreastHeight + kSlope * std::sqrt(near.squared);
    }

  private:
    static std::vector<Vec3> make_plan(std::vector<Vec3> feet) {
        for (Vec3& p : feet) p.z = 0;
        return feet;
    }

    const std::vector<Vec3>& feet_;
    std::vector<Vec3> plan_;
    KdTree tree_;
};

}  // namespace

LooseComponents find_loose_components(const Skeleton& s) {
    const std::vector<Part> parts = find_parts(s);
    const double least = kLong * std::ranges::max(parts, {}, &Part::length).length;
    std::vector<Vec3> feet;
    for (const Part& part : parts)
        if (part.length >= least) feet.push_back(part.foot);
    const Ground ground(feet);
    LooseComponents out;
    double length = 0;
    for (const Part& part : parts) {
        length += part.length;
        if (part.length >= least || ground.bears(part)) {
            out.trees.push_back(part.root);
        } else {
            out.loose.push_back(part.root);
            out.length += part.length;
        }
    }
    out.share = length > 0 ? out.length / length : 0;
    return out;
}

Skeleton extract_parts(const Skeleton& s, const std::vector<NodeId>& roots) {
    COPPICE_ASSERT(!roots.empty());
    std::vector<NodeId> new_id(s.size(), NodeId::none()), parents;
    std::vector<Vec3> positions;
    std::vector<float> radii;
    std::vector<StableId> ids;
    for (const NodeId n : nodes(s)) {
        const NodeId parent = s.is_root(n) ? NodeId::none() : new_id[s.parent(n).index()];
        if (s.is_root(n) ? !std::ranges::binary_search(roots, n) : !parent) continue;
        new_id[n.index()] = NodeId(static_cast<std::uint32_t>(parents.size()));
        parents.push_back(parent);
        positions.push_back(s.position(n));
        radii.push_back(s.radius(n));
        ids.push_back(s.stable_id(n));
    }
    return Skeleton(std::move(parents), std::move(positions), std::move(radii), s.origin(), std::move(ids));
}

}  // namespace coppice
