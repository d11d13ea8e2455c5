#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "coppice/system/file_progress.h"

namespace coppice {

/// Parsing of numbers and lines of untrusted text, independent of the locale and without copies.

inline bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\f' || c == '\v'; }

/// Returns the text without leading and trailing blanks.
std::string_view trimmed(std::string_view text);

/// Parses the whole token as a number: "1", "-1.", "+2", "1.0000e+000", "nan", "inf"; returns nullopt if it
/// contains anything else. Numbers beyond the range of double return infinity or zero.
std::optional<double> parse_number(std::string_view token);

/// Parses the whole token as an integer, also one in decimal notation ("1.0e+000"); returns nullopt if it is
/// not integral or exceeds 2^53.
std::optional<std::int64_t> parse_integer(std::string_view token);

/// Returns the text in single quotes for use in a message, shortened and with unprintable bytes replaced.
std::string in_quotes(std::string_view token);

/// Returns the letters and digits in lower case without text in brackets: "startx" for "Start_X (m)".
std::string plain_name(std::string_view name);

/// Splits a text into lines that end with LF, CR LF or CR; skips a byte order mark.
class LineReader {
  public:
    /// The text and the context must outlive this object.
    explicit LineReader(std::string_view text, const Context& ctx = {});

    /// Moves to the next line; returns false at the end of the text. Throws `Cancelled` on cancellation.
    bool next();
    std::string_view line() const { return line_; }         ///< without its line end
    std::uint32_t number() const { return number_; }        ///< from 1
    std::size_t remaining() const { return rest_.size(); }  ///< number of bytes after this line

  private:
    FileProgress progress_;
    std::size_t size_;
    std::string_view rest_;
    std::string_view line_;
    std::uint32_t number_ = 0;
};

/// Splits a row of a table into cells at blanks, commas and semicolons outside quotes (" or '), which are
/// removed. Two adjacent commas enclose an empty cell.
void split_row(std::string_view line, std::vector<std::string_view>& cells);

/// Splits a line at blanks, and also at commas and semicolons if `commas` is set. Empty cells are dropped.
void split_at_blanks(std::string_view line, std::vector<std::string_view>& cells, bool commas = false);

/// Splits a line at `separator`; trims the cells, removes quotes around them and drops one empty cell at the
/// end.
void split_at(std::string_view line, char separator, std::vector<std::string_view>& cells);

/// Returns whether at least `columns` numbers are separated by blanks or semicolons and one of them has a
/// decimal comma.
bool has_decimal_commas(std::string_view row, std::size_t columns);
/// Returns whether the row has commas and no decimal point, so that each comma may be a decimal comma.
bool has_only_commas(std::string_view row);
/// The end of a sentence that refuses such a table.
inline constexpr std::string_view kDecimalCommas =
    "its numbers have decimal commas, which cannot be distinguished from commas between numbers; write them "
    "with decimal points";

/// Throws InvalidInput with the text "source:line: text".
[[noreturn]] void fail_at(const std::string& source, std::size_t line, std::string_view text);

}  // namespace coppice
