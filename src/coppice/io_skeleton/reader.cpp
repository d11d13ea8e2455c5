#include "coppice/io_skeleton/reader.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <set>
#include <span>
#include <utility>

#include <fmt/format.h>

#include "coppice/base/check_fields.h"
#include "coppice/base/error.h"
#include "coppice/base/option_fields.h"
#include "coppice/io/text.h"
#include "coppice/io/unread_format.h"
#include "coppice/io_skeleton/parsers_internal.h"
#include "coppice/system/file.h"

namespace coppice {

namespace {

SkeletonFormat detect(std::string_view text, const std::string& source) {
    const auto by_content = format_of_content(text);
    // These contents are unambiguous; the extension of the file may be wrong.
    if (by_content == SkeletonFormat::ply || by_content == SkeletonFormat::mat) return *by_content;
    const auto by_extension = format_of_extension(source);
    // MATLAB writes .mat as HDF5 too; the reader of .mat explains how to save it.
    if (const auto unread = unread_format(text); unread && by_extension != SkeletonFormat::mat)
        throw Unsupported(fmt::format("{}: it is {}", source, *unread));
    // Programs use .csv for any comma-separated text.
    if (by_extension && !(by_extension == SkeletonFormat::cylinders && by_content)) return *by_extension;
    if (by_content) return *by_content;
    if (by_extension) return *by_extension;
    throw Unsupported(fmt::format(
        "{}: neither its name nor its first line is that of a skeleton file; supported are SWC, cylinder "
        "tables, TreeQSM .mat, raycloudtools trees, edge PLY, GEL graphs, OBJ lines, RSML, MTG and JSON",
        source));
}

/// Returns the decimal number nearest to the float: 0.001f is not 0.001, and positions have enough digits for
/// the difference to matter.
double exact_scale(float scale) { return parse_number(fmt::format("{}", scale)).value_or(scale); }

/// Returns whether the nodes have the SWC types of a neuron, a soma (1) with axons and dendrites (2 to 4),
/// and the size would be too large for a tree in metres: trees are written with such types too.
bool is_neuron(const RawSkeleton& raw) {
    constexpr double kTallestTree = 130;
    Vec3d low = raw.nodes.empty() ? Vec3d{} : raw.nodes.front().position, high = low;
    for (const RawNode& n : raw.nodes) {
        low = {std::min(low.x, n.position.x), std::min(low.y, n.position.y), std::min(low.z, n.position.z)};
        high = {std::max(high.x, n.position.x), std::max(high.y, n.position.y),
                std::max(high.z, n.position.z)};
    }
    const Vec3d size = high - low;
    if (!(std::max({size.x, size.y, size.z}) > kTallestTree)) return false;
    bool soma = false, neurites = false;
    for (const RawAttribute& a : raw.attributes) {
        if (a.name != kSwcType) continue;
        for (const double type : a.values) {
            soma = soma || type == 1;
            neurites = neurites || (type >= 2 && type <= 4);
        }
    }
    return soma && neurites;
}

/// Returns the values of the source nodes if all are finite.
std::optional<std::vector<float>> convert_values(const RawAttribute& attribute,
                                                 std::span<const std::uint32_t> sources) {
    std::vector<float> out;
    out.reserve(sources.size());
    for (const std::uint32_t i : sources) {
        out.push_back(static_cast<float>(attribute.values[i]));
        if (!std::isfinite(out.back())) return std::nullopt;
    }
    return out;
}

/// Returns the first attribute of each name that every node has.
std::vector<NodeAttribute> kept_attributes(std::span<const RawAttribute> attributes,
                                           std::span<const std::uint32_t> sources) {
    std::vector<NodeAttribute> kept;
    std::set<std::string_view> names;
    for (const RawAttribute& a : attributes) {
        if (names.contains(a.name)) continue;
        auto values = convert_values(a, sources);
        if (!values) continue;
        names.insert(a.name);
        kept.push_back({a.name, *std::move(values)});
    }
    return kept;
}

/// Returns the SWC ids of the nodes; nullopt if they are 1, 2, 3 and so on, which written files have anyway,
/// or if an attribute cannot represent them.
std::optional<NodeAttribute> swc_ids(std::span<const RawNode> nodes, std::span<const std::uint32_t> sources) {
    NodeAttribute out{std::string(kSwcId), {}};
    out.values.reserve(sources.size());
    bool counted = true;
    for (const std::uint32_t i : sources) {
        const std::int64_t id = nodes[i].id;
        if (id < 1 || id > std::int64_t{kMaxSwcId}) return std::nullopt;
        out.values.push_back(static_cast<float>(id));
        counted = counted && id == static_cast<std::int64_t>(out.values.size());
    }
    return counted ? std::nullopt : std::optional(std::move(out));
}

CylinderTotals compute_totals(const std::vector<RawCylinder>& cylinders) {
    CylinderTotals sum;
    for (const RawCylinder& c : cylinders) {
        const double length = distance(c.start, c.end);
        if (!std::isfinite(length) || !std::isfinite(c.radius)) continue;
        ++sum.cylinders;
        sum.length += length;
        sum.area += 2 * std::numbers::pi * c.radius * length;
        sum.volume += std::numbers::pi * c.radius * c.radius * length;
    }
    return sum;
}

class Reading {
  public:
    Reading(SkeletonFormat format, const std::string& source, const ReadSkeletonOptions& options,
            const Context& ctx)
        : format_(format),
          source_(source),
          options_(options),
          ctx_(ctx),
          scale_(exact_scale(options.scale)) {}

