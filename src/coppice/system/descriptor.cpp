#include "coppice/system/descriptor.h"

#include <unistd.h>

#include <cerrno>

namespace coppice {

void Descriptor::close() {
    if (number_ < 0) return;
    const int kept = errno;
    ::close(std::exchange(number_, -1));
    errno = kept;
}

}  // namespace coppice
