#include "coppice/io_skeleton/writer.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include <fmt/compile.h>
#include <fmt/format.h>

#include "coppice/base/error.h"
#include "coppice/base/option_fields.h"
#include "coppice/io_skeleton/encoder_internal.h"
#include "coppice/io_skeleton/parsers_internal.h"
#include "coppice/io_skeleton/writers_internal.h"
#include "coppice/system/file.h"

namespace coppice {

namespace {

/// Returns an attribute if all of its values are integers from 0; otherwise an empty span.
std::span<const float> whole_numbers(std::span<const NodeAttribute> attributes, std::string_view name) {
    constexpr float kMaxExact = 1 << 24;
    const auto found = std::ranges::find(attributes, name, &NodeAttribute::name);
    if (found == attributes.end()) return {};
    const auto is_whole = [](float v) { return v >= 0 && v <= kMaxExact && v == std::trunc(v); };
    return std::ranges::all_of(found->values, is_whole) ? std::span<const float>(found->values)
                                                        : std::span<const float>{};
}

/// Returns the ids of the nodes for SWC: those of the attribute `id`; nodes that have none, or one of an
/// earlier node, are numbered above the maximum. Without the attribute, 1, 2, 3 and so on.
std::vector<std::uint32_t> swc_ids(const Skeleton& s, std::span<const NodeAttribute> attributes) {
    std::vector<std::uint32_t> ids(s.size(), 0);
    std::vector<bool> taken{true};
    const auto found = std::ranges::find(attributes, kSwcId, &NodeAttribute::name);
    if (found != attributes.end()) {
        for (const NodeId n : nodes(s)) {
            const float value = found->values[n.index()];
            if (!(value >= 1 && value <= float{kMaxSwcId}) || value != std::trunc(value)) continue;
            const auto id = static_cast<std::uint32_t>(value);
            if (id >= taken.size()) taken.resize(id + 1);
            if (!taken[id]) ids[n.index()] = id;
            taken[id] = true;
        }
    }
    auto next = static_cast<std::uint32_t>(taken.size());
    for (std::uint32_t& id : ids) {
        if (id == 0) id = next++;
    }
    return ids;
}

/// Returns the unit that files state.
std::string_view unit_name(LengthUnit units) {
    return units == LengthUnit::automatic ? name_of(LengthUnit::m) : name_of(units);
}

std::string encode_swc(const Skeleton& s, LengthUnit units, std::span<const NodeAttribute> attributes,
                       const Context& ctx) {
    const std::span<const float> types = whole_numbers(attributes, kSwcType);
    const std::vector<std::uint32_t> ids = swc_ids(s, attributes);
    Encoder out(s, ctx);
    out.add(FMT_COMPILE("# SWC written by Coppice; units: {}\n# id type x y z radius parent\n"),
            unit_name(units));
    for (const NodeId n : nodes(s)) {
        out.add(FMT_COMPILE("{} {} "), ids[n.index()],
                types.empty() ? 0u : static_cast<std::uint32_t>(types[n.index()]));
        out.add_position(n, ' ');
        if (s.is_root(n)) {
            out.add(FMT_COMPILE(" {} -1\n"), s.radius(n));
        } else {
            out.add(FMT_COMPILE(" {} {}\n"), s.radius(n), ids[s.parent(n).index()]);
        }
    }
    return out.text();
}

std::string encode_obj(const Skeleton& s, LengthUnit units, const Context& ctx) {
    Encoder out(s, ctx);
    out.add(FMT_COMPILE("# {}\n# units: {}\n"), kDirectedMark, unit_name(units));
    for (const NodeId n : nodes(s)) {
        out.add(FMT_COMPILE("v "));
        out.add_position(n, ' ');
        out.add(FMT_COMPILE("\n# radius {}\n"), s.radius(n));
    }
    for (const NodeId n : nodes(s)) {
        if (!s.is_root(n)) {
            out.add(FMT_COMPILE("l {} {}\n"), s.parent(n).index() + 1, n.index() + 1);
        } else if (s.is_tip(n)) {
            out.add(FMT_COMPILE("p {}\n"), n.index() + 1);
        }
    }
    return out.text();
}

std::string encode_json(const Skeleton& s, LengthUnit units, std::span<const NodeAttribute> attributes,
                        const Context& ctx) {
    Encoder out(s, ctx);
    const Vec3d origin = s.origin();
    out.add(FMT_COMPILE("{{\n\"format\": \"coppice-skeleton\",\n\"version\": 1,\n\"units\": \"{}\",\n"
                        "\"origin\": [{}, {}, {}],\n\"parent\": ["),
            unit_name(units), origin.x, origin.y, origin.z);
    const auto separator = [](NodeId n) { return n.index() == 0 ? "" : ","; };
    for (const NodeId n : nodes(s)) {
        out.add(FMT_COMPILE("{}{}"), separator(n), s.is_root(n) ? std::int64_t{-1} : s.parent(n).index());
    }
    out.add(FMT_COMPILE("],\n\"position\": ["));
    for (const NodeId n : nodes(s)) {
        const Vec3 p = s.position(n);
        out.add(FMT_COMPILE("{}\n[{},{},{}]"), separator(n), p.x, p.y, p.z);
    }
    out.add(FMT_COMPILE("],\n\"radius\": ["));
    for (const NodeId n : nodes(s)) out.add(FMT_COMPILE("{}{}"), separator(n), s.radius(n));
    if (!s.stable_ids().empty()) {
        out.add(FMT_COMPILE("],\n\"stable_id\": ["));
        for (const NodeId n : nodes(s)) out.add(FMT_COMPILE("{}{}"), separator(n), s.stable_id(n).index());
    }
    for (const NodeAttribute& a : attributes) {
        out.add(FMT_COMPILE("],\n\"{}\": ["), a.name);
        for (const NodeId n : nodes(s)) out.add(FMT_COMPILE("{}{}"), separator(n), a.values[n.index()]);
    }
    out.add(FMT_COMPILE("]\n}}\n"));
    return out.text();
}

void add_ply_vertices(Encoder& out, const Skeleton& s, bool binary,
                      std::span<const NodeAttribute> attributes) {
    for (const NodeId n : nodes(s)) {
        if (!binary) {
            out.add_position(n, ' ');
            out.add(FMT_COMPILE(" {}"), s.radius(n));
            for (const NodeAttribute& a : attributes) out.add(FMT_COMPILE(" {}"), a.values[n.index()]);
            out.add(FMT_COMPILE("\n"));
            continue;
        }
        const Vec3 p = s.position(n);
        const Vec3d world = s.origin() + Vec3d(p);
        for (int axis = 0; axis < 3; ++axis) {
            if (out.is_local()) {
                out.add_bytes(p[axis]);
            } else {
                out.add_bytes(world[axis]);
            }
        }
        out.add_bytes(s.radius(n));
        for (const NodeAttribute& a : attributes) out.add_bytes(a.values[n.index()]);
    }
}

std::string encode_ply(const Skeleton& s, const WriteSkeletonOptions& options,
                       std::span<const NodeAttribute> attributes, const Context& ctx) {
    const bool binary = options.binary;
    Encoder out(s, ctx);
    out.add(FMT_COMPILE("ply\nformat {} 1.0\ncomment {}\ncomment units: {}\n"),
            binary ? "binary_little_endian" : "ascii", kDirectedMark, unit_name(options.units));
    const std::string_view type = out.is_local() ? "float" : "double";
    out.add(FMT_COMPILE(
                "element vertex {}\nproperty {} x\nproperty {} y\nproperty {} z\nproperty float radius\n"),
            s.size(), type, type, type);
    for (const NodeAttribute& a : attributes) out.add(FMT_COMPILE("property float {}\n"), a.name);
    out.add(FMT_COMPILE("element edge {}\nproperty list uint int vertex_indices\nend_header\n"),
            s.size() - s.tree_count());
    add_ply_vertices(out, s, binary, attributes);
    for (const NodeId n : nodes(s)) {
        if (s.is_root(n)) continue;
        if (binary) {
            for (const std::uint32_t value : {2u, s.parent(n).index(), n.index()}) out.add_bytes(value);
        } else {
            out.add(FMT_COMPILE("2 {} {}\n"), s.parent(n).index(), n.index());
        }
    }
    return out.text();
}

/// Position of a cylinder in its tree, as written in a cylinder list.
struct CylinderPlace {
    std::int64_t id = -1;     ///< -1 for roots, which have no cylinder
    std::uint32_t order = 0;  ///< order of its axis; by default the number of nodes on the path from the root
                              ///< that are not the thickest child
    std::int64_t branch = -1;   ///< axis: cylinders that follow the thickest child
    std::int64_t segment = -1;  ///< segment: cylinders between two forks
};

/// Orders and axes are those of the attributes `order` and `axis` if all are integers.
std::vector<CylinderPlace> cylinder_places(const Skeleton& s, std::span<const NodeAttribute> attributes) {
    const std::span<const float> orders = whole_numbers(attributes, kOrderOfNode);
    const std::span<const float> axes = whole_numbers(attributes, kAxisOfNode);
    std::vector<CylinderPlace> place(s.size());
    std::int64_t cylinders = 0, branches = 0, segments = 0;
    for (const NodeId n : nodes(s)) {
        if (s.is_root(n)) continue;
        const NodeId parent = s.parent(n);
        const CylinderPlace& below = place[parent.index()];
        const bool leads = s.leader(parent) == n;
        CylinderPlace& here = place[n.index()];
        here.id = cylinders++;
        here.order = below.order + (leads ? 0 : 1);
        here.branch = leads && below.branch >= 0 ? below.branch : branches++;
        here.segment = s.children(parent).size() == 1 && below.segment >= 0 ? below.segment : segments++;
    }
    for (const NodeId n : nodes(s)) {
        if (!orders.empty()) place[n.index()].order = static_cast<std::uint32_t>(orders[n.index()]);
        if (!axes.empty()) place[n.index()].branch = static_cast<std::int64_t>(axes[n.index()]);
    }
    return place;
}

std::string encode_cylinders(const Skeleton& s, std::span<const NodeAttribute> attributes,
                             const Context& ctx) {
    if (s.size() == s.tree_count()) {
        throw Unsupported(
            "the skeleton has no segments, so there are no cylinders to write; choose another format");
    }
    const std::vector<CylinderPlace> place = cylinder_places(s, attributes);
    const std::span<const float> trees = whole_numbers(attributes, kTreeOfNode);
    Encoder out(s, ctx);
    out.add(FMT_COMPILE("ID,parentID,startX,startY,startZ,endX,endY,endZ,radius,length,branchOrder,branchID,"
                        "segmentID,parentSegmentID{}\n"),
            trees.empty() ? "" : ",treeID");
    for (const NodeId n : nodes(s)) {
        if (s.is_root(n)) continue;
        const CylinderPlace &here = place[n.index()], &below = place[s.parent(n).index()];
        const Segment segment = s.segment(n);
        const double a = segment.radius_a, b = segment.radius_b;
        out.add(FMT_COMPILE("{},{},"), here.id, below.id);
        out.add_position(s.parent(n), ',');
        out.add(FMT_COMPILE(","));
        out.add_position(n, ',');
        out.add(FMT_COMPILE(",{},{},{},{},{},{}"), static_cast<float>(std::sqrt((a * a + a * b + b * b) / 3)),
                distance(segment.a, segment.b), here.order, here.branch, here.segment, below.segment);
        if (!trees.empty()) out.add(FMT_COMPILE(",{}"), trees[n.index()]);
        out.add(FMT_COMPILE("\n"));
    }
    return out.text();
}

/// Returns the skeleton with the up axis of the file.
Skeleton turned(const Skeleton& s, FileUp up) {
    std::vector<Vec3> positions;
    positions.reserve(s.size());
    for (const Vec3 p : s.positions()) positions.push_back(to_file(p, up));
    return Skeleton({s.parents().begin(), s.parents().end()}, std::move(positions),
                    {s.radii().begin(), s.radii().end()}, to_file(s.origin(), up),
                    {s.stable_ids().begin(), s.stable_ids().end()});
}

}  // namespace

std::string encode_skeleton(const Skeleton& skeleton, const WriteSkeletonOptions& options,
                            std::span<const NodeAttribute> attributes, const Context& ctx) {
    if (skeleton.size() == 0) throw InvalidInput("the skeleton has no nodes");
    if (options.up != FileUp::z) {
        WriteSkeletonOptions in_place = options;
        in_place.up = FileUp::z;
        return encode_skeleton(turned(skeleton, options.up), in_place, attributes, ctx);
    }
    for (const NodeAttribute& a : attributes) COPPICE_ASSERT(a.values.size() == skeleton.size());
    switch (options.format) {
        case SkeletonFormat::swc:
            return encode_swc(skeleton, options.units, attributes, ctx);
        case SkeletonFormat::cylinders:
            return encode_cylinders(skeleton, attributes, ctx);
        case SkeletonFormat::ply:
            return encode_ply(skeleton, options, attributes, ctx);
        case SkeletonFormat::obj:
            return encode_obj(skeleton, options.units, ctx);
        case SkeletonFormat::json:
            return encode_json(skeleton, options.units, attributes, ctx);
        case SkeletonFormat::rsml:
            return encode_rsml(skeleton, unit_name(options.units), attributes, ctx);
        case SkeletonFormat::mtg:
            return encode_mtg(skeleton, unit_name(options.units), attributes, ctx);
        case SkeletonFormat::automatic:
        case SkeletonFormat::mat:
        case SkeletonFormat::raycloud:
        case SkeletonFormat::gel:
            break;
    }
    throw Unsupported(
        fmt::format("skeletons are not written as {}; choose swc, cylinders, ply, obj, json, rsml or mtg",
                    name_of(options.format)));
}

void write_skeleton(const std::filesystem::path& path, const Skeleton& skeleton,
                    const WriteSkeletonOptions& options, std::span<const NodeAttribute> attributes,
                    const Context& ctx) {
    WriteSkeletonOptions chosen = options;
    if (chosen.format == SkeletonFormat::automatic) {
        const auto format = format_of_extension(path);
        if (!format) {
            throw Unsupported(
                fmt::format("{}: the extension is not that of a skeleton format; use .swc, .csv, .ply, .obj, "
                            ".json, .rsml or .mtg",
                            path.string()));
        }
        chosen.format = *format;
    }
    const std::string bytes = encode_skeleton(skeleton, chosen, attributes, ctx);
    write_file(path, bytes);
}

void list_fields(WriteSkeletonOptions& options, FieldList& list) {
    list.add(Field{"format", "Format of the skeleton file; automatic uses the extension of its name."},
             options.format);
    list.add(Field{"binary", "Write PLY as binary instead of ASCII."}, options.binary);
    list.add(Field{"up", "Axis that points up in the written file; .glb and .usda define their own."},
             options.up);
    list.add(Field{"units",
                   "Unit of length, stated in written SWC, JSON, OBJ, PLY, RSML and MTG; lengths are not "
                   "converted."},
             options.units);
}

}  // namespace coppice