    SkeletonFile from_text(std::string_view text) {
        units_ = options_.units;
        if (units_ == LengthUnit::automatic && options_.scale == 1)
            units_ = stated_unit(text).value_or(LengthUnit::automatic);
        switch (format_) {
            case SkeletonFormat::swc:
                return finish(parse_swc(text, source_, ctx_));
            case SkeletonFormat::cylinders:
                return finish(parse_cylinders(text, source_, options_.model, ctx_));
            case SkeletonFormat::raycloud:
                return finish(parse_raycloud(text, source_, ctx_));
            case SkeletonFormat::ply:
                return finish(parse_edge_ply(text, source_, ctx_));
            case SkeletonFormat::gel:
                return finish(parse_gel(text, source_, ctx_));
            case SkeletonFormat::obj:
                return finish(parse_obj_lines(text, source_, ctx_));
            case SkeletonFormat::json:
                if (auto cylinders = parse_treegraph(text, source_, ctx_))
                    return finish(*std::move(cylinders));
                return finish(parse_skeleton_json(text, source_, ctx_));
            case SkeletonFormat::rsml:
                return finish(parse_rsml(text, source_, ctx_));
            case SkeletonFormat::mtg:
                return finish(parse_mtg(text, source_, ctx_));
            case SkeletonFormat::mat:
                return finish(parse_mat(text, source_, options_.model, ctx_));
            case SkeletonFormat::automatic:
                break;
        }
        assertion_failed("the format is known", __FILE__, __LINE__);
    }

  private:
    SkeletonFile finish(RawCylinders raw) {
        notes_ = std::move(raw.notes);
        models_ = raw.models;
        for (RawCylinder& c : raw.cylinders) {
            c.start = placed(c.start);
            c.end = placed(c.end);
            c.radius *= scale_;
        }
        fill_radii(raw.cylinders);
        RepairResult result = repaired(raw.cylinders);
        auto attributes = kept_attributes(raw.attributes, result.source);
        SkeletonFile file = make_file(std::move(result), std::move(attributes));
        file.declared = compute_totals(raw.cylinders);
        return file;
    }

    SkeletonFile finish(std::vector<RawNode> nodes) { return finish(RawSkeleton{std::move(nodes), {}, {}}); }

    SkeletonFile finish(RawSkeleton raw) {
        notes_ = std::move(raw.notes);
        if (format_ == SkeletonFormat::swc) take_neuron_units(raw);
        scale(raw.nodes);
        RepairResult result = repaired(raw.nodes);
        auto attributes = kept_attributes(raw.attributes, result.source);
        if (format_ == SkeletonFormat::swc) {
            if (auto ids = swc_ids(raw.nodes, result.source)) attributes.push_back(*std::move(ids));
        }
        return make_file(std::move(result), std::move(attributes));
    }

