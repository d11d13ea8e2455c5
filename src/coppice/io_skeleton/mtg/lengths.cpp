#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "coppice/base/id.h"
#include "coppice/io_skeleton/mtg/measures_internal.h"

namespace coppice::mtg {

namespace {

constexpr double kInsertion = 45;        // [degrees] default insertion angle
constexpr double kPhyllotaxy = 137.508;  // [degrees] default azimuth between successive branches of an axis

/// Position and orientation at the end of an entity.
struct Frame {
    Vec3d place{0, 0, 0};
    Vec3d heading{0, 0, 1};
    Vec3d front{1, 0, 0};
    std::uint32_t node = kNoIndex;
};

class Laying {
  public:
    Laying(const Document& document, const Measures& measures)
        : document_(document),
          measures_(measures),
          count_(static_cast<std::uint32_t>(document.vertices.size())) {
        share_lengths();
        lay();
        set_plants_apart();
    }

    Nodes take() { return std::move(nodes_); }

  private:
    const Vertex& vertex(std::uint32_t v) const { return document_.vertices[v]; }

    /// Assigns to entities without components and without length an equal share of the length of their
    /// closest complex that has one.
    void share_lengths() {
        owner_.assign(count_, kNoIndex);
        rank_.assign(count_, 0);
        parts_.assign(count_, 0);
        std::vector<std::uint32_t> owner(count_, kNoIndex);
        for (std::uint32_t v = 1; v < count_; ++v) {
            owner[v] = measures_.length(v) > 0 ? v : owner[vertex(v).complex];
            if (vertex(v).components > 0 || owner[v] == kNoIndex) continue;
            owner_[v] = owner[v];
            rank_[v] = ++parts_[owner[v]];
        }
    }

    void lay() {
        std::vector<Frame> end(count_);
        std::vector<std::uint32_t> axis(count_, 0), borne(count_, 0);
        for (std::uint32_t v = 1; v < count_; ++v) {
            Frame frame = end[vertex(v).before];
            axis[v] = vertex(v).before == 0 ? v : axis[vertex(v).before];
            if (vertex(v).edge == '+') {
                turn(frame, v, borne[axis[v]]++);
                axis[v] = v;
            }
            if (owner_[v] != kNoIndex) go(frame, v);
            end[v] = frame;
        }
    }

    void turn(Frame& frame, std::uint32_t v, std::uint32_t rank) const {
        const auto known = [](double angle, double usual) { return std::isfinite(angle) ? angle : usual; };
        const double radians = std::numbers::pi / 180;
        double azimuth = measures_.azimuth(v), insertion = measures_.insertion(v);
        // The row of "+A2/U1/E1" specifies angles of E1 only.
        for (std::uint32_t part = v + 1; part < count_ && vertex(part).complex == part - 1; ++part) {
            if (std::isnan(azimuth)) azimuth = measures_.azimuth(part);
            if (std::isnan(insertion)) insertion = measures_.insertion(part);
        }
        azimuth = radians * known(azimuth, kPhyllotaxy * rank);
        insertion = radians * known(insertion, kInsertion);
        const Vec3d side = cross(frame.heading, frame.front);
        const Vec3d away = frame.front * std::cos(azimuth) + side * std::sin(azimuth);
        const Vec3d heading = frame.heading * std::cos(insertion) + away * std::sin(insertion);
        frame.front = away * std::cos(insertion) - frame.heading * std::sin(insertion);
        frame.heading = heading;
    }

    void go(Frame& frame, std::uint32_t v) {
        const std::uint32_t owner = owner_[v];
        const double t = static_cast<double>(rank_[v]) / parts_[owner];
        if (frame.node == kNoIndex)
            frame.node = add(v, kNoIndex, frame.place, measures_.begin_radius(owner), false);
        frame.place += frame.heading * (measures_.length(owner) / parts_[owner]);
        double radius = measures_.end_radius(v);
        if (std::isnan(radius)) {
            const double from = measures_.begin_radius(owner), to = measures_.end_radius(owner);
            radius = std::isnan(from) ? to : from + t * (to - from);
        }
        frame.node = add(v, frame.node, frame.place, radius, true);
    }

    std::uint32_t add(std::uint32_t v, std::uint32_t parent, Vec3d place, double radius, bool is_measured) {
        nodes_.nodes.push_back({v, parent, place, radius, is_measured});
        return static_cast<std::uint32_t>(nodes_.nodes.size() - 1);
    }

    /// Arranges plants in a row along x, with gaps of a tenth of the maximum width.
    void set_plants_apart() {
        auto& nodes = nodes_.nodes;
        std::vector<std::uint32_t> plant(nodes.size());
        std::vector<std::pair<double, double>> reach;  // in x, by plant
        for (std::size_t i = 0; i < nodes.size(); ++i) {
            if (nodes[i].parent == kNoIndex) {
                plant[i] = static_cast<std::uint32_t>(reach.size());
                reach.emplace_back(nodes[i].position.x, nodes[i].position.x);
            } else {
                plant[i] = plant[nodes[i].parent];
            }
            auto& [low, high] = reach[plant[i]];
            low = std::min(low, nodes[i].position.x);
            high = std::max(high, nodes[i].position.x);
        }
        double widest = 0;
        for (const auto& [low, high] : reach) widest = std::max(widest, high - low);
        std::vector<double> shift(reach.size(), 0);
        for (std::size_t i = 1; i < reach.size(); ++i) {
            shift[i] = shift[i - 1] + reach[i - 1].second + widest / 10 - reach[i].first;
        }
        for (std::size_t i = 0; i < nodes.size(); ++i) nodes[i].position.x += shift[plant[i]];
    }

    const Document& document_;
    const Measures& measures_;
    std::uint32_t count_;
    std::vector<std::uint32_t>
        owner_;  // entity with the length that an entity without components shares; kNoIndex: no length
    std::vector<std::uint32_t> rank_;   // its number among the sharing entities, from 1
    std::vector<std::uint32_t> parts_;  // number of sharing entities, by owner
    Nodes nodes_;
};

}  // namespace

Nodes nodes_of_lengths(const Document& document, const Measures& measures) {
    return Laying(document, measures).take();
}

}  // namespace coppice::mtg
