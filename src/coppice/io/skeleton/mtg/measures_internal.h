#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "coppice/base/vec.h"
#include "coppice/io/skeleton/mtg/document_internal.h"

namespace coppice::mtg {

/// What the columns of a file mean by their names; see docs/user/formats.md. Numbers are as written.
class Measures {
  public:
    explicit Measures(const Document& document);

    std::optional<Vec3d> place(std::uint32_t vertex) const;  ///< where its coordinates are
    double end_radius(std::uint32_t vertex) const;           ///< kUnknown where there is none
    double begin_radius(std::uint32_t vertex) const;         ///< of its base; kUnknown likewise
    double length(std::uint32_t vertex) const { return value(vertex, length_); }        ///< or kUnknown
    double insertion(std::uint32_t vertex) const { return value(vertex, insertion_); }  ///< degrees
    double azimuth(std::uint32_t vertex) const { return value(vertex, azimuth_); }      ///< degrees
    /// A column of numbers; kUnknown where the vertex has none.
    double value(std::uint32_t vertex, std::uint32_t column) const;

    bool has_places() const { return place_[0] != kNone && place_[1] != kNone && place_[2] != kNone; }
    bool has_lengths() const { return length_ != kNone; }
    bool has_diameters() const;  ///< whether thickness is told as diameters and not as radii

  private:
    const Document& document_;
    std::vector<std::uint32_t> first_value_;  // by vertex, and one past the last
    std::array<std::uint32_t, 3> place_{kNone, kNone, kNone};
    std::uint32_t radius_ = kNone, diameter_ = kNone, top_ = kNone, base_ = kNone;
    std::uint32_t length_ = kNone, insertion_ = kNone, azimuth_ = kNone;
};

/// Where plants are told by places: nodes for the entities that have one, and for those that bear some and
/// lie between them. The ids of nodes are their indices; `vertex` tells whose they are.
struct Nodes {
    struct Node {
        std::uint32_t vertex = 0;
        std::uint32_t parent = kNone;
        Vec3d position;
        double radius = kUnknown;
        bool is_measured = true;  ///< and not placed between others
    };
    std::vector<Node> nodes;
};
Nodes nodes_of_places(const Document& document, const Measures& measures);

/// Where plants are told by lengths: every entity without parts goes on straight from the one before it or
/// turns off it.
Nodes nodes_of_lengths(const Document& document, const Measures& measures);

}  // namespace coppice::mtg
