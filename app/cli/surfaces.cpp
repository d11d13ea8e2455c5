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

Figures counts_of(const GraftReport& r) {
    Figures out;
    out["grafted"] = r.grafted;
    out["cut"] = r.cut;
    out["merged"] = r.merged;
    out["buried"] = r.buried;
    out["trees_joined"] = r.joined;
    return out;
}

Figures counts_of(const PartReport& r) {
    Figures out;
    out["absorbed"] = r.absorbed;
    out["advanced"] = r.advanced;
    out["bundled"] = r.bundled;
    out["swallowed"] = r.swallowed;
    return out;
}

Figures counts_of(const KnotReport& r) {
    Figures out;
    out["pairs_before"] = r.pairs_before;
    out["pairs_after"] = r.pairs_after;
    out["lossy"] = r.lossy;
    out["severed"] = r.severed;
    out["folded"] = r.folded;
    out["rounds"] = r.rounds;
    out["slices"] = r.slices;
    return out;
}

Figures counts_of(const CoarsenReport& r) {
    Figures out;
    out["quads_before"] = r.faces_before;
    out["nodes_refined"] = r.raised;
    return out;
}

Figures counts_of(const BendApartReport& r) {
    Figures out;
    out["overlaps_before"] = r.before;
    out["overlaps_after"] = r.after;
    out["nodes_moved"] = r.moved;
    out["farthest"] = r.farthest;
    out["rounds"] = r.rounds;
    return out;
}

Figures counts_of(const RamificationObjective& f) {
    Figures out;
    out["units"] = f.units;
    out["connections"] = f.connections;
    out["pastes"] = f.pastes;
    out["total"] = f.total();
    return out;
}

Figures counts_of(const RamificationReport& r) {
    Figures out;
    out["branches"] = r.branches;
    out["units"] = r.units;
    out["connectable"] = r.connectable;
    out["additional"] = r.additional;
    out["crowded"] = r.crowded;
    out["objective_before"] = counts_of(r.before);
    out["objective_after"] = counts_of(r.after);
    out["connection_seconds"] = r.connection_seconds;
    out["subdivision_seconds"] = r.subdivision_seconds;
    out["paste_seconds"] = r.paste_seconds;
    return out;
}

// How the laterals were joined, and what that did to the objective.
std::string told(const RamificationReport& r) {
    return fmt::format("{} laterals connected, {} pasted, objective {:.1f} from {:.1f}",
                       grouped(r.connectable), grouped(r.additional), r.after.total(), r.before.total());
}

Figures counts_of(const BallReport& r) {
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

// What became of wood that overlapped that of other trees: nothing where none did.
std::string told(const BendApartReport& r) {
    if (r.before == 0) return {};
    const std::string left = r.after > 0 ? fmt::format(", {} left", grouped(r.after)) : "";
    return fmt::format("{} of two trees bent apart{}; ", counted(r.before, "overlap"), left);
}

bool had_knots(const KnotReport& r) { return r.pairs_before + r.lossy + r.severed + r.folded > 0; }

// What to say of quads that crossed, left something out, or severed a branch: nothing where none did.
std::string told(const KnotReport& r) {
    std::vector<std::string> remeshed;
    if (r.pairs_before > 0) remeshed.push_back(counted(r.pairs_before, "crossing"));
    if (r.lossy > 0) remeshed.push_back(counted(r.lossy, "lost bulge"));
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
    counts["bodies"] = surface.knots.parts;
    counts["handles"] = surface.knots.handles;
    counts["branches_grafted"] = counts_of(surface.grafted);
    counts["branches_parted"] = counts_of(surface.parted);
    if (surface.balls) counts["metaballs"] = counts_of(*surface.balls);
    if (had_knots(surface.knots)) counts["crossings_remeshed"] = counts_of(surface.knots);
    if (surface.coarsened) counts["sides_by_radius"] = counts_of(*surface.coarsened);
    if (surface.ramified) counts["ramifications"] = counts_of(*surface.ramified);
    const std::string how =
        surface.ramified ? told(*surface.ramified)
                         : fmt::format("{} merged, {} grafted, {} cut", grouped(surface.grafted.merged),
                                       grouped(surface.grafted.grafted), grouped(surface.grafted.cut));
    const std::string before =
        surface.coarsened ? fmt::format(" of {}", grouped(surface.coarsened->faces_before)) : "";
    return fmt::format("{}; {}{} quads{}", how, grouped(surface.mesh.quads.size()), before,
                       told(surface.knots));
}

Figures counts_of(const PolyhedronReport& r) {
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
    if (surface.polyhedron) counts["polyhedron"] = counts_of(*surface.polyhedron);
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
    counts["least_sides"] = surface.report.least_sides;
    counts["most_sides"] = surface.report.most_sides;
    return fmt::format("{} tubes, {} faces", grouped(surface.report.tubes),
                       grouped(surface.mesh.face_count()));
}

Figures counts_of(const VolumeReport& r) {
    Figures out;
    out["mesh"] = r.mesh;
    out["cones"] = r.cones;
    out["error"] = r.error;
    out["ratio"] = r.ratio();
    return out;
}

Figures counts_of(const AxesReport& r) {
    Figures out = figures_of(r);
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
    options.flag("--normals", write.normals, "also write smooth normals into .obj; .glb and .usda have them",
                 {.group = "Writing a mesh", .common = false});
    options.value(
        {common_field("output_up", "Axis that points up in the written file; .glb and .usda define theirs"),
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
        throw UsageError("--normals are for .obj, which none of the outputs is");
    if (write.up != FileUp::z && !any({obj, ply, stl}))
        throw UsageError("--output-up is for .obj, .ply and .stl, which none of the outputs is");
}

std::string count_surface(Run& run, const MeshResult& result) {
    std::string said =
        std::visit([&](const auto& surface) { return count(run.counts(), surface); }, result.surface);
    tell_device(run, result);
    if (result.bent_apart) {
        run.counts()["trees_bent_apart"] = counts_of(*result.bent_apart);
        said = told(*result.bent_apart) + said;
    }
    if (!result.fitted) return said;
    const FitVolumeReport& fitted = *result.fitted;
    run.counts()["fitted"] = figures_of(fitted);
    return fmt::format("{}; volume {:.2f} % of the cones', {:.2f} % before fitting{}", said,
                       100 * fitted.after / fitted.cones, 100 * fitted.before / fitted.cones,
                       fitted.closed ? "" : " (parts of it are lost: see coppice check)");
}

std::vector<std::string> faults_of(const AxesReport& axes) {
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
        run.counts()["volume"] = counts_of(*verdict->volume);
        if (!result.fitted)
            out.said = fmt::format("; volume {:.1f} % of the cones'", 100 * verdict->volume->ratio());
        if (!verdict->holds_volume()) {
            run.warn(fmt::format("the surface has {:.1f} % of the volume of the skeleton's rounded cones",
                                 100 * verdict->volume->ratio()));
        }
    }
    run.counts()["axes"] = counts_of(verdict->axes);
    for (const std::string& fault : faults_of(verdict->axes)) run.warn(fault);
    if (verdict->crossings > 0)
        run.warn(fmt::format("{} of quads still cross; coppice check names the places",
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
