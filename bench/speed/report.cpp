#include "report.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <nlohmann/json.hpp>

#include "coppice/options/json.h"

namespace coppice::bench {
namespace {

std::string milliseconds(const Measure* measure) {
    if (measure == nullptr) return "-";
    const double ms = measure->median() * 1e3;
    return fmt::format("{:.{}f}", ms, ms < 10 ? 2 : ms < 100 ? 1 : 0);
}

std::string hash_text(std::uint64_t hash) { return fmt::format("{:016x}", hash); }

void add_row(std::string& out, const std::vector<std::string>& cells) {
    fmt::format_to(std::back_inserter(out), "| {} |\n", fmt::join(cells, " | "));
}

void add_main_table(std::string& out, const std::vector<SceneResult>& results) {
    const std::vector<std::string> head{"scene",          "segments",       "quads",       "mesh, ms",
                                        "us per segment", "OpenSubdiv, ms", "ratio",       "bytes per quad",
                                        "PLY, ms",        "OBJ, ms",        "picture, ms", "hash"};
    add_row(out, head);
    add_row(out, std::vector<std::string>(head.size(), "---"));
    for (const SceneResult& r : results) {
        add_row(out, {r.scene, fmt::to_string(r.segments), fmt::to_string(r.quads),
                      milliseconds(r.find("mesh")), fmt::format("{:.2f}", r.microseconds_per_segment()),
                      milliseconds(r.find("opensubdiv")), fmt::format("{:.2f}", r.ratio_to_opensubdiv()),
                      fmt::format("{:.0f}", r.bytes_per_quad()), milliseconds(r.find("write ply")),
                      milliseconds(r.find("write obj")), milliseconds(r.find("render")), hash_text(r.hash)});
    }
}

// Names of the stages of `parent`, as in "mesh: cage", in the order of measurement.
std::vector<std::string> find_parts(const std::string& parent, const std::vector<SceneResult>& results) {
    std::vector<std::string> names;
    for (const SceneResult& r : results) {
        for (const Measure& m : r.measures) {
            const bool known = std::find(names.begin(), names.end(), m.name) != names.end();
            if (!known && m.name.starts_with(parent + ": ")) names.push_back(m.name);
        }
    }
    return names;
}

void add_stage_table(std::string& out, const std::string& parent, const std::vector<SceneResult>& results) {
    const std::vector<std::string> parts = find_parts(parent, results);
    std::vector<std::string> head{"scene"};
    for (const std::string& part : parts) head.push_back(part.substr(parent.size() + 2));
    add_row(out, head);
    add_row(out, std::vector<std::string>(head.size(), "---"));
    for (const SceneResult& r : results) {
        std::vector<std::string> row{r.scene};
        for (const std::string& part : parts) row.push_back(milliseconds(r.find(part)));
        add_row(out, row);
    }
}

}  // namespace

std::string markdown_report(const RunInfo& run, const std::vector<SceneResult>& results) {
    std::string out =
        fmt::format("Machine: {}. Threads: {}. Levels: {}.\n\n", run.machine, run.threads, run.levels);
    add_main_table(out, results);
    out += "\nMilliseconds per stage of meshing:\n\n";
    add_stage_table(out, "mesh", results);
    out += "\nMilliseconds per stage of OpenSubdiv:\n\n";
    add_stage_table(out, "opensubdiv", results);
    return out;
}

std::string csv_report(const RunInfo& run, const std::vector<SceneResult>& results) {
    std::string out = fmt::format("scene,segments,threads,levels,quads,hash,{}\n", kMeasureColumns);
    for (const SceneResult& r : results) {
        for (const Measure& m : r.measures) {
            fmt::format_to(std::back_inserter(out), "{},{},{},{},{},{},{}\n", r.scene, r.segments,
                           run.threads, run.levels, r.quads, hash_text(r.hash), measure_csv(m));
        }
    }
    return out;
}

std::string json_report(const RunInfo& run, const std::vector<SceneResult>& results) {
    Json out{{"machine", run.machine},
             {"threads", run.threads},
             {"levels", run.levels},
             {"scenes", Json::array()}};
    for (const SceneResult& r : results) {
        Json scene{{"scene", r.scene},
                   {"segments", r.segments},
                   {"cage_quads", r.cage_quads},
                   {"quads", r.quads},
                   {"vertices", r.vertices},
                   {"hash", hash_text(r.hash)},
                   {"peak_bytes", r.peak_bytes},
                   {"bytes_per_quad", r.bytes_per_quad()},
                   {"us_per_segment", r.microseconds_per_segment()},
                   {"ratio_to_opensubdiv", r.ratio_to_opensubdiv()},
                   {"measures", measures_json(r.measures)}};
        out["scenes"].push_back(std::move(scene));
    }
    return out.dump(2) + "\n";
}

}  // namespace coppice::bench
