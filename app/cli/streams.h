#pragma once

#include <string_view>

namespace coppice::cli {

/// Opens /dev/null for each of standard input, output and error that is closed, so that no other file gets
/// its number. Reading from it, or writing to it, still fails. To be called before any file is opened.
void open_standard_streams();

/// Writes to standard output. Throws IoError where that fails.
void print(std::string_view text);

/// Writes what print() has buffered. Throws IoError where that fails.
void flush_output();

/// Writes to standard error. Failures are ignored, because there is no place left to report them.
void print_error(std::string_view text) noexcept;

}  // namespace coppice::cli
