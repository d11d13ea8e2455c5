#include "chart.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "architecture_options.h"
#include "command.h"
#include "coppice/extract/stem/stem_form.h"
#include "coppice/io_skeleton/stated_axes.h"
#include "coppice/skeleton/architecture.h"
#include "files.h"
#include "options.h"

namespace coppice::cli {

/// Kinds of charts.
enum class ChartKind { taper, orders, diameters, sholl };
/// Quantity shown by the bars of orders and diameter classes.
enum class ChartOf { length, volume };

}  // namespace coppice::cli

namespace coppice {

template <>
struct EnumNames<cli::ChartKind> {
    static constexpr std::array<std::string_view, 4> names{"taper", "orders", "diameters", "sholl"};
};
template <>
struct EnumNames<cli::ChartOf> {
    static constexpr std::array<std::string_view, 2> names{"length", "volume"};
};

}  // namespace coppice

namespace coppice::cli {
namespace {

struct ChartFlags {
    std::filesystem::path kind, output;
    std::vector<std::filesystem::path> files;
    ArchitectureFlags architecture;
    ChartOf of = ChartOf::length;
    int width = 800, height = 500;
    ReadSkeletonOptions read;
    ReadPointsOptions read_points;
};

ChartKind kind_of_chart(const ChartFlags& flags) {
    constexpr auto kNames = EnumNames<ChartKind>::names;
    const auto found = std::ranges::find(kNames, flags.kind.string());
    if (found == kNames.end() || flags.files.empty() || flags.output.empty())
        throw UsageError(
            fmt::format("choose a chart, and name the files: coppice chart {} FILES... -o CHART.svg",
                        fmt::join(kNames, "|")));
    return static_cast<ChartKind>(found - kNames.begin());
}

/// Adds the diameters along the stem; of several trees, those of the highest one.
void add_taper(ChartSeries& series, std::span<const StemForm> forms) {
    const StemForm& form = *std::ranges::max_element(forms, {}, &StemForm::height);
    for (const StemDiameter& d : form.taper) series.values.emplace_back(d.height, d.diameter);
}

double shown(const auto& part, ChartOf of) { return of == ChartOf::length ? part.length : part.volume; }

/// Adds the values of one skeleton.
void add_values(ChartSeries& series, const SkeletonFile& file, ChartKind kind, std::span<const double> limits,
                const ChartFlags& flags) {
    const Skeleton& s = file.skeleton;
    const auto add = [&](double y) {
        series.values.emplace_back(static_cast<double>(series.values.size()), y);
    };
    switch (kind) {
        case ChartKind::taper:
            return add_taper(series, stem_forms(s));
        case ChartKind::orders: {
            const NodeAxes axes = find_axes(file);
            for (const BranchOrder& o : branch_orders(s, axes.order, axes.axis)) add(shown(o, flags.of));
            return;
        }
        case ChartKind::diameters:
            for (const DiameterClass& c : diameter_classes(s, limits)) add(shown(c, flags.of));
            return;
        case ChartKind::sholl: {
            const ShollProfile profile = sholl(s, flags.architecture.sholl_step);
            for (std::size_t k = 0; k < profile.crossings.size(); ++k)
                series.values.emplace_back(profile.step * static_cast<double>(k + 1),
                                           static_cast<double>(profile.crossings[k]));
            return;
        }
    }
}

/// Sets the labels and categories, once the values and their unit are known.
void label(Chart& chart, ChartKind kind, LengthUnit unit, std::span<const double> limits, ChartOf of) {
    const std::string_view u = unit == LengthUnit::um ? "\u00b5m" : name_of(unit);
    const std::string subject =
        of == ChartOf::length ? fmt::format("length [{}]", u) : fmt::format("volume [{}\u00b3]", u);
    chart.y_label = subject;
    if (kind == ChartKind::taper) {
        chart.title = "Stem taper";
        chart.x_label = fmt::format("height [{}]", u);
        chart.y_label = fmt::format("diameter [{}]", u);
    } else if (kind == ChartKind::sholl) {
        chart.title = "Sholl intersections";
        chart.x_label = fmt::format("radius [{}]", u);
        chart.y_label = "crossings";
    } else if (kind == ChartKind::orders) {
        chart.title = "Axes by order";
        chart.x_label = "order of the axis";
        std::size_t most = 0;
        for (const ChartSeries& s : chart.series) most = std::max(most, s.values.size());
        for (std::size_t o = 0; o < most; ++o) chart.categories.push_back(fmt::format("{}", o));
    } else {
        chart.title = "Diameter classes";
        chart.x_label = fmt::format("diameter [{}]", u);
        for (const double limit : limits) chart.categories.push_back(fmt::format("< {:g}", limit));
        chart.categories.push_back(limits.empty() ? "all" : fmt::format("\u2265 {:g}", limits.back()));
    }
}

ExitCode chart(Run& run, const ChartFlags& flags) {
    const ChartKind kind = kind_of_chart(flags);
    if (!is_chart_name(flags.output))
        throw UsageError(fmt::format("'{}' is not the name of a chart; use the extension .svg or .png",
                                     flags.output.string()));
    check_output_folder(flags.output);
    const std::vector<double> limits = flags.architecture.limits();
    Chart chart{.width = flags.width, .height = flags.height};
    std::optional<LengthUnit> unit;
    for (const auto& path : flags.files) {
        ChartSeries series{path.filename().string(), {}};
        LengthUnit of_file = LengthUnit::m;
        if (kind == ChartKind::taper && kind_of_input(run, path, flags.read.format) == FileKind::points) {
            const PointSet points = load_points(run, path, flags.read.up, flags.read_points);
            run.stage("measure", [&](const Context& ctx) {
                const StemForm form = stem_form(points, ctx);
                add_taper(series, {&form, 1});
            });
        } else {
            const SkeletonFile file = load_skeleton(run, path, flags.read);
            of_file = file.units;
            add_values(series, file, kind, limits, flags);
        }
        check_units(unit, path.string(), of_file);
        if (series.values.empty())
            run.warn(fmt::format("{}: it contains no values for this chart", path.string()));
        chart.series.push_back(std::move(series));
    }
    label(chart, kind, *unit, limits, flags.of);
    run.stage("write", [&](const Context&) { write_chart(flags.output, chart); });
    run.counts()["series"] = chart.series.size();
    run.finish(fmt::format("{}: {} of {} file{}", flags.output.string(), flags.kind.string(),
                           grouped(chart.series.size()), chart.series.size() == 1 ? "" : "s"));
    return kDone;
}

}  // namespace

Command chart_command() {
    const auto flags = std::make_shared<ChartFlags>();
    OptionList options;
    options.file("kind", "taper|orders|diameters|sholl", flags->kind, "Kind of chart to draw.");
    options.files("files", "FILES", flags->files,
                  "Skeletons, and for taper also points; each is one line or one set of bars.");
    options.output("-o,--output", "CHART", flags->output, "Chart to write (.svg, .png).");
    options.value({common_field("of", "Quantity shown by the bars of orders and diameter classes."),
                   choice_of(flags->of)});
    add_architecture_options(options, flags->architecture);
    options.value(
        {common_field("width", "Width of the image in pixels.", Unit::none, 200, 16384), &flags->width});
    options.value(
        {common_field("height", "Height of the image in pixels.", Unit::none, 150, 16384), &flags->height});
    options.fields(flags->read, "Reading a skeleton");
    options.fields(flags->read_points, kReadPointsGroup);
    return {"chart", "Draw the taper of stems, axes by order, diameter classes or Sholl intersections.",
            options, [flags](Run& run, const GivenOptions&) { return chart(run, *flags); }};
}

}  // namespace coppice::cli
