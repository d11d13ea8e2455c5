#include <array>

#include "coppice/base/id.h"
#include "coppice/io_skeleton/mtg/measures_internal.h"

namespace coppice::mtg {

namespace {

class Placing {
  public:
    Placing(const Document& document, const Measures& measures)
        : document_(document),
          count_(static_cast<std::uint32_t>(document.vertices.size())),
          place_(count_),
          is_placed_(count_),
          node_(count_, kNoIndex) {
        for (std::uint32_t v = 1; v < count_; ++v) {
            if (const auto p = measures.place(v)) {
                place_[v] = *p;
                is_placed_[v] = true;
            }
        }
        drop_tops_of_complexes();
        find_behind();
        find_ahead();
        find_bearers();
        for (std::uint32_t v = 1; v < count_; ++v) add_node(v, measures);
    }

    Nodes take() { return std::move(nodes_); }

  private:
    const Vertex& vertex(std::uint32_t v) const { return document_.vertices[v]; }

    /// Removes the coordinates of complexes that denote their top. An entity may have coordinates in addition
    /// to its components. Those of its base precede them; those of its top, which the last component has too,
    /// would lead forth and back. The distances to both decide, for all entities of a scale together.
    void drop_tops_of_complexes() {
        std::vector<std::uint32_t> last(count_, kNoIndex);
        for (std::uint32_t v = 1; v < count_; ++v) {
            if (!is_placed_[v]) continue;
            for (std::uint32_t c = vertex(v).complex; c != 0; c = vertex(c).complex) {
                if (vertex(v).edge != '+' || last[c] == kNoIndex) last[c] = v;
            }
        }
        std::array<double, kFinestScale + 1> balance{};  // distance to the top minus distance to the base
        std::vector<std::uint32_t> behind(count_, kNoIndex);
        for (std::uint32_t v = 1; v < count_; ++v) {
            const std::uint32_t before = vertex(v).before;
            behind[v] = before != 0 && is_placed_[before] ? before : behind[before];
            if (!is_placed_[v] || last[v] == kNoIndex || behind[v] == kNoIndex) continue;
            balance[vertex(v).scale] +=
                distance(place_[v], place_[last[v]]) - distance(place_[v], place_[behind[v]]);
        }
        for (std::uint32_t v = 1; v < count_; ++v) {
            if (last[v] != kNoIndex && balance[vertex(v).scale] < 0) is_placed_[v] = false;
        }
    }

    /// Finds the closest entity with coordinates towards the root, and the number of entities in between.
    void find_behind() {
        behind_.assign(count_, kNoIndex);
        steps_behind_.assign(count_, 0);
        for (std::uint32_t v = 1; v < count_; ++v) {
            const std::uint32_t before = vertex(v).before;
            const std::uint32_t own = vertex(v).components == 0 ? 1 : 0;
            const bool at_place = before != 0 && is_placed_[before];
            behind_[v] = at_place ? before : behind_[before];
            steps_behind_[v] = own + (at_place ? 0 : steps_behind_[before]);
        }
    }

    /// Finds the closest entity with coordinates towards the tip of the axis, likewise.
    void find_ahead() {
        ahead_.assign(count_, kNoIndex);
        steps_ahead_.assign(count_, 0);
        for (std::uint32_t v = count_; v-- > 1;) {
            const std::uint32_t before = vertex(v).before;
            if (vertex(v).edge == '+') continue;
            if (!is_placed_[v] && ahead_[v] == kNoIndex) continue;
            // The first of several in the file is used: the loop visits later ones before.
            ahead_[before] = is_placed_[v] ? v : ahead_[v];
            steps_ahead_[before] =
                (vertex(v).components == 0 ? 1 : 0) + (is_placed_[v] ? 0 : steps_ahead_[v]);
        }
    }

    /// Finds for entities without coordinates the first entity with coordinates on their branches.
    void find_bearers() {
        std::vector<std::uint32_t> first_place(count_, kNoIndex);
        borne_.assign(count_, kNoIndex);
        for (std::uint32_t v = count_; v-- > 1;) {
            const std::uint32_t place = is_placed_[v] ? v : ahead_[v] != kNoIndex ? ahead_[v] : borne_[v];
            if (place != kNoIndex && vertex(v).edge == '+') borne_[vertex(v).before] = place;
        }
    }

    void add_node(std::uint32_t v, const Measures& measures) {
        const std::uint32_t parent = node_[vertex(v).before];
        node_[v] = parent;
        Nodes::Node node{v, parent, place_[v], measures.end_radius(v), is_placed_[v]};
        if (!node.is_measured) {
            if (borne_[v] == kNoIndex) return;
            if (behind_[v] == kNoIndex || ahead_[v] == kNoIndex) {
                node.position = place_[ahead_[v] == kNoIndex ? borne_[v] : ahead_[v]];
            } else {
                const double steps = steps_behind_[v] + steps_ahead_[v];
                const double t = steps > 0 ? steps_behind_[v] / steps : 0;
                const Vec3d from = place_[behind_[v]];
                node.position = from + t * (place_[ahead_[v]] - from);
            }
        }
        node_[v] = static_cast<std::uint32_t>(nodes_.nodes.size());
        nodes_.nodes.push_back(node);
    }

    const Document& document_;
    std::uint32_t count_;
    std::vector<Vec3d> place_;
    std::vector<bool> is_placed_;
    std::vector<std::uint32_t> behind_, ahead_, borne_;
    std::vector<double> steps_behind_, steps_ahead_;
    std::vector<std::uint32_t> node_;  // last node up to each entity
    Nodes nodes_;
};

}  // namespace

Nodes nodes_of_places(const Document& document, const Measures& measures) {
    return Placing(document, measures).take();
}

}  // namespace coppice::mtg
