#include "python/core/working.h"

#include <cxxabi.h>
#include <unistd.h>

namespace py = pybind11;

namespace hausbench_python {
namespace {

bool in_main_thread() {
    const py::object main = py::module_::import("threading").attr("main_thread")();
    return main.attr("ident").cast<unsigned long>() == PyThread_get_thread_ident();
}

// Returns whether Python is ending.
bool finalizing() {
#if PY_VERSION_HEX >= 0x030d0000
    return Py_IsFinalizing() != 0;
#else
    return _Py_IsFinalizing() != 0;
#endif
}

// Returns whether a signal handler raised an exception, which stays set.
bool signal_raised() { return PyErr_CheckSignals() != 0; }

}  // namespace

// Python ends a thread that asks for the GIL too late by pthread_exit(), which unwinds the stack as an exception does. It
// must not unwind the library or destructors that need the GIL.
void Working::take_gil() const {
    try {
        PyEval_RestoreThread(thread_);
    } catch (abi::__forced_unwind&) {
        while (true) ::pause();
    }
}

int Working::cancel(void* data) {
    Working& working = *static_cast<Working*>(data);
    if (working.interrupted_ || finalizing()) return 1;
    if (!working.handles_signals_ || Clock::now() < working.next_) return 0;
    working.take_gil();
    try {
        working.handles_signals_ = in_main_thread();
        working.interrupted_ = working.handles_signals_ && signal_raised();
    } catch (py::error_already_set& error) {  // no caller in C++ may see it
        error.restore();
        working.interrupted_ = true;
    }
    working.thread_ = PyEval_SaveThread();
    working.next_ = Clock::now() + between;
    return working.interrupted_ ? 1 : 0;
}

int Working::progress(void* data, const hausbench_interval* bounds, std::size_t count) {
    Working& working = *static_cast<Working*>(data);
    if (working.interrupted_ || finalizing()) return 1;
    working.take_gil();
    try {
        py::list all;
        for (std::size_t i = 0; i < count; ++i) all.append(py::make_tuple(bounds[i].lower, bounds[i].upper));
        working.function_(all);
    } catch (py::error_already_set& error) {  // no caller in C++ may see it
        error.restore();
        working.interrupted_ = true;
    }
    working.thread_ = PyEval_SaveThread();
    return working.interrupted_ ? 1 : 0;
}

}  // namespace hausbench_python
