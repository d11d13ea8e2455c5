#include <map>
#include <tuple>

#include "coppice/base/id.h"
#include "coppice/base/local_origin.h"
#include "coppice/skeleton/raw.h"
#include "coppice/skeleton/repair_internal.h"

namespace coppice {
namespace skeleton_internal {

std::string place(const std::string& source, std::uint32_t line, std::size_t index) {
    return line > 0 ? fmt::format("{}, line {}", source, line)
                    : fmt::format("{}, record {}", source, index + 1);
}

void check_number(double value, const char* subject, const std::string& source, std::uint32_t line,
                  std::size_t index) {
    if (!std::isfinite(value)) {
        throw InvalidInput(fmt::format("{}: {} is not a finite number", place(source, line, index), subject));
    }
    if (std::abs(value) > kMax) {
        throw InvalidInput(fmt::format("{}: {} is {:g}, beyond the limit of {:g}; check the units",
                                       place(source, line, index), subject, value, kMax));
    }
}

namespace {

/// Finds records by id. Ids come from files and may have any values: no hashing, no arithmetic that may
/// overflow.
class IdIndex {
  public:
    IdIndex(const std::vector<Link>& links, const std::string& source) {
        entries_.reserve(links.size());
        for (std::uint32_t i = 0; i < links.size(); ++i) entries_.emplace_back(links[i].id, i);
        if (!std::is_sorted(entries_.begin(), entries_.end())) std::sort(entries_.begin(), entries_.end());
        const auto same = [](const Entry& a, const Entry& b) { return a.first == b.first; };
        const auto twin = std::adjacent_find(entries_.begin(), entries_.end(), same);
        if (twin == entries_.end()) return;
        const std::uint32_t first = twin->second, second = (twin + 1)->second;
        throw InvalidInput(fmt::format("{}: the id {} was used before ({}); give every record a unique id",
                                       place(source, links[second].line, second), twin->first,
                                       place(source, links[first].line, first)));
    }

    std::uint32_t find(std::int64_t id) const {
        const auto first = static_cast<std::uint64_t>(entries_.front().first);
        const std::uint64_t guess = static_cast<std::uint64_t>(id) - first;
        if (guess < entries_.size() && entries_[guess].first == id) return entries_[guess].second;
        const auto at = std::lower_bound(entries_.begin(), entries_.end(), Entry{id, 0});
        return at != entries_.end() && at->first == id ? at->second : kNoIndex;
    }

  private:
    using Entry = std::pair<std::int64_t, std::uint32_t>;
    std::vector<Entry> entries_;
};

std::pair<Vec3d, Vec3d> corners(const std::vector<Vec3d>& points) {
    Vec3d low = points.front(), high = points.front();
    for (const Vec3d p : points) {
        low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
        high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
    }
    return {low, high};
}

bool known(double radius) { return radius >= kMinRadius; }  // false for NaN

/// The closest known radius in one direction along the skeleton.
struct Nearest {
    double distance = std::numeric_limits<double>::infinity();
    double radius = 0;
    bool found() const { return std::isfinite(distance); }
};

double between(const Nearest& rootward, const Nearest& tipward) {
    if (!rootward.found()) return tipward.radius;
    if (!tipward.found()) return rootward.radius;
    const double length = rootward.distance + tipward.distance;
    return length > 0 ? (rootward.radius * tipward.distance + tipward.radius * rootward.distance) / length
                      : 0.5 * (rootward.radius + tipward.radius);
}

Vec3d choose_origin(const NodeList& nodes) {
    const auto [low, high] = corners(nodes.position);
    const double r = *std::max_element(nodes.radius.begin(), nodes.radius.end());
    const Vec3d margin{r, r, r};
    return local_origin(low - margin, high + margin, nodes.position.front());
}

/// Builds the columns of a skeleton; merges nodes that coincide with their parents or siblings.
class Assembler {
  public:
    explicit Assembler(const NodeList& nodes)
        : nodes_(nodes), origin_(choose_origin(nodes)), merged_(nodes.size()) {
        std::vector<std::uint32_t> children(nodes.size(), 0);
        for (const std::uint32_t p : nodes.parent) {
            if (p != kNoIndex) ++children[p];
        }
        crowded_.reserve(nodes.size());
        for (std::uint32_t i = 0; i < nodes.size(); ++i) crowded_.push_back(children[i] > 1);
    }

