#include "coppice/io/skeleton/writer.h"

#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <iterator>
#include <vector>

#include <fmt/compile.h>
#include <fmt/format.h>

#include "coppice/base/error.h"
#include "coppice/io/file.h"
#include "coppice/io/file_progress.h"
#include "coppice/io/skeleton/parsers_internal.h"

namespace coppice {

namespace {

/// Text of a skeleton: numbers in world space.
class Encoder {
  public:
    Encoder(const Skeleton& skeleton, const Context& ctx)
        : skeleton_(skeleton), progress_({.stop = ctx.stop}, 0), is_local_(skeleton.origin() == Vec3d{}) {}

    template <class Format, class... Args>
    void add(const Format& format, const Args&... args) {
        progress_.at(text_.size());
        fmt::format_to(std::back_inserter(text_), format, args...);
    }

    /// x, y and z of a node with `separator` between them.
    void add_position(NodeId n, char separator) {
        const Vec3 p = skeleton_.position(n);
        if (is_local_) {
            add(FMT_COMPILE("{}{}{}{}{}"), p.x, separator, p.y, separator, p.z);
        } else {
            const Vec3d world = skeleton_.origin() + Vec3d(p);
            add(FMT_COMPILE("{:.15g}{}{:.15g}{}{:.15g}"), world.x, separator, world.y, separator, world.z);
        }
    }

    template <class T>
    void add_bytes(T value) {
        static_assert(std::endian::native == std::endian::little, "binary PLY is written little-endian");
        progress_.at(text_.size());
        char bytes[sizeof(T)];
        std::memcpy(bytes, &value, sizeof(T));
        text_.append(bytes, bytes + sizeof(T));
    }

    bool is_local() const { return is_local_; }
    std::string text() const { return {text_.data(), text_.size()}; }

  private:
    const Skeleton& skeleton_;
    FileProgress progress_;
    bool is_local_;
    fmt::memory_buffer text_;
};

std::string encode_swc(const Skeleton& s, const Context& ctx) {
    Encoder out(s, ctx);
    out.add(FMT_COMPILE("# SWC written by Coppice; units: metre\n# id type x y z radius parent\n"));
    for (const NodeId n : nodes(s)) {
        out.add(FMT_COMPILE("{} 0 "), n.index() + 1);
        out.add_position(n, ' ');
        if (s.is_root(n)) {
            out.add(FMT_COMPILE(" {} -1\n"), s.radius(n));
        } else {
            out.add(FMT_COMPILE(" {} {}\n"), s.radius(n), s.parent(n).index() + 1);
        }
    }
    return out.text();
}

std::string encode_obj(const Skeleton& s, const Context& ctx) {
    Encoder out(s, ctx);
    out.add(FMT_COMPILE("# {}\n"), kDirectedMark);
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

std::string encode_json(const Skeleton& s, std::span<const NodeAttribute> attributes, const Context& ctx) {
    Encoder out(s, ctx);
    const Vec3d origin = s.origin();
    out.add(FMT_COMPILE("{{\n\"format\": \"coppice-skeleton\",\n\"version\": 1,\n\"origin\": [{}, {}, "
                        "{}],\n\"parent\": ["),
            origin.x, origin.y, origin.z);
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

std::string encode_ply(const Skeleton& s, bool binary, std::span<const NodeAttribute> attributes,
                       const Context& ctx) {
    Encoder out(s, ctx);
    out.add(FMT_COMPILE("ply\nformat {} 1.0\ncomment {}\n"), binary ? "binary_little_endian" : "ascii",
            kDirectedMark);
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

/// What a cylinder list says of the place of a cylinder in its tree.
struct CylinderPlace {
    std::int64_t id = -1;       ///< -1 for roots, which have no cylinder
    std::uint32_t order = 0;    ///< how many times the way from the root left the thickest child
    std::int64_t branch = -1;   ///< axis of cylinders that follow the thickest child
    std::int64_t segment = -1;  ///< run of cylinders between two forks
};

std::vector<CylinderPlace> cylinder_places(const Skeleton& s) {
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
    return place;
}

std::string encode_cylinders(const Skeleton& s, const Context& ctx) {
    if (s.size() == s.tree_count()) {
        throw Unsupported(
            "the skeleton has no segments, so there are no cylinders to write; choose another format");
    }
    const std::vector<CylinderPlace> place = cylinder_places(s);
    Encoder out(s, ctx);
    out.add(FMT_COMPILE(
        "ID,parentID,startX,startY,startZ,endX,endY,endZ,radius,length,branchOrder,branchID,segmentID,"
        "parentSegmentID\n"));
    for (const NodeId n : nodes(s)) {
        if (s.is_root(n)) continue;
        const CylinderPlace &here = place[n.index()], &below = place[s.parent(n).index()];
        const Segment segment = s.segment(n);
        const double a = segment.radius_a, b = segment.radius_b;
        out.add(FMT_COMPILE("{},{},"), here.id, below.id);
        out.add_position(s.parent(n), ',');
        out.add(FMT_COMPILE(","));
        out.add_position(n, ',');
        out.add(FMT_COMPILE(",{},{},{},{},{},{}\n"),
                static_cast<float>(std::sqrt((a * a + a * b + b * b) / 3)), distance(segment.a, segment.b),
                here.order, here.branch, here.segment, below.segment);
    }
    return out.text();
}

}  // namespace

std::string encode_skeleton(const Skeleton& skeleton, const WriteSkeletonOptions& options,
                            std::span<const NodeAttribute> attributes, const Context& ctx) {
    for (const NodeAttribute& a : attributes) COPPICE_ASSERT(a.values.size() == skeleton.size());
    switch (options.format) {
        case SkeletonFormat::swc:
            return encode_swc(skeleton, ctx);
        case SkeletonFormat::cylinders:
            return encode_cylinders(skeleton, ctx);
        case SkeletonFormat::ply:
            return encode_ply(skeleton, options.binary, attributes, ctx);
        case SkeletonFormat::obj:
            return encode_obj(skeleton, ctx);
        case SkeletonFormat::json:
            return encode_json(skeleton, attributes, ctx);
        case SkeletonFormat::automatic:
        case SkeletonFormat::mat:
        case SkeletonFormat::raycloud:
        case SkeletonFormat::gel:
            break;
    }
    throw Unsupported(fmt::format("skeletons are not written as {}; choose swc, cylinders, ply, obj or json",
                                  name_of(options.format)));
}

void write_skeleton(const std::filesystem::path& path, const Skeleton& skeleton,
                    const WriteSkeletonOptions& options, std::span<const NodeAttribute> attributes,
                    const Context& ctx) {
    WriteSkeletonOptions chosen = options;
    if (chosen.format == SkeletonFormat::automatic) {
        const auto format = format_of_extension(path);
        if (!format) {
            throw Unsupported(fmt::format(
                "{}: the ending of the name tells no skeleton format; use .swc, .csv, .ply, .obj or .json",
                path.string()));
        }
        chosen.format = *format;
    }
    const std::string bytes = encode_skeleton(skeleton, chosen, attributes, ctx);
    write_file(path, bytes);
}

}  // namespace coppice
