#include "surfaces.h"

#include <fmt/format.h>

#include <algorithm>
#include <initializer_list>
#include <string_view>
#include <vector>

#include "coppice/io/mesh/writer.h"
#include "coppice/pipeline/surface_verdict.h"
#include "figures.h"
#include "files.h"

namespace coppice::cli {
namespace {

Figures compute_counts(const GraftReport& r) {
    Figures out;
    out["grafted"] = r.grafted;
    out["cut"] = r.cut;
    out["merged"] = r.merged;
    out["nodes_inside"] = r.nodes_inside;
    out["trees_joined"] = r.joined;
    return out;
}

Figures compute_counts(const PartReport& r) {
    Figures out;
    out["merged_nodes"] = r.merged_nodes;
    out["shifted_nodes"] = r.shifted_nodes;
    out["paired_nodes"] = r.paired_nodes;
    out["hidden_tips"] = r.hidden_tips;
    return out;
}

Figures compute_counts(const RemeshReport& r) {
    Figures out;
    out["pairs_before"] = r.pairs_before;
    out["pairs_after"] = r.pairs_after;
    out["lost_bulges"] = r.lost_bulges;
    out["severed"] = r.severed;
    out["folded"] = r.folded;
    out["rounds"] = r.rounds;
    out["tube_rows"] = r.tube_rows;
    return out;
}

Figures compute_counts(const CoarsenReport& r) {
    Figures out;
    out["quads_before"] = r.faces_before;
    out["nodes_refined"] = r.raised;
    return out;
}

Figures compute_counts(const BendApartReport& r) {
    Figures out;
    out["overlaps_before"] = r.before;
    out["overlaps_after"] = r.after;
    out["nodes_moved"] = r.moved;
    out["farthest"] = r.farthest;
    out["rounds"] = r.rounds;
    return out;
}

Figures compute_counts(const RamificationObjective& f) {
    Figures out;
    out["units"] = f.units;
    out["connections"] = f.connections;
    out["pastes"] = f.pastes;
    out["total"] = f.total();
    return out;
}

Figures compute_counts(const RamificationReport& r) {
    Figures out;
    out["branches"] = r.branches;
    out["units"] = r.units;
    out["connectable"] = r.connectable;
    out["additional"] = r.additional;
    out["crowded"] = r.crowded;
    out["objective_before"] = compute_counts(r.before);
    out["objective_after"] = compute_counts(r.after);
    out["connection_seconds"] = r.connection_seconds;
    out["subdivision_seconds"] = r.subdivision_seconds;
    out["paste_seconds"] = r.paste_seconds;
    return out;
}

// Summarises how laterals were connected, and the change of the objective.
std::string summary(const RamificationReport& r) {
    return fmt::format("{} laterals connected, {} pasted, objective {:.1f} from {:.1f}",
                       grouped(r.connectable), grouped(r.additional), r.after.total(), r.before.total());
}

Figures compute_counts(const BallReport& r) {
    Figures out;
    out["balls"] = r.balls;
    out["spacing"] = r.chain.spacing;
    out["radius_at_balls"] = r.chain.at_balls;
    out["radius_between"] = r.chain.between;
    return out;
}

std::string counted(std::uint64_t number, std::string_view thing) {
    return fmt::format("{} {}{}", grouped(number), thing, number == 1 ? "" : "s");
}

// Summarises overlaps of branches of different trees; empty if there were none.
std::string summary(const BendApartReport& r) {
    if (r.before == 0) return {};
    const std::string left = r.after > 0 ? fmt::format(", {} left", grouped(r.after)) : "";
    return fmt::format("{} between trees removed by bending{}; ", counted(r.before, "overlap"), left);
}

bool had_repairs(const RemeshReport& r) { return r.pairs_before + r.lost_bulges + r.severed + r.folded > 0; }

// Summarises intersecting quads, lost bulges and severed branches; empty if there were none.
std::string summary(const RemeshReport& r) {
    std::vector<std::string> remeshed;
    if (r.pairs_before > 0) remeshed.push_back(counted(r.pairs_before, "crossing"));
    if (r.lost_bulges > 0) remeshed.push_back(counted(r.lost_bulges, "lost bulge"));
    if (r.severed > 0) remeshed.push_back(counted(r.severed, "severed row"));
    if (r.folded > 0) remeshed.push_back(counted(r.folded, "fold"));
    std::string out;
    if (r.rounds > 0) out += fmt::format(", {} remeshed", fmt::join(remeshed, " and "));
    if (r.pairs_after > 0) out += fmt::format(", {} left", counted(r.pairs_after, "crossing"));
    if (r.handles > 0) out += ", " + counted(static_cast<std::uint64_t>(r.handles), "handle");
    return out;
}

std::string count(Figures& counts, const QuadSurface& surface) {
    counts["vertices"] = surface.mesh.positions.size();
    counts["quads"] = surface.mesh.quads.size();
    counts["cage_quads"] = surface.cage.cage.quads.size();
    counts["bodies"] = surface.repair.parts;
    counts["handles"] = surface.repair.handles;
    counts["branches_grafted"] = compute_counts(surface.grafted);
    counts["branches_parted"] = compute_counts(surface.parted);
    if (surface.balls) counts["metaballs"] = compute_counts(*surface.balls);
    if (had_repairs(surface.repair)) counts["crossings_remeshed"] = compute_counts(surface.repair);
    if (surface.coarsened) counts["sides_by_radius"] = compute_counts(*surface.coarsened);
    if (surface.ramified) counts["ramifications"] = compute_counts(*surface.ramified);
    const std::string how =
        surface.ramified ? summary(*surface.ramified)
                         : fmt::format("{} merged, {} grafted, {} cut", grouped(surface.grafted.merged),
                                       grouped(surface.grafted.grafted), grouped(surface.grafted.cut));
    const std::string before =
        surface.coarsened ? fmt::format(" of {}", grouped(surface.coarsened->faces_before)) : "";
    return fmt::format("{}; {}{} quads{}", how, grouped(surface.mesh.quads.size()), before,
                       summary(surface.repair));
}

Figures compute_counts(const PolyhedronReport& r) {
    Figures out;
    out["sections"] = r.sections;
    out["auxiliary_points"] = r.auxiliary;
    out["sections_added"] = r.added;
    return out;
}

std::string count(Figures& counts, const TetraSurface& surface) {
    counts["vertices"] = surface.mesh.positions.size();
    counts["triangles"] = surface.mesh.triangles.size();
    counts["tetrahedra"] = surface.march.tetra;
    counts["coarse_tetrahedra"] = surface.coarse;
    if (surface.polyhedron) counts["polyhedron"] = compute_counts(*surface.polyhedron);
    counts["samples"] = surface.march.vertices;
    counts["crossed_tetrahedra"] = surface.march.crossed;
    counts["snapped_vertices"] = surface.march.snapped;
    counts["freed_vertices"] = surface.march.freed;
    counts["lattice_grown"] = surface.grown;
    if (!surface.solid.tetra.empty()) {
        counts["volume_vertices"] = surface.solid.positions.size();
        counts["volume_tetrahedra"] = surface.solid.tetra.size();
    }
    return fmt::format("{} triangles", grouped(surface.mesh.triangles.size()));
}

std::string count(Figures& counts, const CylinderMesh& surface) {
    counts["vertices"] = surface.mesh.positions.size();
    counts["faces"] = surface.mesh.face_count();
    counts["tubes"] = surface.report.tubes;
    counts["rings"] = surface.report.rings;
    counts["min_sides"] = surface.report.min_sides;
    counts["max_sides"] = surface.report.max_sides;
    return fmt::format("{} tubes, {} faces", grouped(surface.report.tubes),
                       grouped(surface.mesh.face_count()));
}

Figures compute_counts(const VolumeReport& r) {
    Figures out;
    out["mesh"] = r.mesh;
    out["cones"] = r.cones;
    out["error"] = r.error;
    out["ratio"] = r.ratio();
    return out;
}

Figures compute_counts(const AxesReport& r) {
    Figures out = compute_figures(r);
    out["tips"] = r.tips;
    out["tips_short"] = r.short_tips;
    return out;
}

template <class Surface>
void tell_device(Run& run, const Surface& surface) {
    run.counts()["device"] = surface.device.name;
    if (!surface.device.note.empty()) run.warn(surface.device.note);
}
void tell_device(Run&, const CylinderMesh&) {}

}  // namespace

void tell_device(Run& run, const MeshResult& result) {
    std::visit([&](const auto& surface) { tell_device(run, surface); }, result.surface);
}

void write_surface(const std::filesystem::path& path, const MeshResult& result,
                   const MeshWriteOptions& options, const Context& ctx) {
    const auto* tubes = std::get_if<CylinderMesh>(&result.surface);
    if (tubes != nullptr) return write_textured_mesh(path, tubes->mesh, tubes->texture, options, ctx);
    std::visit([&](const auto& surface) { write_mesh(path, surface.mesh, options, ctx); }, result.surface);
}

void add_mesh_write_options(OptionList& options, MeshWriteOptions& write) {
    options.flag("--normals", write.normals,
                 "Also write smooth normals to .obj; .glb and .usda always contain them.",
                 {.group = "Writing a mesh", .common = false});
    options.value({common_field("output_up",
                                "Axis that points up in the written file; .glb and .usda define their own."),
                   choice_of(write.up)},
                  "Writing a mesh");
}

void check_mesh_write_options(const MeshWriteOptions& write, std::span<const std::filesystem::path> outputs) {
    using enum MeshFormat;
    const auto any = [&](std::initializer_list<MeshFormat> formats) {
        return std::ranges::any_of(outputs, [&](const auto& path) {
            const auto format = mesh_format_of_name(path);
            return format && std::ranges::find(formats, *format) != formats.end();
        });
    };
    if (write.normals && !any({obj}))
        throw UsageError("--normals requires an .obj output; none of the outputs is one");
    if (write.up != FileUp::z && !any({obj, ply, stl}))
        throw UsageError("--output-up requires an .obj, .ply or .stl output; none of the outputs is one");
}

std::string count_surface(Run& run, const MeshResult& result) {
    std::string said =
        std::visit([&](const auto& surface) { return count(run.counts(), surface); }, result.surface);
    tell_device(run, result);
    if (result.bent_apart) {
        run.counts()["trees_bent_apart"] = compute_counts(*result.bent_apart);
        said = summary(*result.bent_apart) + said;
    }
    if (!result.fitted) return said;
    const FitVolumeReport& fitted = *result.fitted;
    run.counts()["fitted"] = compute_figures(fitted);
    return fmt::format("{}; volume {:.2f} % of the cones', {:.2f} % before fitting{}", said,
                       100 * fitted.after / fitted.cones, 100 * fitted.before / fitted.cones,
                       fitted.closed ? "" : " (parts of it are lost: see coppice check)");
}

std::vector<std::string> find_faults(const AxesReport& axes) {
    const auto at = [](NodeId node, Vec3d p) {
        return fmt::format("node {} ({:.6g}, {:.6g}, {:.6g})", node.index(), p.x, p.y, p.z);
    };
    std::vector<std::string> out;
    if (axes.severed > 0) {
        const SeveredPlace& longest = axes.longest.front();
        out.push_back(
            fmt::format("the surface severs branches at {}; the longest, {:.3g} long, begins before {}",
                        counted(axes.severed, "place"), longest.length, at(longest.node, longest.place)));
    }
    if (axes.short_tips > 0) {
        const ShortTip& shortest = axes.shortest.front();
        out.push_back(fmt::format("{} of {} too short; the surface ends {:.2g} radii too early at {}",
                                  grouped(axes.short_tips),
                                  axes.tips == 1 ? "1 tip is" : grouped(axes.tips) + " tips are",
                                  shortest.missing, at(shortest.node, shortest.place)));
    }
    return out;
}

Verdict judge(Run& run, const MeshResult& result, const Skeleton& skeleton, const ControlOptions& ends) {
    const auto verdict =
        run.stage("judge", [&](const Context& ctx) { return judge_surface(result, skeleton, ends, ctx); });
    if (!verdict) return {};
    Verdict out{verdict->is_good(), {}};
    if (verdict->volume) {
        run.counts()["volume"] = compute_counts(*verdict->volume);
        if (!result.fitted)
            out.said = fmt::format("; volume {:.1f} % of the cones'", 100 * verdict->volume->ratio());
        if (!verdict->holds_volume()) {
            run.warn(fmt::format("the surface has {:.1f} % of the volume of the skeleton's rounded cones",
                                 100 * verdict->volume->ratio()));
        }
    }
    run.counts()["axes"] = compute_counts(verdict->axes);
    for (const std::string& fault : find_faults(verdict->axes)) run.warn(fault);
    if (verdict->crossings > 0)
        run.warn(fmt::format("{} of quads still intersect; coppice check lists the places",
                             counted(verdict->crossings, "pair")));
    return out;
}

std::string then_mesh(Run& run, const std::filesystem::path& path, const Skeleton& skeleton,
                      const MeshOptions& options) {
    if (path.empty()) return {};
    const MeshResult made =
        run.stage("mesh", [&](const Context& ctx) { return mesh_skeleton(skeleton, options, ctx); });
    run.stage("write mesh", [&](const Context& ctx) { write_surface(path, made, {}, ctx); });
    const Verdict verdict = judge(run, made, skeleton, options.control);
    return fmt::format("; {}: {}{}", path.string(), count_surface(run, made), verdict.said);
}

}  // namespace coppice::cli