    RepairResult run(RepairReport report) {
        for (std::uint32_t i = 0; i < nodes_.size(); ++i) merged_[i] = place_node(i, report);
        return {Skeleton(std::move(parent_), std::move(position_), std::move(radius_), origin_,
                         std::move(stable_id_)),
                report, std::move(source_)};
    }

  private:
    std::uint32_t place_node(std::uint32_t i, RepairReport& report) {
        const std::uint32_t old_parent = nodes_.parent[i];
        const Vec3 p(nodes_.position[i] - origin_);
        if (old_parent == kNoIndex) return add(NodeId::none(), p, i);
        const std::uint32_t parent = merged_[old_parent];
        if (position_[parent] == p) {
            ++report.zero_length;
            has_siblings_[parent] = true;
            return parent;
        }
        if (!crowded_[old_parent] && !has_siblings_[parent]) return add(NodeId(parent), p, i);
        const auto [at, is_new] = sibling_.try_emplace({parent, p.x, p.y, p.z}, 0);
        if (is_new) return at->second = add(NodeId(parent), p, i);
        ++report.coincident;
        has_siblings_[at->second] = true;
        radius_[at->second] = std::max(radius_[at->second], static_cast<float>(nodes_.radius[i]));
        return at->second;
    }

    std::uint32_t add(NodeId parent, Vec3 position, std::uint32_t i) {
        parent_.push_back(parent);
        position_.push_back(position);
        radius_.push_back(static_cast<float>(nodes_.radius[i]));
        has_siblings_.push_back(false);
        if (!nodes_.stable_id.empty()) stable_id_.push_back(nodes_.stable_id[i]);
        if (!nodes_.source.empty()) source_.push_back(nodes_.source[i]);
        return static_cast<std::uint32_t>(radius_.size() - 1);
    }

