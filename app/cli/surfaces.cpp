#include "surfaces.h"

#include <fmt/format.h>

#include <algorithm>
#include <initializer_list>
#include <string_view>
#include <vector>

#include "coppice/io_mesh/writer.h"
#include "coppice/pipeline/mesh_skeleton.h"
#include "coppice/pipeline/surface_verdict.h"
#include "figures.h"
#include "files.h"
#include "pictures.h"
#include "results.h"

namespace coppice::cli {
namespace {

// Summarises how laterals were connected, and the change of the objective.
std::string summary(const RamificationReport& r) {
    return fmt::format("{} laterals connected, {} pasted, objective {:.1f} from {:.1f}",
                       grouped(r.connectable), grouped(r.additional), r.after.total(), r.before.total());
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

std::string summary(const AtlasReport& r) {
    return fmt::format("; {} use {:.0f} % of the atlas, at {:.3g} pixels per metre",
                       counted(r.charts, "chart"), 100 * r.used, r.pixels_per_metre);
}

// Summarises texture coordinates: the density is 1 where a tile has its given width.
std::string summary(const TextureReport& r) {
    const std::string alone =
        r.projected > 0 ? fmt::format(", {} mapped alone", counted(r.projected, "face")) : "";
    return fmt::format("; texture density {:.2f} to {:.2f}{}", r.density_p5, r.density_p95, alone);
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

std::string count(Json& counts, const QuadSurface& surface) {
    counts.update({{"vertices", surface.mesh.positions.size()},
                   {"quads", surface.mesh.quads.size()},
                   {"cage_quads", surface.cage.cage.quads.size()},
                   {"bodies", surface.repair.parts},
                   {"handles", surface.repair.handles},
                   {"branches_grafted", compute_figures(surface.grafted)},
                   {"branches_parted", compute_figures(surface.parted)}});
    if (surface.balls) counts["metaballs"] = compute_figures(*surface.balls);
    if (had_repairs(surface.repair)) counts["crossings_remeshed"] = compute_figures(surface.repair);
    if (surface.coarsened) counts["sides_by_radius"] = compute_figures(*surface.coarsened);
    if (surface.ramified) counts["ramifications"] = compute_figures(*surface.ramified);
    const std::string how =
        surface.ramified ? summary(*surface.ramified)
                         : fmt::format("{} merged, {} grafted, {} cut", grouped(surface.grafted.merged),
                                       grouped(surface.grafted.grafted), grouped(surface.grafted.truncated));
    const std::string before =
        surface.coarsened ? fmt::format(" of {}", grouped(surface.coarsened->faces_before)) : "";
    return fmt::format("{}; {}{} quads{}", how, grouped(surface.mesh.quads.size()), before,
                       summary(surface.repair));
}

std::string count(Json& counts, const TetraSurface& surface) {
    counts.update({{"vertices", surface.mesh.positions.size()},
                   {"triangles", surface.mesh.triangles.size()},
                   {"tetrahedra", surface.march.tetra},
                   {"coarse_tetrahedra", surface.coarse}});
    if (surface.polyhedron) counts["polyhedron"] = compute_figures(*surface.polyhedron);
    counts.update(compute_figures(surface.march));
    counts["lattice_grown"] = surface.grown;
    if (!surface.solid.tetra.empty()) {
        counts.update({{"volume_vertices", surface.solid.positions.size()},
                       {"volume_tetrahedra", surface.solid.tetra.size()}});
    }
    return fmt::format("{} triangles", grouped(surface.mesh.triangles.size()));
}

std::string count(Json& counts, const CylinderMesh& surface) {
    counts.update({{"vertices", surface.mesh.positions.size()}, {"faces", surface.mesh.face_count()}});
    counts.update(compute_figures(surface.report));
    return fmt::format("{} tubes, {} faces", grouped(surface.report.tubes),
                       grouped(surface.mesh.face_count()));
}

template <class Surface>
void tell_device(Run& run, const Surface& surface) {
    run.counts()["device"] = surface.device.name;
    if (!surface.device.note.empty()) run.warn(surface.device.note);
}
void tell_device(Run&, const CylinderMesh&) {}

// Returns whether the surface is a cage, which is neither subdivided nor repaired.
bool is_cage(const MeshResult& result) {
    const auto* quads = std::get_if<QuadSurface>(&result.surface);
    return quads != nullptr && quads->cage.cage.quads.size() == quads->mesh.quads.size();
}

std::string summary(std::span<const std::uint32_t> slots, Json& counts) {
    const auto count = [&](MaterialSlot slot) {
        return std::ranges::count(slots, static_cast<std::uint32_t>(slot));
    };
    const auto twig = static_cast<std::uint64_t>(count(MaterialSlot::twig)),
               cut = static_cast<std::uint64_t>(count(MaterialSlot::cut)), bark = slots.size() - twig - cut;
    counts = {{"bark", bark}, {"twig", twig}, {"cut", cut}};
    return fmt::format("; {} of bark, {} of twigs, {} of cuts", counted(bark, "face"), grouped(twig),
                       grouped(cut));
}

}  // namespace

void add_material_options(OptionList& options, MaterialPrefixes& prefixes, HelpPlace display) {
    options.file("--material", "PREFIX", prefixes.bark, kMaterialHelp, display);
    display.common = false;
    options.file("--twig-material", "PREFIX", prefixes.twig, kTwigMaterialHelp, display);
    options.file("--cut-material", "PREFIX", prefixes.cut, kCutMaterialHelp, display);
}

void check_materials(const MaterialPrefixes& prefixes) {
    if (!prefixes.bark.empty()) return;
    if (!prefixes.twig.empty()) throw UsageError("--twig-material requires --material for the other faces");
    if (!prefixes.cut.empty()) throw UsageError("--cut-material requires --material for the other faces");
}

std::vector<MaterialFiles> find_materials(const MaterialPrefixes& prefixes) {
    std::vector<MaterialFiles> out;
    if (prefixes.bark.empty()) return out;
    for (const auto& prefix : {prefixes.bark, prefixes.twig, prefixes.cut}) {
        MaterialFiles files = prefix.empty() ? MaterialFiles{} : find_material(prefix);
        make_name_unique(files, out);
        out.push_back(std::move(files));
    }
    return out;
}

SlotOptions make_slots(const MaterialPrefixes& prefixes, SlotOptions options) {
    options.twigs = !prefixes.twig.empty();
    options.cuts = !prefixes.cut.empty();
    return options;
}

void warn_of_lost_materials(Run& run, const MaterialPrefixes& prefixes,
                            std::span<const std::filesystem::path> outputs) {
    if (prefixes.bark.empty()) return;
    for (const auto& output : outputs) {
        const auto format = mesh_format_of_name(output);
        if (format == MeshFormat::ply || format == MeshFormat::stl)
            run.warn(fmt::format("{} has no materials; .glb, .obj and .usda have", output.string()));
    }
}

void check_texture(const GivenOptions& given, const TextureOptions& texture) {
    const auto has = [&](std::string_view name) { return is_given(given, name); };
    const bool is_bark = texture.coordinates == TextureCoordinates::bark;
    const bool is_atlas = texture.coordinates == TextureCoordinates::atlas;
    if (has("--material") && is_atlas)
        throw UsageError(
            "--material repeats its images over the surface, which an atlas does not; use --uv bark");
    for (const std::string_view name : {"--material", "--tile", "--tile-height", "--uv-blend"}) {
        if (has(name) && !is_bark) throw UsageError(fmt::format("{} requires --uv bark", name));
    }
    for (const std::string_view name : {"--twig-diameter", "--twig-tile"}) {
        if (has(name) && !has("--twig-material"))
            throw UsageError(fmt::format("{} requires --twig-material", name));
    }
    if (has("--atlas-size") && !is_atlas) throw UsageError("--atlas-size requires --uv atlas");
}

std::string use_tile_of_image(Run& run, const GivenOptions& given, const std::filesystem::path& image,
                              TextureOptions& texture) {
    if (image.empty() || is_given(given, "--tile") || is_given(given, "--tile-height")) return {};
    const auto size = load_tile_size(image);
    if (!size) return {};
    texture.tile = size->width;
    texture.tile_height = size->height;
    run.counts()["tile_m"] = {size->width, size->height};
    return fmt::format("; tiles of {:.3g} x {:.3g} m, as the images state", size->width, size->height);
}

void tell_device(Run& run, const MeshResult& result) {
    std::visit([&](const auto& surface) { tell_device(run, surface); }, result.surface);
}

void write_surface(const std::filesystem::path& path, const MeshResult& result,
                   const MeshWriteOptions& options, const Context& ctx) {
    MeshWriteOptions complete = options;
    if (const auto* tubes = std::get_if<CylinderMesh>(&result.surface)) complete.texture = tubes->texture;
    if (result.texture) {
        complete.texture = result.texture->points;
        complete.texture_blends = result.texture->blends;
    }
    complete.attributes = result.attributes;
    complete.face_materials = result.slots;
    std::visit([&](const auto& surface) { write_mesh(path, surface.mesh, complete, ctx); }, result.surface);
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
    std::string text =
        std::visit([&](const auto& surface) { return count(run.counts(), surface); }, result.surface);
    tell_device(run, result);
    if (result.bent_apart) {
        run.counts()["trees_bent_apart"] = compute_figures(*result.bent_apart);
        text = summary(*result.bent_apart) + text;
    }
    if (result.texture) {
        run.counts()["texture"] = compute_figures(result.texture->report);
        text += result.atlas ? summary(*result.atlas) : summary(result.texture->report);
        if (result.atlas) run.counts()["atlas"] = compute_figures(*result.atlas);
    }
    if (!result.slots.empty()) text += summary(result.slots, run.counts()["slots"]);
    if (!result.fitted) return text;
    const FitVolumeReport& fitted = *result.fitted;
    run.counts()["fitted"] = compute_figures(fitted);
    return fmt::format("{}; volume {:.2f} % of the cones', {:.2f} % before fitting{}", text,
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

Verdict report_verdict(Run& run, const SurfaceVerdict& verdict, bool is_cage) {
    Verdict out{verdict.is_good(), {}};
    if (verdict.volume) {
        const VolumeReport& volume = *verdict.volume;
        run.counts()["volume"] = {{"mesh", volume.mesh},
                                  {"cones", volume.cones},
                                  {"error", volume.error},
                                  {"ratio", volume.ratio()}};
        out.text = fmt::format("; volume {:.1f} % of the cones'", 100 * volume.ratio());
        if (!verdict.holds_volume()) {
            run.warn(fmt::format("the surface has {:.1f} % of the volume of the skeleton's rounded cones",
                                 100 * volume.ratio()));
        }
    }
    Json& axes = run.counts()["axes"] = compute_figures(verdict.axes);
    axes.update({{"tips", verdict.axes.tips}, {"tips_short", verdict.axes.short_tips}});
    for (const std::string& fault : find_faults(verdict.axes)) run.warn(fault);
    if (verdict.crossings > 0) {
        run.warn(fmt::format(
            "{} of quads still intersect; {}", counted(verdict.crossings, "pair"),
            is_cage ? "a cage is not repaired: use --levels 1 or more, or --faces without --tube-sides equal"
                    : "coppice check lists the places"));
    }
    return out;
}

Verdict judge(Run& run, const MeshResult& result, const Skeleton& skeleton, const ControlOptions& ends) {
    const auto verdict =
        run.stage("judge", [&](const Context& ctx) { return judge_surface(result, skeleton, ends, ctx); });
    if (!verdict) return {};
    Verdict out = report_verdict(run, *verdict, is_cage(result));
    if (result.fitted) out.text.clear();  // the fit states the volume
    return out;
}

std::string then_mesh(Run& run, const std::filesystem::path& path, const Skeleton& skeleton,
                      const MeshOptions& options) {
    if (path.empty()) return {};
    const MeshResult made =
        run.stage("mesh", [&](const Context& ctx) { return mesh_skeleton(skeleton, options, ctx); });
    run.stage("write mesh", [&](const Context& ctx) { store_surface(run, path, made, {}, ctx); });
    const Verdict verdict = judge(run, made, skeleton, options.control);
    return fmt::format("; {}: {}{}", path.string(), count_surface(run, made), verdict.text);
}

}  // namespace coppice::cli
