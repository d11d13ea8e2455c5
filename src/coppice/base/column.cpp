#include "coppice/base/column.h"

#include <cstdlib>
#include <new>

#ifdef __linux__
#include <sys/mman.h>
#endif

namespace coppice {
namespace {

constexpr std::size_t kHugePage = std::size_t{2} << 20;

}  // namespace

void* allocate_large(std::size_t bytes) {
    if (bytes > static_cast<std::size_t>(-1) - kHugePage) throw std::bad_alloc();
    const std::size_t rounded = (bytes + kHugePage - 1) / kHugePage * kHugePage;
    void* p = nullptr;
    while ((p = std::aligned_alloc(kHugePage, rounded)) == nullptr) {
        const std::new_handler handler = std::get_new_handler();  // as operator new does
        if (handler == nullptr) throw std::bad_alloc();
        handler();
    }
#ifdef __linux__
    madvise(p, rounded, MADV_HUGEPAGE);  // only a hint: if it fails, small pages are used
#endif
    return p;
}

void free_large(void* p) noexcept { std::free(p); }

}  // namespace coppice