    const NodeList& nodes_;
    Vec3d origin_;
    std::vector<std::uint32_t> merged_;
    std::vector<bool> crowded_;       // by old node: has several children
    std::vector<bool> has_siblings_;  // by new node: has children of merged nodes
    std::map<std::tuple<std::uint32_t, float, float, float>, std::uint32_t> sibling_;
    std::vector<NodeId> parent_;
    std::vector<Vec3> position_;
    std::vector<float> radius_;
    std::vector<StableId> stable_id_;
    std::vector<std::uint32_t> source_;
};

}  // namespace

std::vector<std::uint32_t> find_parents(const std::vector<Link>& links, const std::string& source,
                                        RepairReport& report) {
    const IdIndex index(links, source);
    std::vector<std::uint32_t> parent(links.size(), kNoIndex);
    for (std::size_t i = 0; i < links.size(); ++i) {
        if (links[i].parent < 0) continue;
        parent[i] = index.find(links[i].parent);
        if (parent[i] == kNoIndex) ++report.missing_parents;
    }
    return parent;
}

std::vector<std::uint32_t> parents_first(const std::vector<std::uint32_t>& parent,
                                         const std::vector<Link>& links, const std::string& source,
                                         RepairReport& report) {
    enum class State : std::uint8_t { waiting, on_path, placed };
    std::vector<State> state(parent.size(), State::waiting);
    std::vector<std::uint32_t> order, path;
    order.reserve(parent.size());
    for (std::uint32_t i = 0; i < parent.size(); ++i) {
        if (parent[i] != kNoIndex && parent[i] > i) ++report.reordered;
        for (std::uint32_t j = i; j != kNoIndex && state[j] != State::placed; j = parent[j]) {
            if (state[j] == State::on_path) {
                throw InvalidInput(
                    fmt::format("{}: the record {} is among its own ancestors; break the cycle",
                                place(source, links[j].line, j), links[j].id));
            }
            state[j] = State::on_path;
            path.push_back(j);
        }
        for (; !path.empty(); path.pop_back()) {
            order.push_back(path.back());
            state[path.back()] = State::placed;
        }
    }
    return order;
}

std::uint32_t fill_radii(const std::vector<std::uint32_t>& parent, const std::vector<double>& step,
                         double size, std::vector<double>& radius) {
    const std::size_t n = radius.size();
    double smallest = std::numeric_limits<double>::infinity();
    for (const double r : radius) {
        if (known(r)) smallest = std::min(smallest, r);
    }
    if (!std::isfinite(smallest)) smallest = size > 0 ? 0.01 * size : 0.01;
    std::vector<Nearest> rootward(n), tipward(n);
    for (std::size_t i = n; i-- > 0;) {
        if (parent[i] == kNoIndex) continue;
        const Nearest here = known(radius[i]) ? Nearest{0, radius[i]} : tipward[i];
        Nearest& best = tipward[parent[i]];
        if (here.distance + step[i] < best.distance) best = {here.distance + step[i], here.radius};
    }
    for (std::size_t i = 0; i < n; ++i) {
        if (parent[i] == kNoIndex) continue;
        const std::uint32_t p = parent[i];
        const Nearest here = known(radius[p]) ? Nearest{0, radius[p]} : rootward[p];
        rootward[i] = {here.distance + step[i], here.radius};
    }
    std::uint32_t filled = 0;
    for (std::size_t i = 0; i < n; ++i) {
        if (known(radius[i])) continue;
        radius[i] = rootward[i].found() || tipward[i].found() ? between(rootward[i], tipward[i]) : smallest;
        ++filled;
    }
    return filled;
}

double extent(const std::vector<Vec3d>& points) {
    const auto [low, high] = corners(points);
    return distance(low, high);
}

RepairResult assemble(const NodeList& nodes, const RepairReport& report) {
    return Assembler(nodes).run(report);
}

}  // namespace skeleton_internal

using namespace skeleton_internal;

RepairResult repair(const std::vector<RawNode>& nodes, const std::string& source) {
    if (nodes.empty()) throw InvalidInput(fmt::format("{}: there are no nodes", source));
    if (nodes.size() >= kNoIndex) throw Unsupported(fmt::format("{}: more than 4 billion nodes", source));
    std::vector<Link> links;
    links.reserve(nodes.size());
    for (std::size_t i = 0; i < nodes.size(); ++i) {
        const RawNode& n = nodes[i];
        for (const double x : {n.position.x, n.position.y, n.position.z}) {
            check_number(x, "a coordinate", source, n.line, i);
        }
        if (!std::isnan(n.radius)) check_number(n.radius, "the radius", source, n.line, i);
        links.push_back({n.id, n.parent, n.line});
    }
    RepairReport report;
    const std::vector<std::uint32_t> parent = find_parents(links, source, report);
    const std::vector<std::uint32_t> order = parents_first(parent, links, source, report);
    NodeList list;
    list.source = order;
    std::vector<std::uint32_t> new_index(nodes.size());
    std::vector<double> step;
    for (const std::uint32_t i : order) {
        const std::uint32_t p = parent[i] == kNoIndex ? kNoIndex : new_index[parent[i]];
        new_index[i] = list.add(p, nodes[i].position, nodes[i].radius);
        if (nodes[i].stable_id) list.stable_id.push_back(nodes[i].stable_id);
        step.push_back(p == kNoIndex ? 0 : distance(nodes[i].position, list.position[p]));
    }
    COPPICE_ASSERT(list.stable_id.empty() || list.stable_id.size() == list.size());
    report.missing_radii = fill_radii(list.parent, step, extent(list.position), list.radius);
    return assemble(list, report);
}

}  // namespace coppice
