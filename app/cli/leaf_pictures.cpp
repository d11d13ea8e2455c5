#include "leaf_pictures.h"

#include <fmt/format.h>

#include "files.h"
#include "pictures.h"
#include "results.h"

namespace coppice::cli {

void write_leafed_picture(Run& run, const std::filesystem::path& path, const PolygonMesh& surface,
                          const FaceMaterials& bark, const SurfaceLeaves* leaves,
                          const RenderOptions& options) {
    RenderScene scene{.mesh = &surface, .materials = bark.materials, .face_materials = bark.of_face};
    std::vector<RenderMaterial> leaf_materials;
    if (leaves) {
        leaf_materials = make_render_materials(*leaves);
        scene.instances = &leaves->tree.foliage.instances;
        scene.prototypes = leaves->tree.prototypes;
        scene.prototype_materials = leaf_materials;
    }
    const Image image = run.stage("render", [&](const Context& ctx) { return render(scene, options, ctx); });
    run.stage("write image", [&](const Context&) { store_picture(run, path, image); });
}

std::string count_leaves(Run& run, const SurfaceLeaves& leaves) {
    const FoliageReport& report = leaves.tree.foliage.report;
    visit_figures(report, [&](const char* name, auto value) { run.counts()[name] = value; });
    run.counts()["branchlets"] = leaves.tree.branchlets;
    std::string text = fmt::format(
        "{} leaves of {:.3g} m2 on {} {}, leaf area index {:.3g}", grouped(report.leaves), report.leaf_area,
        grouped(leaves.tree.branchlets > 0 ? leaves.tree.branchlets : report.shoots),
        leaves.tree.branchlets > 0 ? "branchlets" : "shoots", report.leaf_area_index);
    if (report.flowers > 0) text += fmt::format(", {} flowers", grouped(report.flowers));
    if (report.fruit > 0) text += fmt::format(", {} fruit", grouped(report.fruit));
    return text + fmt::format(", {} removed in wood", grouped(report.inside_wood));
}

}  // namespace coppice::cli
