#include <algorithm>
#include <iterator>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "coppice/base/error.h"
#include "coppice/io/text.h"
#include "coppice/io_skeleton/cylinders/columns_internal.h"
#include "coppice/io_skeleton/parsers_internal.h"

namespace coppice {

namespace {

constexpr std::string_view kCylinders = "cyls";

/// Base of handlers of JSON events: ignores all events and stores nothing.
struct Events : nlohmann::json::json_sax_t {
    bool null() override { return scalar("NA"); }
    bool boolean(bool value) override { return scalar(value ? "1" : "0"); }
    bool number_integer(number_integer_t value) override { return scalar(fmt::to_string(value)); }
    bool number_unsigned(number_unsigned_t value) override { return scalar(fmt::to_string(value)); }
    bool number_float(number_float_t, const string_t& text) override { return scalar(text); }
    bool string(string_t& value) override { return text(value); }
    bool binary(binary_t&) override { return true; }
    bool start_object(std::size_t) override { return enter(); }
    bool end_object() override { return leave(); }
    bool start_array(std::size_t) override { return enter(); }
    bool end_array() override { return leave(); }
    bool key(string_t& name) override { return key_at(name); }
    bool parse_error(std::size_t, const std::string&, const nlohmann::json::exception&) override {
        return false;
    }

  protected:
    virtual bool scalar(std::string_view) { return true; }
    virtual bool text(std::string&) { return true; }
    virtual bool key_at(std::string&) { return true; }

    std::size_t depth() const { return depth_; }

  private:
    bool enter() {
        constexpr std::size_t kDeepest = 32;
        return ++depth_ <= kDeepest;
    }
    bool leave() {
        --depth_;
        return true;
    }
    std::size_t depth_ = 0;
};

/// Finds the text of the table of cylinders in the file.
class TableFinder : public Events {
  public:
    std::string table;
    bool found = false;

  protected:
    bool key_at(std::string& name) override {
        is_table_ = depth() == 1 && name == kCylinders;
        return true;
    }
    bool text(std::string& value) override {
        if (!is_table_ || depth() != 1) return true;
        table = std::move(value);
        found = true;
        return false;  // the rest is not needed
    }

  private:
    bool is_table_ = false;
};

/// Reads a table column by column: an object with the column names as keys and objects of the values by row
/// as values.
class ColumnReader : public Events {
  public:
    struct Column {
        std::string name;
        std::vector<std::string> values;
    };
    std::vector<Column> columns;

  protected:
    bool key_at(std::string& name) override {
        if (depth() == 1) columns.push_back({name, {}});
        return true;
    }
    bool scalar(std::string_view value) override {
        if (depth() == 2) columns.back().values.emplace_back(value);
        return depth() == 2;
    }
    bool text(std::string&) override { return scalar("NA"); }
};

/// Returns the columns as rows of a table with a header.
std::string format_rows(const std::vector<ColumnReader::Column>& columns) {
    std::string out;
    const auto add_row = [&](const auto& compute_cell) {
        for (std::size_t c = 0; c < columns.size(); ++c)
            fmt::format_to(std::back_inserter(out), "{}{}", c == 0 ? "" : ";", compute_cell(columns[c]));
        out += '\n';
    };
    add_row([](const auto& column) { return plain_name(column.name); });
    for (std::size_t i = 0; i < columns.front().values.size(); ++i)
        add_row([&](const auto& column) -> const std::string& { return column.values[i]; });
    return out;
}

}  // namespace

std::optional<RawCylinders> parse_treegraph(std::string_view text, const std::string& source,
                                            const Context& ctx) {
    if (text.find(fmt::format("\"{}\"", kCylinders)) == text.npos) return std::nullopt;
    if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
    TableFinder finder;
    nlohmann::json::sax_parse(text.begin(), text.end(), &finder);
    if (!finder.found) return std::nullopt;
    ctx.throw_if_cancelled();

    const auto fail = [&](std::string_view subject) {
        throw InvalidInput(fmt::format("{}: the table '{}' {}", source, kCylinders, subject));
    };
    ColumnReader reader;
    if (!nlohmann::json::sax_parse(finder.table, &reader) || reader.columns.empty())
        fail("is not JSON of columns by name, each with a value for every row");
    const std::size_t count = reader.columns.front().values.size();
    for (const ColumnReader::Column& column : reader.columns)
        if (column.values.size() != count) fail("has columns of different lengths");
    std::erase_if(reader.columns, [](const ColumnReader::Column& c) { return plain_name(c.name).empty(); });
    return parse_cylinders(format_rows(reader.columns), fmt::format("{}: table '{}'", source, kCylinders), 0,
                           ctx);
}

}  // namespace coppice
