#pragma once

#include <cstdint>
#include <span>

#include "coppice/subdivision/kernel/cage_view.h"
#include "coppice/subdivision/project.h"
#include "coppice/subdivision/untangle.h"

namespace coppice {
class ConvolutionField;
}

namespace coppice::cuda {

/// A cage to subdivide and move onto a field: the input of PatchRefinement, project and untangle. Referenced
/// data must outlive the object that uses the job.
struct QuadJob {
    CageView cage;                          ///< its topology
    int levels = 2;                         ///< number of subdivisions
    std::span<const Vec3> positions;        ///< [m] one per cage vertex
    std::span<const Vec3> anchors;          ///< [m] one per cage vertex
    std::span<const std::uint32_t> region;  ///< per cage quad: region of the field
    std::span<const ClipPlane> clips;       ///< one per flat end, by first quad
    ProjectOptions project;                 ///< as for project()
    UntangleOptions untangle;               ///< as for untangle()
    /// Per cage quad: index of the report that includes it. Empty: one report for all quads.
    std::span<const std::uint32_t> part = {};
    std::uint32_t parts = 1;  ///< number of reports; quads with a higher index are in no report

    /// Returns the index of the report that includes a refined quad.
    std::uint32_t part_of_quad(std::uint32_t refined) const {
        return part.empty() ? 0 : part[refined >> (2 * levels)];
    }
};

/// A job with the field that it is moved onto.
struct QuadTask {
    QuadJob job;                              ///< except `part`
    const ConvolutionField* field = nullptr;  ///< with its regions
};

/// Output buffers of a job, which are resized.
struct QuadPlaces {
    Buffer<Vec3>* positions = nullptr;  ///< [m] per refined vertex
    Buffer<Vec3>* anchors = nullptr;    ///< [m] per refined vertex; null: not copied
};

/// Results of a job other than its points.
struct QuadReport {
    ProjectReport projected;   ///< as from project()
    UntangleReport untangled;  ///< as from untangle()
    /// False if the job did not fit on the GPU and was done in tiles: folds are then left to untangle().
    bool is_whole = true;
};

/// Size of the output of a job.
struct QuadCounts {
    std::uint32_t vertices;  ///< refined
    std::uint32_t quads;     ///< refined
};

/// Returns the counts of a cage of this number of vertices, edges and quads, refined `levels` times.
QuadCounts refined_counts(std::uint32_t vertices, std::uint32_t edges, std::uint32_t quads, int levels);
/// Returns the counts of a cage that must be valid for PatchRefinement.
QuadCounts refined_counts(const CageView& cage, int levels);

/// [bytes] Returns the memory of a GPU that a job requires, if at most a fiftieth of its quads is folded.
std::uint64_t bytes_of_job(const QuadJob& job);

/// [bytes] Returns the memory of a GPU that a field of this number of segments and list entries requires.
std::uint64_t bytes_of_field(std::uint64_t segments, std::uint64_t entries);

/// [bytes] Returns the memory for a field of this number of segments and regions, including the search for
/// its lists.
std::uint64_t bytes_of_contacts(std::uint64_t segments, std::uint64_t regions);

/// [bytes] Allowance for rounding of array sizes, and for small arrays.
inline constexpr std::uint64_t kSlackBytes = std::uint64_t{16} << 20;

}  // namespace coppice::cuda
