#include "paths.h"

namespace coppice {

std::filesystem::path source_dir() { return COPPICE_SOURCE_DIR; }

}  // namespace coppice
