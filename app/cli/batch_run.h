#pragma once

#include "parser.h"
#include "run.h"

namespace coppice::cli {

/// Runs the command of a request; for many files (see plan_file_batch) once for each file, with several files
/// at the same time, a journal and a table of all files. A file that fails costs a row of the table with its
/// error, and exit code 4 at the end.
ExitCode run_request(Run& run, const Parser::Request& request);

}  // namespace coppice::cli
