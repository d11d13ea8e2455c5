#include "routes_report.h"

#include <fmt/format.h>

#include <iterator>
#include <nlohmann/json.hpp>

#include "coppice/options/json.h"

namespace coppice::bench {
namespace {

using Row = std::vector<std::string>;

/// A Markdown table.
class Table {
  public:
    explicit Table(const Row& head) {
        add(head);
        add(Row(head.size(), "---"));
    }
    void add(const Row& cells) {
        fmt::format_to(std::back_inserter(text_), "| {} |\n", fmt::join(cells, " | "));
    }
    const std::string& text() const { return text_; }

  private:
    std::string text_;
};

/// Formats 1234567 as 1,234,567.
std::string grouped(std::uint64_t number) {
    if (number < 1000) return fmt::to_string(number);
    return fmt::format("{},{:03}", grouped(number / 1000), number % 1000);
}

/// Formats seconds with three significant digits.
std::string time_text(double seconds) {
    const double ms = seconds * 1e3;
    if (ms < 9.995) return fmt::format("{:.2f} ms", ms);
    if (ms < 99.95) return fmt::format("{:.1f} ms", ms);
    if (ms < 999.5) return fmt::format("{:.0f} ms", ms);
    return fmt::format("{:.{}f} s", seconds, seconds < 9.995 ? 2 : seconds < 99.95 ? 1 : 0);
}

std::string printed_time(double seconds) { return fmt::format("{:.3f} s", seconds); }

std::string brute_text(const RouteResult& r) {
    if (!r.brute) return "-";
    std::string time = time_text(r.brute->seconds);
    if (r.brute->share == 1) return time;
    return fmt::format("{} (from {:.2g} %)", time, 100 * r.brute->share);
}

std::string memory_text(std::uint64_t bytes) {
    return fmt::format("{:.0f}", static_cast<double>(bytes) / (1 << 20));
}

std::string twigs_text(const SurfaceFigures& f) {
    return fmt::format("{}, {}", f.report.axes->missing, f.report.axes->severed);
}

void add_grid_rows(Table& table, const PaperTree& tree, const RoutesResult& ours) {
    for (const RouteResult& r : ours.routes) {
        if (!r.name.starts_with("grid")) continue;
        Row printed{"-", "-", "-", "-"};
        for (const PrintedGrid& p : tree.grids) {
            if (r.name != fmt::format("grid {0} x {0} x {0}", p.resolution)) continue;
            printed = {grouped(p.triangles), printed_time(p.field), printed_time(p.extract),
                       printed_time(p.total)};
        }
        Row row{tree.name, r.name, grouped(r.sampled)};
        row.insert(row.end(), printed.begin(), printed.end());
        const Row measured{grouped(r.figures.faces()), brute_text(r), time_text(r.seconds()),
                           twigs_text(r.figures)};
        row.insert(row.end(), measured.begin(), measured.end());
        table.add(row);
    }
}

std::string grid_table(const Comparison& all) {
    Table table({"tree", "grid", "corners", "triangles, printed", "field, printed", "surface, printed",
                 "total, printed", "triangles, ours", "every segment, ours", "culled, ours",
                 "missing, severed"});
    for (std::size_t i = 0; i < all.papers.size(); ++i) {
        if (!all.papers[i].grids.empty()) add_grid_rows(table, all.papers[i], all.paper_trees[i]);
    }
    return "### Uniform grids (Zhu2013, table 1)\n\n" + table.text() + "\n";
}

/// Compares our lattice, subdivision, field and surface with those of the paper.
void add_tetra_rows(Table& table, const PaperTree& tree, const RoutesResult& ours) {
    const PrintedTetrahedra& p = tree.tetrahedra;
    const auto stage = [&](std::size_t i) { return p.stages[i].second; };
    table.add({tree.name, tree.paper, tree.segments_are_stated ? fmt::to_string(tree.segments) : "?",
               grouped(p.tetrahedra), grouped(p.vertices), grouped(p.triangles),
               printed_time(stage(0) + stage(1)), printed_time(stage(2)), printed_time(stage(3)),
               printed_time(stage(4)), printed_time(p.total), "-"});
    const RouteResult& r = *ours.find("tetrahedra");
    table.add({tree.name, "ours", fmt::to_string(ours.segments), grouped(r.tetrahedra), grouped(r.sampled),
               grouped(r.figures.faces()), time_text(r.stage("prepare") + r.stage("lattice")),
               "with the surface", time_text(r.stage("field") + r.stage("regions")),
               time_text(r.stage("march")), time_text(r.seconds()), twigs_text(r.figures)});
}

std::string tetra_table(const Comparison& all) {
    Table table({"tree", "row", "segments", "tetrahedra", "vertices", "triangles", "lattice", "subdivision",
                 "field", "surface", "total", "missing, severed"});
    for (std::size_t i = 0; i < all.papers.size(); ++i) {
        add_tetra_rows(table, all.papers[i], all.paper_trees[i]);
    }
    return "### Tetrahedra (Zhu2013, table 2; Zhu2015, table 1)\n\n" + table.text() + "\n";
}

double compute_sum(const RouteResult& r, std::initializer_list<const char*> stages) {
    double sum = 0;
    for (const char* name : stages) sum += r.stage(name);
    return sum;
}

std::string quad_table(const Comparison& all) {
    Table table({"tree", "row", "segments", "quads", "polyhedron", "subdivision", "approximation", "total"});
    for (std::size_t i = 0; i < all.papers.size(); ++i) {
        const PaperTree& tree = all.papers[i];
        const RouteResult* r = all.paper_trees[i].find("quads");
        if (tree.quads.empty() || r == nullptr) continue;
        const PrintedQuads& p = tree.quads.front();
        Row printed{tree.name, tree.paper, fmt::to_string(tree.segments), grouped(p.quads)};
        for (const auto& [name, seconds] : p.stages) printed.push_back(printed_time(seconds));
        printed.push_back(printed_time(p.total));
        table.add(printed);
        table.add({tree.name, "ours", fmt::to_string(all.paper_trees[i].segments),
                   grouped(r->figures.faces()),
                   time_text(compute_sum(*r, {"prepare", "graft", "part", "cage"})),
                   time_text(compute_sum(*r, {"topology", "quads", "refine", "anchors"})),
                   time_text(compute_sum(*r, {"field", "project", "untangle"})), time_text(r->seconds())});
    }
    return "### Quads (Zhu2015, table 2)\n\n" + table.text() + "\n";
}

std::string parts_table(const Comparison& all) {
    Table table({"tree", "route", "faces", "thick, m", "faces per radius, thick", "edge, thick", "thin, m",
                 "faces per radius, thin", "edge, thin", "missing, severed"});
    for (const RoutesResult& tree : all.paper_trees) {
        for (const RouteResult& r : tree.routes) {
            const PartFigures &thick = r.figures.thick, &thin = r.figures.thin;
            table.add({tree.scene, r.name, grouped(r.figures.faces()), fmt::format("{:.3f}", thick.radius),
                       fmt::format("{:.1f}", thick.faces_per_radius), fmt::format("{:.2f}", thick.edge),
                       fmt::format("{:.3f}", thin.radius), fmt::format("{:.1f}", thin.faces_per_radius),
                       fmt::format("{:.2f}", thin.edge), twigs_text(r.figures)});
        }
    }
    return "### Faces at thick and thin parts (Zhu2013, figure 9)\n\n" + table.text() + "\n";
}

std::string routes_tables(const Comparison& all) {
    Table times({"scene", "route", "faces", "time", "us per face", "memory, MiB", "radius, mean error",
                 "missing, severed"});
    Table shapes({"scene", "route", "watertight", "parts", "handles", "crossings: near", "elsewhere",
                  "overlap", "least angle", "edge p5", "p50", "p95", "p95 / p5"});
    for (const RoutesResult& scene : all.scenes) {
        for (const RouteResult& r : scene.routes) {
            const SurfaceFigures& f = r.figures;
            const IntersectionReport& crossings = *f.report.intersections;
            times.add({scene.scene, r.name, grouped(f.faces()), time_text(r.seconds()),
                       fmt::format("{:.3f}", 1e6 * r.seconds() / static_cast<double>(f.faces())),
                       memory_text(r.peak_bytes), fmt::format("{:.4f}", f.report.radius->regular.mean_abs),
                       twigs_text(f)});
            shapes.add({scene.scene, r.name, f.report.watertight() ? "yes" : "no",
                        fmt::to_string(f.report.topology.components),
                        f.report.watertight() ? fmt::to_string(f.handles()) : "-",
                        fmt::to_string(crossings.local), fmt::to_string(crossings.remote),
                        fmt::to_string(crossings.overlap), fmt::format("{:.1f}", f.min_angle),
                        fmt::format("{:.2f}", f.edge.p5), fmt::format("{:.2f}", f.edge.p50),
                        fmt::format("{:.2f}", f.edge.p95), fmt::format("{:.1f}", f.edge.p95 / f.edge.p5)});
        }
    }
    return "### Quads, tetrahedra, grid: time and truth\n\n" + times.text() +
           "\n### Quads, tetrahedra, grid: shape\n\n" + shapes.text() + "\n";
}

std::string twigs_table(const RoutesResult& twigs) {
    Table table({"scene", "route", "cell, m", "triangles", "corners", "culled", "every segment",
                 "memory, MiB", "missing, severed", "times ours"});
    const RouteResult& ours = *twigs.find("tetrahedra");
    for (const RouteResult& r : twigs.routes) {
        const bool is_grid = &r != &ours;
        std::string ratio = "1";
        if (is_grid) {
            ratio = fmt::format("{:.1f}", r.seconds() / ours.seconds());
            if (r.brute) ratio += fmt::format("; every segment {:.0f}", r.brute->seconds / ours.seconds());
        }
        table.add({twigs.scene, r.name, is_grid ? fmt::format("{:.4f}", r.size) : "-",
                   grouped(r.figures.faces()), grouped(r.sampled), time_text(r.seconds()), brute_text(r),
                   memory_text(r.peak_bytes), twigs_text(r.figures), ratio});
    }
    return "### The coarsest grid that shows every twig\n\n" + table.text() + "\n";
}

template <class Visit>
void for_each_result(const Comparison& all, const Visit& visit) {
    for (const RoutesResult& r : all.paper_trees) visit("paper", r);
    for (const RoutesResult& r : all.scenes) visit("routes", r);
    if (all.twigs) visit("twigs", *all.twigs);
}

Json route_json(const RouteResult& r) {
    const SurfaceFigures& f = r.figures;
    Json out{{"route", r.name},
             {"size", r.size},
             {"faces", f.faces()},
             {"vertices", f.vertices},
             {"tetrahedra", r.tetrahedra},
             {"sampled", r.sampled},
             {"peak_bytes", r.peak_bytes},
             {"watertight", f.report.watertight()},
             {"components", f.report.topology.components},
             {"handles", f.handles()},
             {"crossings_local", f.report.intersections->local},
             {"crossings_remote", f.report.intersections->remote},
             {"crossings_overlap", f.report.intersections->overlap},
             {"radius_regular_mean_abs", f.report.radius->regular.mean_abs},
             {"missing", f.report.axes->missing},
             {"severed", f.report.axes->severed},
             {"min_angle_p1", f.min_angle},
             {"edge_p5", f.edge.p5},
             {"edge_p50", f.edge.p50},
             {"edge_p95", f.edge.p95}};
    for (const auto& [name, part] : {std::pair{"thick", f.thick}, std::pair{"thin", f.thin}}) {
        out[name] = {
            {"radius", part.radius}, {"faces_per_radius", part.faces_per_radius}, {"edge", part.edge}};
    }
    if (r.brute) out["every_segment"] = {{"seconds", r.brute->seconds}, {"share", r.brute->share}};
    for (const Measure& m : r.measures) out["seconds"][m.name] = m.samples;
    return out;
}

}  // namespace

std::string comparison_markdown(const Comparison& all) {
    std::string out = fmt::format("Machine: {}. Threads: {}.\n\n", all.machine, all.threads);
    if (!all.papers.empty()) out += grid_table(all) + tetra_table(all) + quad_table(all) + parts_table(all);
    if (!all.scenes.empty()) out += routes_tables(all);
    if (all.twigs) out += twigs_table(*all.twigs);
    return out;
}

std::string comparison_csv(const Comparison& all) {
    std::string out = "kind,scene,segments,route,faces,threads,measure,median_s,min_s,runs\n";
    for_each_result(all, [&](const char* kind, const RoutesResult& scene) {
        for (const RouteResult& r : scene.routes) {
            for (const Measure& m : r.measures) {
                fmt::format_to(std::back_inserter(out), "{},{},{},\"{}\",{},{},{},{:.6f},{:.6f},{}\n", kind,
                               scene.scene, scene.segments, r.name, r.figures.faces(), all.threads, m.name,
                               m.median(), m.least(), m.samples.size());
            }
        }
    });
    return out;
}

std::string comparison_json(const Comparison& all) {
    Json out{{"machine", all.machine}, {"threads", all.threads}, {"results", Json::array()}};
    for_each_result(all, [&](const char* kind, const RoutesResult& scene) {
        Json json{
            {"kind", kind}, {"scene", scene.scene}, {"segments", scene.segments}, {"routes", Json::array()}};
        for (const RouteResult& r : scene.routes) json["routes"].push_back(route_json(r));
        out["results"].push_back(std::move(json));
    });
    return out.dump(2) + "\n";
}

}  // namespace coppice::bench
