#include "harness/ask/no_answer.h"

#include "algorithms/error.h"

#include <exception>
#include <new>

namespace hausbench {

std::optional<NoAnswer> attempt(const std::function<void()>& work) {
    using Why = NoAnswer::Why;
    try {
        work();
    } catch (const InputError& error) {
        return NoAnswer{Why::refused, one_line(error.what())};
    } catch (const std::bad_alloc&) {
        return NoAnswer{Why::out_of_memory, "the solver was refused memory that it asked for"};
    } catch (const std::exception& error) {
        return NoAnswer{Why::failed, "the solver threw: " + one_line(error.what())};
    } catch (...) {
        return NoAnswer{Why::failed, "the solver threw something that is not a std::exception"};
    }
    return std::nullopt;
}

}  // namespace hausbench
