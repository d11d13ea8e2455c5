#include <cstdio>

#include "coppice/skeleton/measure.h"
#include "coppice/skeleton/random_tree.h"
#include "coppice/version.h"

static_assert(COPPICE_VERSION_MAJOR >= 0 && !coppice::kVersion.empty());

int main() {
    const coppice::SkeletonMeasures tree = coppice::measure(coppice::random_tree(100, 1));
    std::printf("coppice %s: %u segments\n", coppice::kVersion.data(), tree.segments);
    return tree.segments == 100 ? 0 : 1;
}
