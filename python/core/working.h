// Runs the library without the GIL, and answers Ctrl-C meanwhile.
#pragma once

#include "library/hausbench.h"

#include <pybind11/pybind11.h>

#include <chrono>

namespace hausbench_python {

// One call of the library that may take long. Other Python threads run meanwhile.
class Working {
public:
    // Calls `call`, which is given no GIL, and returns its result. Throws KeyboardInterrupt, or what another signal
    // handler raised, if that happened meanwhile.
    template <typename Call> int run(Call call) {
        thread_ = PyEval_SaveThread();
        const int code = call();
        take_gil();
        if (interrupted_) throw pybind11::error_already_set();
        return code;
    }

    // A cancel callback of the library; its data are a Working. It takes the GIL at most every 50 ms, and only in the
    // main thread after the first time, because no other thread handles signals.
    static int cancel(void* working);

    // Calls a Python function with the bounds so far, a list of (lower, upper); what it raises ends the call. A progress
    // callback of the library; its data are a Working.
    void show_progress_to(const pybind11::object& function, hausbench_query& query) {
        function_ = function;
        query.progress = &Working::progress;
        query.progress_data = this;
    }
    static int progress(void* working, const hausbench_interval* bounds, std::size_t count);

private:
    // Takes the GIL back. While the interpreter exits, the thread gets no GIL any more: it then waits for the end of the
    // process.
    void take_gil() const;

    using Clock = std::chrono::steady_clock;
    static constexpr std::chrono::milliseconds between{50};

    PyThreadState* thread_ = nullptr;
    Clock::time_point next_ = Clock::now() + between;
    bool handles_signals_ = true;
    bool interrupted_ = false;
    pybind11::object function_;
};

}  // namespace hausbench_python
