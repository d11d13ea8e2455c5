#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "coppice/base/ascii.h"
#include "coppice/base/error.h"
#include "coppice/io/text.h"

namespace coppice {

namespace {

/// Returns whether a token out of the range of double is too small rather than too large: its exponent is
/// negative, or it has no exponent and starts with "0.".
bool is_underflow(std::string_view token) {
    const std::size_t exponent = token.find_first_of("eE");
    if (exponent != std::string_view::npos) return exponent + 1 < token.size() && token[exponent + 1] == '-';
    const std::size_t first = token.find_first_not_of("+-0");
    return first != std::string_view::npos && token[first] == '.';
}

}  // namespace

std::string_view trimmed(std::string_view text) {
    while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
    while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
    return text;
}

std::optional<double> parse_number(std::string_view token) {
    if (token.size() > 1 && token[0] == '+' && token[1] != '-') token.remove_prefix(1);
    double value = 0;
    const char* const end = token.data() + token.size();
    const auto [stop, error] = std::from_chars(token.data(), end, value);
    if (stop != end || error == std::errc::invalid_argument) return std::nullopt;
    if (error == std::errc::result_out_of_range) {
        if (is_underflow(token)) return 0.0;
        const double infinity = std::numeric_limits<double>::infinity();
        return token[0] == '-' ? -infinity : infinity;
    }
    return value;
}

std::optional<std::int64_t> parse_integer(std::string_view token) {
    constexpr double kLargest = 9007199254740992.0;
    std::int64_t value = 0;
    const char* const end = token.data() + token.size();
    const auto [stop, error] = std::from_chars(token.data(), end, value);
    if (error == std::errc{} && stop == end) {
        if (std::abs(static_cast<double>(value)) > kLargest) return std::nullopt;
        return value;
    }
    const std::optional<double> number = parse_number(token);
    if (!number || !(std::abs(*number) <= kLargest) || *number != std::trunc(*number)) return std::nullopt;
    return static_cast<std::int64_t>(*number);
}

std::string in_quotes(std::string_view token) {
    constexpr std::size_t kLongest = 40;
    std::string text = "'";
    for (const char c : token.substr(0, kLongest)) text += c >= ' ' && c <= '~' ? c : '?';
    if (token.size() > kLongest) text += "...";
    return text + "'";
}

std::string plain_name(std::string_view name) {
    std::string plain;
    for (const char raw : name.substr(0, name.find_first_of("(["))) {
        if (is_digit(raw) || is_letter(raw)) plain += to_lower(raw);
    }
    return plain;
}

LineReader::LineReader(std::string_view text, const Context& ctx)
    : progress_(ctx, text.size()), size_(text.size()), rest_(text) {
    if (rest_.starts_with("\xEF\xBB\xBF")) rest_.remove_prefix(3);
}

bool LineReader::next() {
    if (rest_.empty()) return false;
    progress_.at(size_ - rest_.size());
    const std::size_t end = std::min(rest_.find_first_of("\n\r"), rest_.size());
    line_ = rest_.substr(0, end);
    const bool crlf = rest_.substr(end).starts_with("\r\n");
    rest_.remove_prefix(std::min(rest_.size(), end + (crlf ? 2 : 1)));
    ++number_;
    return true;
}

void split_row(std::string_view line, std::vector<std::string_view>& cells) {
    cells.clear();
    const auto skip_blanks = [&] {
        while (!line.empty() && is_blank(line.front())) line.remove_prefix(1);
    };
    const auto is_comma = [](char c) { return c == ',' || c == ';'; };
    for (skip_blanks(); !line.empty(); skip_blanks()) {
        const char first = line.front();
        const bool quoted = first == '"' || first == '\'';
        std::size_t end = quoted ? line.find(first, 1) : 0;
        if (quoted && end != line.npos) {
            cells.push_back(trimmed(line.substr(1, end - 1)));
            line.remove_prefix(end + 1);
        } else {
            for (end = 0; end < line.size() && !is_blank(line[end]) && !is_comma(line[end]);) ++end;
            cells.push_back(line.substr(0, end));
            line.remove_prefix(end);
        }
        skip_blanks();
        if (!line.empty() && is_comma(line.front())) line.remove_prefix(1);
    }
}

void split_at_blanks(std::string_view line, std::vector<std::string_view>& cells, bool commas) {
    cells.clear();
    const auto separates = [commas](char c) { return is_blank(c) || (commas && (c == ',' || c == ';')); };
    std::size_t i = 0;
    while (i < line.size()) {
        while (i < line.size() && separates(line[i])) ++i;
        const std::size_t begin = i;
        while (i < line.size() && !separates(line[i])) ++i;
        if (i > begin) cells.push_back(line.substr(begin, i - begin));
    }
}

void split_at(std::string_view line, char separator, std::vector<std::string_view>& cells) {
    cells.clear();
    while (true) {
        std::size_t end = line.find(separator);
        const std::size_t quote = line.find_first_not_of(' ');
        if (quote != std::string_view::npos && line[quote] == '"') {
            const std::size_t close = line.find('"', quote + 1);
            if (close != std::string_view::npos) end = line.find(separator, close);
        }
        std::string_view cell = trimmed(line.substr(0, end));
        if (cell.size() >= 2 && cell.front() == '"' && cell.back() == '"') {
            cell = trimmed(cell.substr(1, cell.size() - 2));
        }
        cells.push_back(cell);
        if (end == std::string_view::npos) break;
        line.remove_prefix(end + 1);
    }
    if (cells.size() > 1 && cells.back().empty()) cells.pop_back();
}

bool has_decimal_commas(std::string_view row, std::size_t columns) {
    if (row.find(',') == row.npos) return false;
    const auto separates = [](char c) { return is_blank(c) || c == ';'; };
    std::size_t count = 0;
    bool any = false;
    for (std::size_t i = 0; i < row.size() && count < columns; ++i) {
        const std::size_t begin = i;
        while (i < row.size() && !separates(row[i])) ++i;
        if (i == begin) continue;
        const std::string_view cell = row.substr(begin, i - begin);
        const std::size_t comma = cell.find(',');
        const bool decimal = comma != cell.npos && parse_number(cell.substr(0, comma)) &&
                             parse_integer(cell.substr(comma + 1));
        if (!decimal && !parse_number(cell)) return false;
        any = any || decimal;
        ++count;
    }
    return any && count == columns;
}

bool has_only_commas(std::string_view row) { return row.find(',') != row.npos && row.find('.') == row.npos; }

void fail_at(const std::string& source, std::size_t line, std::string_view text) {
    throw InvalidInput(fmt::format("{}:{}: {}", source, line, text));
}

}  // namespace coppice
