#include "measure.h"

#include <fmt/format.h>

#include <algorithm>

namespace coppice::bench {

double Measure::median() const {
    std::vector<double> sorted = samples;
    std::sort(sorted.begin(), sorted.end());
    const std::size_t half = sorted.size() / 2;
    return sorted.size() % 2 == 1 ? sorted[half] : (sorted[half - 1] + sorted[half]) / 2;
}

double Measure::least() const { return *std::min_element(samples.begin(), samples.end()); }

Json measures_json(std::span<const Measure> measures) {
    auto out = Json::object();
    for (const Measure& m : measures)
        out[m.name] = {{"median_s", m.median()}, {"min_s", m.least()}, {"samples_s", m.samples}};
    return out;
}

std::string measure_csv(const Measure& m) {
    return fmt::format("{},{:.6f},{:.6f},{}", m.name, m.median(), m.least(), m.samples.size());
}

void Measures::add(const std::string& name, double seconds) {
    auto it = std::find_if(all_.begin(), all_.end(), [&](const Measure& m) { return m.name == name; });
    if (it == all_.end()) it = all_.insert(all_.end(), Measure{name, {}});
    it->samples.push_back(seconds);
}

}  // namespace coppice::bench
