#include <fmt/format.h>

#include "command.h"
#include "coppice/measure/match/skeleton_match.h"
#include "figures.h"
#include "files.h"
#include "options.h"

namespace coppice::cli {
namespace {

struct CompareFlags {
    std::filesystem::path reference, found;
    bool json = false;
    CompareOptions compare;
    ReadSkeletonOptions read_reference, read_found;
};

/// Figures near 0 would not reveal that the files are in different units.
void check_units(const SkeletonMatch& match, const Skeleton& reference, const Skeleton& found,
                 const CompareFlags& flags) {
    const double ratio = unit_ratio(match, reference, found);
    if (ratio == 1) return;
    throw InvalidInput(
        fmt::format("'{}' is about {:g} times as large as '{}' and hardly matches it; if their units differ, "
                    "read it with --b-scale {:g}",
                    flags.found.string(), ratio, flags.reference.string(), 1 / ratio));
}

ExitCode compare_files(Run& run, const CompareFlags& flags) {
    if (flags.reference.empty() || flags.found.empty())
        throw UsageError("name the reference and the skeleton to judge: coppice compare A B");
    const SkeletonFile a = load_skeleton(run, flags.reference, flags.read_reference);
    const SkeletonFile b = load_skeleton(run, flags.found, flags.read_found);
    const SkeletonMatch match = run.stage(
        "compare", [&](const Context& ctx) { return compare(a.skeleton, b.skeleton, flags.compare, ctx); });
    check_units(match, a.skeleton, b.skeleton, flags);
    const Json figures = compute_figures(match);
    run.print(flags.json ? figures_json(figures) : figures_text(figures));
    run.counts()["figures"] = figures;
    run.finish(fmt::format("{}: {:.1f} % of {} found", flags.found.string(), match.covered_percent,
                           flags.reference.string()));
    return kDone;
}

}  // namespace

Command compare_command() {
    const auto flags = std::make_shared<CompareFlags>();
    OptionList options;
    options.file("a", "A", flags->reference, "Reference skeleton.");
    options.file("b", "B", flags->found, "Skeleton to compare with the reference.");
    options.flag("--json", flags->json, "Print JSON instead of a table.");
    options.fields(flags->compare, "Comparison");
    options.fields(flags->read_reference, "Reading A");
    options.fields(flags->read_found, "Reading B", {.prefix = "b", .common = MemberNames{}});
    return {"compare", "Compare a skeleton with a reference: length, volume, axes, tips, junctions, radii.",
            options, [flags](Run& run, const GivenOptions&) { return compare_files(run, *flags); }};
}

}  // namespace coppice::cli
