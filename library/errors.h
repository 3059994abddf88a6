// Errors and structs as they cross the C boundary.
#pragma once

#include "algorithms/error.h"
#include "library/hausbench.h"

#include <algorithm>
#include <cfenv>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>

namespace hausbench::library {

// An error of one argument of a function. `argument` counts from 1; `row` is the wrong row of an array, or -1.
class ArgumentError : public InputError {
public:
    ArgumentError(int argument, const std::string& text, std::int64_t row = -1)
        : InputError(text), argument_(argument), row_(row) {}

    int argument() const { return argument_; }
    std::int64_t row() const { return row_; }

private:
    int argument_;
    std::int64_t row_;
};

// Throws ArgumentError if the pointer is null.
template <class T> T* given(T* pointer, const char* name, int argument) {
    if (!pointer) throw ArgumentError(argument, std::string(name) + ": is NULL: give a pointer");
    return pointer;
}

// The size of a struct in the first version of the interface that has it. Callers may know no smaller one.
template <class T> inline constexpr std::size_t first_size = 0;
template <> inline constexpr std::size_t first_size<hausbench_error> = offsetof(hausbench_error, text) + 1024;
template <>
inline constexpr std::size_t first_size<hausbench_read_options> = offsetof(hausbench_read_options, reserved) + 4;
template <>
inline constexpr std::size_t first_size<hausbench_description> = offsetof(hausbench_description, diagonal) + 8;
template <> inline constexpr std::size_t first_size<hausbench_plan> = offsetof(hausbench_plan, reserved) + 4;
template <> inline constexpr std::size_t first_size<hausbench_query> = offsetof(hausbench_query, reserved) + 4;
template <> inline constexpr std::size_t first_size<hausbench_answer> = offsetof(hausbench_answer, solve_seconds) + 8;
template <> inline constexpr std::size_t first_size<hausbench_verdict> = offsetof(hausbench_verdict, text) + 1024;

// Throws ArgumentError if the caller's struct was not initialised, or is of no version of the interface.
template <class T> void expect_size(const T& theirs, const char* name, int argument) {
    if (theirs.size < first_size<T>)
        throw ArgumentError(argument, std::string(name) + ": its member `size` is " + std::to_string(theirs.size) +
                                          ", less than " + std::to_string(first_size<T>) +
                                          ": initialise the struct with its macro");
}

// Throws ArgumentError unless the flag is 0 or 1.
inline void expect_flag(std::int32_t flag, const char* name, int argument) {
    if (flag != 0 && flag != 1)
        throw ArgumentError(argument, std::string(name) + ": is " + std::to_string(flag) + ": give 0 or 1");
}

// Returns the caller's struct, with initial values for members that the caller does not know. NULL: all of them.
template <class T> T taken(const T* theirs, const T& initial, const char* name, int argument) {
    T ours = initial;
    if (!theirs) return ours;
    expect_size(*theirs, name, argument);
    std::memcpy(static_cast<void*>(&ours), theirs, std::min(theirs->size, sizeof(T)));
    ours.size = sizeof(T);
    return ours;
}

// Writes the members that the caller knows.
template <class T> void give(T& theirs, const T& ours) {
    const std::size_t size = theirs.size;
    std::memcpy(static_cast<void*>(&theirs), &ours, std::min(size, sizeof(T)));
    theirs.size = size;
}

// Copies a text into an array of a struct, cut at the end of a character.
void copy_text(char* to, std::size_t room, std::string text);

// Computes in the default floating-point environment (rounding to nearest, with subnormal numbers), whatever the
// caller's is, and gives the caller's back.
class DefaultArithmetic {
public:
    DefaultArithmetic() {
        std::fegetenv(&theirs_);
        std::fesetenv(FE_DFL_ENV);
    }
    ~DefaultArithmetic() { std::fesetenv(&theirs_); }
    DefaultArithmetic(const DefaultArithmetic&) = delete;

private:
    std::fenv_t theirs_;
};

// Describes the exception that is being handled, and returns its code. Call it in a catch block.
int describe_exception(hausbench_error* error) noexcept;

// Runs the body of an exported function. Returns HAUSBENCH_OK, or the code of the exception that it throws.
template <class Body> int guarded(hausbench_error* error, const Body& body) noexcept {
    try {
        if (error && error->size < first_size<hausbench_error>) return HAUSBENCH_BAD_INPUT;  // no room for a text
        const DefaultArithmetic arithmetic;
        body();
        return HAUSBENCH_OK;
    } catch (...) {
        return describe_exception(error);
    }
}

}  // namespace hausbench::library
