#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "coppice/base/context.h"
#include "coppice/base/id.h"

namespace coppice::mtg {

inline constexpr std::uint16_t kFinestScale = 64;  ///< maximum scale of a class
inline constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

/// An entity of a plant at one scale. It refers to preceding entities only.
struct Vertex {
    std::uint32_t complex = kNoIndex;  ///< the entity of a coarser scale of which it is a component
    /// Predecessor: the finest known entity that it succeeds or branches off, or its complex if it is only a
    /// component of that.
    std::uint32_t before = kNoIndex;
    std::uint32_t line = 0;
    std::uint32_t components = 0;    ///< number of its components
    std::uint32_t index = kNoIndex;  ///< number in its label, if any
    std::uint16_t scale = 0;
    std::uint16_t symbol = 0;  ///< index into the symbols of the document
    char edge = '/';           ///< '<' succeeds, '+' branches off, '/' is a component
};

/// A feature: a column of the file.
struct Column {
    std::string name;  ///< as in the file
    bool is_number = true;
};

struct Value {
    std::uint32_t vertex = 0, column = 0;
    double value = 0;
};

/// Content of a file. Vertex 0 is the whole scene, at scale 0.
struct Document {
    std::vector<Vertex> vertices;
    std::vector<std::string> symbols;
    std::vector<Column> columns;
    std::vector<Value>
        values;  ///< numbers, sorted by vertex, then column; the last one if a cell has several
    bool is_form_b = false;
};

/// Parses a coding file. Throws InvalidInput "source:line: ..." if it is not valid. O(n log n), not
/// recursive; ranges such as E1<<E9 may imply as many entities as the file has bytes.
Document parse_document(std::string_view text, const std::string& source, const Context& ctx);

}  // namespace coppice::mtg
