#include "python/core/errors.h"

#include <string_view>
#include <utility>

namespace py = pybind11;

namespace hausbench_python {
namespace {

[[noreturn]] void throw_input_error(py::handle text, py::object row) {
    const py::object type = py::module_::import("hausbench.errors").attr("InputError");
    const py::object error = type(text, py::arg("row") = std::move(row));
    PyErr_SetObject(type.ptr(), error.ptr());
    throw py::error_already_set();
}

}  // namespace

py::object text_of(const char* text) {
    PyObject* decoded = PyUnicode_DecodeUTF8(text, static_cast<Py_ssize_t>(std::string_view(text).size()), "replace");
    if (!decoded) throw py::error_already_set();
    return py::reinterpret_steal<py::object>(decoded);
}

void throw_python(const hausbench_error& error) {
    const py::object text = text_of(error.text);
    if (error.code == HAUSBENCH_BAD_INPUT)
        throw_input_error(text, error.row >= 0 ? py::object(py::int_(error.row)) : py::object(py::none()));
    PyErr_SetObject(error.code == HAUSBENCH_NO_MEMORY ? PyExc_MemoryError : PyExc_RuntimeError, text.ptr());
    throw py::error_already_set();
}

void throw_input_error(const char* text) { throw_input_error(py::str(text), py::none()); }

}  // namespace hausbench_python
