#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <span>

#include <fmt/format.h>

#include "coppice/base/error.h"
#include "coppice/io/text.h"
#include "coppice/io_skeleton/cylinders/mat_file_internal.h"
#include "coppice/io_skeleton/cylinders/models_internal.h"
#include "coppice/io_skeleton/parsers_internal.h"

namespace coppice {

namespace {

/// Names of the columns of the cylinder table in versions of TreeQSM, in the form of `plain_name`. From
/// kBranch on they are optional; the last one contains branch, branch order and position in the branch.
enum Field { kRadius, kLength, kStart, kAxis, kParent, kBranch, kOrder, kRanks, kFieldCount };
constexpr std::array<std::array<std::string_view, 2>, kFieldCount> kFieldNames{
    {{"radius", "rad"},
     {"length", "len"},
     {"start", "sta"},
     {"axis", "axe"},
     {"parent", "cpar"},
     {"branch", "branch"},
     {"branchorder", "branchorder"},
     {"boc", "boc"}}};

/// The columns of one table of cylinders; null if a column is missing.
using Table = std::array<const MatArray*, kFieldCount>;

bool is_complete(const Table& table) {
    return std::ranges::all_of(std::span(table).first(kBranch),
                               [](const MatArray* column) { return column != nullptr; });
}

/// Returns the arrays of `arrays` that have the name of a column of cylinders.
Table make_table(std::span<const MatArray> arrays) {
    Table table{};
    for (const MatArray& array : arrays) {
        const std::string name = plain_name(array.name);
        for (std::size_t f = 0; f < kFieldCount; ++f) {
            const auto& known = kFieldNames[f];
            if (!table[f] && std::find(known.begin(), known.end(), name) != known.end()) table[f] = &array;
        }
    }
    return table;
}

/// Adds the tables in a variable at any depth: structs of columns, in the order of the file.
void collect(const MatArray& array, std::vector<Table>& models) {
    const bool structure = array.kind == MatArray::Kind::structure;
    const std::size_t group = structure ? array.fields.size() : 1;
    const std::span<const MatArray> items(array.items);
    for (std::size_t begin = 0; begin < items.size(); begin += group) {
        const auto element = items.subspan(begin, group);
        const Table table = structure ? make_table(element) : Table{};
        if (is_complete(table)) {
            models.push_back(table);
            continue;
        }
        for (const MatArray& item : element) collect(item, models);
    }
}

/// Returns whether a variable is a tree of the TREES toolbox, or cells of such trees.
bool is_trees_toolbox(const MatArray& array) {
    if (array.kind == MatArray::Kind::cell) return std::ranges::any_of(array.items, is_trees_toolbox);
    return std::ranges::find(array.fields, "dA") != array.fields.end();
}

class CylinderReader {
  public:
    CylinderReader(const Table& table, const std::string& source) : source_(source) {
        for (std::size_t f = 0; f < kBranch; ++f) {
            std::optional<std::vector<double>> numbers = table[f]->numbers();
            if (!numbers)
                fail(fmt::format("the column '{}' of the cylinders is not an array of numbers",
                                 kFieldNames[f][0]));
            column_[f] = std::move(*numbers);
        }
        for (std::size_t f = 0; f < kBranch; ++f) {
            const bool point = f == kStart || f == kAxis;
            if (column_[f].size() != (point ? 3 : 1) * count() || (point && table[f]->dims[0] != count())) {
                fail(fmt::format("there are {} radii, but the column '{}' has another shape", count(),
                                 kFieldNames[f][0]));
            }
        }
        for (std::size_t f = kBranch; f < kFieldCount; ++f)
            if (table[f]) column_[f] = table[f]->numbers().value_or(std::vector<double>{});
    }

    /// Adds orders and branches if the file specifies them for all cylinders.
    std::vector<RawAttribute> attributes() const {
        std::vector<RawAttribute> out;
        const std::span<const double> ranks(column_[kRanks]);
        const bool has_ranks = ranks.size() == 3 * count();
        const auto add = [&](std::string_view name, std::span<const double> own, std::size_t rank) {
            const auto values =
                own.size() == count() || !has_ranks ? own : ranks.subspan(rank * count(), count());
            if (values.size() == count()) out.push_back({std::string(name), {values.begin(), values.end()}});
        };
        add(kOrderOfNode, column_[kOrder], 1);
        add(kAxisOfNode, column_[kBranch], 0);
        return out;
    }

    std::vector<RawCylinder> cylinders() const {
        std::vector<RawCylinder> result;
        result.reserve(count());
        for (std::size_t i = 0; i < count(); ++i) {
            const Vec3d start = point(kStart, i);
            const Vec3d end = start + column_[kLength][i] * normalized(point(kAxis, i), Vec3d{});
            result.push_back({static_cast<std::int64_t>(i) + 1, parent(i), start, end, column_[kRadius][i],
                              static_cast<std::uint32_t>(i + 1)});
        }
        return result;
    }

  private:
    std::size_t count() const { return column_[kRadius].size(); }

    /// MATLAB stores arrays column by column.
    Vec3d point(Field f, std::size_t i) const {
        return {column_[f][i], column_[f][i + count()], column_[f][i + 2 * count()]};
    }

    /// Returns the number of the parent from 1; 0 means no parent.
    std::int64_t parent(std::size_t i) const {
        const double value = column_[kParent][i];
        if (!(value >= 0) || value > static_cast<double>(count()) || value != std::trunc(value)) {
            fail(fmt::format("the parent of cylinder {} is {}; it should be 0 to {}", i + 1, value, count()));
        }
        return value == 0 ? -1 : static_cast<std::int64_t>(value);
    }

    [[noreturn]] void fail(const std::string& text) const {
        throw InvalidInput(fmt::format("{}: {}", source_, text));
    }

    const std::string& source_;
    std::array<std::vector<double>, kFieldCount> column_;
};

}  // namespace

RawCylinders parse_mat(std::string_view bytes, const std::string& source, int model, const Context& ctx) {
    const MatFile file(bytes, source, ctx);
    std::vector<Table> models;
    if (const Table loose = make_table(file.variables()); is_complete(loose)) models.push_back(loose);
    for (const MatArray& variable : file.variables()) collect(variable, models);

    if (models.empty() && std::ranges::any_of(file.variables(), is_trees_toolbox)) {
        throw Unsupported(
            fmt::format("{}: it is a tree of the TREES toolbox, which is not read; save it in the toolbox as "
                        "SWC: swc_tree(tree, 'TREE.swc')",
                        source));
    }
    if (models.empty()) {
        throw InvalidInput(
            fmt::format("{}: it contains no cylinders: expected TreeQSM's 'QSM.cylinder' with radius, "
                        "length, start, axis and parent, or the variables Rad, Len, Sta, Axe and CPar",
                        source));
    }
    const CylinderReader reader(models[chosen_model(models.size(), model, source)], source);
    return {reader.cylinders(), reader.attributes(), {}, models.size()};
}

}  // namespace coppice
