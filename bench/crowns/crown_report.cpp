#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <nlohmann/json.hpp>

#include "coppice/options/json.h"

#include "crown_bench.h"

namespace coppice::bench {
namespace {

std::string time_text(double seconds) {
    if (seconds >= 1) return fmt::format("{:.2f} s", seconds);
    return fmt::format("{:.{}f} ms", seconds * 1e3, seconds < 0.01 ? 2 : seconds < 0.1 ? 1 : 0);
}

std::string or_dash(const std::string& text) { return text.empty() ? "-" : text; }

/// Returns the time per item in nanoseconds.
double each(const CrownResult& row) { return row.seconds() * 1e9 / static_cast<double>(row.size); }

}  // namespace

double CrownResult::seconds() const {
    const auto all =
        std::find_if(measures.begin(), measures.end(), [](const Measure& m) { return m.name == "all"; });
    return all->median();
}

std::string crown_markdown(const std::vector<CrownResult>& rows, unsigned threads,
                           const std::string& machine) {
    std::string out = fmt::format("Machine: {}. Threads: {}.\n\n", machine, threads);
    out += "| case | made | time | of one, ns | goal | others | memory, MiB | hash |\n";
    out += "| --- | --- | --- | --- | --- | --- | --- | --- |\n";
    for (const CrownResult& row : rows) {
        fmt::format_to(std::back_inserter(out), "| {} | {} {} | {} | {:.0f} | {} | {} | {:.1f} | {:016x} |\n",
                       row.what, row.size, row.unit, time_text(row.seconds()), each(row), or_dash(row.goal),
                       or_dash(row.baseline), static_cast<double>(row.peak_bytes) / (1 << 20), row.hash);
    }
    std::string stages;
    for (const CrownResult& row : rows) {
        for (const Measure& m : row.measures) {
            if (m.name == "all") continue;
            fmt::format_to(std::back_inserter(stages), "| {} | {} | {} |\n", row.what, m.name,
                           time_text(m.median()));
        }
    }
    if (!stages.empty()) out += "\n| stage of | stage | time |\n| --- | --- | --- |\n" + stages;
    return out;
}

std::string crown_csv(const std::vector<CrownResult>& rows, unsigned threads) {
    std::string out = fmt::format("what,size,unit,threads,hash,peak_bytes,{}\n", kMeasureColumns);
    for (const CrownResult& row : rows) {
        for (const Measure& m : row.measures) {
            fmt::format_to(std::back_inserter(out), "\"{}\",{},{},{},{:016x},{},{}\n", row.what, row.size,
                           row.unit, threads, row.hash, row.peak_bytes, measure_csv(m));
        }
    }
    return out;
}

std::string crown_json(const std::vector<CrownResult>& rows, unsigned threads, const std::string& machine) {
    Json out{{"machine", machine}, {"threads", threads}, {"rows", Json::array()}};
    for (const CrownResult& row : rows) {
        Json json{{"what", row.what},
                  {"goal", row.goal},
                  {"others", row.baseline},
                  {"size", row.size},
                  {"unit", row.unit},
                  {"hash", fmt::format("{:016x}", row.hash)},
                  {"peak_bytes", row.peak_bytes},
                  {"measures", measures_json(row.measures)}};
        out["rows"].push_back(std::move(json));
    }
    return out.dump(2) + "\n";
}

}  // namespace coppice::bench
