// Memory for large arrays that are filled as a whole, soon after they are allocated.
#pragma once

#include <cstddef>
#include <vector>

namespace hausbench {

// Makes the system provide all pages of these bytes at once, as huge pages where they fit. Otherwise the first write to
// each page is a fault, which takes 0.2 to 13 us on the machines that were measured; filling the page takes less. The
// content stays. Does nothing for arrays of a few pages, and where the system cannot do it.
void touch_pages(void* begin, std::size_t bytes);

// Reserves room for `count` elements in a vector that will be filled, and touches its pages.
template <class T> void reserve_touched(std::vector<T>& vector, std::size_t count) {
    if (vector.capacity() >= count) return;
    vector.reserve(count);
    touch_pages(vector.data(), count * sizeof(T));
}

// Returns a vector of `count` value-initialised elements, with its pages touched.
template <class T> std::vector<T> filled(std::size_t count) {
    std::vector<T> vector;
    reserve_touched(vector, count);
    vector.resize(count);
    return vector;
}

}  // namespace hausbench
