#pragma once

#include <filesystem>

namespace coppice {

/// The folder of the sources, with docs, examples and tests. Defined by one object, so that clones share the
/// others.
std::filesystem::path source_dir();

}  // namespace coppice
