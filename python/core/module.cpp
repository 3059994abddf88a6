// The extension module hausbench._core. hausbench/_core.pyi has its types.
#include "library/hausbench.h"
#include "python/core/errors.h"
#include "python/core/pair.h"
#include "python/core/shape.h"
#include "python/core/working.h"

#include <algorithm>
#include <cstddef>
#include <string>

namespace py = pybind11;

namespace hausbench_python {
namespace {

py::array_t<double> array_of(const double (&matrix)[16]) {
    py::array_t<double> array({4, 4});
    std::copy_n(matrix, 16, array.mutable_data());
    return array;
}

py::tuple verify(const py::bytes& path, const Shape& source, const Shape& target, const py::object& source_pose,
                 const py::object& target_pose) {
    const std::string name = path;
    if (name.find('\0') != std::string::npos) throw_input_error("the path contains a null character: remove it");
    hausbench_error error = HAUSBENCH_ERROR_INIT;
    hausbench_verdict verdict = HAUSBENCH_VERDICT_INIT;
    const auto at = matrix_of(source_pose), to = matrix_of(target_pose);
    Working working;
    const int code = working.run([&] {
        return hausbench_verify_posed(name.c_str(), source.get(), target.get(), at ? at->data() : nullptr,
                                      to ? to->data() : nullptr, &verdict, &error);
    });
    check(code, error);
    return py::make_tuple(verdict.accepted != 0, verdict.bounds.lower, verdict.bounds.upper, verdict.proven,
                          verdict.text, array_of(verdict.source_pose), array_of(verdict.target_pose));
}

py::list solvers() {
    py::list names;
    for (std::size_t i = 0; const char* name = hausbench_solver(i); ++i) names.append(name);
    return names;
}

// Pickling an object by protocol 0 or 1 would end the process in pybind11.
void refuse_pickling(const py::module_& module) {
    for (const char* name : {"Shape", "Query", "Pair", "Chain"}) {
        const py::object type = module.attr(name);
        const auto refuse = [](const py::object&) -> py::tuple {
            throw py::type_error("objects of hausbench._core cannot be pickled");
        };
        type.attr("__reduce__") = py::cpp_function(refuse, py::name("__reduce__"), py::is_method(type));
    }
}

// pybind11 before 2.12 takes arrays of numpy 2 for arrays of numpy 1, whose parts are elsewhere.
void refuse_numpy_2() {
#if PYBIND11_VERSION_HEX < 0x020c0000
    const auto version = py::module_::import("numpy").attr("__version__").cast<std::string>();
    if (std::stoi(version) >= 2)
        throw py::import_error(
            "hausbench was built with pybind11 " PYBIND11_TOSTRING(PYBIND11_VERSION_MAJOR) "." PYBIND11_TOSTRING(
                PYBIND11_VERSION_MINOR) ", which cannot read the arrays of numpy " +
            version + ": please install \"numpy<2\", or build it with pybind11 2.12");
#endif
}

}  // namespace
}  // namespace hausbench_python

PYBIND11_MODULE(_core, module) {
    using namespace hausbench_python;
    if (hausbench_interface() != HAUSBENCH_INTERFACE)
        throw py::import_error("libhausbench.so has another interface than this package: install both anew");
    refuse_numpy_2();
    define_shape(module);
    define_pair(module);
    refuse_pickling(module);
    module.def("verify", &verify, py::arg("path"), py::arg("source"), py::arg("target"), py::arg("source_pose"),
               py::arg("target_pose"));
    module.def("solvers", &solvers);
    module.def("version", &hausbench_version);
}
