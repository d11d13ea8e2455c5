#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "coppice/base/id.h"
#include "coppice/base/vec.h"
#include "coppice/io_skeleton/mtg/document_internal.h"

namespace coppice::mtg {

/// Measures of entities, identified by the names of columns; see docs/user/formats.md. Numbers are
/// unconverted.
class Measures {
  public:
    explicit Measures(const Document& document);

    std::optional<Vec3d> place(std::uint32_t vertex) const;  ///< its coordinates, if any
    double end_radius(std::uint32_t vertex) const;           ///< kUnknown if not specified
    double begin_radius(std::uint32_t vertex) const;  ///< radius at its base; kUnknown if not specified
    double length(std::uint32_t vertex) const {
        return value(vertex, length_);
    }  ///< kUnknown if not specified
    double insertion(std::uint32_t vertex) const { return value(vertex, insertion_); }  ///< degrees
    double azimuth(std::uint32_t vertex) const { return value(vertex, azimuth_); }      ///< degrees
    /// Returns a value of a numeric column; kUnknown if the vertex has none.
    double value(std::uint32_t vertex, std::uint32_t column) const;

    bool has_places() const {
        return place_[0] != kNoIndex && place_[1] != kNoIndex && place_[2] != kNoIndex;
    }
    bool has_lengths() const { return length_ != kNoIndex; }
    bool has_diameters() const;  ///< whether thickness is specified as diameters rather than radii

  private:
    const Document& document_;
    std::vector<std::uint32_t> first_value_;  // by vertex, and one past the last
    std::array<std::uint32_t, 3> place_{kNoIndex, kNoIndex, kNoIndex};
    std::uint32_t radius_ = kNoIndex, diameter_ = kNoIndex, top_ = kNoIndex, base_ = kNoIndex;
    std::uint32_t length_ = kNoIndex, insertion_ = kNoIndex, azimuth_ = kNoIndex;
};

/// Nodes of plants with coordinates: one for each entity that has coordinates, and for those without that
/// bear such entities. The ids of nodes are their indices; `vertex` is the entity of a node.
struct Nodes {
    struct Node {
        std::uint32_t vertex = 0;
        std::uint32_t parent = kNoIndex;
        Vec3d position;
        double radius = kUnknown;
        bool is_measured = true;  ///< false if interpolated between others
    };
    std::vector<Node> nodes;
};
Nodes nodes_of_places(const Document& document, const Measures& measures);

/// Returns the nodes of plants specified by lengths: each entity without components continues its predecessor
/// straight or branches off it.
Nodes nodes_of_lengths(const Document& document, const Measures& measures);

}  // namespace coppice::mtg
