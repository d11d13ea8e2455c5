#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <span>
#include <tuple>
#include <utility>

#include <fmt/format.h>

#include "coppice/base/error.h"
#include "coppice/base/id.h"
#include "coppice/io_skeleton/node_attribute.h"
#include "coppice/io_skeleton/parsers_internal.h"
#include "coppice/io_skeleton/rsml/attach_internal.h"
#include "coppice/io_skeleton/rsml/document_internal.h"
#include "coppice/io_skeleton/rsml/units_internal.h"

namespace coppice {

namespace {

using rsml::Document;
using rsml::Domain;
using rsml::Function;
using rsml::kUnknown;
using rsml::LinePlace;
using rsml::Root;

/// Returns for each root its closest ancestor that has points; kNoIndex for the first ones.
std::vector<std::uint32_t> bearers(const Document& document) {
    std::vector<std::uint32_t> bearer(document.roots.size(), kNoIndex);
    for (std::size_t i = 0; i < bearer.size(); ++i) {
        const std::uint32_t parent = document.roots[i].parent;
        if (parent != kNoIndex) bearer[i] = document.roots[parent].point_count > 0 ? parent : bearer[parent];
    }
    return bearer;
}

/// Returns the distance along a root from its first point, for each of its points.
std::vector<double> distances_along(const Document& document, const Root& root) {
    std::vector<double> along(root.point_count, 0);
    for (std::uint32_t i = 1; i < root.point_count; ++i) {
        const Vec3d* p = &document.points[root.first_point + i];
        along[i] = along[i - 1] + distance(p[0], p[-1]);
    }
    return along;
}

using PlacedSample = std::pair<double, double>;  // distance from the first point, value

/// Returns the samples of a function that are not at points, sorted by distance; `length` is that of the
/// root.
std::vector<PlacedSample> placed_samples(const Document& document, const Function& function, double length) {
    std::vector<PlacedSample> placed;
    for (std::uint32_t i = 0; i < function.sample_count; ++i) {
        const rsml::Sample& sample = document.samples[function.first_sample + i];
        double place = sample.place;
        if (function.domain == Domain::uniform) {
            place = function.sample_count > 1 ? length * i / (function.sample_count - 1) : 0;
        }
        if (std::isfinite(place) && std::isfinite(sample.value)) {
            placed.emplace_back(function.from_tip ? length - place : place, sample.value);
        }
    }
    std::ranges::stable_sort(placed, {}, &PlacedSample::first);
    return placed;
}

/// Returns the value of a function at every point of its root; NaN if undefined.
std::vector<double> values_at_points(const Document& document, const Function& function) {
    const Root& root = document.roots[function.root];
    std::vector<double> values(root.point_count, kUnknown);
    if (function.domain == Domain::polyline) {
        for (std::uint32_t i = 0; i < std::min(root.point_count, function.sample_count); ++i) {
            values[i] = document.samples[function.first_sample + i].value;
        }
        if (function.from_tip) std::ranges::reverse(values);
        return values;
    }
    if (root.point_count == 0) return values;
    const std::vector<double> along = distances_along(document, root);
    const std::vector<PlacedSample> placed = placed_samples(document, function, along.back());
    if (placed.empty()) return values;
    std::size_t next = 0;
    for (std::uint32_t i = 0; i < root.point_count; ++i) {
        while (next < placed.size() && placed[next].first < along[i]) ++next;
        if (next == 0 || next == placed.size()) {
            values[i] = placed[next == 0 ? 0 : next - 1].second;
            continue;
        }
        const auto& [x0, y0] = placed[next - 1];
        const auto& [x1, y1] = placed[next];
        values[i] = y0 + (y1 - y0) * (along[i] - x0) / (x1 - x0);
    }
    return values;
}

/// Quantities of a file at its points.
class Quantities {
  public:
    explicit Quantities(const Document& document)
        : radius(document.points.size(), kUnknown), by_name_(document.names.size()) {
        const std::vector<bool> kept = names_kept(document);
        for (const Root& root : document.roots) {
            std::fill_n(radius.begin() + root.first_point, root.point_count, root.diameter / 2);
        }
        for (const Function& function : document.functions) {
            const std::string& name = document.names[function.name];
            const bool diameter = name == "diameter" || name == "diameters" || name == "diam";
            if (!diameter && name != "radius" && name != "radii" && !kept[function.name]) continue;
            const std::vector<double> values = values_at_points(document, function);
            auto& column = kept[function.name] ? by_name_[function.name] : radius;
            column.resize(document.points.size(), kUnknown);
            for (std::size_t i = 0; i < values.size(); ++i) {
                if (!std::isfinite(values[i])) continue;
                column[document.roots[function.root].first_point + i] = diameter ? values[i] / 2 : values[i];
            }
        }
        for (std::size_t i = 0; i < by_name_.size(); ++i) {
            if (by_name_[i].empty()) continue;
            names.push_back(document.names[i]);
            columns.push_back(std::move(by_name_[i]));
        }
    }

