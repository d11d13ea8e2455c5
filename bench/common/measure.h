#pragma once

#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "clock.h"
#include "coppice/options/json.h"

namespace coppice::bench {

/// A quantity that was measured several times.
struct Measure {
    std::string name;             ///< "mesh", "mesh: project", "opensubdiv", "write ply", ...
    std::vector<double> samples;  ///< [s]
    double median() const;
    double least() const;
};

/// Returns an object with the median, the minimum and all samples of every measure, by name.
Json measures_json(std::span<const Measure> measures);

/// Returns the last columns of a line about one measure, see kMeasureColumns.
std::string measure_csv(const Measure& measure);
inline constexpr const char* kMeasureColumns = "measure,median_s,min_s,runs";

/// Measures by name, in the order of their first sample.
class Measures {
  public:
    explicit Measures(std::vector<Measure>& all) : all_(all) {}

    void add(const std::string& name, double seconds);

    template <class Work>
    void time(const std::string& name, const Work& work) {
        const Clock clock;
        work();
        add(name, clock.seconds());
    }

  private:
    std::vector<Measure>& all_;
};

}  // namespace coppice::bench
