#include "coppice/base/error.h"

#include <cstdio>
#include <cstdlib>

namespace coppice {

void assertion_failed(const char* condition, const char* file, int line) {
    std::fprintf(stderr, "%s:%d: precondition broken: %s\n", file, line, condition);
    std::abort();
}

}  // namespace coppice
