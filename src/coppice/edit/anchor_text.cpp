#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "coppice/edit/anchor.h"
#include "coppice/edit/parts_internal.h"
#include "coppice/edit/selection.h"

namespace coppice {

using namespace edit_internal;

namespace {

/// Returns the distance [m] from a node to the closest node with which it could be confused, of similar
/// radius and on another axis; 2 tolerances if none is nearer. The order of the other axis is ignored,
/// because after a branch is removed another one may become the leader.
double room_around(const EditableTree& tree, const AnchorFrame& frame, StableId node) {
    NodeSet own = find_axis(tree, node);
    std::ranges::sort(own);
    double room = 2 * kAnchorTolerance * frame.size;
    const Vec3d place = get_position(tree, node);
    for (const StableId n : tree.nodes()) {
        const double away = distance(get_position(tree, n), place);
        if (away >= room || holds(own, n)) continue;
        const double thicker = double{tree.radius(n)} / tree.radius(node);
        if (thicker <= kAnchorThicker && thicker >= 1 / kAnchorThicker) room = away;
    }
    return room;
}

std::string fixed(double value, int decimals) {
    std::string text = fmt::format("{:.{}f}", value, decimals);
    if (decimals > 0) text.erase(text.find_last_not_of('0') + 1);
    if (text.ends_with('.')) text.pop_back();
    return text == "-0" ? "0" : text;
}

/// Formats the anchor of a node.
class Writer {
  public:
    Writer(const EditableTree& tree, StableId node)
        : tree_(tree), node_(node), frame_(anchor_frame(tree)), anchor_(compute_anchor(tree, frame_, node)) {
        constexpr double kFine = 1e-4;  // [size] resolution
        decimals_ =
            std::clamp(static_cast<int>(std::ceil(-std::log10(kFine * frame_.size))), 0, kMaxDecimals);
        room_ = room_around(tree, frame_, node);
    }

    std::string text() const {
        constexpr int kMore = 2;
        for (int decimals = decimals_; decimals < decimals_ + 3 * kMore; decimals += kMore) {
            if (std::string text = written(decimals); holds_it(text)) return text;
        }
        std::string text = written(kEvery);
        return holds_it(text) ? text : written(kEvery, true);
    }

  private:
    static constexpr int kMaxDecimals = 15, kEvery = 99;

    bool is_crowded() const { return room_ < 2 * kAnchorTolerance * frame_.size; }

    std::string length_text(double metres, int decimals) const {
        return decimals == kEvery ? fmt::format("{}", metres) : fixed(metres, decimals);
    }

    std::string written(int decimals, bool with_id = false) const {
        const Vec3d p = tree_.origin() + get_position(tree_, node_);
        std::string out = fmt::format("at({},{},{},{},", length_text(p.x, decimals),
                                      length_text(p.y, decimals), length_text(p.z, decimals), anchor_.order);
        const float radius = tree_.radius(node_);
        out += decimals == kEvery ? fmt::format("{}", radius) : fmt::format("{:.3g}", radius);
        if (is_crowded() || decimals > decimals_) {
            out += decimals == kEvery
                       ? fmt::format(",{},{}", anchor_.along, anchor_.length * frame_.size)
                       : fmt::format(",{:.3g},{:.4g}", anchor_.along, anchor_.length * frame_.size);
            out += fmt::format(",{:.2g}", within(decimals));
        }
        if (with_id) out += fmt::format(",{}", node_.index());
        return out + ")";
    }

    /// Returns a tolerance below half the distance to the closest confusable node, but not below the rounding
    /// error.
    double within(int decimals) const {
        const double least = decimals == kEvery ? 1e-6 * frame_.size : 2 * std::pow(10.0, -decimals);
        return std::max(room_ * 0.49, least);
    }

    bool holds_it(const std::string& text) const {
        try {
            return selected(tree_, parse_selection(text)) == NodeSet{node_};
        } catch (const InvalidInput&) {
            return false;  // two nodes match
        }
    }

    const EditableTree& tree_;
    StableId node_;
    AnchorFrame frame_;
    Anchor anchor_;
    int decimals_ = 0;
    double room_ = 0;  // [m]
};

}  // namespace

std::string anchor_text(const EditableTree& tree, StableId node) {
    check_node(tree, node);
    return Writer(tree, node).text();
}

}  // namespace coppice
