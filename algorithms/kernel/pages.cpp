#include "algorithms/kernel/pages.h"

#include <sys/mman.h>

#include <cstdint>

namespace hausbench {

void touch_pages(void* begin, std::size_t bytes) {
    constexpr std::size_t page = 4096, least = 16 * page;
    constexpr int populate_write = 23;  // MADV_POPULATE_WRITE since Linux 5.14; older C libraries do not name it
    if (bytes < least) return;
    const auto first = (reinterpret_cast<std::uintptr_t>(begin) + page - 1) / page * page;
    const auto last = (reinterpret_cast<std::uintptr_t>(begin) + bytes) / page * page;
    // A huge page takes one fault instead of 512.
    (void)::madvise(reinterpret_cast<void*>(first), last - first, MADV_HUGEPAGE);
    // An error means that nothing was done, and the pages come one by one.
    (void)::madvise(reinterpret_cast<void*>(first), last - first, populate_write);
}

}  // namespace hausbench
