#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace coppice::bench {

/// A row of a published table.
struct PrintedGrid {
    std::uint32_t resolution;  ///< corners of cells along a side of the cube
    std::uint64_t corners, triangles;
    double field, extract, total;  ///< [s]
};

struct PrintedTetrahedra {
    std::uint64_t tetrahedra, vertices, triangles;
    std::vector<std::pair<std::string, double>> stages;  ///< name, seconds
    double total;                                        ///< [s]
};

struct PrintedQuads {
    std::uint64_t quads;
    std::vector<std::pair<std::string, double>> stages;
    double total;  ///< [s]
};

/// A tree of [Zhu2013], tables 1 and 2, or of [Zhu2015], tables 1 and 2.
struct PaperTree {
    std::string name, paper;
    std::uint32_t segments;    ///< number of segments of the tree that represents it
    bool segments_are_stated;  ///< otherwise they are estimated
    PrintedTetrahedra tetrahedra;
    std::vector<PrintedGrid> grids;   ///< Zhu2013 only
    std::vector<PrintedQuads> quads;  ///< Zhu2015 only: one
};

std::vector<PaperTree> paper_trees();

}  // namespace coppice::bench
