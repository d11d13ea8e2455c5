#pragma once

#include <string_view>

namespace coppice::cli {

/// Opens /dev/null for each of standard input, output and error that is closed, so that no other file
/// receives its descriptor. Reading and writing still fail. Must be called before any file is opened.
void open_standard_streams();

/// Writes to standard output. Throws IoError on failure.
void print(std::string_view text);

/// Writes the buffered output of print(). Throws IoError on failure.
void flush_output();

/// Writes to standard error. Ignores failures, as they cannot be reported.
void print_error(std::string_view text) noexcept;

}  // namespace coppice::cli
