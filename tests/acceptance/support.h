#pragma once

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "paths.h"

// Foreign skeletons and the workloads are in a folder next to the sources that not every checkout has;
// without it these cases are skipped, and the zoo and synthetic trees remain.

namespace coppice::test {

namespace fs = std::filesystem;

inline const fs::path kShared = source_dir().parent_path() / "shared";

/// Tables that were written from a .mat file contain the same trees; a test of the readers compares them.
inline bool is_twin(const fs::path& file) {
    const fs::path name = file.stem();  // tree.cylinders for tree.cylinders.csv
    return name.extension() == ".cylinders" &&
           fs::exists(file.parent_path() / (name.stem().string() + ".mat"));
}

inline bool is_skeleton_file(const fs::path& file) {
    if (is_twin(file)) return false;
    const std::string end = file.extension(), name = file.filename();
    return end == ".swc" || end == ".csv" || end == ".mat" || name.find("TreeQSM.txt") != std::string::npos;
}

inline std::vector<fs::path> skeleton_files() {
    std::vector<fs::path> files;
    for (const char* folder : {"swc", "qsm"}) {
        std::error_code absent;
        for (const auto& entry : fs::directory_iterator(kShared / "data" / folder, absent)) {
            if (is_skeleton_file(entry.path())) files.push_back(entry.path());
        }
    }
    for (const char* name : {"tree300.swc", "tree300hard.swc", "tree3k.swc", "tree3khard.swc"}) {
        if (fs::exists(kShared / "workloads" / name)) files.push_back(kShared / "workloads" / name);
    }
    std::sort(files.begin(), files.end());
    return files;
}

inline fs::path workload(const std::string& name) { return kShared / "workloads" / (name + ".swc"); }

}  // namespace coppice::test
