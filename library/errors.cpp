#include "library/errors.h"

#include "algorithms/registry.h"
#include "library/pair.h"

#include <exception>
#include <new>
#include <stdexcept>
#include <vector>

namespace hausbench::library {

void copy_text(char* to, std::size_t room, std::string text) {
    if (text.size() >= room) {
        std::size_t end = room - 1;
        while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xc0) == 0x80) --end;  // inside a character
        text.resize(end);
    }
    std::memcpy(to, text.c_str(), text.size() + 1);
}

namespace {

// Allocates nothing before a text exists, because memory may have run out.
int describe(hausbench_error* error, int code, const char* text, int argument, std::int64_t row) noexcept {
    if (!error) return code;
    hausbench_error ours = HAUSBENCH_ERROR_INIT;
    ours.code = code;
    ours.argument = argument;
    ours.row = row;
    try {
        copy_text(ours.text, sizeof ours.text, one_line(text));
    } catch (...) {
        std::strncpy(ours.text, "no memory is left for the text of this error", sizeof ours.text - 1);
    }
    give(*error, ours);
    return code;
}

}  // namespace

int describe_exception(hausbench_error* error) noexcept {
    constexpr const char* no_memory = "no memory is left: use smaller shapes, or free some memory";
    try {
        throw;
    } catch (const ArgumentError& wrong) {
        return describe(error, HAUSBENCH_BAD_INPUT, wrong.what(), wrong.argument(), wrong.row());
    } catch (const InputError& wrong) {
        return describe(error, HAUSBENCH_BAD_INPUT, wrong.what(), 0, -1);
    } catch (const std::bad_alloc&) {
        return describe(error, HAUSBENCH_NO_MEMORY, no_memory, 0, -1);
    } catch (const std::length_error&) {
        return describe(error, HAUSBENCH_NO_MEMORY, no_memory, 0, -1);
    } catch (const std::exception& wrong) {
        return describe(error, HAUSBENCH_INTERNAL, wrong.what(), 0, -1);
    } catch (...) {
        return describe(error, HAUSBENCH_INTERNAL, "an exception without a text", 0, -1);
    }
}

}  // namespace hausbench::library

extern "C" {

const char* hausbench_version(void) { return HAUSBENCH_VERSION; }

int hausbench_interface(void) { return HAUSBENCH_INTERFACE; }

const char* hausbench_solver(size_t number) {
    const auto name = [&] {
        for (const hausbench::SolverEntry& entry : hausbench::solvers()) {
            if (hausbench::library::is_for_plans(entry.info) && number-- == 0) return entry.info.name.c_str();
        }
        return static_cast<const char*>(nullptr);
    };
    try {
        return name();
    } catch (...) {
        return nullptr;
    }
}

}  // extern "C"
