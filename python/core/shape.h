// hausbench._core.Shape, which hausbench.Shape holds: a mesh or a point set, made from numpy arrays or a file.
#pragma once

#include "library/hausbench.h"

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <tuple>

namespace hausbench_python {

class Shape {
public:
    // Returns whether the library reads an array as it is; hausbench.arrays converts others. Runs no Python code.
    static bool is_read(const pybind11::object& values, bool integers);

    // How a shape came to be: segments, single_points, dropped_points, dropped_faces, unit and up of
    // hausbench_description, which states `up` as a string, empty if it is not stated.
    using Stated = std::tuple<std::int64_t, std::int64_t, std::int64_t, std::int64_t, double, std::string>;

    // Copies arrays for which is_read() is true; `faces` is None for a point set. Keeps the GIL, so that no Python code
    // changes an array meanwhile.
    Shape(const pybind11::object& vertices, const pybind11::object& faces, const std::optional<Stated>& stated);

    // Reads a file. `path` is in the encoding of the file system, and the other texts are in UTF-8.
    using Text = std::optional<pybind11::bytes>;
    static Shape read(const pybind11::bytes& path, const Text& format, const Text& columns, bool drop_invalid,
                      const Text& unit, const Text& up);

    const hausbench_shape* get() const { return shape_.get(); }
    hausbench_description describe() const;
    pybind11::array_t<double> vertices() const;
    pybind11::object faces() const;  // None for a point set
    pybind11::tuple notes() const;

private:
    struct Release {
        void operator()(hausbench_shape* shape) const { hausbench_shape_release(shape); }
    };
    explicit Shape(hausbench_shape* shape) : shape_(shape) {}

    std::unique_ptr<hausbench_shape, Release> shape_;
};

void define_shape(pybind11::module_& module);

}  // namespace hausbench_python
