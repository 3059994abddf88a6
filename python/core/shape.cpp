#include "python/core/shape.h"

#include "python/core/errors.h"
#include "python/core/working.h"

#include <algorithm>
#include <cstdint>
#include <string>
#include <utility>

namespace py = pybind11;

namespace hausbench_python {
namespace {

// Returns the library's name for the type of an array's numbers, or -1 if it does not read them.
int type_of(const py::array& array) {
    const py::dtype type = array.dtype();
    if (type.byteorder() != '=') return -1;
    if (type.kind() == 'f')
        return type.itemsize() == 8 ? HAUSBENCH_FLOAT64 : type.itemsize() == 4 ? HAUSBENCH_FLOAT32 : -1;
    if (type.kind() == 'i') return type.itemsize() == 8 ? HAUSBENCH_INT64 : type.itemsize() == 4 ? HAUSBENCH_INT32 : -1;
    return -1;
}

// Describes an array in place. Returns false if it has to be converted first: it is a subclass, such as a masked
// array, has another shape or type, or is not aligned.
bool describe(const py::object& values, bool integers, hausbench_array& table) {
    const auto& numpy = py::detail::npy_api::get();
    if (Py_TYPE(values.ptr()) != numpy.PyArray_Type_) return false;
    const auto array = py::reinterpret_borrow<py::array>(values);
    const int type = type_of(array);
    if (type < 0 || integers != (type == HAUSBENCH_INT64 || type == HAUSBENCH_INT32)) return false;
    if (array.ndim() != 2 || array.shape(1) != 3 || !(array.flags() & py::detail::npy_api::NPY_ARRAY_ALIGNED_))
        return false;
    table = {array.data(), array.shape(0), array.strides(0), array.strides(1), type, 0};
    return true;
}

// Makes `values` an array that describe() accepts. Throws InputError if it is not a table of numbers. May run any Python
// code, which may change every array.
void convert(py::object& values, const char* name, bool integers) {
    hausbench_array table;
    if (!describe(values, integers, table)) values = py::module_::import("hausbench.arrays").attr(name)(values);
}

// Describes an array that convert() made. No Python code may run before the description is used.
hausbench_array table_of(const py::object& values, const char* name, bool integers) {
    hausbench_array table;
    if (!describe(values, integers, table))
        throw_input_error((std::string(name) + ": the array changed during the call: keep it, or give a copy").c_str());
    return table;
}

std::string text_of(const Shape& shape) {
    const hausbench_description about = shape.describe();
    if (!about.is_mesh) return "<hausbench.Shape: " + std::to_string(about.vertices) + " points>";
    return "<hausbench.Shape: " + std::to_string(about.faces) + " triangles, " + std::to_string(about.vertices) +
           " vertices>";
}

}  // namespace

Shape::Shape(py::object vertices, py::object faces) {
    const bool is_mesh = !faces.is_none();
    convert(vertices, "vertices", false);
    if (is_mesh) convert(faces, "faces", true);
    const hausbench_array points = table_of(vertices, "vertices", false);
    const hausbench_array triangles = is_mesh ? table_of(faces, "faces", true) : hausbench_array{};
    hausbench_error error = HAUSBENCH_ERROR_INIT;
    hausbench_shape* shape = nullptr;
    check(hausbench_shape_of(&points, is_mesh ? &triangles : nullptr, &shape, &error), error);
    shape_.reset(shape);
}

Shape Shape::read(const py::bytes& path) {
    const std::string name = path;
    if (name.find('\0') != std::string::npos) throw_input_error("the path contains a null character: remove it");
    hausbench_error error = HAUSBENCH_ERROR_INIT;
    hausbench_shape* shape = nullptr;
    Working working;
    const int code = working.run([&] { return hausbench_read(name.c_str(), &shape, &error); });
    check(code, error);
    return Shape(shape);
}

hausbench_description Shape::describe() const {
    hausbench_description description = HAUSBENCH_DESCRIPTION_INIT;
    hausbench_error error = HAUSBENCH_ERROR_INIT;
    check(hausbench_describe(get(), &description, &error), error);
    return description;
}

py::array_t<double> Shape::vertices() const {
    py::array_t<double> values({static_cast<py::ssize_t>(describe().vertices), py::ssize_t{3}});
    hausbench_error error = HAUSBENCH_ERROR_INIT;
    check(hausbench_copy_out(get(), values.mutable_data(), nullptr, &error), error);
    return values;
}

py::object Shape::faces() const {
    const hausbench_description about = describe();
    if (!about.is_mesh) return py::none();
    py::array_t<std::int64_t> values({static_cast<py::ssize_t>(about.faces), py::ssize_t{3}});
    hausbench_error error = HAUSBENCH_ERROR_INIT;
    check(hausbench_copy_out(get(), nullptr, values.mutable_data(), &error), error);
    return values;
}

void define_shape(py::module_& module) {
    py::class_<Shape> shape(
        module, "Shape",
        "A triangle mesh or a point set. It never changes; structures built over it are kept with it.\n\n"
        "Shape(vertices, faces=None) copies the arrays: vertices (n, 3), in any unit of length, and faces (m, 3), "
        "rows\n"
        "of `vertices` from 0. Without faces it is a point set. Raises InputError.");
    shape.def(py::init<py::object, py::object>(), py::arg("vertices"), py::arg("faces") = py::none())
        .def_property_readonly(
            "is_mesh", [](const Shape& self) { return self.describe().is_mesh != 0; },
            "Whether this is a mesh, not a point set.")
        .def_property_readonly(
            "vertex_count", [](const Shape& self) { return self.describe().vertices; },
            "The number of vertices, with those that no face uses, or of points.")
        .def_property_readonly("vertices", &Shape::vertices, "A copy of the vertices or points: (n, 3), float64.")
        .def_property_readonly("faces", &Shape::faces, "A copy of the triangles: (m, 3), int64; None for a point set.")
        .def_property_readonly(
            "diagonal", [](const Shape& self) { return self.describe().diagonal; },
            "The diagonal of the bounding box of the shape, rounded.")
        .def_property_readonly(
            "box",
            [](const Shape& self) {
                const hausbench_description about = self.describe();
                py::array_t<double> box({2, 3});
                std::copy(about.box, about.box + 6, box.mutable_data());
                return box;
            },
            "The bounding box: (2, 3), the smallest coordinates, then the largest.")
        .def("__repr__", &text_of)
        .def(py::pickle([](const Shape& self) { return py::make_tuple(self.vertices(), self.faces()); },
                        [](const py::tuple& state) { return Shape(state[0], state[1]); }));
    module.def("read", &Shape::read, py::arg("path"));
}

}  // namespace hausbench_python
