#include "python/core/shape.h"

#include "python/core/errors.h"
#include "python/core/working.h"

#include <pybind11/stl.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <tuple>
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
bool describe_array(const py::object& values, bool integers, hausbench_array& table) {
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

// Describes an array for which is_read() is true. No Python code may run before the description is used.
hausbench_array table_of(const py::object& values, const char* name, bool integers) {
    hausbench_array table;
    if (!describe_array(values, integers, table))
        throw_input_error((std::string(name) + ": the array changed during the call: keep it, or give a copy").c_str());
    return table;
}

}  // namespace

bool Shape::is_read(const py::object& values, bool integers) {
    hausbench_array table;
    return describe_array(values, integers, table);
}

Shape::Shape(const py::object& vertices, const py::object& faces, const std::optional<Stated>& stated) {
    hausbench_description about = HAUSBENCH_DESCRIPTION_INIT;
    if (stated) {
        std::string up;
        std::tie(about.segments, about.single_points, about.dropped_points, about.dropped_faces, about.unit, up) =
            *stated;
        about.up = up.empty() ? 0 : up.front();
    }
    const bool is_mesh = !faces.is_none();
    const hausbench_array points = table_of(vertices, "vertices", false);
    const hausbench_array triangles = is_mesh ? table_of(faces, "faces", true) : hausbench_array{};
    hausbench_error error = HAUSBENCH_ERROR_INIT;
    hausbench_shape* shape = nullptr;
    check(hausbench_shape_stating(&points, is_mesh ? &triangles : nullptr, &about, &shape, &error), error);
    shape_.reset(shape);
}

Shape Shape::read(const py::bytes& path, const Text& format, const Text& columns, bool drop_invalid, const Text& unit,
                  const Text& up) {
    const auto text = [](const Text& given) { return given ? std::optional<std::string>(*given) : std::nullopt; };
    const auto pointer = [](const std::optional<std::string>& given) { return given ? given->c_str() : nullptr; };
    const std::string name = path;
    const std::optional<std::string> texts[] = {text(format), text(columns), text(unit), text(up)};
    if (name.find('\0') != std::string::npos) throw_input_error("the path contains a null character: remove it");
    hausbench_read_options options = HAUSBENCH_READ_OPTIONS_INIT;
    options.format = pointer(texts[0]);
    options.columns = pointer(texts[1]);
    options.unit = pointer(texts[2]);
    options.up = pointer(texts[3]);
    options.drop_invalid = drop_invalid;
    hausbench_error error = HAUSBENCH_ERROR_INIT;
    hausbench_shape* shape = nullptr;
    Working working;
    const int code = working.run([&] { return hausbench_read_with(name.c_str(), &options, &shape, &error); });
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

py::tuple Shape::notes() const {
    py::list notes;
    for (std::size_t i = 0; const char* note = hausbench_note(get(), i); ++i) notes.append(text_of(note));
    return py::tuple(notes);
}

void define_shape(py::module_& module) {
    py::class_<Shape>(module, "Shape")
        .def(py::init<const py::object&, const py::object&, const std::optional<Shape::Stated>&>(), py::arg("vertices"),
             py::arg("faces"), py::arg("stated") = py::none())
        .def("describe",
             [](const Shape& self) {
                 const hausbench_description about = self.describe();
                 py::array_t<double> box({2, 3});
                 std::copy(about.box, about.box + 6, box.mutable_data());
                 const Shape::Stated stated{
                     about.segments,       about.single_points,
                     about.dropped_points, about.dropped_faces,
                     about.unit,           std::string(about.up ? 1 : 0, static_cast<char>(about.up))};
                 return py::make_tuple(about.is_mesh != 0, about.vertices, about.faces, box, about.diagonal, stated);
             })
        .def("vertices", &Shape::vertices)
        .def("faces", &Shape::faces)
        .def("notes", &Shape::notes);
    module.def("read", &Shape::read, py::arg("path"), py::arg("format"), py::arg("columns"), py::arg("drop_invalid"),
               py::arg("unit"), py::arg("up"));
    module.def("is_read", &Shape::is_read, py::arg("values"), py::arg("integers"));
}

}  // namespace hausbench_python
