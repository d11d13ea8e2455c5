#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "coppice/io/file_progress.h"

namespace coppice {

/// Numbers and lines of untrusted text, independent of the locale and without copies.

inline bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\f' || c == '\v'; }

/// The text without blanks at its ends.
std::string_view trimmed(std::string_view text);

/// The whole token as a number: "1", "-1.", "+2", "1.0000e+000", "nan", "inf"; none when anything else is in
/// it. Numbers beyond the range of double give an infinity or zero.
std::optional<double> parse_number(std::string_view token);

/// The whole token as an integer, also when it is written as a decimal ("1.0e+000"); none when it is not
/// whole or beyond 2^53.
std::optional<std::int64_t> parse_integer(std::string_view token);

/// The text in single quotes, shortened and with unprintable bytes replaced, for use in a message.
std::string in_quotes(std::string_view token);

/// Letters and digits in lower case: "Start_X (m)" gives "startx". What stands in brackets is left out.
std::string plain_name(std::string_view name);

/// Cuts a text into lines ended by LF, CR LF or CR; skips a byte order mark.
class LineReader {
  public:
    explicit LineReader(std::string_view text, const Context& ctx = {});

    /// Steps to the next line; false at the end of the text. Throws `Cancelled` when a stop was asked for.
    bool next();
    std::string_view line() const { return line_; }         ///< without its end
    std::uint32_t number() const { return number_; }        ///< from 1
    std::size_t remaining() const { return rest_.size(); }  ///< bytes after this line

  private:
    FileProgress progress_;
    std::size_t size_;
    std::string_view rest_;
    std::string_view line_;
    std::uint32_t number_ = 0;
};

/// Cuts a row of a table into cells: at blanks, commas and semicolons, but not within quotes (" or '), which
/// are taken off. Two commas with nothing between them enclose an empty cell.
void split_row(std::string_view line, std::vector<std::string_view>& cells);

/// Cuts a line at blanks; also at commas and semicolons when `commas` is set. Empty cells vanish.
void split_at_blanks(std::string_view line, std::vector<std::string_view>& cells, bool commas = false);

/// Cuts a line at `separator`; cells are trimmed, quotes about a cell are taken off, and one empty cell at
/// the end is dropped.
void split_at(std::string_view line, char separator, std::vector<std::string_view>& cells);

/// Whether blanks or semicolons separate at least `columns` numbers, and one of these has a decimal comma.
bool has_decimal_commas(std::string_view row, std::size_t columns);
/// Whether the row has commas and no decimal point, so that each comma may be a decimal comma.
bool has_only_commas(std::string_view row);
inline constexpr std::string_view kDecimalCommas =
    "its numbers have commas for decimal points, which cannot be told from commas between numbers; write "
    "them with points";

/// Throws InvalidInput "source:line: text".
[[noreturn]] void fail_at(const std::string& source, std::size_t line, std::string_view text);

}  // namespace coppice
