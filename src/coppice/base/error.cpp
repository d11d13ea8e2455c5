#include "coppice/base/error.h"

#include <string>

namespace coppice {

void assertion_failed(const char* condition, const char* file, int line) {
    throw PreconditionBroken(std::string(file) + ":" + std::to_string(line) +
                             ": precondition broken: " + condition);
}

}  // namespace coppice
