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

/// A cage that is to be subdivided and moved onto a field: what PatchRefinement, project and untangle are
/// given. All has to outlive what it is given to.
struct QuadJob {
    CageView cage;                          ///< its topology
    int levels = 2;                         ///< times that it is refined
    std::span<const Vec3> positions;        ///< [m] one per cage vertex
    std::span<const Vec3> anchors;          ///< [m] one per cage vertex
    std::span<const std::uint32_t> region;  ///< per cage quad: of the field
    std::span<const ClipPlane> clips;       ///< one per flat end, by first quad
    ProjectOptions project;                 ///< as for project()
    UntangleOptions untangle;               ///< as for untangle()
    /// Per cage quad: which of several reports tells of it. Empty: there is one, of all.
    std::span<const std::uint32_t> part = {};
    std::uint32_t parts = 1;  ///< reports; quads of no lower part are in none of them

    /// Which report tells of a refined quad.
    std::uint32_t part_of_quad(std::uint32_t refined) const {
        return part.empty() ? 0 : part[refined >> (2 * levels)];
    }
};

/// A job with the field that it is moved onto.
struct QuadTask {
    QuadJob job;                              ///< all but `part`
    const ConvolutionField* field = nullptr;  ///< with its regions
};

/// Where the results of a job are copied to: buffers that are resized.
struct QuadPlaces {
    Buffer<Vec3>* positions = nullptr;  ///< [m] per refined vertex
    Buffer<Vec3>* anchors = nullptr;    ///< [m] the same; none: they are not copied
};

/// What was done to a job.
struct QuadReport {
    ProjectReport projected;   ///< as from project()
    UntangleReport untangled;  ///< as from untangle()
    /// False where the card had no room for the job as a whole, and did it in pieces: then what is folded is
    /// left to untangle().
    bool is_whole = true;
};

/// What comes out of a job.
struct QuadCounts {
    std::uint32_t vertices;  ///< refined
    std::uint32_t quads;     ///< refined
};

/// Of a cage of so many vertices, edges and quads that is refined so many times.
QuadCounts refined_counts(std::uint32_t vertices, std::uint32_t edges, std::uint32_t quads, int levels);
/// The same of a cage. It must be one that PatchRefinement takes.
QuadCounts refined_counts(const CageView& cage, int levels);

/// [bytes] Of a card that a job takes, if not more than a fiftieth of its quads is folded.
std::uint64_t bytes_of_job(const QuadJob& job);

/// [bytes] Of a card that a field of so many segments takes, whose lists have so many entries.
std::uint64_t bytes_of_field(std::uint64_t segments, std::uint64_t entries);

/// [bytes] The same of a field of so many segments in so many regions, with all that finding its lists takes.
std::uint64_t bytes_of_contacts(std::uint64_t segments, std::uint64_t regions);

/// [bytes] What arrays are rounded up by, and what is small.
inline constexpr std::uint64_t kSlackBytes = std::uint64_t{16} << 20;

}  // namespace coppice::cuda
