#include "algorithms/kernel/pages.h"

#include <sys/mman.h>

#include <cstdint>

namespace hausbench {

namespace {

constexpr std::size_t page = 4096, least = 16 * page;

// The whole pages among some bytes.
struct Pages {
    Pages(void* begin, std::size_t bytes) {
        const auto first = (reinterpret_cast<std::uintptr_t>(begin) + page - 1) / page * page;
        const auto last = (reinterpret_cast<std::uintptr_t>(begin) + bytes) / page * page;
        at = reinterpret_cast<void*>(first);
        size = bytes < least ? 0 : last - first;
    }
    void* at;
    std::size_t size;  // 0: too few to be worth a call
};

}  // namespace

void want_huge_pages(void* begin, std::size_t bytes) {
    const Pages pages(begin, bytes);
    if (pages.size > 0) (void)::madvise(pages.at, pages.size, MADV_HUGEPAGE);
}

void touch_pages(void* begin, std::size_t bytes) {
    constexpr int populate_write = 23;  // MADV_POPULATE_WRITE since Linux 5.14; older C libraries do not name it
    want_huge_pages(begin, bytes);      // a huge page takes one fault instead of 512
    const Pages pages(begin, bytes);
    // An error means that nothing was done, and the pages come one by one.
    if (pages.size > 0) (void)::madvise(pages.at, pages.size, populate_write);
}

}  // namespace hausbench
