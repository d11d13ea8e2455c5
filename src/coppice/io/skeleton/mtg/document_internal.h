#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "coppice/base/context.h"

namespace coppice::mtg {

inline constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
inline constexpr std::uint16_t kFinestScale = 64;  ///< no class is of a greater one
inline constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

/// An entity of a plant at one scale. All that it names were written before it.
struct Vertex {
    std::uint32_t complex = kNone;  ///< the entity of a coarser scale that it is a part of
    /// What it goes on from: the finest entity known where it follows or branches off, or its complex where
    /// it is only a part of that.
    std::uint32_t before = kNone;
    std::uint32_t line = 0;
    std::uint32_t components = 0;  ///< number of its own parts
    std::uint32_t index = kNone;   ///< the number in its label, if it has one
    std::uint16_t scale = 0;
    std::uint16_t symbol = 0;  ///< index into its document's symbols
    char edge = '/';           ///< '<' follows, '+' branches off, '/' is a part
};

/// A feature: a column of the file.
struct Column {
    std::string name;  ///< as written
    bool is_number = true;
};

struct Value {
    std::uint32_t vertex = 0, column = 0;
    double value = 0;
};

/// What a file says. Vertex 0 is the whole scene, at scale 0.
struct Document {
    std::vector<Vertex> vertices;
    std::vector<std::string> symbols;
    std::vector<Column> columns;
    std::vector<Value> values;  ///< numbers, by vertex, then column; of several for one cell the last
    bool is_form_b = false;
};

/// Reads a coding file. Throws InvalidInput "source:line: ..." for what is none. O(n log n), no recursion;
/// ranges such as E1<<E9 may imply as many entities as the file has bytes.
Document parse_document(std::string_view text, const std::string& source, const Context& ctx);

}  // namespace coppice::mtg