    std::vector<double> radius;  ///< in pixels
    std::vector<std::string> names;
    std::vector<std::vector<double>> columns;

  private:
    /// Selects the names that become attributes: those with at least as many samples as there are points, so
    /// that the memory is proportional to the size of the file.
    static std::vector<bool> names_kept(const Document& document) {
        std::vector<std::size_t> samples(document.names.size(), 0);
        for (const Function& f : document.functions) samples[f.name] += f.sample_count;
        std::vector<bool> kept(document.names.size());
        for (std::size_t i = 0; i < kept.size(); ++i) {
            const std::string& name = document.names[i];
            const bool is_radius =
                name == "diameter" || name == "diameters" || name == "diam" || name == "radii";
            kept[i] = !is_radius && is_attribute_name(name) && samples[i] >= document.points.size();
        }
        return kept;
    }

    std::vector<std::vector<double>> by_name_;
};

/// A root that branches off another one within a segment or at a point.
struct Fork {
    LinePlace place;
    std::uint32_t root;
};

class SkeletonBuilder {
  public:
    SkeletonBuilder(const Document& document, std::vector<std::string>& notes)
        : document_(document),
          quantities_(document),
          bearer_(bearers(document)),
          start_(document.roots.size(), kNoIndex),
          merged_(document.roots.size()),
          forks_(document.roots.size()),
          values_(quantities_.columns.size()) {
        place_forks();
        const rsml::Upright upright(document, notes);
        const double scale = rsml::metres_per_pixel(document, notes);
        for (std::uint32_t i = 0; i < document.roots.size(); ++i) add_root(i);
        for (RawNode& n : raw_.nodes) {
            n.position = scale * upright(n.position);
            n.radius *= scale;
        }
    }

    RawSkeleton take() {
        for (std::size_t i = 0; i < quantities_.names.size(); ++i) {
            raw_.attributes.push_back({quantities_.names[i], std::move(values_[i])});
        }
        raw_.attributes.push_back({std::string(kOrderOfNode), std::move(order_)});
        raw_.attributes.push_back({std::string(kAxisOfNode), std::move(axis_)});
        return std::move(raw_);
    }

  private:
    void place_forks() {
        const std::vector<LinePlace> places = rsml::attach_roots(document_, bearer_);
        for (std::uint32_t i = 0; i < places.size(); ++i) {
            const Root& root = document_.roots[i];
            if (bearer_[i] == kNoIndex || root.point_count == 0) continue;
            const Root& bearer = document_.roots[bearer_[i]];
            LinePlace place = places[i];
            const Vec3d* at = &document_.points[bearer.first_point + place.point];
            const Vec3d foot = place.t > 0 ? at[0] + place.t * (at[1] - at[0]) : at[0];
            const Vec3d to = document_.points[root.first_point];
            merged_[i] = distance(foot, to) <= kOnLine * segment_length(bearer, place.point);
            const double snap = merged_[i] ? kOnLine : kNearPoint;
            if (place.t > 1 - snap) place = {place.point + 1, 0};
            if (place.t < snap) place.t = 0;
            forks_[bearer_[i]].push_back({place, i});
        }
        for (auto& forks : forks_) {
            std::ranges::stable_sort(forks, [](const Fork& a, const Fork& b) {
                return std::tie(a.place.point, a.place.t) < std::tie(b.place.point, b.place.t);
            });
        }
    }

