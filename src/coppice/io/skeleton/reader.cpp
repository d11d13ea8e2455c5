#include "coppice/io/skeleton/reader.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <utility>

#include <fmt/format.h>

#include "coppice/base/check_fields.h"
#include "coppice/base/error.h"
#include "coppice/io/file.h"
#include "coppice/io/skeleton/parsers_internal.h"
#include "coppice/io/text_internal.h"

namespace coppice {

namespace {

SkeletonFormat detect(std::string_view text, const std::string& source) {
    const auto by_content = format_of_content(text);
    // These say what they are; the name of the file may be wrong.
    if (by_content == SkeletonFormat::ply || by_content == SkeletonFormat::mat) return *by_content;
    const auto by_extension = format_of_extension(source);
    // Tables are called .csv by all programs that write comma-separated text.
    if (by_extension && !(by_extension == SkeletonFormat::cylinders && by_content)) return *by_extension;
    if (by_content) return *by_content;
    if (by_extension) return *by_extension;
    throw Unsupported(fmt::format(
        "{}: this is no skeleton file that can be told from its name or first line; known are SWC, cylinder "
        "tables, TreeQSM .mat, raycloudtools trees, edge PLY, GEL graphs, OBJ lines and JSON",
        source));
}

/// The decimal number that was meant: 0.001f is not 0.001, and positions have the digits to show it.
double exact_scale(float scale) { return parse_number(fmt::format("{}", scale)).value_or(scale); }

/// The values of the nodes that the sources name, if all are finite.
std::optional<std::vector<float>> values_of(const RawAttribute& attribute, const std::vector<RawNode>& nodes,
                                            std::span<const std::uint32_t> sources) {
    std::vector<float> out;
    out.reserve(sources.size());
    for (const std::uint32_t i : sources) {
        out.push_back(static_cast<float>(attribute.values[static_cast<std::size_t>(nodes[i].id)]));
        if (!std::isfinite(out.back())) return std::nullopt;
    }
    return out;
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
        switch (format_) {
            case SkeletonFormat::swc:
                return finish(parse_swc(text, source_, ctx_));
            case SkeletonFormat::cylinders:
                return finish(parse_cylinders(text, source_, ctx_));
            case SkeletonFormat::raycloud:
                return finish(parse_raycloud(text, source_, ctx_));
            case SkeletonFormat::ply:
                return finish(parse_edge_ply(text, source_, ctx_));
            case SkeletonFormat::gel:
                return finish(parse_gel(text, source_, ctx_));
            case SkeletonFormat::obj:
                return finish(parse_obj_lines(text, source_, ctx_));
            case SkeletonFormat::json:
                return finish_json(parse_skeleton_json(text, source_, ctx_));
            case SkeletonFormat::mat:
                return finish(parse_mat(text, source_, options_.model, ctx_));
            case SkeletonFormat::automatic:
                break;
        }
        assertion_failed("the format is known", __FILE__, __LINE__);
    }

  private:
    SkeletonFile finish(std::vector<RawCylinder> cylinders) {
        for (RawCylinder& c : cylinders) {
            c.start *= scale_;
            c.end *= scale_;
            c.radius *= scale_;
        }
        fill_radii(cylinders);
        return file_of(repaired(cylinders));
    }

    SkeletonFile finish(std::vector<RawNode> nodes, std::span<const RawAttribute> attributes = {}) {
        for (RawNode& n : nodes) {
            n.position *= scale_;
            n.radius *= scale_;
        }
        fill_radii(nodes);
        RepairResult result = repaired(nodes);
        std::vector<NodeAttribute> kept;
        for (const RawAttribute& a : attributes) {
            const bool is_new = std::ranges::find(kept, a.name, &NodeAttribute::name) == kept.end();
            auto values = values_of(a, nodes, result.source);
            if (is_new && values) kept.push_back({a.name, *std::move(values)});
        }
        return file_of(std::move(result), std::move(kept));
    }

    SkeletonFile finish_json(RawSkeleton raw) { return finish(std::move(raw.nodes), raw.attributes); }

    SkeletonFile finish(const EdgeGraph& graph) {
        Forest forest = forest_of(graph, source_);
        if (forest.loops_cut > 0) {
            notes_.push_back(fmt::format("{} edges that closed loops were left out", forest.loops_cut));
        }
        return finish(std::move(forest.nodes), graph.attributes);
    }

    template <class Raw>
    void fill_radii(std::vector<Raw>& items) {
        if (std::any_of(items.begin(), items.end(), [](const Raw& item) { return item.radius > 0; })) return;
        if (options_.default_radius > 0) {
            for (Raw& item : items) item.radius = options_.default_radius;
        } else {
            notes_.push_back(
                "the file has no radii: 1 % of its size was taken; set default_radius for another one");
        }
    }

    template <class Raw>
    RepairResult repaired(const std::vector<Raw>& items) const {
        if (options_.model > 1 && format_ != SkeletonFormat::mat) {
            throw InvalidInput(
                fmt::format("{}: there is no model {}; the file holds 1", source_, options_.model));
        }
        ctx_.throw_if_cancelled();
        return repair(items, source_);
    }

    SkeletonFile file_of(RepairResult result, std::vector<NodeAttribute> attributes = {}) {
        return {std::move(result.skeleton), result.report, std::string(name_of(format_)), std::move(notes_),
                std::move(attributes)};
    }

    SkeletonFormat format_;
    const std::string& source_;
    const ReadSkeletonOptions& options_;
    const Context& ctx_;
    double scale_;
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

}  // namespace coppice
