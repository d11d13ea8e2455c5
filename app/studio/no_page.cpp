#include "page.h"

namespace coppice::server {

std::span<const PageFile> embedded_page() { return {}; }

}  // namespace coppice::server