    SkeletonFile finish(EdgeGraph graph) {
        // Roots may have been chosen as the lowest ends.
        for (Vec3d& p : graph.position) p = placed(p);
        for (double& radius : graph.radius) radius *= scale_;
        Forest forest = make_forest(graph, source_);
        if (forest.loops_cut > 0) {
            notes_.push_back(fmt::format("{} edges that closed loops were omitted", forest.loops_cut));
        }
        fill_radii(forest.nodes);
        RepairResult result = repaired(forest.nodes);
        std::vector<std::uint32_t> vertex;  // by node
        for (const std::uint32_t i : result.source)
            vertex.push_back(static_cast<std::uint32_t>(forest.nodes[i].id));
        return make_file(std::move(result), kept_attributes(graph.attributes, vertex));
    }

    /// The unit of SWC is the micrometre, but trees in metres are written without types.
    void take_neuron_units(const RawSkeleton& raw) {
        if (units_ != LengthUnit::automatic || options_.scale != 1 || !is_neuron(raw)) return;
        units_ = LengthUnit::um;
        notes_.push_back(
            "the types of its nodes are those of a neuron, and it is too large for a tree: lengths are "
            "assumed to be in um; set units to m if they are in metres");
    }

    void scale(std::vector<RawNode>& nodes) {
        for (RawNode& n : nodes) {
            n.position = placed(n.position);
            n.radius *= scale_;
        }
        fill_radii(nodes);
    }

    Vec3d placed(Vec3d p) const { return from_file(p * scale_, options_.up); }

    template <class Raw>
    void fill_radii(std::vector<Raw>& items) {
        if (std::any_of(items.begin(), items.end(), [](const Raw& item) { return item.radius > 0; })) return;
        if (options_.default_radius > 0) {
            for (Raw& item : items) item.radius = options_.default_radius;
        } else {
            notes_.push_back(
                "the file has no radii: 1 % of its size was used; set default_radius for another radius");
        }
    }

    template <class Raw>
    RepairResult repaired(const std::vector<Raw>& items) const {
        if (options_.model > 1 && models_ == 1) {
            throw InvalidInput(
                fmt::format("{}: there is no model {}; the file contains 1", source_, options_.model));
        }
        ctx_.throw_if_cancelled();
        return repair(items, source_);
    }

    SkeletonFile make_file(RepairResult result, std::vector<NodeAttribute> attributes = {}) {
        return {std::move(result.skeleton),
                result.report,
                std::string(name_of(format_)),
                units_ == LengthUnit::automatic ? LengthUnit::m : units_,
                std::move(notes_),
                std::move(attributes),
                std::nullopt,
                models_};
    }

    SkeletonFormat format_;
    const std::string& source_;
    const ReadSkeletonOptions& options_;
    const Context& ctx_;
    double scale_;
    LengthUnit units_ = LengthUnit::automatic;
    std::size_t models_ = 1;
    std::vector<std::string> notes_;
};

}  // namespace

std::span<const float> SkeletonFile::attribute(std::string_view name) const {
    const auto found = std::ranges::find(attributes, name, &NodeAttribute::name);
    return found == attributes.end() ? std::span<const float>{} : found->values;
}

SkeletonFile read_skeleton(const std::filesystem::path& path, const ReadSkeletonOptions& options,
                           const Context& ctx) {
    return parse_skeleton(read_file(path, kLargestFile, ctx), path.string(), options, ctx);
}

SkeletonFile parse_skeleton(std::string_view text, const std::string& source,
                            const ReadSkeletonOptions& options, const Context& ctx) {
    check_fields(options, "read");
    const SkeletonFormat format =
        options.format == SkeletonFormat::automatic ? detect(text, source) : options.format;
    return Reading(format, source, options, ctx).from_text(text);
}

void list_fields(ReadSkeletonOptions& options, FieldList& list) {
    list.add(Field{"format", "Format of the skeleton file."}, options.format);
    list.add(common_field("scale",
                          "Factor that converts positions and radii from the units of the file to metres.",
                          Unit::none, 1e-12, 1e12),
             options.scale);
    list.add(common_field("up", "Axis of the file that points up; y for OBJ files from Blender and games."),
             options.up);
    list.add(
        Field{"units",
              "Unit of length after scaling, which labels figures and is stated in written files; automatic "
              "uses the unit stated in the file, otherwise um for large neurons and m for others."},
        options.units);
    list.add(
        Field{"model",
              "Number of the model to read from a file with several, counted from 1; 0 reads the only one.",
              Unit::none, 0, 1e6},
        options.model);
    list.add(Field{"default_radius", "Radius of all nodes if the file has none; 0 estimates it.", Unit::metre,
                   0, 1e6},
             options.default_radius);
}

}  // namespace coppice
