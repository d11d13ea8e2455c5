#pragma once

#include "command.h"

namespace coppice::cli {

/// Checks the files that the options name before any work is done. Throws UsageError if two outputs are the
/// same file, or an output would overwrite an input that it may not replace; see OptionList::may_replace().
/// Different spellings of a path, and symbolic links, name the same file. Devices and pipes may be named
/// several times.
void check_outputs(const GivenOptions& given);

}  // namespace coppice::cli