    /// Returns the length of the segment that begins at a point; for the last point, of the segment that ends
    /// there.
    double segment_length(const Root& root, std::uint32_t point) const {
        if (root.point_count == 1) return 0;
        const Vec3d* at = &document_.points[root.first_point + std::min(point, root.point_count - 2)];
        return distance(at[0], at[1]);
    }

    void add_root(std::uint32_t index) {
        const Root& root = document_.roots[index];
        if (root.point_count == 0) return;
        std::uint32_t last = bearer_[index] == kNoIndex ? shared_start(index) : start_[index];
        auto fork = forks_[index].begin();
        for (std::uint32_t i = 0; i < root.point_count; ++i) {
            const std::uint32_t point = root.first_point + i;
            if (i > 0 || !merged_[index]) last = add_node(index, last, document_.points[point], point, 0);
            if (i == 0 && bearer_[index] == kNoIndex) first_of_plant_.try_emplace(plant_place(index), last);
            double t = 0;
            for (; fork != forks_[index].end() && fork->place.point == i; ++fork) {
                if (fork->place.t > t + kOnLine) {
                    t = fork->place.t;
                    last = add_node(index, last, get_position(*fork), point, t);
                }
                start_[fork->root] = last;
            }
        }
    }

    /// Roots of a plant that begin at the same point form one tree.
    std::uint32_t shared_start(std::uint32_t index) {
        const auto known = first_of_plant_.find(plant_place(index));
        merged_[index] = known != first_of_plant_.end();
        return merged_[index] ? known->second : kNoIndex;
    }

    using PlantPlace = std::tuple<std::uint32_t, double, double, double>;
    PlantPlace plant_place(std::uint32_t index) const {
        const Root& root = document_.roots[index];
        const Vec3d p = document_.points[root.first_point];
        return {root.plant, p.x, p.y, p.z};
    }

    /// Returns the position at which a root branches off a segment: its first point if that is on the
    /// segment.
    Vec3d get_position(const Fork& fork) const {
        const Root& root = document_.roots[fork.root];
        if (merged_[fork.root]) return document_.points[root.first_point];
        const Vec3d* at =
            &document_.points[document_.roots[bearer_[fork.root]].first_point + fork.place.point];
        return at[0] + fork.place.t * (at[1] - at[0]);
    }

    /// Adds a node at parameter `t` between a point of the file and the next one.
    std::uint32_t add_node(std::uint32_t root, std::uint32_t parent, Vec3d position, std::uint32_t point,
                           double t) {
        const auto id = static_cast<std::uint32_t>(raw_.nodes.size());
        const auto value = [&](const std::vector<double>& column) {
            return t > 0 ? column[point] + t * (column[point + 1] - column[point]) : column[point];
        };
        raw_.nodes.push_back({id, parent == kNoIndex ? -1 : std::int64_t{parent}, position,
                              value(quantities_.radius), document_.lines[point]});
        for (std::size_t i = 0; i < values_.size(); ++i) values_[i].push_back(value(quantities_.columns[i]));
        order_.push_back(document_.roots[root].order);
        axis_.push_back(root);
        return id;
    }

    static constexpr double kOnLine = 1e-3;    // [segment length] tolerance within which positions coincide
    static constexpr double kNearPoint = 0.1;  // [segment length] minimum distance of an added node to others

    const Document& document_;
    Quantities quantities_;
    std::vector<std::uint32_t> bearer_;
    std::vector<std::uint32_t> start_;      // node at which a root branches off
    std::vector<bool> merged_;              // whether its first point coincides with that node
    std::vector<std::vector<Fork>> forks_;  // by parent root
    std::map<PlantPlace, std::uint32_t> first_of_plant_;
    RawSkeleton raw_;
    std::vector<std::vector<double>> values_;  // values of the nodes, by quantity
    std::vector<double> order_, axis_;
};

}  // namespace

RawSkeleton parse_rsml(std::string_view text, const std::string& source, const Context& ctx) {
    const Document document = rsml::parse_document(text, source, ctx);
    if (document.points.empty()) {
        throw InvalidInput(
            fmt::format("{}: there are no nodes: no root of a plant has a polyline with points", source));
    }
    std::vector<std::string> notes;
    RawSkeleton raw = SkeletonBuilder(document, notes).take();
    raw.notes = std::move(notes);
    put_in_written_order(raw);
    return raw;
}

}  // namespace coppice
