#include "coppice/studio/show/live_surfaces_internal.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "coppice/base/error.h"

namespace coppice {
namespace {

constexpr std::size_t kMaxSurfaces = 4;
constexpr std::size_t kMaxChanges = 64;
constexpr double kMebibyte = 1 << 20;

/// Measured for trees of 1,700 to 5,200 nodes: the data of each node, and four to five quads in the cage.
std::uint64_t estimate_bytes(const Skeleton& tree, const MeshOptions& options) {
    constexpr std::uint64_t kOfNode = 500, kOfItsQuads = 182;
    return tree.size() * (kOfNode + (kOfItsQuads << 2 * options.levels));
}

std::vector<std::pair<StableId, NodeId>> by_id(const Skeleton& tree) {
    std::vector<std::pair<StableId, NodeId>> out;
    out.reserve(tree.size());
    for (const NodeId n : nodes(tree)) out.emplace_back(tree.stable_id(n), n);
    if (!std::ranges::is_sorted(out)) std::ranges::sort(out);
    return out;
}

StableId get_parent(const Skeleton& tree, NodeId n) {
    return tree.parent(n) ? tree.stable_id(tree.parent(n)) : StableId();
}

bool same_node(const Skeleton& a, NodeId n, const Skeleton& b, NodeId m) {
    return a.position(n) == b.position(m) && a.radius(n) == b.radius(m) &&
           get_parent(a, n) == get_parent(b, m);
}

/// Returns the disjoint ranges that cover both, in ascending order.
std::vector<NumberRange> merged(std::vector<NumberRange> a, const std::vector<NumberRange>& b) {
    a.insert(a.end(), b.begin(), b.end());
    std::ranges::sort(a, {}, &NumberRange::first);
    std::vector<NumberRange> out;
    for (const NumberRange& r : a) {
        if (out.empty() || r.first > out.back().first + out.back().count) {
            out.push_back(r);
        } else {
            const std::uint32_t end = std::max(out.back().first + out.back().count, r.first + r.count);
            out.back().count = end - out.back().first;
        }
    }
    return out;
}

}  // namespace

std::vector<StableId> changed_nodes(const Skeleton& before, const Skeleton& after) {
    const auto a = by_id(before), b = by_id(after);
    std::vector<StableId> out;
    auto at = a.begin();
    for (const auto& [id, node] : b) {
        for (; at != a.end() && at->first < id; ++at) out.push_back(at->first);
        const bool known = at != a.end() && at->first == id;
        if (!known || !same_node(before, at->second, after, node)) out.push_back(id);
        if (known) ++at;
    }
    for (; at != a.end(); ++at) out.push_back(at->first);
    return out;
}

LiveSurfaces::Shown& LiveSurfaces::follow(const std::string& name, const ObjectPtr& object,
                                          const MeshOptions& options, const std::string& options_text,
                                          const Context& ctx) {
    const Skeleton& now = std::get<Skeleton>(object->value);
    const auto found = std::ranges::find_if(
        shown_, [&](const Shown& s) { return s.name == name && s.options_text == options_text; });
    const auto& get_tree = [](const Shown& s) -> const Skeleton& {
        return std::get<Skeleton>(s.object->value);
    };
    const std::uint64_t bytes = estimate_bytes(now, options);
    if (bytes > max_bytes_) {
        throw InvalidInput(fmt::format(
            "the surface of '{}' may take {:.1f} MiB, and {:.1f} are available for surfaces that follow "
            "edits; show its axes, reduce the levels, or give the studio more with --max-memory",
            name, static_cast<double>(bytes) / kMebibyte, static_cast<double>(max_bytes_) / kMebibyte));
    }
    if (found == shown_.end() || get_tree(*found).origin() != now.origin()) {
        if (found != shown_.end()) shown_.splice(shown_.end(), shown_, found);  // removed first
        make_room(bytes, kMaxSurfaces - 1);
        LiveSurface surface(now, options, ctx);
        std::erase_if(shown_,
                      [&](const Shown& s) { return s.name == name && s.options_text == options_text; });
        shown_.push_front({name, options, options_text, object, std::move(surface), ++number_, {}});
        return shown_.front();
    }
    shown_.splice(shown_.begin(), shown_, found);
    Shown& shown = shown_.front();
    if (shown.object == object) return shown;
    make_room(0, kMaxSurfaces);
    const std::vector<StableId> changed = changed_nodes(get_tree(shown), now);
    if (!changed.empty()) {
        SurfaceChange change = shown.surface.update(now, changed, ctx);
        shown.changes.emplace_back(std::exchange(shown.number, ++number_), std::move(change));
        if (shown.changes.size() > kMaxChanges) shown.changes.pop_front();
    }
    shown.object = object;
    return shown;
}

std::uint64_t LiveSurfaces::bytes() const {
    std::uint64_t out = 0;
    for (const Shown& s : shown_) out += estimate_bytes(std::get<Skeleton>(s.object->value), s.options);
    return out;
}

/// Keeps the most recently used ones, within the memory limit.
void LiveSurfaces::make_room(std::uint64_t more, std::size_t most) {
    while (!shown_.empty() && (shown_.size() > most || bytes() + more > max_bytes_)) shown_.pop_back();
}

std::optional<SurfaceChange> LiveSurfaces::since(const Shown& shown, std::uint64_t number) {
    SurfaceChange out;
    if (number == shown.number) return out;
    for (auto at = shown.changes.rbegin(); at != shown.changes.rend(); ++at) {
        if (at->second.is_whole) return std::nullopt;
        out.vertices = merged(std::move(out.vertices), at->second.vertices);
        out.quads = merged(std::move(out.quads), at->second.quads);
        out.meshed += at->second.meshed;
        if (at->first == number) return out;
    }
    return std::nullopt;
}

}  // namespace coppice
