#pragma once

#include <filesystem>

namespace coppice {

/// The folder of the sources, with docs, examples and tests. One object has it, so that clones share the
/// others.
std::filesystem::path source_dir();

}  // namespace coppice
