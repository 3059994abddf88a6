// Turns errors of the C library into Python exceptions.
#pragma once

#include "library/hausbench.h"

#include <pybind11/pybind11.h>

namespace hausbench_python {

// Throws hausbench.InputError, with the row of the array in its attribute `row`, or MemoryError, or RuntimeError.
// Needs the GIL.
[[noreturn]] void throw_python(const hausbench_error& error);

// Throws hausbench.InputError without a row. Needs the GIL.
[[noreturn]] void throw_input_error(const char* text);

// Returns a text of the library. It may hold bytes of a file that are not UTF-8; they become question marks. Needs the
// GIL.
pybind11::object text_of(const char* text);

// Throws if a function of the library failed.
inline void check(int code, const hausbench_error& error) {
    if (code != HAUSBENCH_OK) throw_python(error);
}

}  // namespace hausbench_python
